"""An assembly as LIGGGHTS' atoms and commands.

Every piece is a rigid body. Every contact node is a pair of spheres, one in each piece, which touch
nobody else: a small one in the piece that brings the vertex, a large one in that of the flat side.
At inner faces two more atoms, both at the node, are joined by a spring of length zero; when the
spring is cut, the spheres come into play.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations

from ..scripts.assembly import (
    GivenAssembly,
    GivenPiece,
    GivenSearch,
    Vector,
    cross,
    dot,
    plus,
)
from ..scripts.records import NoAnswerError
from .loads import beyond_gravity, common_acceleration, common_gravity, handle_forces

SKIN = 1e-3  # m, between spheres that LIGGGHTS looks at
# Steps from one look for spheres that are near to the next: in so few no piece moves by `SKIN`. The
# centres of flat sides, which are far away, do, and with a look in every step a case takes 15 times
# as long.
LOOK = 100
TURNED = 10.0  # force on a face over the weight, at most, while gravity turns
LEAST_FLAT = 20.0  # radius of a flat side over what presses it together: less is round
GROUPS = 28  # that LIGGGHTS has left, of its 32
AXES = (0, 1, 2)
BODIES = "fix bodies free rigid molecule"
HANDLES_OF_FORCE = 2  # of a piece, which share a force on it; see `handle_forces`


def reach(piece: GivenPiece) -> float:
    """Distance (m) of a piece's handles from its centroid.

    A piece's mass is in six handles, at its centroid plus and minus this along each axis: so they
    have its mass and, about all axes, its largest inertia. All other atoms weigh next to nothing.
    """
    return math.sqrt(1.5 * piece.inertia_kgm2 / piece.mass_kg)


@dataclass(frozen=True)
class Patch:
    """The nodes of one face, by index, that have the same area (m2), and vertices of one piece.

    A contact's stiffness is a property of the types of its atoms, and so of a patch.
    """

    face: int
    area_m2: float
    vertex_above: bool
    nodes: tuple[int, ...]


def patches(assembly: GivenAssembly) -> list[Patch]:
    """The patches of all faces, in the order of their first nodes."""
    found: dict[tuple[int, float, bool], list[int]] = {}
    for number, node in enumerate(assembly.nodes):
        key = node.face, float(f"{node.area_m2:.9g}"), node.vertex_above
        found.setdefault(key, []).append(number)
    return [Patch(*key, tuple(nodes)) for key, nodes in found.items()]


def flat_radii(assembly: GivenAssembly, every: Sequence[Patch], largest: float) -> list[float]:
    """Radius of the large spheres of each patch (m), at most ``largest``.

    From the small spheres of nodes at the pitch they have a gap of pitch^2 / (2 radius): twice what
    the face is pressed together by the largest strength of a face, or, where only gravity turns, by
    `TURNED` times what always acts.
    """
    area = [0.0] * len(assembly.faces)
    for node in assembly.nodes:
        area[node.face] += node.area_m2
    strength = max(f.material.cohesion * a for f, a in zip(assembly.faces, area, strict=True))
    reached = strength if assembly.axis is None else TURNED * assembly.permanent_N
    force, result = max(reached, assembly.permanent_N), []
    for patch in every:
        stiffness = assembly.faces[patch.face].material.normal_stiffness
        pressed = force / (stiffness * area[patch.face])
        pairs = combinations((assembly.nodes[node].position_m for node in patch.nodes), 2)
        apart = min((math.dist(*pair) for pair in pairs), default=math.inf)
        result.append(min(largest, apart**2 / (4 * pressed)))
        if result[-1] < LEAST_FLAT * pressed:
            name = assembly.faces[patch.face].name
            raise NoAnswerError(f"liggghts: {name} is too soft for nodes {apart:.3g} m apart")
    return result


@dataclass
class Atoms:
    """All atoms, by their numbers from 1 on.

    ``lines``, ``bonds``: of the data file. ``handles``: of each piece, none of a fixed one, as it
    is not moved. ``spheres``: of each node, below and above. ``ends``: of each inner node's spring.
    ``light``: the mass (kg) of a sphere.
    """

    lines: list[str] = field(default_factory=list)
    bonds: list[tuple[int, int]] = field(default_factory=list)
    handles: list[list[int]] = field(default_factory=list)
    spheres: list[tuple[int, int]] = field(default_factory=list)
    ends: dict[int, tuple[int, int]] = field(default_factory=dict)
    light: float = 0.0

    def add(self, kind: int, position: Vector, radius: float, mass: float, piece: int) -> int:
        """Add an atom of a type; its number."""
        diameter = 2 * radius
        density = mass / (math.pi / 6 * diameter**3)
        values = [*position, diameter, density]
        number = len(self.lines) + 1
        self.lines.append(f"{number} {kind} {' '.join(f'{v:.17g}' for v in values)} {piece + 1}")
        return number


class LiggghtsDeck:
    """LIGGGHTS' atoms and input script for an assembly without load."""

    def __init__(
        self,
        assembly: GivenAssembly,
        search: GivenSearch,
        radii: Vector,
        drag: float,
        gradual: bool = False,
    ) -> None:
        """``radii``: of vertices and, at most, of flat sides, m. Others: see `.run`."""
        self.assembly, self.search = assembly, search
        # Steps in which the permanent loads are raised; 0: they act at once.
        self.permanent_ramp = search.ramp(assembly.permanent_N, 0.0) if gradual else 0
        critical = 4 * math.pi / (search.period_steps * search.time_step_s)
        self.drag = drag * critical  # force over momentum, 1/s
        free = assembly.free
        self.gravity, self.shared = common_gravity(assembly), common_acceleration(assembly)
        # Whether loads accelerate all pieces alike, and change with time.
        many = HANDLES_OF_FORCE * len(assembly.loads) > GROUPS
        self.accelerated = gradual or assembly.axis is not None or bool(self.shared and many)
        # Types of atoms: one for the handles of each free piece, one that touches nothing, and two
        # for each patch, below and above, that touch each other.
        self.handle_type = {piece: number for number, piece in enumerate(free, start=1)}
        self.lone = len(free) + 1
        self.patches = patches(assembly)
        self.patch_of = {n: k for k, patch in enumerate(self.patches) for n in patch.nodes}
        self.patch_types = [
            (self.lone + 2 * patch + 1, self.lone + 2 * patch + 2)
            for patch in range(len(self.patches))
        ]
        self.types = self.lone + 2 * len(self.patches)
        self.point, self.flat_radii = radii[0], flat_radii(assembly, self.patches, radii[1])
        self.reach = [reach(piece) for piece in assembly.pieces]
        self.atoms = self._build()
        self.bond = {node: number for number, node in enumerate(self.atoms.ends, start=1)}

    def _build(self) -> Atoms:
        atoms, assembly = Atoms(), self.assembly
        for index, piece in enumerate(assembly.pieces):
            mass = piece.mass_kg / 6
            atoms.handles.append(
                []
                if piece.fixed
                else [
                    atoms.add(self.handle_type[index], place, 1e-6, mass, index)
                    for place in self._handle_places(index)
                ]
            )
        light = atoms.light = 1e-9 * min(piece.mass_kg for piece in assembly.pieces)
        for number, node in enumerate(assembly.nodes):
            face, patch = assembly.faces[node.face], self.patch_of[number]
            radii, lone = node.radii(self.point, self.flat_radii[patch]), (self.lone, self.lone)
            types = lone if face.cohesive else self.patch_types[patch]
            below, above = (
                atoms.add(kind, plus(node.position_m, face.normal, sign * r), r, light, piece)
                for kind, piece, sign, r in zip(
                    types, (face.below, face.above), (-1, 1), radii, strict=True
                )
            )
            atoms.spheres.append((below, above))
            if face.cohesive:
                ends = tuple(
                    atoms.add(self.lone, node.position_m, 1e-6, light, piece)
                    for piece in (face.below, face.above)
                )
                atoms.ends[number] = (ends[0], ends[1])
                atoms.bonds.append(atoms.ends[number])
        return atoms

    def _handle_places(self, index: int) -> list[list[float]]:
        centre, distance = self.assembly.pieces[index].centre_m, self.reach[index]
        return [
            plus(centre, [sign * distance * (axis == k) for k in AXES])
            for axis in AXES
            for sign in (1, -1)
        ]

    def spring_stiffness(self, node: int) -> float:
        """Stiffness of the spring at an inner node, in N/m."""
        contact = self.assembly.nodes[node]
        return self.assembly.faces[contact.face].material.normal_stiffness * contact.area_m2

    def data_file(self, title: str) -> str:
        """Text of the file of atoms and bonds."""
        atoms, nodes = self.atoms, self.assembly.nodes
        margin = 4 * max(self.flat_radii) + max(self.reach[piece] for piece in self.assembly.free)
        lines = [f"{title}\n", f"{len(atoms.lines)} atoms", f"{len(atoms.bonds)} bonds"]
        lines += [f"{self.types} atom types", f"{max(1, len(atoms.bonds))} bond types\n"]
        for axis, name in enumerate("xyz"):
            low = min(node.position_m[axis] for node in nodes) - margin
            high = max(node.position_m[axis] for node in nodes) + margin
            lines.append(f"{low:.9g} {high:.9g} {name}lo {name}hi")
        lines += ["\nAtoms\n", *atoms.lines]
        if atoms.bonds:
            lines.append("\nBonds\n")
            lines += [f"{n} {n} {one} {two}" for n, (one, two) in enumerate(atoms.bonds, start=1)]
        return "\n".join(lines) + "\n"

    def input_script(self) -> Iterator[str]:
        """LIGGGHTS' commands up to the first run."""
        yield from (
            "units si",
            "atom_style hybrid granular molecular",
            "atom_modify map array",
            "boundary f f f",
            "newton off",
            "communicate single vel yes",
            "read_data joint.atoms",
            f"neighbor {SKIN:g} bin",
            f"neigh_modify delay {LOOK} every {LOOK}",
        )
        yield from self._laws()
        yield f"timestep {self.search.time_step_s!r}"
        free = self.assembly.free
        yield f"group free molecule {' '.join(str(piece + 1) for piece in free)}"
        handles = " ".join(str(atom) for piece in free for atom in self.atoms.handles[piece])
        yield f"group handles id {handles}"
        # All force fixes before fix rigid, or each run would kick the bodies.
        yield from self._loads()
        yield from self._bodies()

    def _laws(self) -> Iterator[str]:
        """Pairs that touch, and the laws of contacts and springs."""
        touching = {frozenset(pair) for pair in self.patch_types}
        for one in range(1, self.types + 1):
            for other in range(one, self.types + 1):
                if frozenset((one, other)) not in touching:
                    yield f"neigh_modify exclude type {one} {other}"
        yield (
            "pair_style gran model hooke/stiffness tangential history"
            " tangential_damping off absolute_damping on"
        )
        yield "pair_coeff * *"

        laws = [(self.assembly.faces[each.face].material, each.area_m2) for each in self.patches]
        yield self._matrix("kn", [law.normal_stiffness * area for law, area in laws])
        yield self._matrix("kt", [law.shear_stiffness * area for law, area in laws])
        yield self._matrix("gamman_abs", [0.0] * len(laws))
        yield self._matrix("gammat_abs", [0.0] * len(laws))
        yield self._matrix("coefficientFriction", [law.friction for law, _ in laws])
        if self.bond:
            yield "bond_style harmonic"
        for node, number in self.bond.items():
            # The energy is coefficient * length^2.
            yield f"bond_coeff {number} {self.spring_stiffness(node) / 2:.12g} 0.0"

    def _matrix(self, name: str, of_patches: Sequence[float]) -> str:
        """A property of pairs of types, 0 but between the two sides of a patch."""
        values = [[0.0] * self.types for _ in range(self.types)]
        for value, (one, other) in zip(of_patches, self.patch_types, strict=True):
            values[one - 1][other - 1] = values[other - 1][one - 1] = value
        numbers = " ".join(f"{v:.12g}" for row in values for v in row)
        return f"fix {name} all property/global {name} peratomtypepair {self.types} {numbers}"

    def _loads(self) -> Iterator[str]:
        """Gravity and drag, other permanent loads, and the load that is raised, on the handles."""
        variable = {part.piece: (part.force, part.moment_m) for part in self.assembly.loads}
        gravity, share = self.gravity, ""
        if self.accelerated:
            if self.permanent_ramp:
                share = "v_permanent*"
                part = f"0.5-0.5*cos(PI*step/{self.permanent_ramp})"
                yield (
                    f"variable permanent equal (step<{self.permanent_ramp})*({part})"
                    f"+(step>={self.permanent_ramp})"
                )
            if self.shared:
                variable = {}
        elif gravity:
            yield f"fix gravity handles gravity {gravity!r} vector 0.0 0.0 -1.0"
        pull = "v_pull_{0}" if self.accelerated else "0.0"
        for name in "xyz":  # one fix for all handles, however many there are
            net = f"({pull.format(name)}-v_load_drag*v{name})"
            yield f"variable force_{name} atom mass*{net}"
        yield "fix force handles addforce v_force_x v_force_y v_force_z"
        none = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        groups = 0
        for index in self.assembly.free:
            piece = self.assembly.pieces[index]
            force = beyond_gravity(piece, gravity)
            always = handle_forces(force, piece.moment_Nm, self.reach[index])
            raised = handle_forces(*variable.get(index, none), self.reach[index])
            for number, atom in enumerate(self.atoms.handles[index]):
                axes = [k for k in AXES if always[number][k] or raised[number][k]]
                if not axes:
                    continue
                groups += 1
                name = f"handle{atom}"
                yield f"group {name} id {atom}"
                terms = ["0.0", "0.0", "0.0"]
                for k in axes:
                    constant = f"+{share}({always[number][k]!r})" if always[number][k] else ""
                    terms[k] = f"v_{name}_{'xyz'[k]}"
                    yield (
                        f"variable {name}_{'xyz'[k]} equal v_load*({raised[number][k]!r}){constant}"
                    )
                yield f"fix {name} {name} addforce {' '.join(terms)}"
        if groups > GROUPS:
            raise NoAnswerError(
                f"liggghts: {groups} points of load application; at most {GROUPS} are allowed"
            )

    def pull(self, load: float | None = None) -> Iterator[str]:
        """Variables of the acceleration (m/s2) of all pieces: under a ``load`` (N), or as it rises.

        Numbers take LIGGGHTS a third of the time of formulas, which it reads in every step.
        """
        if not self.accelerated:
            return
        axis, down = self.assembly.axis or (0.0, 0.0, 1.0), (0.0, 0.0, -self.gravity)
        along = [dot(down, axis) * part for part in axis]
        across, aside = plus(down, along, -1.0), cross(axis, down)
        shared = self.shared or (0.0, 0.0, 0.0)
        share = "v_permanent*" if self.permanent_ramp else ""
        angle = f"v_load/{self.assembly.permanent_N!r}"
        for k, name in enumerate("xyz"):
            if load is None:
                turn = f"({across[k]!r})*cos({angle})+({aside[k]!r})*sin({angle})"
                value = f"{share}({along[k]!r}+{turn})+v_load*({shared[k]!r})"
            else:
                turned = load / self.assembly.permanent_N
                part = across[k] * math.cos(turned) + aside[k] * math.sin(turned)
                value = repr(along[k] + part + load * shared[k])
            yield f"variable pull_{name} equal {value}"

    def _bodies(self) -> Iterator[str]:
        """The rigid bodies, and the variables of their motion."""
        yield BODIES
        yield "thermo 1000000"
        yield "thermo_modify lost error"
        for name, formula in (*self.forces.items(), *self.places.items()):
            yield f"variable {name} equal {formula}"
        # The last of all: a variable that is set anew moves there, and fixes know them by number.
        yield "variable load equal 0.0"  # N
        yield f"variable load_drag equal {self.drag!r}"  # 1/s
        yield from self.pull()

    @cached_property
    def places(self) -> dict[str, str]:
        """Formulas of variables by name: positions of the handles, 18 for each free piece."""
        handles = [atom for piece in self.assembly.free for atom in self.atoms.handles[piece]]
        return {f"p{atom}_{name}": f"{name}[{atom}]" for atom in handles for name in "xyz"}

    @cached_property
    def forces(self) -> dict[str, str]:
        """Formulas of variables by name: net force and moment, but for the drag, on free pieces.

        Drag takes from the moment in proportion to the turning of the handles, which have all mass.
        """
        found = {}
        for n, index in enumerate(self.assembly.free, start=1):
            piece, handles = self.assembly.pieces[index], self.atoms.handles[index]
            spin = piece.inertia_kgm2 / (2.0 * self.reach[index])
            for k, name in enumerate("xyz"):
                velocity = f"f_bodies[{n}][{4 + k}]"
                found[f"f{n}_{name}"] = (
                    f"f_bodies[{n}][{7 + k}]+v_load_drag*{piece.mass_kg!r}*{velocity}"
                )
                # About x, ends of the axis y move along z.
                one, other = handles[2 * ((k + 1) % 3) :][:2]
                along = "xyz"[(k + 2) % 3]
                found[f"t{n}_{name}"] = (
                    f"f_bodies[{n}][{10 + k}]"
                    f"+v_load_drag*{spin!r}*(v{along}[{one}]-v{along}[{other}])"
                )
        return found
