"""Checks of a design by models that had no part in it, on locks that are cut out of the blocks.

The design's model gives locks no height and no tensile strength, and lets all forces redistribute.
Limit analysis of the locks as pieces has their height, their sides and their roots in tension;
without dilation sliding does not open joints; the static model follows elastic joints with brittle
roots and the history of friction.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from sidmacib.answers.structure import bond_fails, static_answer
from sidmacib.answers.structure_limit import limit_state
from sidmacib.design.file import Task, designed
from sidmacib.design.sizing import Choice, carried
from sidmacib.errors import CapacityError, UnboundedError
from sidmacib.mechanics.assembly import Assembly, Loads
from sidmacib.mechanics.sliding import sliding_limit
from sidmacib.mechanics.static.model import static_peak
from sidmacib.problem import Problem
from sidmacib.structure.files.structure_file import assembly_of

DESIGN, LIMIT, SLIDING = "design", "limit", "limit, no dilation"
FIRST, PEAK = "static, first failure", "static, peak"
CLOSE = 1e-6  # over the factor: what a check may lack, for rounding


@dataclass(frozen=True)
class Check:
    """Share of a case that a model carries.

    ``factor``: load over that of the case; infinite if it can grow without limit, None without an
    answer. ``decides``: whether the design stands or falls by it.
    """

    case: str
    model: str
    factor: float | None
    note: str
    decides: bool

    def passes(self, factor: float) -> bool:
        """Whether it does not speak against the design."""
        if self.factor is None:
            return not self.decides
        return not self.decides or self.factor >= factor * (1.0 - CLOSE)


def checks_of(
    task: Task, choice: Choice, note: Callable[[str], None] = lambda _: None
) -> tuple[Check, ...]:
    """Loads of all cases by the design's model and the others, with the rows of ``choice``."""
    found = [
        Check(each.case, DESIGN, each.factor, "condensed locks, associated friction", True)
        for each in carried(task.structure, choice)
    ]
    assembly = assembly_of(designed(task, choice), folder=task.folder)
    for case in task.cases:
        note(f"checking {case.name} on {len(assembly.pieces)} pieces")
        load = case.amount(assembly)
        of_case = _of_case(assembly, case.loads(assembly), load, task)
        found += [
            Check(case.name, model, value and value / load, words, decides)
            for model, value, words, decides in of_case
        ]
    return tuple(found)


def _of_case(
    assembly: Assembly, loads: Loads, amount: float, task: Task
) -> Iterator[tuple[str, float | None, str, bool]]:
    """Model, load (N), note, whether it decides; ``amount``: of the case (N)."""
    yield LIMIT, *_answer(lambda: _limit(assembly, loads)), True
    if task.asked.no_dilation:
        # Its rounds need not settle: without an answer it counts neither way.
        load, words = _answer(lambda: _sliding(assembly, loads))
        yield SLIDING, load, words, load is not None
    try:
        yield from _static(
            Problem(assembly, loads), task.asked.first_failure, amount * task.asked.factor
        )
    except CapacityError as error:
        unlimited = math.inf if isinstance(error, UnboundedError) else None
        yield FIRST, unlimited, _line(error), task.asked.first_failure
        yield PEAK, unlimited, _line(error), not task.asked.first_failure


def _static(
    problem: Problem, first_failure: bool, needed: float
) -> Iterator[tuple[str, float, str, bool]]:
    """Model, load (N), note, whether it decides: of the first failure and of the peak.

    That decides which counts, see `static_answer`, or the ``first_failure`` where that is asked
    for. Both are less their mesh errors. Where already the peak on the cells of the file is below
    what is ``needed`` (N), there are no other meshes.
    """
    coarse = static_peak(*problem)
    if coarse.peak.load < needed:
        ends = f"failure mode: {coarse.mode}"
        yield FIRST, coarse.first_failure_load, "first bond failure, else the peak", first_failure
        yield PEAK, coarse.peak.load, ends, not first_failure
        return
    answer = static_answer(problem)
    first, peak = (
        load * (1.0 - (error or 0.0))
        for load, error in zip(answer.failures, answer.mesh_errors, strict=True)
    )
    decides = first_failure or not answer.counts.peak
    about = [f"less its mesh error of {error or 0.0:.2g}" for error in answer.mesh_errors]
    # A peak is never below the first failure, whatever the estimates of their errors.
    if bond_fails(answer.failures):
        peak = max(peak, first)
    else:
        first = peak = min(first, peak)
    ends = f"{about[1]}; {answer.counts}; failure mode: {answer.mode}"
    yield FIRST, first, f"{about[0]}; first bond failure, else the peak", decides
    yield PEAK, peak, ends, not decides


def _limit(assembly: Assembly, loads: Loads) -> tuple[float, str]:
    return limit_state(assembly, loads).load, "locks modelled as solids; ductile bonds"


def _sliding(assembly: Assembly, loads: Loads) -> tuple[float, str]:
    return sliding_limit(assembly, loads).state.load, "non-dilatant sliding"


def _answer(model: Callable[[], tuple[float, str]]) -> tuple[float | None, str]:
    try:
        return model()
    except UnboundedError as error:
        return math.inf, _line(error)
    except CapacityError as error:
        return None, _line(error)


def _line(error: Exception) -> str:
    return " ".join(str(error).split())
