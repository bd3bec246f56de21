"""Limit analysis of what is loaded in its plane, as most walls and arches are.

Nodes of a face that lie behind each other, seen along the normal of the plane, act as one. Their
limits are the same over their areas, so what they may carry together is what one node with the area
of all may carry; and where their middle lies in the plane, forces that are spread by areas neither
push a piece out of it nor turn it about an axis in it. So a limit load, and the state with the
least sum of s^2 / A, need two forces at each place in the plane and three equations for each piece,
in place of three at each node and six.
"""

from dataclasses import dataclass

import cvxpy as cp
import numpy as np
from scipy.sparse import csr_array, eye_array, kron

from sidmacib.mechanics.assembly import Assembly, Floats, Integers
from sidmacib.mechanics.contact_law import Cone, ContactLaw
from sidmacib.mechanics.equilibrium import face_axes
from sidmacib.mechanics.loads import Loads

OFF = 1e-9  # of the assembly's length, or of the loads: what may be out of a plane, or of a place
ALIKE = 1e-9  # of the limits at a place, over the areas of its nodes
OBLIQUE = 1e-3  # least sine of the angle between directions that make a plane


@dataclass(frozen=True, eq=False)
class Reduced:
    """Forces and equations of limit analysis, at all nodes or at places in a plane.

    ``nodes``: one at each place, (G,). ``shares``: of the areas of all nodes, (G,). ``spread``:
    forces in the frames of the nodes by those at the places, (3 N, 2 G), both over the areas.
    ``rows``: those of the equations for the free pieces that are left, (3 F, 6 F). None if all are.
    """

    nodes: Integers
    shares: Floats
    spread: csr_array | None = None
    rows: csr_array | None = None

    @classmethod
    def whole(cls, assembly: Assembly) -> "Reduced":
        """Nothing is reduced."""
        share = assembly.nodes.area / assembly.nodes.area.sum()
        return cls(np.arange(len(share)), share)

    @classmethod
    def of(cls, assembly: Assembly, loads: Loads, cone: Cone) -> "Reduced":
        """To the plane of ``assembly`` and ``loads`` if there is one, which ``cone`` allows."""
        whole = cls.whole(assembly)
        share, plane = whole.shares, _plane(assembly, loads)
        if plane is None or ContactLaw.of(assembly).locked.any():
            return whole
        axes = face_axes(assembly)
        along = np.cross(axes[:, 0], plane[2])
        place = _places(assembly, along)
        shares = np.asarray(np.bincount(place, share), float)
        nodes = np.unique(place, return_index=True)[1]
        middles = np.bincount(place, share * (assembly.nodes.position @ plane[2])) / shares
        pieces = np.array([each.centre @ plane[2] for each in assembly.pieces if not each.fixed])
        flat = np.ptp([*middles, *pieces]) <= OFF * assembly.length
        if not flat or not _alike(cone, share, nodes[place]):
            return whole
        equations = np.zeros((3, 6))
        equations[:2, :3], equations[2, 3:] = plane[:2], plane[2]
        tangents = np.einsum("fij,fj->fi", axes[:, 1:], along)[assembly.nodes.face]
        spread = _spread(place, tangents, len(nodes))
        return cls(nodes, shares, spread, kron(eye_array(len(pieces)), equations, "csr"))

    def unknowns(self) -> cp.Variable:
        """The forces at the places, one after the other.

        Of each that along the normal, and those along both tangents or along the plane.
        """
        return cp.Variable((3 if self.spread is None else 2) * len(self.nodes))

    def at_places(self, forces: cp.Variable) -> cp.Expression:
        """The ``forces`` at each place, (G, 3), or in the plane (G, 2)."""
        return cp.reshape(forces, (len(self.nodes), -1), order="C")

    def at_nodes(self, forces: cp.Variable) -> cp.Expression:
        """The ``forces`` in the frames of all nodes, (N, 3)."""
        every = forces if self.spread is None else self.spread @ forces
        return cp.reshape(every, (-1, 3), order="C")

    def equations(self, balance: csr_array) -> csr_array:
        """What is left of the ``balance``, (6 F, 3 N), of the free pieces under forces at nodes."""
        return balance if self.spread is None else csr_array(self.rows @ balance @ self.spread)

    def left_of(self, loads: Floats) -> Floats:
        """What is left of ``loads`` on the free pieces, (R,)."""
        return loads if self.rows is None else self.rows @ loads

    def multipliers(self, left: Floats) -> Floats:
        """Multipliers of all equations by those of the ones that are ``left``."""
        return left if self.rows is None else left @ self.rows


def _plane(assembly: Assembly, loads: Loads) -> Floats | None:
    """Two directions in the plane of all loads and of all normals of faces, and its normal, (3, 3).

    None if there is none, or more than one.
    """
    free = np.array([not piece.fixed for piece in assembly.pieces])
    both = np.vstack([loads.permanent[free], loads.variable[free] * loads.scale])
    forces, moments = both[:, :3], both[:, 3:] / assembly.length
    size = np.linalg.norm(forces, axis=1)
    acting = size > 0.0
    ways = np.vstack([face_axes(assembly)[:, 0], forces[acting] / size[acting, None]])
    across = np.cross(ways[0], ways)
    sines = np.linalg.norm(across, axis=1)
    if sines.max() < OBLIQUE or not acting.any():
        return None
    normal = across[sines.argmax()] / sines.max()
    in_it = moments - (moments @ normal)[:, None] * normal
    if max(np.abs(ways @ normal).max(), np.abs(in_it).max() / size.max()) > OFF:
        return None
    return np.array([ways[0], np.cross(normal, ways[0]), normal])


def _places(assembly: Assembly, along: Floats) -> Integers:
    """The number of the place of each node, (N,): on its face, and ``along`` that, (F, 3)."""
    face = assembly.nodes.face
    where = np.einsum("ni,ni->n", assembly.nodes.position, along[face])
    order = np.lexsort((where, face))
    new = (np.diff(face[order]) != 0) | (np.diff(where[order]) > OFF * assembly.length)
    place = np.zeros(len(face), np.int64)
    place[order[1:]] = np.cumsum(new)
    return place


def _spread(place: Integers, tangents: Floats, places: int) -> csr_array:
    """`Reduced.spread`: to nodes at each ``place``, (N,), by ``tangents`` in the plane, (N, 2)."""
    rows = np.arange(3 * len(place)).reshape(-1, 3)
    columns = 2 * place[:, None] + np.array([0, 1, 1])
    values = np.column_stack([np.ones(len(place)), tangents])
    shape = rows.size, 2 * places
    found = csr_array((values.ravel(), (rows.ravel(), columns.ravel())), shape)
    found.eliminate_zeros()
    return found


def _alike(cone: Cone, share: Floats, first: Integers) -> bool:
    """Whether nodes have, over their ``share`` of the areas, the limits of the ``first`` there."""
    limits = np.array([cone.held / share, cone.torn / share, cone.slope])
    most = np.abs(limits).max(axis=1, keepdims=True)
    return bool((np.abs(limits - limits[:, first]) <= ALIKE * most).all())
