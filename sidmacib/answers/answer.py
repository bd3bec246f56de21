"""What a model answers for a structure, in one form for all doors.

The command, notes, pages and the tables of a study show an `Answer`; none of them decides anything
or says anything of mechanics that does not stand here.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

from sidmacib.answers.structure_paths import StaticAnswer
from sidmacib.errors import CapacityError, reason
from sidmacib.mechanics.crushing import crushing_use
from sidmacib.mechanics.equilibrium import has_bonds
from sidmacib.mechanics.limit import LimitState
from sidmacib.problem import Counts, Failures, Problem
from sidmacib.quantities import four_digits, some_of
from sidmacib.structure.analysis.forces import CRUSHED
from sidmacib.structure.analysis.limit import LimitTilt, assumes, limit_mesh_error
from sidmacib.structure.analysis.tilt import moves_most

LIMIT, NO_DILATION, STATIC = "limit", "limit, no dilation", "static"
MOST = 6  # names in a note

Limit = LimitState | LimitTilt | CapacityError
Static = StaticAnswer | CapacityError


@dataclass(frozen=True, kw_only=True)
class Answer:
    """The load (N) that a ``model`` finds, or the angle (degrees) where gravity turns: ``value``.

    None where it has none, because of an ``error``. ``failures``, ``counts``, ``mode``: of the
    static model, see `StaticAnswer`; ``mesh_error``: of the value, over it. ``bounds``: whether
    nothing carries more, of limit analysis. ``notes``: what it rests on, and how blocks move.
    """

    model: str
    value: float | None = None
    failures: Failures | None = None
    counts: Counts | None = None
    mesh_error: float | None = None
    mode: str | None = None
    bounds: bool = True
    notes: tuple[str, ...] = ()
    error: CapacityError | None = None

    @property
    def note(self) -> str:
        """The notes in a line, or why there is no answer."""
        return "; ".join(self.notes) if self.error is None else reason(self.error)


def of_limit(problem: Problem, found: Limit) -> Answer:
    """What limit analysis has ``found``."""
    bounds = not has_bonds(problem.assembly)
    if isinstance(found, CapacityError):
        return Answer(model=LIMIT, bounds=bounds, error=found)
    value = found.load if isinstance(found, LimitState) else found.angle
    notes: tuple[str, ...] = ("in equilibrium at every tilt",)
    if found.mechanism is not None:
        moves = f"largest displacement: {moves_most(problem.assembly, found.mechanism)}"
        limited = _limited_by(problem, found) if isinstance(found, LimitState) else ()
        notes = (assumes(problem.assembly), *limited, moves)
    error = limit_mesh_error(problem, value)
    return Answer(model=LIMIT, value=value, mesh_error=error, bounds=bounds, notes=notes)


def _limited_by(problem: Problem, limit: LimitState) -> Iterator[str]:
    """That torque limits the load, with the load without that; which interfaces are crushed."""
    untwisted = limit.untwisted
    if untwisted is not None and four_digits(untwisted) != four_digits(limit.load):
        others = "no limit" if math.isinf(untwisted) else f"{four_digits(untwisted)} N"
        yield f"limited by the torque of interfaces ({others} without)"
    use = crushing_use(problem.assembly, limit.force)
    names = [problem.assembly.faces[number].name for number, of in use.items() if of >= CRUSHED]
    if names:
        yield f"crushed: {some_of(names, MOST)}"


def of_static(found: Static) -> Answer:
    """What the static model has ``found``: the load that counts, and why."""
    if isinstance(found, CapacityError):
        return Answer(model=STATIC, error=found)
    notes: tuple[str, ...] = (str(found.counts), f"failure mode: {found.mode}")
    if found.mechanism is not None:
        moves = moves_most(found.assembly, found.mechanism)
        notes = (*notes, f"largest displacement: {moves}")
    return Answer(
        model=STATIC,
        value=found.load,
        failures=found.failures,
        counts=found.counts,
        mesh_error=found.mesh_error,
        mode=found.mode,
        notes=notes,
    )
