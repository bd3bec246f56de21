"""An assembly: pieces that meet across faces, contact nodes on every face, and loads.

Every model and every engine works from this one description, whatever was assembled. Pieces and
faces may have any shape; the joint's are cuboids and rectangles. All quantities are in SI units.
"""

import math
from dataclasses import dataclass, field
from enum import StrEnum
from itertools import product
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

from sidmacib.quantities import (
    FractureEnergy,
    Friction,
    Modulus,
    Part,
    Poisson,
    Stiffness,
    Strength,
)
from sidmacib.validation import (
    refused,
    require_kinds,
    require_member,
    require_not_negative,
    require_positive,
)

GRAVITY = 9.81  # m/s2
CLOSE = 1e-9  # over a size: points no further apart than this are the same point
Vector = tuple[float, float, float]
Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
_Shape = TypeVar("_Shape", bound="Cuboid | Rectangle")
_AXES = np.eye(3)[(np.arange(3)[:, None] + np.arange(3)) % 3]  # normal and tangents along each axis


@dataclass(frozen=True)
class FaceMaterial:
    """Stiffnesses and strengths of a contact face, per unit of area.

    ``normal_stiffness``, ``shear_stiffness``: stress over displacement, Pa/m. ``friction``:
    coefficient mu. ``cohesion``: shear strength of a bond that is not pressed (the paper's tau_k),
    Pa. ``tensile_strength``: of a bond, Pa. ``residual``: of bonds that soften, the part of both
    strengths that remains. ``fracture_energy``: of bonds that soften, the work that uses up one
    strength, J/m2. ``bond_friction``: coefficient by which compression raises the shear strength of
    a bond, and tension lowers it (EN 1996-1-1, 3.6.2); that of ``friction`` if it is None.
    ValueError for a number out of its range.
    """

    normal_stiffness: Stiffness
    shear_stiffness: Stiffness
    friction: Friction
    cohesion: Strength
    tensile_strength: Strength
    residual: Part = 0.0
    fracture_energy: FractureEnergy = 0.0
    bond_friction: Friction | None = None

    def __post_init__(self) -> None:
        require_kinds(self)

    @property
    def friction_in_bonds(self) -> float:
        """The coefficient mu_b by which compression raises the shear strength of a bond."""
        return self.friction if self.bond_friction is None else self.bond_friction

    @property
    def needs_in_bonds(self) -> str | None:
        """What ``bond_friction`` must be where bonds have one friction or none; None if it is."""
        if self.friction_in_bonds in (0.0, self.friction):
            return None
        return f"0 or {self.friction:g}, the friction" if self.friction else "0"


SOFTENED = ("residual", "fracture_energy")  # numbers of bonds that soften
OF_BONDS = (*SOFTENED, "bond_friction")  # of no use on dry faces


class Failure(StrEnum):
    """Behaviour of a node of an inner face that has reached its strength."""

    BRITTLE = "brittle"  # nothing: cohesion and tensile strength are lost at once
    SOFTENING = "softening"  # less and less as it moves on, down to the residual fraction
    DUCTILE = "ductile"  # its full strength


@dataclass(frozen=True)
class Elastic:
    """Linear elastic, isotropic material: Young's modulus in Pa and Poisson's ratio.

    ValueError for a number out of its range.
    """

    young: Modulus
    poisson: Poisson = 0.2

    def __post_init__(self) -> None:
        require_kinds(self)


class Kind(StrEnum):
    """The kind of a face."""

    INNER = "inner"  # cohesive: it joins two pieces until it fails
    DRY = "dry"  # frictional and unilateral
    PLATE = "plate"  # frictionless and unilateral, under a fixed plate
    LOCKED = "locked"  # contact points in place of locks: friction along these, strength across


class NodeLayout(StrEnum):
    """Positions of the contact nodes of a cell, and the shares of its area.

    Stresses are largest at the edges of a face, so a layout without nodes there finds failure late.
    """

    CENTRES = "centres"  # one, in the middle: midpoint rule, no node on an edge
    VERTICES = "vertices"  # four, shared with other cells: trapezoidal rule, as in 3DEC
    LOBATTO = "lobatto"  # nine, those on edges shared: Gauss-Lobatto rule (Simpson's)


class Piece:
    """A block or a part of one, of any shape; rigid unless it has an ``elastic`` material.

    ``name``: unique in the assembly. ``fixed``: whether it cannot move.
    """

    name: str
    fixed: bool
    elastic: Elastic | None = None

    if TYPE_CHECKING:  # a field of some, which others compute

        @property
        def mass(self) -> float:
            """In kg."""
            raise NotImplementedError

    @property
    def centre(self) -> Floats:
        """Centroid, in m, shape (3,)."""
        raise NotImplementedError

    @property
    def inertia(self) -> Floats:
        """Principal moments of inertia about the centroid, in kg m2, shape (3,)."""
        raise NotImplementedError

    @property
    def weight(self) -> float:
        """Self-weight in N."""
        return self.mass * GRAVITY


@dataclass(frozen=True)
class Cuboid(Piece):
    """A piece given by two opposite corners in m; rigid unless it has an elastic material.

    ValueError unless its edges are finite and above 0, and its mass finite and not negative.
    """

    name: str
    low: Vector
    high: Vector
    mass: float  # kg
    fixed: bool = False
    elastic: Elastic | None = None

    def __post_init__(self) -> None:
        edges = zip("xyz", self.low, self.high, strict=True)
        require_positive(**{f"{self.name}, edge {k} (m)": high - low for k, low, high in edges})
        require_not_negative(**{f"{self.name}, mass (kg)": self.mass})

    @property
    def centre(self) -> Floats:
        """Centroid, in m, shape (3,)."""
        return (np.array(self.low) + np.array(self.high)) / 2

    @property
    def size(self) -> Floats:
        """Edge lengths, in m, shape (3,)."""
        return np.array(self.high) - np.array(self.low)

    @property
    def inertia(self) -> Floats:
        """Principal moments of inertia about the centroid, in kg m2, shape (3,)."""
        squares = self.size**2
        return self.mass / 12 * (squares.sum() - squares)


@dataclass(frozen=True, eq=False)
class Face:
    """A plane region of any outline across which two pieces meet.

    ``name``: unique in the assembly. ``below`` and ``above`` are indices of pieces; ``axes``: the
    unit normal from ``below`` to ``above``, then two tangents, (3, 3). ``middle``: the point about
    which its motion is described, in m.
    """

    name: str
    kind: Kind
    material: FaceMaterial
    below: int
    above: int

    if TYPE_CHECKING:  # fields of some, which others compute

        @property
        def axes(self) -> Floats:
            """Unit normal, then two tangents, shape (3, 3)."""
            raise NotImplementedError

        @property
        def middle(self) -> Vector:
            """In m."""
            raise NotImplementedError

    @property
    def area(self) -> float:
        """In m2."""
        raise NotImplementedError

    @property
    def corners(self) -> Floats:
        """Corners of its outer boundary, in m, (K, 3)."""
        raise NotImplementedError


@dataclass(frozen=True)
class Rectangle(Face):
    """A face whose sides are along two axes, and its normal along ``axis``: 0, 1, 2 for x, y, z."""

    axis: int
    low: Vector
    high: Vector

    @property
    def axes(self) -> Floats:
        """Unit normal from ``below`` to ``above``, then two tangents, shape (3, 3)."""
        return _AXES[self.axis]

    @property
    def middle(self) -> Vector:
        """Centre, in m."""
        (x, y, z), (right, back, top) = self.low, self.high
        return (x + right) / 2, (y + back) / 2, (z + top) / 2

    @property
    def area(self) -> float:
        """Area in m2."""
        sides = [high - low for low, high in zip(self.low, self.high, strict=True)]
        return math.prod(side for side in sides if side > 0.0)

    @property
    def corners(self) -> Floats:
        """In m, (4, 3)."""
        ends = [sorted({low, high}) for low, high in zip(self.low, self.high, strict=True)]
        return np.array(list(product(*ends)))


@dataclass(frozen=True)
class Nodes:
    """Contact nodes of all faces, one row each, face by face.

    ``triangles`` between nodes of a face, face by face, over whose pressed parts the pressure on
    dry faces is integrated, each with an area of ``parts``; faces without have springs at their
    nodes. ValueError unless nodes are in the order of their faces, and areas above 0.
    """

    face: Integers  # (N,) index of the face
    position: Floats  # (N, 3) in m
    area: Floats  # (N,) tributary area in m2
    triangles: Integers = field(default_factory=lambda: np.zeros((0, 3), np.int64))  # (T, 3)
    parts: Floats = field(default_factory=lambda: np.zeros(0))  # (T,) in m2

    def __post_init__(self) -> None:
        if np.any(self.face[1:] < self.face[:-1]):
            raise ValueError("nodes: must be in the order of their faces")
        if not (np.isfinite(self.position).all() and np.isfinite(self.area).all()):
            raise ValueError("nodes: positions and areas must be finite")
        if not np.all(self.area > 0.0):
            raise ValueError("nodes: areas must be more than 0 m2")


@dataclass(frozen=True)
class Assembly:
    """Pieces, their faces and the nodes on them.

    ``length`` (m) converts rotations to displacements and moments to forces. ``failure``: of all
    inner faces. ``mesh`` (m) and ``layout``: of the nodes, and of the finite elements of elastic
    pieces. ``most_opening`` (m): of a face, before a bond fails. ``share``: of the piece below in
    how frames of faces turn, and of that above in where nodes are: all, or half, which prefers
    none. ValueError unless lengths are above 0, and for bonds with friction that are not brittle.
    """

    pieces: tuple[Piece, ...]
    faces: tuple[Face, ...]
    nodes: Nodes
    length: float
    failure: Failure = Failure.BRITTLE
    mesh: float = math.inf
    layout: NodeLayout = NodeLayout.LOBATTO
    most_opening: float = math.inf
    share: float = 1.0

    def __post_init__(self) -> None:
        require_positive(length=self.length)
        require_member(NodeLayout, layout=self.layout)
        for name in ("mesh", "most_opening"):
            if not getattr(self, name) > 0.0:
                raise refused(name, getattr(self, name), "more than 0")
        inner = (face.material for face in self.faces if face.kind is Kind.INNER)
        rough = next(filter(None, (law.friction_in_bonds for law in inner)), 0.0)
        if rough and self.failure is not Failure.BRITTLE:
            raise refused("bond_friction", rough, f"0, as failure is {self.failure}")

    @property
    def cuboids(self) -> tuple[Cuboid, ...]:
        """The pieces, where a model needs cuboids; ValueError if one has another shape."""
        return tuple(_shaped(piece, Cuboid) for piece in self.pieces)

    @property
    def rectangles(self) -> tuple[Rectangle, ...]:
        """The faces, where a model needs rectangles; ValueError if one has another outline."""
        return tuple(_shaped(face, Rectangle) for face in self.faces)

    @property
    def elastic(self) -> bool:
        """Whether a free piece is elastic."""
        return any(piece.elastic is not None and not piece.fixed for piece in self.pieces)

    @property
    def without_stiffness(self) -> str | None:
        """A refusal that names a face without stiffness; None if all faces have one."""
        name = next((face.name for face in self.faces if face.kind is Kind.LOCKED), None)
        return name and f"{name} has condensed locks, which have no stiffness; cut them out"


def _shaped(one: Piece | Face, shape: type[_Shape]) -> _Shape:
    if isinstance(one, shape):
        return one
    raise ValueError(f"{one.name}: must be a {shape.__name__.lower()} along the axes in this model")
