"""An assembly in LIGGGHTS, at a load; it can be brought back to where it stood before."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from ..scripts.assembly import Vector, dot, length, plus, utilisation
from ..scripts.motion import STILL, Fall, PieceMotion, nodes_off_sides
from ..scripts.next_failure import most_used
from ..scripts.records import EngineOutcome, History, NodeForce
from .deck import LiggghtsDeck
from .process import LiggghtsProcess

INPUT_SCRIPT, DATA_FILE = "joint.in", "joint.atoms"
SWING = 20.0  # utilisation over unbalanced ratio: by more, no bond swings after a cut
SOON = 0.05  # of the longest wait: what moves then still goes on against less drag, and so faster
LESS_DRAG = 0.1
LOOKS = 10  # at least, in every time as long as all that was waited before


@dataclass(frozen=True)
class Event:
    """A change of the assembly: its load was raised (N), or springs of nodes were cut."""

    load: float | None
    nodes: tuple[int, ...] = ()


class Placement:
    """Position of a moved piece: its centroid (m) and its axes."""

    def __init__(self, start: Vector, distance: float, places: Sequence[float]) -> None:
        """``places`` (m) of its handles, +x, -x, +y, -y, +z, -z, ``distance`` from ``start``."""
        ends = [places[3 * k : 3 * k + 3] for k in range(6)]
        self.start = start
        self.centre = [math.fsum(end[k] for end in ends) / 6 for k in range(3)]
        self.axes = [
            [(one - other) / (2 * distance) for one, other in zip(*pair, strict=True)]
            for pair in (ends[0:2], ends[2:4], ends[4:6])
        ]

    def place(self, position: Vector) -> list[float]:
        """Present position of a point of the piece."""
        arm = plus(position, self.start, -1.0)
        return [
            c + math.fsum(arm[k] * self.axes[k][i] for k in range(3))
            for i, c in enumerate(self.centre)
        ]

    def motion(self) -> PieceMotion:
        """Displacement of the centroid and small rotation about x, y, z."""
        (_, xy, xz), (yx, _, yz), (zx, zy, _) = self.axes
        turn = [(yz - zy) / 2, (zx - xz) / 2, (xy - yx) / 2]
        return PieceMotion(plus(self.centre, self.start, -1.0), turn)


class LiggghtsModel:
    """A LIGGGHTS process with the assembly, and the changes made so far."""

    def __init__(self, deck: LiggghtsDeck, ranks: int, history: History) -> None:
        self.deck, self.assembly, self.search = deck, deck.assembly, deck.search
        self.ranks, self.history = ranks, history
        self.slice = max(1, round(2 * self.search.period_steps))  # steps between two looks at it
        self.events: list[Event] = []
        self.place_variables = deck.place_variables
        self.force_variables = deck.force_variables
        self._start()

    def _start(self) -> None:
        self.engine, self.load = LiggghtsProcess(self.ranks), 0.0
        self.cut_nodes: set[int] = set()
        self.lost: set[int] = set()  # nodes whose vertex has left the side that it touched
        self.fall = Fall(self.assembly, self.search.collapse_m, [STILL] * len(self.assembly.pieces))
        self.engine.send(f"include {INPUT_SCRIPT}")
        self._run(0)

    # --- the way to equilibrium ------------------------------------------------------------------
    def raised(self, load: float) -> EngineOutcome:
        """Raise the load (N) smoothly and wait for the outcome."""
        return self._new(Event(load))

    def cut(self, nodes: Iterable[int]) -> EngineOutcome:
        """Cut the springs of nodes and wait for the outcome."""
        return self._new(Event(None, tuple(sorted(nodes))))

    def back(self) -> None:
        """Undo the last event, by doing all before it again."""
        self.engine.stop()
        self.events.pop()
        self._start()
        for event in self.events:
            self._do(event)

    def _new(self, event: Event) -> EngineOutcome:
        self.history.attempts += 1
        self.events.append(event)
        return self._do(event)

    def _do(self, event: Event) -> EngineOutcome:
        return self._cut(event.nodes) if event.load is None else self._raise(event.load)

    def _raise(self, load: float) -> EngineOutcome:
        ramp = self.search.ramp(load - self.load, load)
        if self.engine.steps < self.deck.permanent_ramp:
            ramp = max(ramp, self.deck.permanent_ramp)
        self._set_load(self.load, load - self.load, ramp)
        self.fall = Fall(self.assembly, self.search.collapse_m, self.motions())
        for done in range(0, ramp, self.slice):
            if self._falls(min(self.slice, ramp - done)):
                return self.fall.outcome(self.motions())
        self.load = load
        self._set_load(load)
        return self._waits()

    def _set_load(self, load: float, rise: float = 0, ramp: int = 1, drag: float = 1) -> None:
        """Have the load (N) rise from ``load`` by ``rise`` in ``ramp`` steps, against some drag."""
        values = {
            "load_before": load,
            "load_rise": rise,
            "load_start": self.engine.steps,
            "load_ramp": float(ramp),
            "load_drag": drag * self.deck.drag,
        }
        self.engine.send(*(f"variable {name} equal {value!r}" for name, value in values.items()))

    def _cut(self, nodes: Iterable[int]) -> EngineOutcome:
        self.cut_nodes |= set(nodes)
        self.fall = Fall(self.assembly, self.search.collapse_m, self.motions())
        commands = []
        for node in nodes:
            commands.append(f"bond_coeff {self.deck.bond[node]} 0.0 0.0")
            types = self.deck.patch_types[self.deck.patch_of[node]]
            commands += [
                f"set atom {atom} type {kind}"
                for atom, kind in zip(self.deck.atoms.spheres[node], types, strict=True)
            ]
        self.engine.send(*commands)
        self.engine.fresh = True
        return self._waits(SWING)

    def _waits(self, swing: float = math.inf) -> EngineOutcome:
        """Wait for the outcome.

        No longer than until a bond is overstressed by more than it may swing back by: ``swing``
        times the unbalanced ratio.
        """
        waited = 0
        while waited < self.search.hold_steps:
            if waited > SOON * self.search.hold_steps:
                self._set_load(self.load, drag=LESS_DRAG)
            steps = max(self.slice, waited // LOOKS)
            if self._falls(steps):
                return self.fall.outcome(self.motions())
            unbalanced = self.unbalanced_ratio(self.load)
            if unbalanced < self.search.unbalanced_ratio:
                return EngineOutcome.EQUILIBRIUM
            if swing < math.inf and most_used(self.utilisation()) > 1.0 + swing * unbalanced:
                return EngineOutcome.OVERSTRESSED
            waited += steps
        return self.fall.at_last(self.motions())

    def _run(self, steps: int) -> None:
        self.engine.run(steps)
        self.history.time_steps += steps

    def _falls(self, steps: int) -> bool:
        """Advance by ``steps`` of time; whether a piece falls."""
        self._run(steps)
        motions = self.motions()
        falls = self.fall.sees(motions, steps)
        if self.fall.went_on():
            self._lose(nodes_off_sides(self.assembly, motions))
        return falls

    def _lose(self, nodes: list[int]) -> None:
        """Let nodes touch no more."""
        lost = set(nodes) - self.lost
        self.lost |= lost
        spheres = [atom for node in sorted(lost) for atom in self.deck.atoms.spheres[node]]
        self.engine.send(*(f"set atom {atom} type {self.deck.lone}" for atom in spheres))
        self.engine.fresh = self.engine.fresh or bool(lost)

    # --- measurements ----------------------------------------------------------------------------
    def _placed(self) -> dict[int, Placement]:
        """Placement of each free piece."""
        values, pieces = self.engine.values(self.place_variables), self.assembly.pieces
        return {
            piece: Placement(
                pieces[piece].centre_m, self.deck.reach[piece], values[18 * k : 18 * k + 18]
            )
            for k, piece in enumerate(self.assembly.free)
        }

    def motions(self) -> list[PieceMotion]:
        """Displacement and rotation of each piece."""
        placed = self._placed()
        pieces = range(len(self.assembly.pieces))
        return [placed[piece].motion() if piece in placed else STILL for piece in pieces]

    def displacement(self) -> float:
        """The displacement that the load works on, in m, see `Assembly.displacement`."""
        return self.assembly.displacement(self.motions().__getitem__)

    def unbalanced_ratio(self, load: float) -> float:
        """Mean unbalanced force on a free piece over the load, or the permanent one if larger."""
        values = self.engine.values(self.force_variables)
        total = math.fsum(map(length, zip(values[::3], values[1::3], values[2::3], strict=True)))
        return total / len(self.assembly.free) / max(load, self.assembly.permanent_N)

    def spring_forces(self) -> dict[int, list[float]]:
        """Force of each spring (N), on the piece above; 0 where it is cut."""
        placed = self._placed()

        def place(piece: int, position: Vector) -> Vector:
            return placed[piece].place(position) if piece in placed else position

        forces = {}
        for node in self.deck.bond:
            contact = self.assembly.nodes[node]
            face, position = self.assembly.faces[contact.face], contact.position_m
            apart = plus(place(face.below, position), place(face.above, position), -1.0)
            stiffness = self.deck.spring_stiffness(node)
            forces[node] = [0.0 if node in self.cut_nodes else stiffness * d for d in apart]
        return forces

    def node_forces(self) -> list[NodeForce]:
        """Forces of all nodes."""
        touching = self.engine.dump("all", ["fx", "fy", "fz"])
        springs, rows = self.spring_forces(), []
        for number, node in enumerate(self.assembly.nodes):
            normal = self.assembly.faces[node.face].normal
            bonded = number in self.deck.bond and number not in self.cut_nodes
            # The sphere above has one neighbour, the one below: its force is the node's.
            force = springs[number] if bonded else touching[self.deck.atoms.spheres[number][1]]
            along = dot(force, normal)
            rows.append(NodeForce(along, plus(force, normal, -along), bonded))
        return rows

    def utilisation(self) -> dict[int, float]:
        """Shear or tension over its strength, of each spring that holds."""
        rows = {}
        for node, force in self.spring_forces().items():
            if node not in self.cut_nodes:
                contact = self.assembly.nodes[node]
                face = self.assembly.faces[contact.face]
                rows[node] = utilisation(force, face.normal, face.material, contact.area_m2)
        return rows

    def record(self, load: float, stage: str) -> list[NodeForce]:
        """Add a line to the history; the forces of all nodes."""
        nodes = self.node_forces()
        self.history.record(load, stage, self.displacement(), self.unbalanced_ratio(load), nodes)
        return nodes
