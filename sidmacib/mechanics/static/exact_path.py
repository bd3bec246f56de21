"""A path of the static model to rounding error, and how far each node is used at its end.

The solver's equilibria are good to ten digits, and its first failure to five. What is
differentiated should be known better: so Newton's method goes on from there.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import Floats
from sidmacib.mechanics.solution import Equilibrium
from sidmacib.mechanics.static.linearised import (
    BOND_FRICTION,
    COHESION,
    SHEAR,
    TENSION,
    Linearised,
    System,
)

EXACT = 1e-12  # unbalanced force over the loads, and utilisation less 1
STEPS = 20  # of Newton's method, from an equilibrium of the solver to an exact one
FAR = 1e-3  # over the load: the first failure is nearer to the end of the path


@dataclass(frozen=True)
class State:
    """An equilibrium: ``load`` in N, ``unknowns`` in m, and its linear equations."""

    load: float
    unknowns: Floats
    here: Linearised


def exact_path(system: System, path: Sequence[Equilibrium], units: Floats) -> list[State]:
    """The equilibria of ``path`` to rounding error, with the first failure in place of the last.

    ``units``: see `Springs.units`. `CapacityError` if the first failure is not near.
    """
    whole, slip = path[0].state.whole, np.zeros_like(path[0].state.slip)
    states: list[State] = []
    for point in path[:-1]:
        states.append(_balanced(system, point.load, point.unknowns * units, slip, whole))
        slip = _slip(states[-1], slip)
    last = path[-1]
    state = _balanced(system, last.load, last.unknowns * units, slip, whole)
    for _ in range(STEPS):
        used = utilisations(system, state.here.force, whole)
        if abs(used.max() - 1.0) <= EXACT:
            break
        kind, node = divmod(int(used.argmax()), used.shape[1])
        onward = state.here.solved(system.variable)
        force_by = state.here.tangent @ (system.motion @ onward)
        rise = used_by(system, (), state.here.force, force_by.reshape(-1, 3, 1), (kind, node))
        load = state.load + float((1.0 - used.max()) / rise[0])
        if not abs(load - last.load) <= FAR * last.load:  # true for NaN as well
            raise CapacityError("derivatives: a bond without strength fails once it is stressed")
        unknowns = state.unknowns + (load - state.load) * onward
        state = _balanced(system, load, unknowns, slip, whole)
    return [*states, state]


def _balanced(system: System, load: float, unknowns: Floats, slip: Floats, whole: Floats) -> State:
    """The equilibrium at ``load`` (N) by Newton's method from one that is almost exact."""
    target = system.at(load)
    for _ in range(STEPS):
        here = Linearised.of(system, unknowns, slip, whole)
        residual = target - system.motion.T @ here.force.ravel()
        if np.abs(residual).max() <= EXACT * np.abs(target).max():
            break
        unknowns = unknowns + here.solved(residual)
    return State(load, unknowns, here)


def _slip(state: State, before: Floats) -> Floats:
    """The slip (m) of the nodes after an equilibrium, (N, 2)."""
    here = state.here
    strain = here.force[:, 1:] / here.system.nodes[SHEAR][:, None]
    return np.where(here.held[:, None], before, before + here.apart[:, 1:] - strain)


def utilisations(system: System, force: Floats, whole: Floats) -> Floats:
    """Shear and tension over strength at each node, (2, N); 0 without a bond or strength."""
    shear = np.hypot(force[:, 1], force[:, 2]) - system.nodes[BOND_FRICTION] * force[:, 0]
    demand, strength = np.array([shear, -force[:, 0]]), system.nodes[[COHESION, TENSION]]
    counts = (whole > 0.0) & (strength > 0.0)
    return np.divide(demand, strength, out=np.zeros_like(demand), where=counts)


def used_by(
    system: System,
    slopes: Sequence[System],
    force: Floats,
    force_by: Floats,
    criterion: tuple[int, int],
) -> Floats:
    """Derivatives of a utilisation: of shear (0) or tension (1) and of the node, (P + 1,)."""
    kind, node = criterion
    (normal, *along), (normal_by, *along_by) = force[node], force_by[node]
    mine, others = system.nodes[:, node], [slope.nodes[:, node] for slope in slopes]
    strength = mine[(COHESION, TENSION)[kind]]
    strength_by = np.array([*(other[(COHESION, TENSION)[kind]] for other in others), 0.0])
    if kind == 1:
        demand, demand_by = -normal, -normal_by
    else:
        size = np.hypot(*along)
        rough_by = np.array([*(other[BOND_FRICTION] for other in others), 0.0])
        demand = size - mine[BOND_FRICTION] * normal
        demand_by = (along[0] * along_by[0] + along[1] * along_by[1]) / size
        demand_by = demand_by - mine[BOND_FRICTION] * normal_by - rough_by * normal
    return np.asarray((demand_by - demand / strength * strength_by) / strength)
