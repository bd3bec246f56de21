"""The models of the joint's pieces that need no engine. To add one, see CONTRIBUTING.md."""

from collections.abc import Callable
from dataclasses import dataclass

from sidmacib.mechanics.assembly import Assembly, Floats, Loads
from sidmacib.mechanics.contact_law import Flags, NodeLaw
from sidmacib.mechanics.equilibrium import free_rows
from sidmacib.mechanics.limit import limit_load
from sidmacib.mechanics.static import static_peak


@dataclass(frozen=True)
class State:
    """Node forces that balance a ``load`` (N, along the direction of loading).

    ``displacement``: the one that the load works on, in m; None in a rigid model. ``force``: (N, 3)
    in N, on the piece above in the frame of the face, see `sidmacib.mechanics.equilibrium.face_frames`.
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
    solve: Callable[[Assembly, Loads], Outcome]
    brittle: bool


def _static(assembly: Assembly, loads: Loads) -> Outcome:
    solution = static_peak(assembly, loads)
    reference = loads.variable.ravel()[free_rows(assembly)]
    path = tuple(
        State(p.load, float(reference @ p.displacement), p.force, p.state.bonded)
        for p in solution.path
    )
    return Outcome(path, solution.failed_load, solution.first_failure_load)


def _limit(assembly: Assembly, loads: Loads) -> Outcome:
    found = limit_load(assembly, loads)
    state = State(found.load, None, found.force, NodeLaw.of(assembly).cohesive)
    return Outcome((state,), found.load, None)


SOLVERS = {
    solver.name: solver
    for solver in (Solver("static", _static, brittle=True), Solver("limit", _limit, brittle=False))
}
