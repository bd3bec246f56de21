"""Limit analysis of an assembly: pieces and nodes of the distinct elements, rigid-plastic.

The static theorem: the largest load for which node forces exist that keep every piece in
equilibrium and no strength exceeded. At inner nodes |s_t| <= tau A and s_n >= -sigma A; dry nodes
cannot pull, and resist along the face only where friction is asked for, |s_t| <= mu s_n
(associated: sliding would dilate, so it overestimates). Forces can be redistributed freely: every
lock is used as far as the geometry allows, with no reduction rule put in.

A first programme finds the load. Many states of forces carry it; a second programme, which also
weighs the sum of s^2 / A a little, picks the one where it is least, which is unique.
"""

import math
from dataclasses import dataclass

import cvxpy as cp
import numpy as np
from scipy.sparse import csr_array

from sidmacib.errors import CapacityError, SolverError
from sidmacib.mechanics.assembly import Assembly, Floats, Integers, Kind, Loads
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.equilibrium import equilibrium_matrix, free_rows, row_units
from sidmacib.mechanics.optimisation import solve

# Of the load, over itself or the loads' scale if that is larger, and the digits that are checked
# then. In joints of an even number of locks the last ones are lost in rounding.
ACCURACIES = {1e-9: 9, 1e-7: 7}
# Of the second aim in units of the first, so that it decides between equals only.
SMALL = (1e-5, 1e-7, 1e-9)
LOST = 1e-8  # of the load, at most, to the second aim
LARGEST = 10.0  # force of a node over its part of the scale, about, where forces concentrate
WHAT = "limit analysis"
MOST_MEMORY = 2**31  # bytes, of the equations of equilibrium


@dataclass(frozen=True)
class LimitState:
    """The limit load, and of the forces that carry it those of least sum of s^2 / A.

    ``load``: along the direction, in N. ``force``: (N, 3) in N, what the piece below each node
    exerts on the piece above, in the frame of the face (normal, two tangents).
    """

    load: float
    force: Floats


def limit_load(assembly: Assembly, loads: Loads, *, friction: bool = False) -> LimitState:
    """The largest multiple of the variable ``loads`` that ``assembly`` carries.

    Accurate to 1e-9, sometimes 1e-7, of the load or of ``loads.scale``, whichever is larger, and
    rounded to that. Associated friction has no limit under a fixed plate, which can press as hard
    as it likes: put a force in its place, see `sidmacib.hold_down`. ValueError otherwise;
    `sidmacib.errors.CapacityError` where there is no largest load.
    """
    if friction and any(face.kind is Kind.PLATE for face in assembly.faces):
        raise ValueError(
            "friction: true is not possible under a fixed plate, where associated friction has no "
            "limit; put a force in its place"
        )
    _require_room(assembly)
    programme = _Programme(assembly, loads, friction)
    load, force = cp.Variable(), cp.Variable((len(assembly.nodes.area), 3))
    constraints = programme.constraints(load, force)
    met = solve(cp.Problem(cp.Maximize(load), constraints), WHAT, *ACCURACIES)
    largest = float(load.value)
    # In the norm of the areas: the same state however fine the mesh.
    size = cp.sum_squares(cp.multiply(LARGEST * np.sqrt(programme.share)[:, None], force))
    for small in SMALL:
        aim = cp.Maximize(load - small * size)
        of_forces = solve(cp.Problem(aim, constraints), WHAT, *ACCURACIES)
        if largest - float(load.value) <= max(LOST, met) * max(abs(largest), 1.0):
            break
    else:
        raise SolverError(f"{WHAT}: no forces of least size were found that carry the limit load")
    digits = ACCURACIES[max(met, of_forces)]
    return LimitState(
        _rounded(largest * programme.scale, programme.scale, ACCURACIES[met]),
        # Noise is rounded away; plus 0: no -0 in tables.
        programme.unit[:, None] / LARGEST * (np.round(LARGEST * force.value, digits) + 0.0),
    )


def _require_room(assembly: Assembly) -> None:
    """`CapacityError` if the equations of ``assembly``, kept as a full matrix, are too large."""
    pieces, nodes = len(assembly.pieces), len(assembly.nodes.area)
    size = 8 * (6 * pieces) * (3 * nodes)
    if size > MOST_MEMORY:
        raise CapacityError(
            f"{WHAT}: {pieces:,} pieces with {nodes:,} nodes would take {size / 2**30:.1f} GiB; "
            f"they must take {MOST_MEMORY / 2**30:g} GiB or less: fewer locks or a coarser mesh"
        )


class _Programme:
    """The constraints that both programmes share, in units in which their numbers are about 1."""

    def __init__(self, assembly: Assembly, loads: Loads, friction: bool) -> None:
        law, rows = ContactLaw.of(assembly), free_rows(assembly)
        area = assembly.nodes.area
        self.share = area / area.sum()
        # Where nothing has strength, permanent loads are the only measure.
        self.scale = loads.scale or float(np.abs(loads.permanent).max()) or 1.0
        # A node's unit: its part of the scale on a face of mean area, and more.
        self.unit = LARGEST * self.scale * self.share * len(assembly.faces)
        # Forces over the scale, and moments over the scale times the length, are about 1.
        size = row_units(assembly) * self.scale
        columns = np.repeat(self.unit, 3)
        self.balance = csr_array(equilibrium_matrix(assembly)[rows] / size[:, None] * columns)
        self.permanent = loads.permanent.ravel()[rows] / size
        self.variable = loads.variable.ravel()[rows] / size * self.scale
        self.shear, self.tension = law.shear_strength / self.unit, law.tensile_strength / self.unit
        self.friction = law.friction
        rough = ~law.cohesive & friction & (law.friction > 0.0)
        self.inner, self.rough = np.flatnonzero(law.cohesive), np.flatnonzero(rough)
        self.smooth = np.flatnonzero(~law.cohesive & ~rough)

    def constraints(self, load: cp.Variable, force: cp.Variable) -> list[cp.Constraint]:
        """Equilibrium under ``load``, and the law of the nodes."""
        normal, shear = force[:, 0], force[:, 1:]
        inner, rough, smooth = self.inner, self.rough, self.smooth

        def size(own: Integers) -> cp.Expression:
            return cp.norm(shear[own], 2, axis=1)

        return [
            # The pieces below get the opposite of ``force``: hence no minus on this side.
            self.balance @ cp.vec(force, order="C") == self.permanent + load * self.variable,
            size(inner) <= self.shear[inner],
            normal[inner] >= -self.tension[inner],
            size(rough) <= cp.multiply(self.friction[rough], normal[rough]),
            shear[smooth] == 0,
            normal[smooth] >= 0,
        ]


def _rounded(load: float, scale: float, digits: int) -> float:
    """``load`` to so many ``digits``, of itself or of ``scale`` if that is larger; never -0."""
    largest = max(abs(load), scale)
    return round(load, digits - 1 - math.floor(math.log10(largest))) + 0.0
