"""Search for the peak of a model whose bonds are cut one by one: from failure to failure."""

import math
from collections.abc import Sequence
from typing import Any

from .assembly import GivenSearch
from .increments import AT_ONCE, BEYOND, GROWTH, HALF, LEAST_INCREMENT, STRIDE, next_stop
from .records import (
    BONDS,
    EngineOutcome,
    EnginePeak,
    NoAnswerError,
    failure_mode,
    require_contacts,
    require_standing,
)

APART = 0.05  # of the load, between equilibria that give a slope
NEAR = 0.01  # of a load: what is as near to it is reached in one go
AFTER = 0.05  # of the load, the first increment after a failure: the next one may be near
TOGETHER = 1e-4  # nodes whose utilisations differ by less fail together


def failure_ahead(used: Sequence[tuple[float, float]]) -> float:
    """The load (N) at which the most used bond will reach its strength, if all stays linear.

    ``used``: loads (N) and largest utilisations of the last equilibria. The slope is taken over
    some distance, as every equilibrium is still a bit off; infinite where they give none.
    """
    load, most = used[-1]
    far = [(0.0, 0.0), *(point for point in used[:-1] if point[0] <= (1.0 - APART) * load)]
    before, less = far[-1]
    if not (load > before and less < most < math.inf):
        return math.inf
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
    failure = (1.0 - tolerance / 2) * failure_ahead(used)
    # Near a failure all the way to it, otherwise most of it.
    share = 1.0 if failure - load < NEAR * failure else AT_ONCE
    furthest = min(load + increment, load + share * (failure - load))
    furthest = max(furthest, load * (1.0 + tolerance / 4))
    if furthest < failed or failed <= load * (1.0 + tolerance):
        return min(furthest, failed)
    return (load + failed) / 2


def failing(used: dict[int, float]) -> list[int]:
    """Nodes that fail together: the most used of those at their strength."""
    most = max(used.values())
    return [node for node, u in used.items() if u >= min(1.0, most) * (1.0 - TOGETHER)]


def most_used(used: dict[int, float]) -> float:
    """The largest utilisation; 0 without bonds."""
    return max(used.values(), default=0.0)


def peak_by_failures(model: Any, search: GivenSearch) -> EnginePeak:
    """The largest load that ``model`` carries.

    The model, such as LIGGGHTS', says of itself at which ``load`` it is, what it has ``met`` and
    the ``utilisation`` of each intact bond; its load is ``raised``, bonds are ``cut``, it can go
    ``back`` to where its load was raised last, and ``record`` its state.

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
    bonds = bool(used := model.utilisation())
    while True:
        peak, most = model.load, most_used(used)
        before.append((peak, most))
        nodes = model.record(peak, EngineOutcome.EQUILIBRIUM.value)
        if most >= 1.0 - tolerance:
            first_failure = peak if first_failure is None else first_failure
            outcome, used = _cascade(model, used, search)
            if outcome is not EngineOutcome.EQUILIBRIUM:
                model.record(peak, outcome.value)
                return EnginePeak(peak, peak * (1.0 + tolerance), first_failure, BONDS, nodes)
            before, increment, expected, failed = [], max(first / 4, AFTER * peak), 0.0, math.inf
            continue
        if search.guide and not bonds and peak <= (1.0 + BEYOND) * search.guide.peak_N:
            # Stop by stop, then little by little: after a load that fails, all is done again.
            stop = next_stop(peak, search.guide.peak_N, tolerance)
            increment = stop - peak if stop else STRIDE * tolerance * peak
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
            share = 0.5
            if balanced and math.isfinite(over):
                share = (1.0 - tolerance / 2 - most) / (over - most)
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
    model: Any, used: dict[int, float], search: GivenSearch
) -> tuple[EngineOutcome, dict[int, float]]:
    """Cut the bonds at their strength, and all that fail in turn; utilisations of the others."""
    outcome = EngineOutcome.EQUILIBRIUM
    while most_used(used) >= 1.0 - search.tolerance:
        cut = failing(used)
        print(f"{model.load:12.4f} N cuts {len(cut)} springs", flush=True)
        outcome = model.cut(cut)
        if outcome not in (EngineOutcome.EQUILIBRIUM, EngineOutcome.OVERSTRESSED):
            break
        used = model.utilisation()
    require_contacts(outcome, search.said(model.load), model.met)
    if not model.load:
        require_standing(outcome, model.met, search.guide)
    return outcome, used
