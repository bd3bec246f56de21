"""Derivatives of the limit load: by strengths, friction, loads and geometry, from one solution.

The limit load t is the optimum of a programme. By the envelope theorem its derivative by a
parameter p is that of the programme's Lagrangian, with the forces and multipliers of the optimum
held. The multipliers of the equations of equilibrium are the mechanism; those of the strengths
follow from how it deforms the nodes. So, for 1 m along the variable load,

    dt/dp = sum over nodes of (slip * d(shear limit)/dp + opening * d(tensile strength)/dp)
            - work of the mechanism on d(unbalanced forces)/dp,

where the unbalanced forces are those that the forces of the optimum leave on the changed pieces. A
bond opens by what its own friction does not explain.

Where several mechanisms are possible, or where a mechanism moves against forces that are not
determined, the load may have no derivative. So the problem is shaken a little to either side. Where
the results differ, the problem is solved at either end of the change as well, and if these results
differ too, none is given.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from sidmacib.mechanics.assembly import Assembly, Loads
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.crushing import crushed_faces
from sidmacib.mechanics.equilibrium import equilibrium_matrix, unbalanced_forces
from sidmacib.mechanics.limit import LimitState, limit_load

COARSE = 0.01  # of a parameter: a change that loads with limits of torque tell
SHAKE = 1e-5  # of loads, areas and lengths
SAME = 1e-3  # difference of derivatives to either side, over the largest or the load over the size


@dataclass(frozen=True)
class Change:
    """A small change of a parameter.

    ``before`` and ``after``: assembly and loads, with the same pieces, faces and number of nodes as
    those without the change. ``difference``: of the parameter between them. ``size``: of the
    parameter, 100 % of it.
    """

    before: tuple[Assembly, Loads]
    after: tuple[Assembly, Loads]
    difference: float
    size: float = 1.0

    @property
    def ends(self) -> tuple[tuple[Assembly, Loads], tuple[Assembly, Loads]]:
        """Before and after."""
        return self.before, self.after


@dataclass(frozen=True)
class LimitDerivatives:
    """The limit load, in N, and its derivatives by the names of the changes.

    In N per unit of each parameter; None where there is none.
    """

    load: float
    by: dict[str, float | None]


def limit_derivatives(
    assembly: Assembly, loads: Loads, changes: Mapping[str, Change], *, friction: bool = False
) -> LimitDerivatives:
    """The limit load of ``assembly`` and its derivatives; arguments and errors of `limit_load`.

    Three solutions are enough, however many changes there are, where the forces and the mechanism
    are unique. Where the torque of dry faces is limited, or blocks may be crushed, the loads at
    either end of each change tell instead, with limits of torque those of changes by at least
    `COARSE` only. ValueError for a change with other pieces, faces or numbers of nodes.
    """
    for name, change in changes.items():
        for other, _ in change.ends:
            if _shape(other) != _shape(assembly):
                raise ValueError(f"{name}: must keep pieces, faces and the number of nodes")
    state = limit_load(assembly, loads, friction=friction)
    found: dict[str, float | None] = {}
    if state.untwisted is not None or crushed_faces(assembly):
        for name, change in changes.items():
            if state.untwisted is not None and change.difference < COARSE * change.size:
                found[name] = None  # loads with limits of torque are not that accurate
                continue
            before, after = (limit_load(*end, friction=friction).load for end in change.ends)
            found[name] = (after - before) / change.difference
        return LimitDerivatives(state.load, found)
    shaken = [
        limit_load(*_shaken(assembly, loads, sign), friction=friction) for sign in (SHAKE, -SHAKE)
    ]
    for name, change in changes.items():
        value, *others = (
            _derivative(assembly, each, change, friction) for each in (state, *shaken)
        )
        least = max(abs(value), abs(state.load) / change.size)
        found[name] = value if abs(others[0] - others[1]) <= SAME * least else None
    return LimitDerivatives(state.load, found)


def _shape(assembly: Assembly) -> tuple[int, tuple[tuple[int, int], ...], list[int]]:
    ends = tuple((face.below, face.above) for face in assembly.faces)
    return len(assembly.pieces), ends, assembly.nodes.face.tolist()


def _derivative(assembly: Assembly, state: LimitState, change: Change, friction: bool) -> float:
    """The derivative of the limit load with the forces and the mechanism of ``state`` held."""
    left = [unbalanced_forces(*each, state.load, state.force) for each in change.ends]
    value = -float(np.sum(state.mechanism * (left[1] - left[0])))
    moved = equilibrium_matrix(assembly).T @ state.mechanism.ravel()
    closing, *along = moved.reshape(-1, 3).T
    slip, normal = np.hypot(*along), state.force[:, 0]
    law = ContactLaw.of(assembly)
    cone = law.cone(friction=friction)
    before, after = (ContactLaw.of(each).cone(friction=friction) for each, _ in change.ends)
    held, slope = after.held - before.held, after.slope - before.slope
    opening = np.maximum(-closing - cone.slope * slip, 0.0)
    sliding = slip * (held + normal * slope) + opening * (after.torn - before.torn)
    of_locks = np.abs(along[0]) * normal * slope + np.abs(along[1]) * held
    value += float(np.sum(np.where(law.locked, of_locks, sliding)))
    return value / change.difference


def _shaken(assembly: Assembly, loads: Loads, share: float) -> tuple[Assembly, Loads]:
    """The problem with all numbers a little different, by ``share`` of their size."""
    random, nodes = np.random.default_rng(0), assembly.nodes
    position = nodes.position + share * assembly.length * random.uniform(
        -1, 1, nodes.position.shape
    )
    area = nodes.area * (1.0 + share * random.uniform(-1.0, 1.0, nodes.area.shape))
    # In proportion: a force where there was none might find nothing that carries it.
    permanent = loads.permanent * (1.0 + share * random.uniform(-1.0, 1.0, loads.permanent.shape))
    return (
        replace(assembly, nodes=replace(nodes, position=position, area=area)),
        replace(loads, permanent=permanent),
    )
