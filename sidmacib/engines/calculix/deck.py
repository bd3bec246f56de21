"""CalculiX's input deck of an assembly of elastic pieces.

Every piece has a separate grid of hexahedra with incompatible modes (C3D8I), which bend without
locking. Grid lines run through the contact nodes of all but smooth faces, so that displacement
jumps are read there, and between these elements are no longer than half the mesh. Fixed pieces are
one layer whose nodes are all held, with the grid of what they touch.

A face is one contact pair, surface to surface. Inner faces are tied with their stiffness, whatever
they carry; others are linear springs that cannot pull, with friction.

Loads are nodal forces, consistent with the shape functions: force and moment are exact.
"""

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import count, pairwise, product
from operator import add

from ..scripts.assembly import GivenAssembly, GivenFace, GivenPiece, Vector, cross, plus

CLOSE = 1e-7  # of a piece's longest edge: grid lines that are no further apart are one
PER_MESH = 2  # elements in the length of the mesh, at least
NODES, HELD, JOB = "NALL", "HELD", "joint"
# Corners of an element, as steps along x, y and z, and the names of its sides, low and high.
CORNERS = (
    *((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)),
    *((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)),
)
SIDES = (("S6", "S4"), ("S3", "S5"), ("S1", "S2"))
FIRST_SHARE = 0.05  # of the first step of the load, in its first increment
LEAST_FRICTION = 1e-9  # CalculiX wants more than none
DIGITS = 12  # of printed numbers

Steps = tuple[int, ...]  # along x, y and z
Lines = tuple[tuple[float, ...], ...]  # places (m) of grid lines along x, y and z
Forces = dict[tuple[int, int], float]  # N, or per newton, by node and direction 1, 2, 3


@dataclass(frozen=True)
class Grid:
    """Grid of a piece: places of its lines (m) along x, y and z, and what is numbered in it.

    ``nodes``: numbers by the steps along x, y and z to them; ``elements``: by those to their first
    corners.
    """

    lines: Lines
    nodes: dict[Steps, int]
    elements: dict[Steps, int]

    def place(self, steps: Steps) -> list[float]:
        """Position of a node, in m."""
        return [line[step] for line, step in zip(self.lines, steps, strict=True)]

    def weights(self, place: Vector) -> dict[int, float]:
        """Shape functions at a place in m, by node; those that are 0 there are left out."""
        along = [line_weights(line, x) for line, x in zip(self.lines, place, strict=True)]
        return {
            self.nodes[tuple(step for step, _ in corner)]: math.prod(share for _, share in corner)
            for corner in product(*along)
        }

    def span(self, axis: int, low: float, high: float) -> range:
        """Elements along an axis that lie between two places in m."""
        line, near = self.lines[axis], CLOSE * (self.lines[axis][-1] - self.lines[axis][0])
        inside = [
            step
            for step, (one, other) in enumerate(pairwise(line))
            if one >= low - near and other <= high + near
        ]
        return range(inside[0], inside[-1] + 1)


def line_weights(line: Sequence[float], place: float) -> list[tuple[int, float]]:
    """Steps to the grid lines about a place, and their shares in it."""
    near = CLOSE * (line[-1] - line[0])
    for step, value in enumerate(line):
        if abs(value - place) <= near:
            return [(step, 1.0)]
    for step, (low, high) in enumerate(pairwise(line)):
        if low < place < high:
            share = (place - low) / (high - low)
            return [(step, 1.0 - share), (step + 1, share)]
    raise ValueError(f"{place} m is not on the grid from {line[0]} to {line[-1]} m")


class CalculixDeck:
    """The deck of ``assembly``, and the evaluation of its nodes."""

    def __init__(self, assembly: GivenAssembly) -> None:
        for piece in assembly.pieces:
            if not piece.fixed and piece.young_Pa is None:
                raise SystemExit(f"{piece.name} is rigid: CalculiX needs elastic pieces here")
        self.assembly = assembly
        self.rectangles = [rectangle(assembly, face) for face in assembly.faces]
        self.grids = self._grids()
        self.permanent = self._forces(permanent=True)
        self.variable = self._forces(permanent=False)

    # --- grids -----------------------------------------------------------------------------------
    def _grids(self) -> list[Grid]:
        pieces, lines = self.assembly.pieces, dict[int, Lines]()
        # Fixed pieces have the grid of those that they touch.
        for index in sorted(range(len(pieces)), key=lambda number: pieces[number].fixed):
            lines[index] = tuple(self._lines(index, axis, lines) for axis in range(3))
        node, element = count(1), count(1)
        return [
            Grid(
                each,
                {steps: next(node) for steps in product(*(range(len(line)) for line in each))},
                {
                    steps: next(element)
                    for steps in product(*(range(len(line) - 1) for line in each))
                },
            )
            for _, each in sorted(lines.items())
        ]

    def _lines(self, index: int, axis: int, known: dict[int, Lines]) -> tuple[float, ...]:
        """Places of a piece's grid lines along an axis."""
        piece = self.assembly.pieces[index]
        low, high = piece.low_m[axis], piece.high_m[axis]
        near = CLOSE * max(plus(piece.high_m, piece.low_m, -1.0))
        places = [low, high]
        for number, face in enumerate(self.assembly.faces):
            if index not in (face.below, face.above) or across(face) == axis:
                continue
            start, end = (corner[axis] for corner in self.rectangles[number])
            places += [start, end]
            if piece.fixed:
                other = known[face.above if face.below == index else face.below][axis]
                places += [place for place in other if start <= place <= end]
            elif face.cohesive or face.material.friction > LEAST_FRICTION:
                nodes = self._coordinates(number, axis)
                places += nodes
                if self.assembly.layout == "centres":  # and the edges of their cells
                    cells = range(len(nodes) + 1)
                    places += [start + (end - start) * cell / len(nodes) for cell in cells]
        places = merged(places, near)
        if piece.fixed:
            return tuple(places)
        longest = (self.assembly.mesh_m or math.inf) / PER_MESH
        found = []
        for one, next_one in pairwise(places):
            parts = max(1, math.ceil((next_one - one) / longest - CLOSE))
            found += [one + (next_one - one) * part / parts for part in range(parts)]
        return (*found, places[-1])

    def _coordinates(self, number: int, axis: int) -> list[float]:
        """Coordinates of a face's contact nodes along an axis."""
        low, high = (corner[axis] for corner in self.rectangles[number])
        every = [node.position_m[axis] for node in self.assembly.nodes if node.face == number]
        return merged(every, CLOSE * (high - low))

    # --- loads -----------------------------------------------------------------------------------
    def _forces(self, permanent: bool) -> Forces:
        """Nodal forces of the permanent loads (N), or of the variable load per newton."""
        found: Forces = defaultdict(float)
        for index, piece in enumerate(self.assembly.pieces):
            if piece.fixed:
                continue
            rest = [*piece.force_N, *piece.moment_Nm] if permanent else [0.0] * 6
            for load in self.assembly.loads if not permanent else ():
                if load.piece == index:
                    rest = plus(rest, [*load.force, *load.moment_m])
            parts: list[tuple[Vector, tuple[int, bool] | None]] = []
            for side in self.assembly.sides:
                if side.piece == index and side.permanent == permanent:
                    rest = plus(rest, side.wrench, -1.0)
                    parts.append((side.wrench, (side.axis, side.high)))
            for wrench, end in (*parts, (rest, None)):
                for place, force in spread(self.grids[index], piece, wrench, end).items():
                    found[place] += force
        return {place: force for place, force in found.items() if force}

    # --- text ------------------------------------------------------------------------------------
    def text(self, title: str, loads: Sequence[float]) -> str:
        """The deck: first the permanent loads, then one step to each of the ``loads`` (N)."""
        lines = ["*HEADING", title, *self._mesh(), *self._contacts()]
        lines += self._step(self.permanent, 1.0)
        for number, load in enumerate(loads):
            total = {
                place: self.permanent.get(place, 0.0) + load * force
                for place, force in self.variable.items()
            }
            # What little the dry faces carry at first soon opens, closes and slips.
            lines += self._step(total, 1.0 if number else FIRST_SHARE)
        return "\n".join(lines) + "\n"

    def _mesh(self) -> Iterator[str]:
        pieces = self.assembly.pieces
        yield f"*NODE, NSET={NODES}"
        for grid in self.grids:
            for steps, number in grid.nodes.items():
                yield f"{number}, " + ", ".join(map(printed, grid.place(steps)))
        for index, grid in enumerate(self.grids):
            yield f"*ELEMENT, TYPE=C3D8I, ELSET=P{index}"
            for steps, number in grid.elements.items():
                corners = (grid.nodes[tuple(map(add, steps, corner))] for corner in CORNERS)
                yield f"{number}, " + ", ".join(map(str, corners))
        held = [self.grids[i] for i, piece in enumerate(pieces) if piece.fixed]
        yield f"*NSET, NSET={HELD}, GENERATE"
        for grid in held:
            yield f"{min(grid.nodes.values())}, {max(grid.nodes.values())}, 1"
        if held:
            yield from ("*BOUNDARY", f"{HELD}, 1, 3")
        some = next(piece for piece in pieces if piece.young_Pa is not None)
        for index, piece in enumerate(pieces):
            elastic = some if piece.young_Pa is None else piece  # any will do for fixed pieces
            assert elastic.young_Pa is not None
            yield f"*MATERIAL, NAME=M{index}"
            yield from ("*ELASTIC", f"{printed(elastic.young_Pa)}, {printed(elastic.poisson)}")
            yield f"*SOLID SECTION, ELSET=P{index}, MATERIAL=M{index}"

    def _contacts(self) -> Iterator[str]:
        for number, face in enumerate(self.assembly.faces):
            law, axis = face.material, across(face)
            for name, index, high in (("B", face.below, 1), ("A", face.above, 0)):
                yield f"*SURFACE, NAME={name}{number}, TYPE=ELEMENT"
                for element in self._under(index, axis, high, *self.rectangles[number]):
                    yield f"{element}, {SIDES[axis][high]}"
            yield f"*SURFACE INTERACTION, NAME=I{number}"
            kind = "TIED" if face.cohesive else "LINEAR"
            yield f"*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE={kind}"
            yield printed(law.normal_stiffness)
            friction = 1.0 if face.cohesive else law.friction
            if friction > LEAST_FRICTION:
                yield from ("*FRICTION", f"{printed(friction)}, {printed(law.shear_stiffness)}")
            yield f"*CONTACT PAIR, INTERACTION=I{number}, TYPE=SURFACE TO SURFACE"
            # The slave is a piece that moves.
            below_is_slave = self.assembly.pieces[face.above].fixed
            yield f"B{number}, A{number}" if below_is_slave else f"A{number}, B{number}"

    def _under(self, index: int, axis: int, high: int, low_m: Vector, high_m: Vector) -> list[int]:
        """Elements of a piece that lie under a face, on one of its sides."""
        grid = self.grids[index]
        spans = [grid.span(k, low_m[k], high_m[k]) for k in range(3) if k != axis]
        end = len(grid.lines[axis]) - 2 if high else 0
        spans.insert(axis, range(end, end + 1))
        return [grid.elements[steps] for steps in product(*spans)]

    def _step(self, forces: Forces, share: float) -> Iterator[str]:
        """A step of CalculiX to these forces; ``share``: its first increment."""
        yield from ("*STEP, INC=1000", "*STATIC", f"{share}, 1., 1e-6, 1.")
        if forces:
            yield "*CLOAD"
        for (node, direction), force in sorted(forces.items()):
            yield f"{node}, {direction}, {printed(force)}"
        yield from ("*NODE FILE", "U", "*END STEP")

    # --- results of its nodes --------------------------------------------------------------------
    def jump_weights(self, number: int) -> dict[int, float]:
        """Shares of the grid's nodes in the displacement of below less above at a contact node.

        A node at a cell's centre stands for the mean over the cell.
        """
        node = self.assembly.nodes[number]
        face = self.assembly.faces[node.face]
        found: dict[int, float] = defaultdict(float)
        for place, share in self._places(number):
            for index, sign in ((face.below, 1.0), (face.above, -1.0)):
                for grid_node, weight in self.grids[index].weights(place).items():
                    found[grid_node] += sign * share * weight
        return found

    def _places(self, number: int) -> list[tuple[list[float], float]]:
        node = self.assembly.nodes[number]
        position = list(node.position_m)
        if self.assembly.layout != "centres":
            return [(position, 1.0)]
        low, high = self.rectangles[node.face]
        axis, along = across(self.assembly.faces[node.face]), []
        for k in range(3):
            shares = [(0.0, 1.0)]
            if k != axis:
                half = (high[k] - low[k]) / len(self._coordinates(node.face, k)) / 2
                shares = [(-half, 0.25), (0.0, 0.5), (half, 0.25)]
            along.append([(position[k] + shift, share) for shift, share in shares])
        return [
            ([place for place, _ in point], math.prod(share for _, share in point))
            for point in product(*along)
        ]


def across(face: GivenFace) -> int:
    """The axis of a face's normal."""
    return max(range(3), key=lambda axis: abs(face.normal[axis]))


def rectangle(assembly: GivenAssembly, face: GivenFace) -> tuple[list[float], list[float]]:
    """Two opposite corners of a face, in m."""
    one, other = assembly.pieces[face.below], assembly.pieces[face.above]
    low = [*map(max, one.low_m, other.low_m)]
    high = [*map(min, one.high_m, other.high_m)]
    axis = across(face)
    low[axis] = high[axis] = one.high_m[axis]
    return low, high


def merged(places: Iterable[float], near: float) -> list[float]:
    """``places`` in order, those that are no further apart than ``near`` being one."""
    found: list[float] = []
    for place in sorted(places):
        if not found or place - found[-1] > near:
            found.append(place)
    return found


def spread(grid: Grid, piece: GivenPiece, wrench: Vector, end: tuple[int, bool] | None) -> Forces:
    """Nodal forces of a force and a moment about a piece's centre, spread over a side or all of it.

    What is spread varies linearly: uniform for the force, like a rotation for the moment. ``end``:
    the axis that the side lies across, and whether it is the far one.
    """
    if not any(wrench):
        return {}
    size, force = plus(piece.high_m, piece.low_m, -1.0), wrench[:3]
    centre = [(low + high) / 2 for low, high in zip(piece.low_m, piece.high_m, strict=True)]
    arm = [0.0, 0.0, 0.0]  # of the side
    along = [shares(line) for line in grid.lines]
    if end:
        axis, high = end
        size[axis] = 0.0
        arm[axis] = (piece.high_m if high else piece.low_m)[axis] - centre[axis]
        along[axis] = [(len(along[axis]) - 1 if high else 0, 1.0, centre[axis] + arm[axis])]
    moment = plus(wrench[3:], cross(arm, force), -1.0)  # about the centre of the side
    turn = [0.0, 0.0, 0.0]
    for k in range(3):
        second = math.fsum(edge**2 for j, edge in enumerate(size) if j != k) / 12
        turn[k] = moment[k] / second if second else 0.0
    middle = plus(centre, arm)
    found: Forces = {}
    for point in product(*along):
        node = grid.nodes[tuple(step for step, _, _ in point)]
        part = math.prod(mean for _, mean, _ in point)
        # From the middle to the mean place, weighted by the node's shape function.
        lever = [first / mean - m for (_, mean, first), m in zip(point, middle, strict=True)]
        for k, value in enumerate(plus(force, cross(turn, lever))):
            if value:
                found[node, k + 1] = part * value
    return found


def shares(line: Sequence[float]) -> list[tuple[int, float, float]]:
    """For each grid line: its step, the mean of its shape function and that times the place."""
    length = line[-1] - line[0]
    mean, first = [0.0] * len(line), [0.0] * len(line)
    for step, (low, high) in enumerate(pairwise(line)):
        part = (high - low) / length
        mean[step] += part / 2
        mean[step + 1] += part / 2
        first[step] += part * (2 * low + high) / 6
        first[step + 1] += part * (low + 2 * high) / 6
    return [(step, m, f) for step, (m, f) in enumerate(zip(mean, first, strict=True))]


def printed(value: float) -> str:
    """A number as CalculiX reads it: no more than 20 characters, and never taken for an integer."""
    return f"{value:.{DIGITS}e}"
