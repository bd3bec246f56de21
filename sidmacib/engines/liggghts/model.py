"""An assembly in LIGGGHTS, at a load; it can be brought back to where it stood before."""

import math
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from ..scripts.assembly import Vector, dot, length, plus, utilisation
from ..scripts.motion import STILL, Fall, PieceMotion
from ..scripts.next_failure import most_used
from ..scripts.records import EngineOutcome, History, NodeForce
from ..scripts.surroundings import Surroundings, centres
from .deck import BODIES, LiggghtsDeck
from .process import LiggghtsProcess

INPUT_SCRIPT, DATA_FILE, RESTART = "joint.in", "joint.atoms", "joint.restart"
SWING = 20.0  # utilisation over unbalanced ratio: by more, no bond swings after a cut
# Shares of the longest wait: what moves then still goes on against less drag, and so faster; what
# then does not slow down does not come to rest.
SOON, LATER = 0.05, 0.2
LESS_DRAG = 0.1  # share of the drag then
LOOKS = 10  # at least, in every time as long as all that was waited before


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
        """Displacement of the centroid and rotation as a vector."""
        (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = self.axes
        turn = [(yz - zy) / 2, (zx - xz) / 2, (xy - yx) / 2]
        if sine := length(turn):
            angle = math.atan2(sine, (xx + yy + zz - 1) / 2)
            turn = [part * angle / sine for part in turn]
        return PieceMotion(plus(self.centre, self.start, -1.0), turn)


class LiggghtsModel:
    """A LIGGGHTS process with the assembly, and the changes made so far."""

    def __init__(self, deck: LiggghtsDeck, ranks: int, history: History) -> None:
        self.deck, self.assembly, self.search = deck, deck.assembly, deck.search
        self.ranks, self.history = ranks, history
        self.slice = max(1, round(2 * self.search.period_steps))  # steps between two looks at it
        # What `RESTART` does not hold: load (N), time step, nodes that are cut, and surroundings.
        self.kept = 0.0, 0, frozenset[int](), Surroundings(self.assembly)
        self._start(f"include {INPUT_SCRIPT}")

    def _start(self, *commands: str) -> None:
        self.engine = LiggghtsProcess(self.ranks)
        self.load, self.engine.steps, self.cut_nodes, surroundings = self.kept
        self.surroundings = surroundings.copy()
        self.engine.send(*commands)
        self._set_load(self.load)
        self._run(0)
        self.fall = Fall(self.assembly, self.search.collapse_m, self.motions())

    @property
    def met(self) -> str | None:
        """Which two pieces have met, in words."""
        return self.surroundings.met

    # --- the way to equilibrium ------------------------------------------------------------------
    def raised(self, load: float) -> EngineOutcome:
        """Raise the load (N) smoothly and wait for the outcome."""
        self.history.attempts += 1
        self.kept = self.load, self.engine.steps, self.cut_nodes, self.surroundings.copy()
        self.engine.send(f"write_restart {RESTART}")
        self.engine.fresh = True
        ramp = self.search.ramp(load - self.load, load)
        if self.engine.steps < self.deck.permanent_ramp:
            ramp = max(ramp, self.deck.permanent_ramp)
        self._set_load(self.load, load - self.load, ramp)
        self.fall = Fall(self.assembly, self.search.collapse_m, self.motions())
        for done in range(0, ramp, self.slice):
            if outcome := self._goes_on(min(self.slice, ramp - done)):
                return outcome
        self.load = load
        self._set_load(load)
        return self._waits()

    def cut(self, nodes: Iterable[int]) -> EngineOutcome:
        """Cut the springs of nodes and wait for the outcome, or until others must fail."""
        self.history.attempts += 1
        cut = sorted(nodes)
        self.cut_nodes |= frozenset(cut)
        self.fall = Fall(self.assembly, self.search.collapse_m, self.motions())
        commands = []
        for node in cut:
            commands.append(self._uncoupled(node))
            types = self.deck.patch_types[self.deck.patch_of[node]]
            commands += [
                f"set atom {atom} type {kind}"
                for atom, kind in zip(self.deck.atoms.spheres[node], types, strict=True)
            ]
        self.engine.send(*commands)
        self.engine.fresh = True
        return self._waits(SWING)

    def back(self) -> None:
        """Return to where the load was raised last."""
        self.engine.stop()
        script = Path(INPUT_SCRIPT).read_text().splitlines()
        again = [f"read_restart {RESTART}" if c.startswith("read_data") else c for c in script]
        self._start(*again, *(self._uncoupled(node) for node in sorted(self.cut_nodes)))

    def _uncoupled(self, node: int) -> str:
        return f"bond_coeff {self.deck.bond[node]} 0.0 0.0"

    def _set_load(self, load: float, rise: float = 0, ramp: int = 1, drag: float = 1) -> None:
        """Have the load (N) rise from ``load`` by ``rise`` in ``ramp`` steps, against some drag."""
        share = f"(0.5-0.5*cos(PI*(step-{self.engine.steps})/{ramp}))"
        whole = f"{load!r}+({rise!r})*{share}" if rise else f"{load!r}"
        self.engine.send(
            f"variable load equal {whole}",
            f"variable load_drag equal {drag * self.deck.drag!r}",
            *self.deck.pull(None if rise or self.engine.steps < self.deck.permanent_ramp else load),
        )

    def _waits(self, swing: float = math.inf) -> EngineOutcome:
        """Wait for the outcome.

        No longer than until a bond is overstressed by more than it may swing back by: ``swing``
        times the unbalanced ratio.
        """
        waited, hold = 0, self.search.hold_steps
        while waited < hold:
            if waited > SOON * hold:
                self._set_load(self.load, drag=LESS_DRAG)
            steps = max(self.slice, waited // LOOKS)
            if outcome := self._goes_on(steps):
                return outcome
            unbalanced = self.unbalanced_ratio(self.load)
            if unbalanced < self.search.unbalanced_ratio:
                return EngineOutcome.EQUILIBRIUM
            if swing < math.inf and most_used(self.utilisation()) > 1.0 + swing * unbalanced:
                return EngineOutcome.OVERSTRESSED
            waited += steps
            if waited > LATER * hold and self.fall.goes_on():
                break
        return self.surroundings.at_last(self.fall, self.motions())

    def _run(self, steps: int) -> None:
        self.engine.run(steps)
        self.history.time_steps += steps

    def _goes_on(self, steps: int) -> EngineOutcome | None:
        """Advance by ``steps`` of time; the outcome if pieces fall or meet."""
        self._run(steps)
        motions = self.motions()
        if self.fall.sees(motions, steps):
            return self.fall.outcome(motions)
        if changed := self.surroundings.look(motions):
            for node in changed:
                self.engine.send(*self._changed(node, motions))
            if self.assembly.dry:  # atoms that were set go back without
                self.engine.send("unfix bodies", BODIES)
            self.engine.fresh = True
        return EngineOutcome.MEETING if self.met else None

    def _changed(self, number: int, motions: Sequence[PieceMotion]) -> Iterator[str]:
        """Let a node touch no more, or put its spheres where it has gone."""
        spheres, patch = self.deck.atoms.spheres[number], self.deck.patch_of[number]
        if number in self.surroundings.lost:
            yield from (f"set atom {atom} type {self.deck.lone}" for atom in spheres)
            return
        node = self.surroundings.nodes[number]
        radii = node.radii(self.deck.point, self.deck.flat_radii[patch])
        types = self.deck.patch_types[patch]
        if node.vertex_above is not self.assembly.nodes[number].vertex_above:
            types = types[1], types[0]  # it does not touch those that are as before
        places = centres(self.assembly, node, radii, motions)
        for atom, radius, kind, (x, y, z) in zip(spheres, radii, types, places, strict=True):
            density = self.deck.atoms.light / (math.pi / 6 * (2 * radius) ** 3)
            yield f"set atom {atom} type {kind} x {x!r} y {y!r} z {z!r}"
            yield f"set atom {atom} diameter {2 * radius!r} density {density!r}"

    # --- measurements ----------------------------------------------------------------------------
    def _placed(self) -> dict[int, Placement]:
        """Placement of each free piece."""
        values, pieces = self.engine.values(self.deck.places), self.assembly.pieces
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
        """Mean unbalanced force on a free piece over the load, or the permanent one if larger.

        A moment counts as a force at the mean size of pieces: what only spins is at no rest.
        """
        values = self.engine.values(self.deck.forces)
        total = math.fsum(
            max(
                length(values[k : k + 6 : 2]),
                length(values[k + 1 : k + 6 : 2]) / self.assembly.length_m,
            )
            for k in range(0, len(values), 6)
        )
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
        touching = self.engine.forces()
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
