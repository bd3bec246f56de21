"""What is said of what the models find for a structure: its `Answer`, with the notes on it.

The command, notes, pages and the tables of a study show these words; none of them says anything of
mechanics that does not stand here.
"""

import math
from collections.abc import Iterator

from sidmacib.answers.answer import LIMIT, STATIC, Answer
from sidmacib.answers.structure import Limit
from sidmacib.answers.structure_paths import StaticAnswer
from sidmacib.errors import CapacityError
from sidmacib.mechanics.crushing import crushing_use
from sidmacib.mechanics.equilibrium import has_bonds
from sidmacib.mechanics.limit import LimitState
from sidmacib.problem import Problem
from sidmacib.quantities import four_digits, some_of
from sidmacib.structure.analysis.forces import CRUSHED
from sidmacib.structure.analysis.limit import assumes, limit_mesh_error
from sidmacib.structure.analysis.tilt import moves_most

MOST = 6  # names in a note

Static = StaticAnswer | CapacityError


def of_limit(problem: Problem, found: Limit) -> Answer:
    """What limit analysis has ``found``."""
    bounds = not has_bonds(problem.assembly)
    if isinstance(found, CapacityError):
        return Answer(model=LIMIT, bounds=bounds, error=found)
    notes: tuple[str, ...] = ("in equilibrium at every tilt",)
    if found.mechanism is not None:
        moves = f"largest displacement: {moves_most(problem.assembly, found.mechanism)}"
        limited = _limited_by(problem, found) if isinstance(found, LimitState) else ()
        notes = (assumes(problem.assembly), *limited, moves)
    error = limit_mesh_error(problem, found.load)
    return Answer(model=LIMIT, value=found.load, mesh_error=error, bounds=bounds, notes=notes)


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
