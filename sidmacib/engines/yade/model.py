"""An assembly in YADE.

Every contact node is a pair of spheres, one in each of the two pieces that meet there; the node's
tributary area is in their stiffness and strength. All spheres of a piece are one rigid clump. The
sphere of the piece that brings a vertex is small, so that the point of contact stays at it; that of
the piece with the flat side is large, so that the normal turns with this one.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from ..scripts.assembly import GivenAssembly, GivenFace, GivenMaterial, GivenSearch
from ..scripts.motion import Fall, PieceMotion
from ..scripts.records import EngineOutcome, History, NoAnswerError, NodeForce, require_contacts
from ..scripts.surroundings import Surroundings
from .program import O, Vector3, create_interaction, wrapper

SLICE = 10  # time steps between two looks at the assembly
HEAVY = 1e24  # mass of the sphere at a piece's centroid over those of contact spheres


@dataclass(frozen=True)
class YadeSettings:
    """The parts that only YADE has.

    ``point_m``, ``flat_m``: radii of spheres that are vertices and flat sides. ``damping``:
    Cundall's, not viscous. ``ductile``: whether inner faces keep their strength once it is reached.
    """

    point_m: float
    flat_m: float
    damping: float
    ductile: bool


class YadeModel:
    """An assembly of bodies in YADE's one and only scene."""

    def __init__(
        self, assembly: GivenAssembly, search: GivenSearch, settings: YadeSettings, history: History
    ) -> None:
        self.assembly, self.search, self.settings = assembly, search, settings
        self.history = history
        self.breakable = not settings.ductile
        self.face_of = [assembly.faces[node.face] for node in assembly.nodes]
        O.reset()  # it may hold another model
        self.clumps, self.pairs = self._build()
        # Node forces, while nothing has moved since, and those of the state that was kept.
        self.seen: list[NodeForce] | None = None
        self.kept: tuple[list[NodeForce] | None, set[int]] = None, set()
        self.surroundings = Surroundings(assembly)
        self.free = [self.clumps[index] for index in assembly.free]

    # --- bodies ----------------------------------------------------------------------------------
    def _build(self) -> tuple[list[int], list[tuple[int, int]]]:
        """Make spheres, clumps and engines; ids of each piece's clump and each node's spheres."""
        material_of = lru_cache(maxsize=None)(self._add_material)
        members: list[list[int]] = [[] for _ in self.assembly.pieces]
        pairs = []
        for node, face in zip(self.assembly.nodes, self.face_of, strict=True):
            below, above = node.radii(self.settings.point_m, self.settings.flat_m)
            normal, place = Vector3(face.normal), Vector3(node.position_m)
            law = face.material, face.cohesive, node.area_m2
            pair = (
                self._add_sphere(place - below * normal, below, material_of(*law, below)),
                self._add_sphere(place + above * normal, above, material_of(*law, above)),
            )
            members[face.below].append(pair[0])
            members[face.above].append(pair[1])
            pairs.append(pair)
        clumps = self._clump(members)
        O.dt = self.search.time_step_s
        detection = wrapper.Ig2_Sphere_Sphere_ScGeom6D(
            interactionDetectionFactor=1.001,
            updateRotations=False,  # of one sphere against the other, which no law here asks for
        )
        O.engines = [  # no collider: nodes are the only contacts
            wrapper.ForceResetter(),
            wrapper.InteractionLoop(
                [detection],
                [wrapper.Ip2_CohFrictMat_CohFrictMat_CohFrictPhys(setCohesionNow=True)],
                [wrapper.Law2_ScGeom6D_CohFrictPhys_CohesionMoment()],
            ),
            wrapper.NewtonIntegrator(damping=self.settings.damping, gravity=(0, 0, 0)),
        ]
        _watch(pairs)
        O.step()  # bonds form now, and never again
        _without_friction_of_bonds(pairs, self.face_of)
        if self.settings.ductile:
            _keep_in_tension(pairs)
        detection.interactionDetectionFactor = 1.0
        return clumps, pairs

    def _add_material(self, law: GivenMaterial, cohesive: bool, area: float, radius: float) -> int:
        """Material of a sphere of this radius (m) at a node with this area (m2).

        Of two spheres YADE takes as kn the harmonic mean of young * radius, ks = poisson * kn, and
        as adhesion the cohesion times the square of the smaller radius.
        """
        least = self.settings.point_m
        material = wrapper.CohFrictMat(
            young=law.normal_stiffness * area / radius,
            poisson=law.shear_stiffness / law.normal_stiffness,
            frictionAngle=math.atan(law.friction),
            isCohesive=law.cohesion > 0,
            normalCohesion=law.effective_tensile_strength * area / least**2,
            shearCohesion=law.cohesion * area / least**2,
            momentRotationLaw=False,
            # Dry nodes too: if not, one in tension shifts its reference and closes too early.
            fragile=not (self.settings.ductile and cohesive),
            density=1.0 / radius**3,
        )
        return int(O.materials.append(material))

    def _add_sphere(self, centre: Any, radius: float, material: int) -> int:
        body = wrapper.Body()
        body.shape = wrapper.Sphere(radius=radius)
        body.mat = O.materials[material]
        body.state = body.mat.newAssocState()
        body.state.mass, body.state.inertia = 1.0, Vector3.Ones  # those of its clump count
        body.state.pos = body.state.refPos = centre
        body.aspherical = False
        return int(O.bodies.append(body))

    def _clump(self, members: list[list[int]]) -> list[int]:
        """Make a clump of each piece's spheres, with the mass of the piece; their ids.

        A clump's origin is the centroid of its spheres: one that outweighs the others by far, and
        touches nothing, puts it at the centroid of the piece.
        """
        radius = self.settings.point_m
        heavy = int(O.materials.append(wrapper.CohFrictMat(density=HEAVY / radius**3)))
        clumps = []
        for piece, spheres in zip(self.assembly.pieces, members, strict=True):
            spheres.append(self._add_sphere(Vector3(piece.centre_m), radius, heavy))
            clumps.append(int(O.bodies.clump(spheres)))
            state = O.bodies[clumps[-1]].state
            state.mass = piece.mass_kg
            # The same about all axes: the clump's frame may be turned against the cuboid's.
            state.inertia = piece.inertia_kgm2 * Vector3.Ones
            state.refPos, state.refOri = state.pos, state.ori  # displacements count from here
            if piece.fixed:
                O.bodies[clumps[-1]].dynamic = False
                state.blockedDOFs = "xyzXYZ"
        return clumps

    @property
    def met(self) -> str | None:
        """Which two pieces have met, in words."""
        return self.surroundings.met

    # --- loads and measurements ------------------------------------------------------------------
    def _apply(self, load: float, permanent: float) -> None:
        """Put the load (N) and a share of the permanent loads on the pieces."""
        always = self.assembly.always(load)
        forces = [permanent * Vector3(force) for force, _ in always]
        moments = [permanent * Vector3(moment) for _, moment in always]
        for part in self.assembly.loads:
            forces[part.piece] += load * Vector3(part.force)
            moments[part.piece] += load * Vector3(part.moment_m)
        for index in self.assembly.free:
            O.forces.setPermF(self.clumps[index], forces[index])
            O.forces.setPermT(self.clumps[index], moments[index])

    def displacement(self) -> float:
        """The displacement that the load works on, in m, see `GivenAssembly.displacement`."""
        return self.assembly.displacement(self._motion)

    def motions(self) -> list[PieceMotion]:
        """Displacement and rotation of each piece."""
        return [self._motion(index) for index in range(len(self.clumps))]

    def _motion(self, piece: int) -> PieceMotion:
        state = O.bodies[self.clumps[piece]].state
        # rot() is in the frame of the clump.
        return PieceMotion(tuple(state.displ()), tuple(state.refOri * state.rot()))

    def unbalanced_ratio(self, load: float) -> float:
        """Mean unbalanced force on a free piece over the load, or the permanent one if larger.

        A moment counts as a force at the mean size of pieces: what only spins is at no rest.
        """
        total = math.fsum(
            max(
                O.forces.f(clump, sync=True).norm(),
                O.forces.t(clump).norm() / self.assembly.length_m,
            )
            for clump in self.free
        )
        return float(total / len(self.free) / max(load, self.assembly.permanent_N))

    def node_forces(self) -> list[NodeForce]:
        """Forces of all nodes."""
        if self.seen is None:
            self.seen = [
                _node_force(pair, face) for pair, face in zip(self.pairs, self.face_of, strict=True)
            ]
        return self.seen

    def broken(self) -> int:
        """Number of nodes whose bond has broken."""
        forces = self.node_forces()
        return sum(
            face.cohesive and not force.bonded
            for force, face in zip(forces, self.face_of, strict=True)
        )

    # --- the way to equilibrium ------------------------------------------------------------------
    def raised(self, start: float, end: float, permanent: tuple[float, float]) -> EngineOutcome:
        """Raise the load smoothly from start to end (N) and wait for the outcome."""
        self.history.attempts += 1
        rise = end - start + (permanent[1] - permanent[0]) * self.assembly.permanent_N
        ramp = self.search.ramp(rise, end)
        fall = Fall(self.assembly, self.search.collapse_m, self.motions())
        for step in range(SLICE, ramp + SLICE, SLICE):
            share = 0.5 - 0.5 * math.cos(math.pi * min(1.0, step / ramp))
            load = start + share * (end - start)
            self._apply(load, permanent[0] + share * (permanent[1] - permanent[0]))
            if outcome := self._goes_on(fall):
                return self._ended(load, outcome)
        self._record(end, "loaded")
        for _ in range(0, self.search.hold_steps, SLICE):
            if outcome := self._goes_on(fall):
                return self._ended(end, outcome)
            if self.unbalanced_ratio(end) < self.search.unbalanced_ratio:
                return self._ended(end, EngineOutcome.EQUILIBRIUM)
        return self._ended(end, self.surroundings.at_last(fall, self.motions()))

    def pulled(self, stiffness: float, ends: tuple[float, float]) -> float:
        """The load (N) of a spring (N/m) that pulls along it, at rest.

        ``ends``: its end moves from the one to the other (m). Exits with a reason where there is no
        rest, or pieces meet.
        """
        before, after = ends
        for step in range(0, self.search.ramp_steps + self.search.hold_steps, SLICE):
            end = before + min(1.0, step / self.search.ramp_steps) * (after - before)
            load = stiffness * (end - self.displacement())
            self._apply(load, 1.0)
            self._advance()
            require_contacts(EngineOutcome.MEETING if self.met else None, load, self.met)
            rests = self.unbalanced_ratio(load) < self.search.unbalanced_ratio
            if step > self.search.ramp_steps and rests:
                self._record(load, EngineOutcome.EQUILIBRIUM.value)
                return load
        raise NoAnswerError(f"no rest at a displacement of {self.displacement():.6g} m")

    def _goes_on(self, fall: Fall) -> EngineOutcome | None:
        """Advance by a slice of time steps; the outcome if pieces fall or meet."""
        motions = self._advance()
        if fall.sees(motions, SLICE):
            return fall.outcome(motions)
        return EngineOutcome.MEETING if self.met else None

    def _advance(self) -> list[PieceMotion]:
        """Motions after a slice of time steps; nodes whose vertex has left its side are lost."""
        for _ in range(SLICE):
            O.step()  # O.run(SLICE, wait=True) would sleep 40 ms at each call
        self.history.time_steps += SLICE
        self.seen, motions = None, self.motions()
        for node in self.surroundings.look(motions):
            O.interactions.erase(*self.pairs[node])
        return motions

    def _ended(self, load: float, outcome: EngineOutcome) -> EngineOutcome:
        self._record(load, outcome.value)
        return outcome

    def _record(self, load: float, stage: str) -> None:
        self.history.record(
            load, stage, self.displacement(), self.unbalanced_ratio(load), self.node_forces()
        )

    def keep(self) -> None:
        """Keep the present state."""
        O.saveTmp("equilibrium")
        self.kept = self.seen, set(self.surroundings.lost)

    def go_back(self) -> None:
        """Return to the state that was kept last."""
        O.loadTmp("equilibrium")
        self.seen, lost = self.kept
        self.surroundings = Surroundings(self.assembly, lost)
        # Open nodes are not saved.
        _watch([pair for node, pair in enumerate(self.pairs) if node not in lost])


def _node_force(pair: tuple[int, int], face: GivenFace) -> NodeForce:
    """The force between two spheres."""
    if not O.interactions.has(*pair) or not O.interactions[pair].isReal:
        return NodeForce(0.0, (0.0, 0.0, 0.0), False)
    contact = O.interactions[pair]
    normal = contact.geom.normal
    # YADE's forces act on the second body; the normal points from the first to the second.
    on_above = 1.0 if normal.dot(Vector3(face.normal)) > 0 else -1.0
    bonded = face.cohesive and not contact.phys.cohesionBroken
    shear = tuple(on_above * contact.phys.shearForce)
    return NodeForce(contact.phys.normalForce.dot(normal), shear, bonded)


def _without_friction_of_bonds(pairs: list[tuple[int, int]], faces: list[GivenFace]) -> None:
    """Let a rough face rub only where its bond has failed.

    By default YADE adds friction to the cohesion of a bond, and in tension takes it off.
    """
    for pair, face in zip(pairs, faces, strict=True):
        if face.cohesive and face.material.friction and O.interactions.has(*pair):
            O.interactions[pair].phys.cohesionDisablesFriction = True


def _keep_in_tension(pairs: list[tuple[int, int]]) -> None:
    """Let bonds yield in tension without limit.

    By default YADE breaks a bond at its first plastic opening, also one that is not fragile.
    """
    for pair in pairs:
        contact = O.interactions[pair] if O.interactions.has(*pair) else None
        if contact and contact.isReal and not contact.phys.cohesionBroken:
            contact.phys.unpMax = -1.0


def _watch(pairs: list[tuple[int, int]]) -> None:
    """Have every node looked at in each step, whether it is in contact or not."""
    for pair in pairs:
        if not O.interactions.has(*pair):
            create_interaction(*pair, virtualI=True)
