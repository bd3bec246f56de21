"""Derivatives of the first failure of the static model, by implicit differentiation of its path.

Along the path the displacements u and the slip s of the dry nodes follow from

    B' f(B u - s, p) = W(p) + t F(p),    s after = B u - (shear force over shear stiffness),

increment by increment, with p a parameter of the assembly and t the load. Both equations are
differentiated in every increment: the derivative of u solves the equations of Newton's last step
with another right side, and that of s goes on to the next increment. So a sliding node carries the
derivative of its limit, a sticking one that of its anchor. At the first failure the utilisation of
a node is 1, which gives the derivative of the load. The increments stay the same fractions of it.

How B, the stiffnesses, the strengths and the loads depend on p is found by differences. These are
smooth functions known to rounding error, so that nine digits are left.

Where a contact is just about to open, to close or to slide, as faces that only touch under the
weight, and where nodes fail together, less of p may have another effect than more of it. Both are
then given: each such contact is taken to go on the way that the change moves it.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import Assembly, Floats, Integers, Loads
from sidmacib.mechanics.change import Change
from sidmacib.mechanics.contact_law import Flags
from sidmacib.mechanics.springs import Springs
from sidmacib.mechanics.static.exact_path import State, exact_path, used_by, utilisations
from sidmacib.mechanics.static.linearised import FRICTION, NORMAL, SHEAR, Linearised, System
from sidmacib.mechanics.static.model import path_to_first_failure

TOGETHER = 1e-9  # largest difference of the utilisations of nodes that fail together
SAME = 1e-7  # difference of results, per 100 % of a parameter, that counts as 0
ON_EDGE = 1e-6  # change of the parameter, over it, within which no contact may open, close or slide
LEAN = 1e-8  # of the change: contacts on an edge are moved on by this much of what it does
NOTHING = 1e-12  # over the largest displacement: rounding error
ROUNDS = 12  # of moving them on
STAYS = 1e-6  # change of the distance from that, over the largest one: a contact that stays there


@dataclass(frozen=True)
class Derivative:
    """Derivatives in N per unit of the parameter, for ``less`` and for ``more`` of it.

    None where none is found: where nothing carries the forces of the change.
    """

    less: float | None
    more: float | None

    @property
    def value(self) -> float | None:
        """The derivative, if it is the same for less and more."""
        return self.more if self.less == self.more else None


@dataclass(frozen=True)
class FailureDerivatives:
    """The first failure, in N, and its derivatives by the names of the changes.

    ``faces``: names of the faces with a node that fails.
    """

    load: float
    faces: tuple[str, ...]
    by: dict[str, Derivative]


def failure_derivatives(
    assembly: Assembly, loads: Loads, changes: Mapping[str, Change]
) -> FailureDerivatives:
    """The first failure of ``assembly`` and its derivatives for ``changes``.

    `CapacityError` where no bond fails first, where one fails as soon as it is stressed, and for
    elastic pieces; errors of `sidmacib.static_first_failure`.
    """
    if any(piece.elastic and not piece.fixed for piece in assembly.pieces):
        raise CapacityError("derivatives: for rigid pieces only; elastic ones have none here")
    path, failing = path_to_first_failure(assembly, loads)
    if not failing.any():
        raise CapacityError("derivatives: pieces slide or rock before a bond fails")
    if len(path) < 2:
        raise CapacityError("derivatives: a bond fails before the load is raised")
    system = System.of(assembly, loads)
    slopes = [
        System.of(*each.after).less(System.of(*each.before), each.difference / each.size)
        for each in changes.values()
    ]
    states = exact_path(system, path, Springs.of(assembly).units)
    end = _differentiated(system, slopes, states)
    names = np.unique(assembly.nodes.face[end.nodes])
    found = {}
    for place, (name, each) in enumerate(changes.items()):
        sides = _derivative(system, slopes[place], states, end, place, each.rises)
        less, more = (None if math.isnan(x) else float(x * end.load / each.size) for x in sides)
        found[name] = Derivative(less, more)
    return FailureDerivatives(
        float(end.load), tuple(assembly.faces[face].name for face in names.tolist()), found
    )


# --- its derivatives -----------------------------------------------------------------------------
@dataclass(frozen=True)
class _Edges:
    """Nodes of one equilibrium that are just about to open, to close or to slide, E of them.

    ``distance``: from that, (E,), and ``by``: its derivatives, (E, P + 1), both over the largest
    distance; ``node``: which they are, (E,), and how they move, ``apart_by``, (E, 3, P + 1).
    """

    node: Integers
    distance: Floats
    by: Floats
    apart_by: Floats


@dataclass(frozen=True)
class _End:
    """The first failure: its ``load`` (N), and the ``nodes`` that reach their strength, (G,).

    ``used_by``: change of the utilisation of each of these nodes, for 100 % more of P parameters
    and then of the load, (G, P + 1). ``edges``: of each equilibrium on the way.
    """

    load: float
    nodes: Integers
    used_by: Floats
    edges: tuple[_Edges, ...]

    def load_by(self, place: int) -> Floats:
        """Change of the load at which each node fails, over it, by a parameter, (G,)."""
        return np.asarray(-self.used_by[:, place] / self.used_by[:, -1])


def _differentiated(
    system: System,
    slopes: Sequence[System],
    states: Sequence[State],
    leaning: Sequence[Linearised] | None = None,
) -> _End:
    """The derivatives at the end of a path, for those of the system by each parameter over it.

    ``leaning``: the equations in place of those of ``states``.
    """
    load, end = states[-1].load, states[-1].here
    shape = (system.nodes.shape[1], 3, len(slopes) + 1)
    shear, shear_by = system.nodes[SHEAR, :, None], _columns([p.nodes[SHEAR] for p in slopes])
    slip_by, edges = np.zeros((shape[0], 2, shape[2])), []
    for place, state in enumerate(states):
        here = state.here if leaning is None else leaning[place]
        force = here.force
        apart_by = _columns([p.motion @ state.unknowns for p in slopes]).reshape(shape)
        apart_by[:, 1:] -= slip_by
        given = _columns([here.force_by(p.nodes).ravel() for p in slopes])
        given += here.tangent @ apart_by.reshape(given.shape)
        right = _columns([p.at(state.load) - p.motion.T @ force.ravel() for p in slopes])
        right[:, -1] = state.load * system.variable
        further = system.motion @ here.carried(right - system.motion.T @ given)
        apart_by += further.reshape(shape)
        force_by = (given + here.tangent @ further).reshape(shape)
        edges.append(_edges(state.here, slopes, apart_by))
        strain = force[:, 1:] / shear
        strain_by = (force_by[:, 1:] - strain[:, :, None] * shear_by[:, None]) / shear[:, None]
        slip_by = np.where(here.held[:, None, None], 0.0, slip_by + apart_by[:, 1:] - strain_by)
    used = utilisations(system, end.force, end.whole)
    failing = [(int(kind), int(node)) for kind, node in np.argwhere(used >= used.max() - TOGETHER)]
    rises = [used_by(system, slopes, end.force, force_by, each) for each in failing]
    return _End(load, np.array(failing)[:, 1], np.array(rises), tuple(edges))


def _columns(by_parameter: Sequence[Floats]) -> Floats:
    """Derivatives by each parameter side by side, and 0 for the load, (N, P + 1)."""
    return np.column_stack([*by_parameter, np.zeros_like(by_parameter[0])])


def _edges(here: Linearised, slopes: Sequence[System], apart_by: Floats) -> _Edges:
    """The nodes on an edge, see `_Edges`."""
    mine, free, normal = here.system.nodes, ~here.held, here.apart[:, 0]
    size = np.hypot(here.apart[:, 1], here.apart[:, 2])
    along = np.divide(here.apart[:, 1:].T, size, out=np.zeros((2, len(size))), where=size > 0.0)
    size_by = np.einsum("kn,nkp->np", along, apart_by[:, 1:])
    slope_by = _columns(
        [p.nodes[FRICTION] * mine[NORMAL] + mine[FRICTION] * p.nodes[NORMAL] for p in slopes]
    )
    limit_by = slope_by * normal[:, None]
    limit_by += (mine[FRICTION] * mine[NORMAL])[:, None] * apart_by[:, 0]
    beyond_by = _columns([p.nodes[SHEAR] * size for p in slopes]) - limit_by
    beyond_by += mine[SHEAR][:, None] * size_by
    closed, rough = free & (normal > 0.0), mine[FRICTION] > 0.0
    opens = _near(normal, apart_by[:, 0], free, float(np.abs(normal).max()))
    limit = float(here.limit[free].max(initial=0.0))
    slides = _near(here.beyond, beyond_by, closed & rough, limit)
    node, distance, by = (np.concatenate(pair) for pair in zip(opens, slides, strict=True))
    return _Edges(node, distance, by, apart_by[node])


def _near(
    distance: Floats, by: Floats, counts: Flags, scale: float
) -> tuple[Integers, Floats, Floats]:
    """The nodes that count and are near an edge; their distances and derivatives over ``scale``."""
    if not scale:
        return np.zeros(0, np.int64), np.zeros(0), np.zeros((0, by.shape[1]))
    near = np.flatnonzero(counts & (np.abs(distance) <= ON_EDGE * scale))
    return near, distance[near] / scale, by[near] / scale


def _derivative(
    system: System, slope: System, states: Sequence[State], end: _End, place: int, rises: bool
) -> tuple[float, float]:
    """Changes of the load over it, for 100 % less and more of a parameter; NaN if not found."""
    if not rises and not _kinked(end, place):
        value = float(end.load_by(place).mean())
        return value, value
    more = _sided(system, slope, states, 1.0)
    less = more if rises else _sided(system, slope, states, -1.0)
    if abs(more - less) <= SAME:
        less = more = (less + more) / 2.0
    return less, more


def _kinked(end: _End, place: int) -> bool:
    """Whether less of a parameter may have another effect than more of it."""
    each = end.load_by(place)
    if np.ptp(each) > SAME:
        return True
    for edges in end.edges:
        moves = np.abs(edges.by[:, place] + each.mean() * edges.by[:, -1])
        if ((moves > STAYS) & (np.abs(edges.distance) <= ON_EDGE * moves)).any():
            return True
    return False


def _sided(system: System, slope: System, states: Sequence[State], sign: float) -> float:
    """The change of the load over it, for 100 % more (1) or less (-1), the latter times -1.

    Contacts on an edge are moved a little further along, as the change moves them, which again
    changes how they move: repeated until the result stays. NaN if it does not.
    """
    leaning, last = [state.here for state in states], math.inf
    for _ in range(ROUNDS):
        end = _differentiated(system, [slope], states, leaning)
        found = float((sign * end.load_by(0)).min())  # the first node to fail counts
        if abs(found - last) <= SAME / 10.0:
            return sign * found
        if math.isnan(found):
            break
        last = found
        leaning = [
            _leaning(state.here, edges, sign, found)
            for state, edges in zip(states, end.edges, strict=True)
        ]
    return math.nan


def _leaning(here: Linearised, edges: _Edges, sign: float, rise: float) -> Linearised:
    """The equations where nodes on an edge have moved on, as the parameter and the load change."""
    if not len(edges.node):
        return here
    apart = here.apart.copy()
    on_edge = apart[edges.node]
    on_edge[np.abs(on_edge) <= NOTHING * np.abs(apart).max()] = 0.0
    moves = sign * edges.apart_by[:, :, 0] + rise * edges.apart_by[:, :, 1]
    apart[edges.node] = on_edge + LEAN * moves
    return replace(here, apart=apart)
