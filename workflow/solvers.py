"""The models of the joint's pieces that need no engine. To add one, see CONTRIBUTING.md."""

from collections.abc import Callable
from dataclasses import dataclass

from sidmacib.contact_law import Flags, NodeLaw
from sidmacib.discretisation import Discretisation, Floats
from sidmacib.equilibrium import free_rows, permanent_and_reference
from sidmacib.limit import limit_load
from sidmacib.loading import PieceLoad
from sidmacib.static import static_peak


@dataclass(frozen=True)
class State:
    """Node forces that balance a ``load`` (N, along the direction of loading).

    ``displacement``: the one that the load works on, in m; None in a rigid model. ``force``: (N, 3)
    in N, on the piece above in the frame of the face, see `sidmacib.equilibrium.face_frames`.
    """

    load: float
    displacement: float | None
    force: Floats
    bonded: Flags


@dataclass(frozen=True)
class Outcome:
    """What a model finds: states on the way, the last of them the peak, and loads in N.

    ``failed_load``: the smallest known that the joint does not carry. ``first_failure_load``: where
    the first node fails; None in a model without failure.
    """

    path: tuple[State, ...]
    failed_load: float
    first_failure_load: float | None


@dataclass(frozen=True)
class Solver:
    """A model in this process. ``brittle``: it follows brittle failure and knows no other."""

    name: str
    solve: Callable[[Discretisation, tuple[PieceLoad, ...]], Outcome]
    brittle: bool


def _static(model: Discretisation, loads: tuple[PieceLoad, ...]) -> Outcome:
    solution = static_peak(model, loads)
    reference = permanent_and_reference(model, loads)[1][free_rows(model)]
    path = tuple(
        State(p.load, float(reference @ p.displacement), p.force, p.state.bonded)
        for p in solution.path
    )
    return Outcome(path, solution.failed_load, solution.first_failure_load)


def _limit(model: Discretisation, loads: tuple[PieceLoad, ...]) -> Outcome:
    found = limit_load(model, loads)
    state = State(found.load, None, found.force, NodeLaw.of(model).cohesive)
    return Outcome((state,), found.load, None)


SOLVERS = {
    solver.name: solver
    for solver in (Solver("static", _static, brittle=True), Solver("limit", _limit, brittle=False))
}
