"""The programme of limit analysis: forces that an assembly admits, in units of about 1.

`balanced` and `within` are the equilibrium and the cones of finite motion and of designs, too.
"""

from collections.abc import Collection, Iterator
from dataclasses import dataclass

import cvxpy as cp
import numpy as np
from scipy.sparse import csr_array, diags_array, vstack

from sidmacib.mechanics.assembly import Assembly, Floats, Integers
from sidmacib.mechanics.contact_law import Cone, ContactLaw
from sidmacib.mechanics.crushing import crushed_faces, resultant_rows, stress_blocks
from sidmacib.mechanics.equilibrium import (
    equilibrium_matrix,
    free_rows,
    row_units,
    sparse_rows,
)
from sidmacib.mechanics.in_plane import Reduced
from sidmacib.mechanics.loads import Loads
from sidmacib.mechanics.polygons import CondensedLocks
from sidmacib.mechanics.twist import Twist

LARGEST = 10.0  # approximate force of a node over its share of the scale, where forces concentrate


def balanced(
    matrix: csr_array,
    forces: cp.Variable,
    loads: cp.Expression | Floats,
    others: cp.Expression | float = 0.0,
) -> cp.Constraint:
    """The ``forces``, and ``others`` along the rows, balance ``loads``, (R,); see `in_units`."""
    return matrix @ cp.vec(forces, order="C") + others == loads


def in_units(matrix: csr_array, rows: Floats, forces: Floats) -> csr_array:
    """The ``matrix`` of equilibrium, (R, C), in units: N or N m of ``rows``, N of ``forces``.

    ``forces``: a unit for each node, contact or lock, which has one column or three.
    """
    row = np.repeat(np.arange(matrix.shape[0]), np.diff(matrix.indptr))
    columns = np.repeat(forces, matrix.shape[1] // max(len(forces), 1))
    data = matrix.data / rows[row] * columns[matrix.indices]
    return csr_array((data, matrix.indices, matrix.indptr), matrix.shape)


@dataclass(frozen=True)
class Scales:
    """Units in which the numbers of the programme are about 1.

    ``load``: N. ``node``: of the force at each node, N, (N,): ten times its share of that by area
    on a face of mean area. ``row``: of forces (N) and moments (N m) on the free pieces, (R,).
    """

    load: float
    node: Floats
    row: Floats

    @classmethod
    def of(cls, assembly: Assembly, loads: Loads) -> "Scales":
        """ValueError if gravity turns."""
        loads.require_proportional()
        share = assembly.nodes.area / assembly.nodes.area.sum()
        node = LARGEST * loads.scale * share * len(assembly.faces)
        # Forces over the load, and moments over the load times the length, are about 1.
        return cls(loads.scale, node, row_units(assembly) * loads.scale)


def admissible(
    assembly: Assembly,
    loads: Loads,
    cone: Cone,
    load: cp.Variable,
    reduced: Reduced,
    forces: cp.Variable,
    limited: Collection[int],
    twist: Twist | None = None,
    driven: Floats | None = None,
) -> list[cp.Constraint]:
    r"""The constraints of limit analysis on the ``load`` and the ``forces`` at nodes, in `Scales`.

    .. math::

        \begin{aligned}
        \max_{\lambda, s} \quad & \lambda \\
        \text{subject to} \quad & C s = p + \lambda q & \text{free pieces} \\
        & |s_t| \le \tau A + \mu_b s_n, \quad s_n \ge -\sigma A & \text{bonded nodes} \\
        & |s_t| \le \mu s_n & \text{rough dry nodes} \\
        & s_t = 0, \quad s_n \ge 0 & \text{smooth nodes} \\
        & |s_{t1}| \le \mu s_n, \quad |s_{t2}| \le \tau A, \quad s_n \ge 0 & \text{locks}
        \end{aligned}

    :math:`\lambda` is the load and p the permanent loads. The ``cone`` of the nodes gives tau A, mu
    and sigma A; a node that is not bonded is rough if its mu is above 0. Locks are contact points
    in their place, t1 along them and t2 across. Added are limits of torque by a ``twist``, the
    equilibrium of what is ``driven`` under the load, those of a rule for condensed locks, and those
    of pressed parts of ``limited`` faces by `sidmacib.mechanics.crushing`.
    """
    law, units = ContactLaw.of(assembly), Scales.of(assembly, loads)
    locks, others = np.flatnonzero(law.locked), np.flatnonzero(~law.locked[reduced.nodes])
    every = equilibrium_matrix(assembly)
    C = reduced.equations(in_units(every[free_rows(assembly)], units.row, units.node))
    p, q = map(reduced.left_of, scaled_loads(assembly, loads, units))
    scaled = Cone(cone.held / units.node, cone.slope, cone.torn / units.node)
    places, s = reduced.at_places(forces), reduced.at_nodes(forces)
    s_n, s_t = s[:, 0], s[:, 1:]
    constraints = [
        # ``s`` acts on the pieces above, C is for those below: hence no minus.
        balanced(C, forces, p + load * q),
        *within(scaled.at(reduced.nodes), places[:, 0], places[:, 1:], others),
    ]
    if driven is not None:
        of_nodes = (driven.ravel() @ every) * np.repeat(units.node, 3) / units.load
        constraints.append(of_nodes @ cp.vec(s, order="C") == load)
    if twist is not None and twist.motions:
        rough = np.flatnonzero(~law.cohesive & ~law.locked & (cone.slope > 0.0))
        works, limits = twist.rows(assembly, rough, units.node)
        most = _most_shear(scaled, s_n, rough)
        constraints.append(works @ cp.vec(s_t[rough], order="C") <= limits @ most)
    if len(locks):
        along, across = scaled.slope[locks], scaled.held[locks]
        constraints += [
            s_n[locks] >= 0,
            s_t[locks, 0] <= cp.multiply(along, s_n[locks]),
            -s_t[locks, 0] <= cp.multiply(along, s_n[locks]),
            s_t[locks, 1] <= across,
            -s_t[locks, 1] <= across,
        ]
    return [
        *constraints,
        *_of_rules(assembly, units, s_n, s_t),
        *_of_crushing(assembly, units, limited, s_n, np.where(law.cohesive, scaled.torn, 0.0)),
    ]


def within(
    cone: Cone, s_n: cp.Expression, s_t: cp.Expression, nodes: Integers
) -> list[cp.Constraint]:
    """Forces ``s_n``, (N,), and ``s_t``, (N, 2), at ``nodes`` keep the ``cone`` of all nodes.

    In the unit of ``cone``, and for all models: nothing else says what a node carries.
    """
    held, slope = cone.held[nodes], cone.slope[nodes]
    rubs = nodes[(held > 0.0) | (slope > 0.0)]
    smooth = nodes[(held <= 0.0) & (slope <= 0.0)]
    # A cone through the origin keeps s_n above 0 by itself.
    pulled = nodes[(held > 0.0) | (slope <= 0.0) | (cone.torn[nodes] > 0.0)]
    most = _most_shear(cone, s_n, rubs)
    if s_t.shape[1] == 1:  # in a plane
        rubbing = [s_t[rubs, 0] <= most, -s_t[rubs, 0] <= most]
    else:
        # By itself, and not as a norm, for which cvxpy adds an unknown and a row for each node.
        rubbing = [cp.SOC(most, s_t[rubs], axis=1)] if len(rubs) else []
    return [
        *rubbing,
        s_t[smooth] == 0,
        s_n[pulled] >= -cone.torn[pulled],
    ]


def _most_shear(cone: Cone, s_n: cp.Expression, nodes: Integers) -> Floats | cp.Expression:
    """The largest shear at ``nodes``; a number where none of them has friction."""
    held, slope = cone.held[nodes], cone.slope[nodes]
    return held + cp.multiply(slope, s_n[nodes]) if slope.any() else held


def _of_crushing(
    assembly: Assembly,
    units: Scales,
    limited: Collection[int],
    s_n: cp.Expression,
    sigma: Floats,
) -> Iterator[cp.Constraint]:
    """Limits of what presses ``limited`` faces; ``sigma``: tensile strengths of the nodes, (N,).

    Where bonds pull at one side of a face, more presses the other.
    """
    rows, limits = [], []
    for number, face, strength in crushed_faces(assembly):
        if number in limited:
            blocks = stress_blocks(face.outline)
            nodes, sums = resultant_rows(assembly, number, blocks.size)
            unit = units.node[nodes] / units.load
            rows.append(sparse_rows(blocks.normals @ sums * unit, nodes, len(sigma)))
            limits.append(blocks.limits * (strength * face.area / units.load))
    if not rows:
        return
    pull = np.zeros(len(sigma))
    if sigma.any():
        pull = cp.Variable(len(sigma), nonneg=True)
        yield pull <= sigma
        yield s_n + pull >= 0.0
    yield vstack(rows) @ (s_n + pull) <= np.concatenate(limits)


def _of_rules(
    assembly: Assembly, units: Scales, s_n: cp.Expression, s_t: cp.Expression
) -> Iterator[cp.Constraint]:
    """The limits of V and M of condensed locks, and the compression that these rest on."""
    for number, face in enumerate(assembly.faces):
        if isinstance(face, CondensedLocks) and (limits := face.limits):
            nodes = np.flatnonzero(assembly.nodes.face == number)
            unit, (run, row) = units.node[nodes], face.places.T
            shear, torque = limits.shear[:, None], limits.torque[:, None]
            # What the block below exerts on that above is opposite to V and M.
            along, across = torque * row * unit, (-shear - torque * run) * unit
            yield along @ s_t[nodes, 0] + across @ s_t[nodes, 1] <= 1.0
            if limits.compression > 0.0:
                yield unit / limits.compression @ s_n[nodes] >= 1.0


def square_sum(forces: cp.Variable, reduced: Reduced) -> cp.Expression:
    """The sum of s^2 / A, in the norm of the areas: of the same state however fine the mesh."""
    weights = np.repeat(LARGEST**2 * reduced.shares, forces.size // len(reduced.shares))
    return cp.quad_form(forces, diags_array(weights, format="csc"), assume_PSD=True)


def scaled_loads(assembly: Assembly, loads: Loads, units: Scales) -> tuple[Floats, Floats]:
    """Permanent and variable loads on the free pieces in ``units``, both (R,)."""
    rows = free_rows(assembly)
    p, q = (each.ravel()[rows] / units.row for each in (loads.permanent, loads.variable))
    return p, q * units.load
