"""What the static model answers for a structure: paths, and what limit analysis takes from them.

Limit analysis bounds what dry blocks carry. A peak above it is one on cells that are too large,
though meshes may agree on it by chance.

Crushing: the model follows elastic interfaces that no pressure crushes. As long as their
resultants satisfy the limits of `sidmacib.mechanics.crushing`, its path is that of blocks that can
be crushed. Beyond, the parts of interfaces that are crushed yield, and forces go elsewhere, which
limit analysis finds: the lower of its load and the model's is the capacity. Where forces can go
nowhere else, crushing begins at the limit load.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from scipy.optimize import bisect

from sidmacib.answers.structure_paths import (
    CRUSHING,
    LOWER,
    NO_BOND,
    SMALL,
    StaticAnswer,
    unbounded_answer,
    without_other_meshes,
)
from sidmacib.errors import CapacityError, InfeasibleError, NoEquilibriumError, UnboundedError
from sidmacib.mechanics.assembly import Assembly, Floats
from sidmacib.mechanics.contact_law import NodeState
from sidmacib.mechanics.crushing import crushed_faces, crushing_use
from sidmacib.mechanics.equilibrium import is_dry
from sidmacib.mechanics.limit import LimitState
from sidmacib.mechanics.solution import Equilibrium, Mode, OtherSearches, Solver
from sidmacib.mechanics.static import peak_of, solver_of
from sidmacib.problem import UNKNOWN, Counts, Failures, MeshErrors, Problem
from sidmacib.quantities import four_digits
from sidmacib.structure.analysis.limit import LimitTilt, limit_mesh_error, limit_or_tilt
from sidmacib.structure.loads import naming_permanent
from sidmacib.structure.structure import refined, with_dry_joints

BEYOND = 1.001  # over the limit load: where a path ends that has no other end
NOT_CRUSHED = "no interface is crushed"
MOST_BLOCKS = 3000  # that can move: the path of more takes many hours
PRECISION = 1e-6  # of where crushing begins between two equilibria
Limit = LimitState | LimitTilt | CapacityError


def static_answer(problem: Problem, limit: Limit | None = None) -> StaticAnswer:
    """The answer of the static model for a structure, as a `Problem` on the cells of its file.

    ``limit``: of limit analysis, if it is known, which bounds blocks that are dry or are crushed.
    `CapacityError` if it has none, or too many blocks; `NoEquilibriumError` if the structure does
    not stand.
    """
    if (free := sum(not piece.fixed for piece in problem.assembly.pieces)) > MOST_BLOCKS:
        most = f"the path of at most {MOST_BLOCKS:,} is followed"
        raise CapacityError(f"{free:,} free blocks; {most}")
    with naming_permanent(problem.loads):
        answer = _of_model(problem, limit)
        if answer.counts.peak:
            return answer
        try:
            dry = _of_model(with_dry_joints(problem), None)
            if dry.load > answer.load:
                return _of_dry_joints(answer, dry)
        except CapacityError:
            pass
        if not answer.failures.first > 0.0:
            doubt = answer.counts.why
            raise CapacityError(f"bonds fail under its own weight alone, and {doubt}")
        return answer


def _of_dry_joints(answer: StaticAnswer, dry: StaticAnswer) -> StaticAnswer:
    """The answer for ``dry`` joints in place of that with bonds, whose peak does not count."""
    known = "" if dry.counts.why == NO_BOND else f"{dry.counts.why}; "
    return replace(
        dry,
        failures=Failures(answer.failures.first, dry.load),
        mesh_errors=MeshErrors(answer.mesh_errors.first, dry.mesh_error),
        counts=Counts(peak=True, why=f"{known}with bonds, {answer.counts.why}", dry=True),
    )


def _of_model(problem: Problem, limit: Limit | None) -> StaticAnswer:
    """The answer for bonds, or for dry joints, as they are."""
    if crushed_faces(problem.assembly):
        return with_crushing(problem, limit)
    return _bounded_answer(problem, limit)


def _bounded_answer(problem: Problem, limit: Limit | None) -> StaticAnswer:
    """The answer for blocks that are not crushed."""
    answer = unbounded_answer(problem)
    if not is_dry(problem.assembly):
        return answer
    most = _bound(problem, answer.load, limit)
    if answer.load > (1.0 + SMALL) * most:
        answer = unbounded_answer(problem, most)
    if not most < (1.0 - LOWER) * answer.load:
        return answer
    alone = problem.loads.raised.told(answer.load)
    why = f"{answer.counts.why}; limit analysis is below the static model alone, {alone}"
    return _limited(problem, answer, most, why)


def _bound(problem: Problem, load: float, limit: Limit | None) -> float:
    """The load (N or degrees) of limit analysis, if it is below ``load``; else no bound."""
    try:
        return _limit_load(problem, limit, (1.0 - LOWER) * load)
    except CapacityError:
        return math.inf


def with_crushing(problem: Problem, limit: Limit | None) -> StaticAnswer:
    """The answer for blocks that can be crushed.

    ``limit``: of limit analysis, if it is known. `NoEquilibriumError` if they do not stand.
    """
    try:
        answer = unbounded_answer(problem)
        without = problem.loads.raised.told(answer.load)
    except UnboundedError as error:
        answer, without = _as_far_as(problem, _limit_load(problem, limit), error), "any load"
    begins = crushing_begins(answer.assembly, answer.path)
    if begins is None or begins[0] > answer.load:
        return _because(answer, NOT_CRUSHED)
    load, place = begins
    words = f"{place} is at its compressive strength from {problem.loads.raised.told(load)} on"
    try:
        most = _limit_load(problem, limit)
    except UnboundedError:
        most = math.inf
    if most >= answer.load:
        return _because(answer, words)
    why = f"limited by crushing in limit analysis; {words}; without crushing {without}"
    limited = _limited(problem, answer, most, why)
    return replace(limited, mode=CRUSHING, mechanism=None)


def _limited(problem: Problem, answer: StaticAnswer, most: float, why: str) -> StaticAnswer:
    """The ``answer`` up to the load ``most`` of limit analysis; ``why`` it is what counts."""
    only_ended = answer.mode in (Mode.PRESSED, Mode.TURNED)  # of the path beyond that load
    return replace(
        answer,
        mode=str(Mode.MECHANISM) if only_ended else answer.mode,
        failures=Failures(*np.minimum(answer.failures, most).tolist()),
        mesh_errors=MeshErrors(answer.mesh_errors.first, limit_mesh_error(problem, most)),
        counts=Counts(peak=True, why=why),
        path=_up_to(answer.path, most),
    )


def _as_far_as(problem: Problem, most: float, error: UnboundedError) -> StaticAnswer:
    """The answer to just beyond the load ``most`` (N) where the model has no limit: ``error``."""
    assembly, loads = refined(problem.assembly), problem.loads
    told = f"{error} without crushing; limit analysis: {loads.raised.told(most)} with it"
    loads.raised.require_newtons(CapacityError(told))
    found = peak_of(_UpTo(solver_of(assembly, loads), BEYOND * most))
    failures = Failures(found.first_failure_load, found.peak.load)
    return StaticAnswer(
        *(assembly, failures, found.path, found.mode),
        mesh_errors=UNKNOWN,
        counts=without_other_meshes(failures),
    )


class _UpTo(OtherSearches):
    """A ``solver`` that finds no equilibria above the load ``most`` (N)."""

    def __init__(self, solver: Solver, most: float) -> None:
        super().__init__(solver)
        self.most = most

    def solve(
        self, load: float, guess: Floats, state: NodeState, *, thorough: bool = False
    ) -> Equilibrium:
        if load > self.most:
            raise NoEquilibriumError(f"no equilibrium at {four_digits(load)} N")
        return self.solver.solve(load, guess, state, thorough=thorough)


def crushing_begins(assembly: Assembly, path: Sequence[Equilibrium]) -> tuple[float, str] | None:
    """The load at which an interface is first at its compressive strength, and its name.

    Between two equilibria of a ``path`` forces are linear. None if none is.
    """
    before: Equilibrium | None = None
    for point in path:
        if _most_used(assembly, point)[0] > 1.0:
            found = point if before is None else _where_full(assembly, before, point)
            return found.load, _most_used(assembly, found)[1]
        before = point
    return None


def _where_full(assembly: Assembly, before: Equilibrium, after: Equilibrium) -> Equilibrium:
    """The state between two equilibria in which the first interface is used in full."""

    def left(part: float) -> float:
        return 1.0 - min(_most_used(assembly, _between(before, after, part))[0], 2.0)

    return _between(before, after, bisect(left, 0.0, 1.0, xtol=PRECISION))


def _most_used(assembly: Assembly, point: Equilibrium) -> tuple[float, str]:
    use = crushing_use(assembly, point.force)
    number = max(use, key=lambda face: use[face])
    return use[number], assembly.faces[number].name


def _between(before: Equilibrium, after: Equilibrium, part: float) -> Equilibrium:
    """The state at a ``part`` of the way, whose forces are in equilibrium, and admissible."""
    return replace(
        before,
        **{
            name: getattr(before, name) + part * (getattr(after, name) - getattr(before, name))
            for name in ("load", "unknowns", "displacement", "force")
        },
    )


def _up_to(path: Sequence[Equilibrium], load: float) -> tuple[Equilibrium, ...]:
    """The ``path`` up to a ``load`` that it reaches."""
    for number, (before, after) in enumerate(pairwise(path), start=1):
        if after.load >= load:
            part = (load - before.load) / (after.load - before.load)
            return (*path[:number], replace(_between(before, after, part), load=load))
    return tuple(path)


def _limit_load(problem: Problem, limit: Limit | None, most: float | None = None) -> float:
    """The load of limit analysis with crushing, or the angle where gravity turns.

    ``most``: see `limit_or_tilt`.
    `NoEquilibriumError` if they do not stand.
    """
    try:
        if isinstance(limit, CapacityError):
            raise limit
        return (limit_or_tilt(problem, most) if limit is None else limit).load
    except InfeasibleError as error:
        raise NoEquilibriumError(str(error)) from None


def _because(answer: StaticAnswer, words: str) -> StaticAnswer:
    why = f"{answer.counts.why}; {words}"
    return replace(answer, counts=replace(answer.counts, why=why))
