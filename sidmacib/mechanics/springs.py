"""Contact nodes as springs between pieces, in terms of the pieces' displacements.

The unknowns are the displacements of the free pieces, so their number does not depend on the mesh.
Rotations are multiplied by the assembly's ``length`` and moments divided by it: all unknowns are in
m, all forces in N and all stiffnesses in N/m.

Pieces are rigid: each has three displacements of its centroid and three rotations, and the nodes of
a face move as a rigid body.

The same springs, unbroken, give the natural frequencies and the compliance that set the scales of
an explicit computation: its time step, its loading rate, and the displacement beyond which the
assembly can only have failed.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from sidmacib.mechanics.assembly import Assembly, Floats, Integers, Kind, Loads
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.equilibrium import face_axes, free_rows

RIGID = 6  # unknowns of a rigid piece


@dataclass(frozen=True)
class Springs:
    """Springs at the nodes, and how the pieces move them.

    The motion of a face, w, is the displacement of the piece below relative to the piece above, at
    the face's middle: three translations along the face's normal and tangents and three rotations
    about them. A node at ``place`` (p, q) of its face moves by delta = (w0 + q w4 - p w5,
    w1 - q w3, w2 + p w3).

    ``start``: first node of each face, then the number of nodes, (F + 1,). ``place``: of each node
    along the tangents, from the face's middle, over ``length``, (N, 2). ``piece``: the pieces below
    and above each face, counted among the free pieces, -1 for a fixed one, (F, 2). ``axes``: normal
    and tangents of each face, (F, 3, 3). ``levers``: from the centroid of either piece to the
    face's middle, over ``length``, (F, 2, 3). ``unknowns``: first unknown of each free piece, then
    the number of unknowns, (P + 1,). ``length`` in m.
    """

    contact_law: ContactLaw
    start: Integers
    place: Floats
    piece: Integers
    axes: Floats
    levers: Floats
    unknowns: Integers
    length: float

    @classmethod
    def of(cls, assembly: Assembly) -> "Springs":
        """The springs of ``assembly``."""
        nodes, faces = assembly.nodes, assembly.faces
        middle = np.array([face.middle for face in faces])
        axes = face_axes(assembly)
        arms = (nodes.position - middle[nodes.face]) / assembly.length
        tangents = axes[nodes.face, 1:]
        number = np.cumsum([not piece.fixed for piece in assembly.pieces]) - 1
        number[[piece.fixed for piece in assembly.pieces]] = -1
        ends = np.array([(face.below, face.above) for face in faces])
        centres = np.array([piece.centre for piece in assembly.pieces])
        levers = (middle[:, None] - centres[ends]) / assembly.length
        return cls(
            ContactLaw.of(assembly),
            np.searchsorted(nodes.face, np.arange(len(faces) + 1)),
            (tangents * arms[:, None]).sum(axis=2),
            number[ends],
            axes,
            levers,
            RIGID * np.arange(number.max() + 2),
            assembly.length,
        )

    @cached_property
    def motion(self) -> Floats:
        """Motion w of each face per unit of the unknowns of either piece, (F, 2, 6, 6)."""
        motion = np.zeros((len(self.piece), 2, 6, RIGID))
        motion[:, :, :3, :3] = motion[:, :, 3:, 3:] = self.axes[:, None]
        # A rotation moves the middle of the face by rotation x lever.
        motion[:, :, :3, 3:] = np.cross(self.levers[:, :, None], self.axes[:, None])
        motion[:, 1] *= -1.0
        return motion

    def elastic_stiffness(self) -> Floats:
        """Stiffness (N/m) by all unknowns, (U, U), with every node closed and bonded."""
        p, q = self.place.T
        normal, shear = self.contact_law.normal_stiffness, self.contact_law.shear_stiffness
        zero, one = np.zeros(len(p)), np.ones(len(p))
        rows = np.array(  # of the nodes' displacements by the motion of their face
            [
                [one, zero, zero, zero, q, -p],
                [zero, one, zero, -q, zero, zero],
                [zero, zero, one, p, zero, zero],
            ]
        )
        per_node = np.einsum("in,ikn,iln->nkl", np.array([normal, shear, shear]), rows, rows)
        per_face = np.add.reduceat(per_node, self.start[:-1])
        blocks = np.einsum("fsij,fik,ftkl->fsjtl", self.motion, per_face, self.motion)
        # Fixed pieces have unknowns behind all others, which are left out.
        free = int(self.unknowns[-1])
        begin = np.append(self.unknowns[:-1], free)[self.piece]
        where = begin[:, :, None] + np.arange(RIGID)
        stiffness = np.zeros((free + RIGID, free + RIGID))
        np.add.at(stiffness, (where[:, :, :, None, None], where[:, None, None, :, :]), blocks)
        return stiffness[:free, :free]

    @property
    def units(self) -> Floats:
        """Factor from displacements (m) and rotations (rad) of the free pieces to unknowns, (U,).

        Forces (N) and moments (N m) are divided by it.
        """
        return np.tile([1.0] * 3 + [self.length] * 3, len(self.unknowns) - 1)


def natural_frequencies(assembly: Assembly) -> Floats:
    """Angular frequencies of the free pieces, ascending, in rad/s, with every node closed.

    Every piece has its largest principal moment of inertia about all axes.
    """
    free = [piece for piece in assembly.pieces if not piece.fixed]
    inertia = [piece.inertia.max() / assembly.length**2 for piece in free]  # kg, as rotations in m
    mass = np.concatenate(
        [[piece.mass] * 3 + [turned] * 3 for piece, turned in zip(free, inertia, strict=True)]
    )
    root = np.sqrt(mass)
    stiffness = Springs.of(assembly).elastic_stiffness() / root / root[:, None]
    return np.sqrt(np.linalg.eigvalsh(stiffness))


def soft_springs(assembly: Assembly) -> Springs:
    """The springs of ``assembly`` with no face stiffer than the softest inner one, if there is any.

    The reference for displacements: where all nodes are bonded, dry faces carry loads past the
    inner ones, and the stiffer they are the less moves. Once they slip, the inner faces decide.
    """
    springs = Springs.of(assembly)
    laws = [face.material for face in assembly.faces]
    stiffness = np.array([(law.normal_stiffness, law.shear_stiffness) for law in laws])
    inner = np.array([face.kind is Kind.INNER for face in assembly.faces])
    most = stiffness[inner].min(axis=0, initial=np.inf)
    normal, shear = np.minimum(1.0, most / stiffness)[assembly.nodes.face].T
    law = springs.contact_law
    soft = replace(
        law,
        normal_stiffness=law.normal_stiffness * normal,
        shear_stiffness=law.shear_stiffness * shear,
    )
    return replace(springs, contact_law=soft)


def compliance(assembly: Assembly, loads: Loads) -> float:
    """Displacement along the variable load, per newton of load, in m/N, with every node closed.

    Of `soft_springs`.
    """
    springs = soft_springs(assembly)
    force = loads.variable.ravel()[free_rows(assembly)] / springs.units
    return float(np.sum(force * np.linalg.solve(springs.elastic_stiffness(), force)))
