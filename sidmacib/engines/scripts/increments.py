"""Search for the peak of a model that breaks by itself: by ever smaller increments of the load."""

import math
from dataclasses import dataclass
from typing import Any

from .assembly import GivenSearch
from .records import (
    EngineOutcome,
    EnginePeak,
    NoAnswerError,
    failure_mode,
    require_standing,
)

AT_ONCE = 0.9  # of the way to a load at which something is expected: so far in one go
BEYOND = 0.01  # of a load at which something is expected: further on, nothing is any more
HALF = 0.5  # of such a load: a stop on the way, as displacements do not grow quite in proportion
STOPS = (HALF, AT_ONCE, 0.97, 0.99)  # of a load at which something is expected
STRIDE = 2.0  # over the tolerance, the increment near a load at which something is expected
GROWTH = 1.5  # of the increment while the load is carried
LEAST_INCREMENT = 1e-9  # over the first: less is no load


def next_stop(load: float, expected: float, tolerance: float) -> float | None:
    """The next stop (N) on the way to an ``expected`` load (N); None after the last."""
    stops = (share * expected for share in STOPS)
    return next((stop for stop in stops if load < stop * (1.0 - STRIDE * tolerance)), None)


@dataclass
class Bracket:
    """Between which loads (N) the next event is: the first failure of a node, then the peak.

    ``load`` is carried; ``event`` was not, or broke the first node, when it was last tried.
    ``expected``: where the event should be; 0: nothing is. ``increment``: the next one.
    """

    load: float
    event: float
    expected: float
    increment: float
    tolerance: float

    def next_load(self) -> float:
        """The load to go to.

        Stop by stop to an expected event, from the last stop on by increments; half the way to a
        load that failed, and to that once more from nearby, and so slowly.
        """
        if self.event <= self.load * (1.0 + self.tolerance):
            return self.event
        if self.event < math.inf:
            return (self.load + self.event) / 2
        stop = next_stop(self.load, self.expected, self.tolerance)
        return stop or self.load + self.increment

    def carries(self, load: float) -> None:
        """Note that ``load`` is carried, and the increment to go on by."""
        if load <= self.expected * (1.0 + BEYOND):
            self.increment = STRIDE * self.tolerance * load
        elif load >= self.event:
            self.increment = load - self.load
        elif self.event == math.inf:
            self.increment *= GROWTH
        self.event = self.event if load < self.event else math.inf
        self.load = load


def peak_by_increments(model: Any, search: GivenSearch) -> EnginePeak:
    """The largest load that ``model`` carries.

    The model, such as YADE's, says of itself whether it is ``breakable``, how many nodes are
    ``broken``, what it has ``met`` and its ``node_forces``; its load is ``raised``, and it can
    ``keep`` a state and ``go_back`` to it.

    With a guide, the load goes in few steps to most of the first failure that is expected, and then
    on by small increments. Without, the increment grows until the assembly fails. From then on
    every failure is taken back to the last equilibrium and halves the increment, so that the last
    one, which decides, is small and slow, whatever was expected. The first node that fails is
    looked for in the same way, before the load goes on. Exits with a reason where the
    last failure is none: no bond breaks, and the pieces neither move off nor come to rest.
    """
    outcome = model.raised(0.0, 0.0, (0.0, 1.0))
    require_standing(outcome, model.met, search.guide)
    least, guide = search.first_increment_N, search.guide
    expected = guide.first_failure_N if guide else 0.0
    bracket = Bracket(0.0, math.inf, expected, least, search.tolerance)
    first_failure = 0.0 if model.breakable and model.broken() else None
    while True:
        model.keep()
        nodes, broken = model.node_forces(), model.broken()
        while True:
            start, load = bracket.load, bracket.next_load()
            outcome = model.raised(start, load, (1.0, 1.0))
            balanced = outcome is EngineOutcome.EQUILIBRIUM
            breaks = model.breakable and model.broken() > broken
            first = balanced and breaks and first_failure is None
            # The first node may fail at a load that is next to none.
            near = load - start <= search.tolerance * (max(start, least) if first else start)
            if balanced and (near or not first):
                break
            print(search.said(load), "breaks" if first else "fails", flush=True)
            if near:
                mode = failure_mode(outcome, breaks, search.said(load), model.met)
                if first_failure is None and breaks:
                    first_failure = start
                return EnginePeak(start, load, first_failure, mode, nodes)
            if load - start < LEAST_INCREMENT * least:
                raise NoAnswerError("the assembly carries no load in this direction")
            bracket.event = load
            model.go_back()
        bracket.carries(load)
        if first:  # the first failure is found: on to the peak
            first_failure, expected = load, guide.peak_after(load) if guide else 0.0
            increment = STRIDE * search.tolerance * load
            bracket = Bracket(load, math.inf, expected, increment, search.tolerance)
        print(search.said(load), "stands", flush=True)
        if load > search.last_N:
            raise NoAnswerError(search.no_peak)
