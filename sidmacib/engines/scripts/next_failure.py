"""Search for the peak of a model whose bonds are cut one by one: from failure to failure."""

import math
from collections.abc import Iterable, Sequence
from typing import Protocol

from .assembly import GivenSearch
from .increments import AT_ONCE, BEYOND, GROWTH, HALF, LEAST_INCREMENT, STOPS, STRIDE
from .records import (
    BONDS,
    EngineOutcome,
    EnginePeak,
    NoAnswerError,
    NodeForce,
    failure_mode,
    require_contacts,
    require_standing,
)

APART = 0.05  # of the load, between equilibria that give a slope
NEAR = 0.01  # of a load: what is as near to it is reached in one go
AFTER = 0.05  # of the load, the first increment after a failure: the next one may be near
TOGETHER = 1e-4  # nodes whose utilisations differ by less fail together


class CutModel(Protocol):
    """A model whose bonds hold until the search cuts them."""

    load: float  # N, that it stands at

    def raised(self, load: float) -> EngineOutcome:
        """Raise the load (N) and wait for the outcome."""

    def cut(self, nodes: Iterable[int]) -> EngineOutcome:
        """Cut the bonds of nodes and wait for the outcome, or until others must fail."""

    def back(self) -> None:
        """Undo the last event."""

    @property
    def met(self) -> str | None:
        """Which two pieces have met, in words."""

    def utilisation(self) -> dict[int, float]:
        """Utilisation of each intact bond."""

    def record(self, load: float, stage: str) -> Sequence[NodeForce]:
        """Add the state to the history; forces of all nodes."""


def failure_ahead(used: Sequence[tuple[float, float]], otherwise: float) -> float:
    """The load (N) at which the most used bond will reach its strength, if all stays linear.

    ``used``: loads (N) and largest utilisations of the last equilibria; ``otherwise`` where they
    give no slope, which is taken over some distance, as every equilibrium is still a bit off.
    """
    load, most = used[-1]
    far = [(0.0, 0.0), *(point for point in used[:-1] if point[0] <= (1.0 - APART) * load)]
    before, less = far[-1]
    if not (load > before and less < most < math.inf):
        return otherwise
    return load + (1.0 - most) * (load - before) / (most - less)


def next_load(
    used: Sequence[tuple[float, float]],
    increment: float,
    tolerance: float,
    failed: float = math.inf,
) -> float:
    """The load to go to (N): at most just below the next failure, where that can be predicted.

    ``used``: loads and largest utilisations of the last equilibria; all but linear. Half the way
    to a load that ``failed``, and to that once more from nearby.
    """
    load = used[-1][0]
    failure = (1.0 - tolerance / 2) * failure_ahead(used, math.inf)
    # Near a failure all the way to it, otherwise most of it.
    share = 1.0 if failure - load < NEAR * failure else AT_ONCE
    furthest = min(load + increment, load + share * (failure - load))
    furthest = max(furthest, load * (1.0 + tolerance / 4))
    if furthest < failed or failed <= load * (1.0 + tolerance):
        return min(furthest, failed)
    return (load + failed) / 2


def towards_mechanism(load: float, expected: float, tolerance: float) -> float:
    """The increment (N) of a model without bonds: stop by stop to the ``expected`` load (N).

    From the last stop on it is small: a load that fails is dear, as all is done again from the
    beginning.
    """
    for share in STOPS:
        if load < share * expected * (1.0 - STRIDE * tolerance):
            return share * expected - load
    return STRIDE * tolerance * load


def failing(used: dict[int, float]) -> list[int]:
    """Nodes that fail together: the most used of those at their strength."""
    most = max(used.values())
    return [node for node, u in used.items() if u >= min(1.0, most) * (1.0 - TOGETHER)]


def most_used(used: dict[int, float]) -> float:
    """The largest utilisation; 0 without bonds."""
    return max(used.values(), default=0.0)


def peak_by_failures(model: CutModel, search: GivenSearch) -> EnginePeak:
    """The largest load that ``model`` carries.

    The load rises to just below the failure of the next bond, with a guide by halves of the first
    one. That bond is cut, at this load, and all that fail in turn; where no equilibrium follows is
    the peak. A load that fails with no bond at its limit is taken back and halves the increment.
    """
    outcome = model.raised(0.0)
    require_standing(outcome, model.met, search.guide)
    tolerance, first = search.tolerance, search.first_increment_N
    expected = search.guide.first_failure_N if search.guide else 0.0
    increment = HALF * expected or first
    first_failure, before, failed = None, list[tuple[float, float]](), math.inf
    used = model.utilisation()
    bonds = bool(used)
    while True:
        most = most_used(used)
        before.append((model.load, most))
        peak = model.load
        nodes = model.record(peak, EngineOutcome.EQUILIBRIUM.value)
        if most >= 1.0 - tolerance:
            first_failure = peak if first_failure is None else first_failure
            outcome, used = _cascade(model, used, tolerance)
            require_contacts(outcome, search.said(peak), model.met)
            if outcome is not EngineOutcome.EQUILIBRIUM:
                model.record(peak, outcome.value)
                return EnginePeak(peak, peak * (1.0 + tolerance), first_failure, BONDS, nodes)
            before, increment, expected, failed = [], max(first / 4, AFTER * peak), 0.0, math.inf
            continue
        if search.guide and not bonds and peak <= (1.0 + BEYOND) * search.guide.peak_N:
            increment = towards_mechanism(peak, search.guide.peak_N, tolerance)
        load = next_load(before, increment, tolerance, failed)
        while True:
            outcome = model.raised(load)
            balanced = outcome is EngineOutcome.EQUILIBRIUM
            used = model.utilisation() if balanced else {}
            over = most_used(used)
            near = load - peak <= tolerance * max(peak, first)
            if balanced and (over <= 1.0 + tolerance or near):
                break  # what is overstressed from one load to the next is cut there
            print(search.said(load), "breaks" if balanced else "fails", flush=True)
            model.record(load, EngineOutcome.OVERSTRESSED.value if balanced else outcome.value)
            if near:
                mode = failure_mode(outcome, False, search.said(load), model.met)
                return EnginePeak(peak, load, first_failure, mode, nodes)
            if load - peak < LEAST_INCREMENT * first:
                raise NoAnswerError("the assembly carries no load in this direction")
            known = balanced and math.isfinite(over)
            share = (1.0 - tolerance / 2 - most) / (over - most) if known else 0.5
            increment = share * (load - peak)
            failed = load if not balanced else failed
            model.back()
            load = peak + increment
        failed = failed if load < failed else math.inf
        print(search.said(load), "stands", flush=True)
        if load > search.last_N:
            raise NoAnswerError(search.no_peak)
        increment *= GROWTH if load >= expected else 1.0


def _cascade(
    model: CutModel, used: dict[int, float], tolerance: float
) -> tuple[EngineOutcome, dict[int, float]]:
    """Cut the bonds at their strength, and all that fail in turn; utilisations of the others."""
    outcome = EngineOutcome.EQUILIBRIUM
    while most_used(used) >= 1.0 - tolerance:
        cut = failing(used)
        print(f"{model.load:12.4f} N cuts {len(cut)} springs", flush=True)
        outcome = model.cut(cut)
        if outcome not in (EngineOutcome.EQUILIBRIUM, EngineOutcome.OVERSTRESSED):
            break
        used = model.utilisation()
    return outcome, used
