"""The assembly, its loads and how its peak is searched, as a script reads them."""

import json
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

Vector = Sequence[float]

LEAST_TENSION = 1e-6  # over the cohesion
LEAST_RAMP = 0.1  # of the time in which the whole load is raised


@dataclass(frozen=True)
class GivenMaterial:
    """Law of a face per unit of area: stiffness in Pa/m, friction coefficients, strengths in Pa."""

    normal_stiffness: float
    shear_stiffness: float
    friction: float
    cohesion: float
    tensile_strength: float
    friction_in_bonds: float

    @property
    def effective_tensile_strength(self) -> float:
        """Tensile strength (Pa), or the least that differs from none by more than rounding.

        Bonds without any would break in faces that carry nothing, at random.
        """
        return max(self.tensile_strength, LEAST_TENSION * self.cohesion)


@dataclass(frozen=True)
class GivenSolid:
    """A convex part of a piece: its corners (m), unit normals of its faces, and its edges.

    Edges as unit vectors; of parallel normals and edges one.
    """

    corners_m: Sequence[Vector]
    normals: Sequence[Vector]
    edges: Sequence[Vector]

    @cached_property
    def box(self) -> tuple[Vector, Vector]:
        """Least and largest coordinates (m) of its corners."""
        return tuple(map(min, *self.corners_m)), tuple(map(max, *self.corners_m))


@dataclass(frozen=True)
class GivenPiece:
    """A piece; force (N) and moment (N m) are its permanent loads at its centroid.

    ``inertia_kgm2`` is the largest principal moment, taken about every axis: equilibria do not
    depend on it. ``low_m``, ``high_m``: opposite corners. ``young_Pa``: Young's modulus, None of
    a rigid piece. ``solids``: its convex parts.
    """

    name: str
    fixed: bool
    centre_m: Vector
    mass_kg: float
    inertia_kgm2: float
    force_N: Vector
    moment_Nm: Vector
    low_m: Vector = ()
    high_m: Vector = ()
    young_Pa: float | None = None
    poisson: float = 0.0
    solids: Sequence[GivenSolid] = ()

    @cached_property
    def gyration_m(self) -> float:
        """Radius of gyration."""
        return math.sqrt(self.inertia_kgm2 / self.mass_kg)


@dataclass(frozen=True)
class GivenFace:
    """A face; its unit normal points from the piece ``below`` to the piece ``above``, by index.

    ``tangents``: two unit vectors; none of a rectangle along the axes. ``edges_below``,
    ``edges_above``: of the two pieces' sides there, each a unit vector across it, outwards, and its
    distance (m) from the origin in this direction.
    """

    name: str
    kind: str
    below: int
    above: int
    normal: Vector
    material: GivenMaterial
    tangents: Sequence[Vector] = ()
    edges_below: Sequence[Vector] = ()
    edges_above: Sequence[Vector] = ()

    @property
    def cohesive(self) -> bool:
        """Whether its nodes are bonded until they fail."""
        return self.kind == "inner"


@dataclass(frozen=True)
class PieceLoad:
    """Force (1) and moment (m) on a piece, by index, per newton of load."""

    piece: int
    force: Vector
    moment_m: Vector


@dataclass(frozen=True)
class GivenSideLoad:
    """The part of a piece's loads that acts on its side across ``axis``, the far one if ``high``.

    ``wrench``: force (N) and moment (N m) about the centroid, or per newton of load unless
    ``permanent``; the stress on the side varies linearly.
    """

    piece: int
    axis: int
    high: bool
    wrench: Vector
    permanent: bool


@dataclass(frozen=True)
class SupportMove:
    """A fixed piece, by index, that moves along a unit vector, or turns about it through a point.

    The load is its movement then, in m, or in rad where ``about_m`` is that point.
    """

    piece: int
    along: Vector
    about_m: Vector | None = None

    def place(self, centre: Vector, movement: float) -> list[float]:
        """Where a point of the support that was at ``centre`` is after a ``movement``."""
        if self.about_m is None:
            return plus(centre, self.along, movement)
        arm = plus(centre, self.about_m, -1.0)
        return plus(self.about_m, turned(arm, self.along, movement))


@dataclass(frozen=True)
class Node:
    """A contact node: index of its face, position in m, tributary area in m2.

    It is a vertex of one piece on the flat side of the other: of the one above if ``vertex_above``.
    Its position is where this vertex was built.
    """

    face: int
    position_m: Vector
    area_m2: float
    vertex_above: bool

    def radii(self, point: float, flat: float) -> tuple[float, float]:
        """Radii (m) of the spheres below and above: of a ``point`` and of a ``flat`` side."""
        return (flat, point) if self.vertex_above else (point, flat)


@dataclass(frozen=True)
class GivenAssembly:
    """Pieces that meet across faces with nodes, and the loads on them; ``length_m``: mean size.

    ``axis``: a unit vector if gravity turns: what always acts turns about it, by the load over
    `permanent_N` in radians. ``support``: if one moves, see `SupportMove`. For elastic pieces only:
    ``sides``, the parts of the loads that act on sides of pieces, the rest being spread over the
    volume; ``mesh_m`` and ``layout``: how the nodes were made.
    """

    pieces: list[GivenPiece]
    faces: list[GivenFace]
    nodes: list[Node]
    loads: list[PieceLoad]
    length_m: float
    axis: Vector | None = None
    support: SupportMove | None = None
    sides: Sequence[GivenSideLoad] = ()
    mesh_m: float | None = None
    layout: str = ""

    @cached_property
    def free(self) -> list[int]:
        """Indices of the pieces that can move."""
        return [index for index, piece in enumerate(self.pieces) if not piece.fixed]

    @cached_property
    def dry(self) -> bool:
        """Whether no face is bonded."""
        return not any(face.cohesive for face in self.faces)

    @cached_property
    def planes_m(self) -> dict[int, Vector]:
        """A point of the plane of each face, by index."""
        return {node.face: node.position_m for node in self.nodes}

    @property
    def permanent_N(self) -> float:
        """Sum of the forces that always act on the free pieces, such as their weight."""
        return math.fsum(length(self.pieces[index].force_N) for index in self.free)

    def always(self, load: float) -> list[tuple[Vector, Vector]]:
        """Force (N) and moment (N m) that always act on each piece, as turned by ``load`` (N)."""
        given = [(piece.force_N, piece.moment_Nm) for piece in self.pieces]
        if self.axis is None:
            return given
        angle = load / self.permanent_N
        return [(turned(f, self.axis, angle), turned(m, self.axis, angle)) for f, m in given]

    def displacement(self, motion: Callable[[int], tuple[Vector, Vector]]) -> float:
        """The displacement that the load works on: its work per unit of load, in m.

        ``motion``: displacement (m) and rotation (rad) of a piece, by index. Where gravity turns or
        a support moves: how far pieces have moved, on average over their weights.
        """
        if self.axis is None and self.support is None:
            return math.fsum(
                dot(part.force, moved) + dot(part.moment_m, turn)
                for part in self.loads
                for moved, turn in (motion(part.piece),)
            )
        weights = {index: length(self.pieces[index].force_N) for index in self.free}
        work = math.fsum(weight * length(motion(index)[0]) for index, weight in weights.items())
        return work / self.permanent_N


@dataclass(frozen=True)
class Guide:
    """Loads of another model, in N: the first failure, or the peak if no node fails, and the peak.

    It only sets where the search starts; the engine decides which loads fail.
    """

    first_failure_N: float
    peak_N: float

    def peak_after(self, first_failure: float) -> float:
        """The peak (N) to be expected where the first node has failed at that load (N); 0: none."""
        return self.peak_N / self.first_failure_N * first_failure if self.first_failure_N else 0.0


@dataclass(frozen=True)
class GivenSearch:
    """Parameters of the search for the peak.

    ``ramp_steps``: time steps in which the whole load is raised; ``hold_steps``: of the longest
    wait for equilibrium after an increment; ``period_steps``: of the assembly's longest natural
    period. ``unbalanced_ratio``: mean unbalanced force on a piece over the load, at equilibrium.
    ``collapse_m``: what has moved so far since then, and ever faster, falls. ``tolerance``:
    last increment over the peak. ``last_N``: the load up to which it goes; ``no_peak``: what there
    is to say where the assembly carries it. ``guide``: where the search starts, if known. ``unit``:
    of loads, m or rad where they are movements of a support.
    """

    time_step_s: float
    period_steps: float
    ramp_steps: int
    hold_steps: int
    unbalanced_ratio: float
    collapse_m: float
    first_increment_N: float
    tolerance: float
    last_N: float = math.inf
    no_peak: str = "the load grows without a peak"
    guide: Guide | None = None
    unit: str = "N"

    def said(self, load: float) -> str:
        """A load in words."""
        return f"{load:g} {self.unit}"

    def ramp(self, rise: float, whole: float) -> int:
        """Time steps in which a load is raised by ``rise``, to ``whole`` (N).

        What a smooth rise overshoots by goes with its height and the inverse square of its
        duration: with a guide, half the load takes as long as the whole, a smaller part the root of
        its share in that, and a tenth at least. Without one, every part takes as long.
        """
        if self.guide is None:
            return self.ramp_steps
        largest = max(rise, whole, self.guide.first_failure_N)
        share = 2.0 * max(0.0, rise) / largest if largest > 0.0 else 0.0
        part = min(1.0, max(LEAST_RAMP, math.sqrt(share)))
        return max(1, math.ceil(part * self.ramp_steps))


def read_assembly(path: str, materials: dict[str, dict[str, float]]) -> GivenAssembly:
    """The assembly of a data file, with the materials that its faces name."""
    return assembly_of(json.loads(Path(path).read_text()), materials)


def assembly_of(data: dict[str, Any], materials: dict[str, dict[str, float]]) -> GivenAssembly:
    """`read_assembly` of what is in such a file."""
    laws = {name: GivenMaterial(**law) for name, law in materials.items()}
    faces = [GivenFace(**{**face, "material": laws[face["material"]]}) for face in data["faces"]]
    nodes = [Node(*row) for row in zip(*data["nodes"].values(), strict=True)]
    return GivenAssembly(
        [
            GivenPiece(**{**piece, "solids": [GivenSolid(*solid) for solid in piece["solids"]]})
            for piece in data["pieces"]
        ],
        faces,
        nodes,
        [PieceLoad(**load) for load in data["loads"]],
        data["length_m"],
        data["axis"],
        SupportMove(**data["support"]) if data["support"] else None,
        [GivenSideLoad(**side) for side in data["sides"]],
        data["mesh_m"],
        data["layout"],
    )


def dot(one: Iterable[float], other: Iterable[float]) -> float:
    """Scalar product."""
    return math.fsum(a * b for a, b in zip(one, other, strict=True))


def length(vector: Vector) -> float:
    """Euclidean norm."""
    return math.sqrt(dot(vector, vector))


def plus(one: Vector, other: Vector, factor: float = 1.0) -> list[float]:
    """``one + factor * other``."""
    return [a + factor * b for a, b in zip(one, other, strict=True)]


def cross(one: Vector, other: Vector) -> list[float]:
    """Vector product."""
    return [
        one[1] * other[2] - one[2] * other[1],
        one[2] * other[0] - one[0] * other[2],
        one[0] * other[1] - one[1] * other[0],
    ]


def turned(vector: Vector, axis: Vector, angle: float) -> list[float]:
    """``vector`` turned about a unit ``axis`` by ``angle`` (rad)."""
    along = [dot(vector, axis) * part for part in axis]
    across = plus(vector, along, -1.0)
    aside = plus(along, cross(axis, vector), math.sin(angle))
    return plus(aside, across, math.cos(angle))


def utilisation(force: Vector, normal: Vector, law: GivenMaterial, area: float) -> float:
    """Shear or tension over its strength, whichever is more, of a bond under ``force`` (N)."""
    along = dot(force, normal)
    shear = length(plus(force, normal, -along)) - law.friction_in_bonds * along
    strengths = (shear, law.cohesion * area), (-along, law.effective_tensile_strength * area)
    used = [part / most if most else math.inf for part, most in strengths if part > 0.0]
    return max(used, default=0.0)
