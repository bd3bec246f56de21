"""An assembly in YADE.

Every contact node is a pair of spheres, one in each of the two pieces that meet there; the node's
tributary area is in their stiffness and strength. All spheres of a piece are one rigid clump. The
sphere of the piece that brings a vertex is small, so that the point of contact stays at it; that of
the piece with the flat side is large, so that the normal turns with this one.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from ..scripts.assembly import (
    GivenAssembly,
    GivenMaterial,
    GivenSearch,
    Node,
    SupportMove,
    Vector,
)
from ..scripts.motion import STILL, Fall, PieceMotion
from ..scripts.records import EngineOutcome, History, NodeForce
from ..scripts.surroundings import Surroundings, centres
from .program import (
    O,
    Vector3,
    contact,
    node_force,
    watch,
    wrapper,
)

SLICE = 10  # time steps between two looks at the assembly
SLOW = 0.02  # largest acceleration of what is moved over that of gravity
FOLLOWS = 10.0  # motion of a piece over that of a support: what moves further does not follow it
HEAVY = 1e24  # mass of the sphere at a piece's centroid over those of contact spheres


@dataclass(frozen=True)
class YadeSettings:
    """The parts that only YADE has.

    ``point_m``, ``flat_m``: radii of spheres that are vertices and flat sides. ``damping``:
    Cundall's, not viscous. ``ductile``: whether inner faces keep their strength once reached.
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
        self._material_of = lru_cache(maxsize=None)(self._add_material)
        O.reset()  # it may hold another model
        self.clumps, self.pairs = self._build()
        self.surroundings = Surroundings(assembly)
        self.keep()
        self.free = [self.clumps[index] for index in assembly.free]

    # --- bodies ----------------------------------------------------------------------------------
    def _build(self) -> tuple[list[int], list[tuple[int, int]]]:
        """Make spheres, clumps and engines; ids of each piece's clump and each node's spheres."""
        members: list[list[int]] = [[] for _ in self.assembly.pieces]
        still = [STILL] * len(members)
        pairs = [self._add_pair(node, still) for node in self.assembly.nodes]
        for pair, face in zip(pairs, self.face_of, strict=True):
            members[face.below].append(pair[0])
            members[face.above].append(pair[1])
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
        watch(pairs)
        O.step()  # bonds form now, and never again
        for found, face in zip(map(contact, pairs), self.face_of, strict=True):
            if found and not found.phys.cohesionBroken:
                # If not, YADE adds friction to the cohesion, and in tension takes it off.
                found.phys.cohesionDisablesFriction = face.material.friction_in_bonds == 0.0
                if self.settings.ductile:  # or its first plastic opening would break a bond
                    found.phys.unpMax = -1.0
        detection.interactionDetectionFactor = 1.0
        return clumps, pairs

    def _add_pair(self, node: Node, motions: Sequence[PieceMotion]) -> tuple[int, int]:
        """Spheres of a node where its pieces have moved to, not in clumps yet; their ids."""
        face = self.assembly.faces[node.face]
        law = face.material, face.cohesive, node.area_m2
        radii = node.radii(self.settings.point_m, self.settings.flat_m)
        below, above = (
            self._add_sphere(Vector3(centre), radius, self._material_of(*law, radius))
            for centre, radius in zip(
                centres(self.assembly, node, radii, motions), radii, strict=True
            )
        )
        return below, above

    def _replace(self, number: int, motions: Sequence[PieceMotion]) -> None:
        """Put new spheres into the clumps for a node that has been replaced."""
        face = self.face_of[number]
        self.pairs[number] = self._add_pair(self.surroundings.nodes[number], motions)
        for piece, sphere in zip((face.below, face.above), self.pairs[number], strict=True):
            state = O.bodies[self.clumps[piece]].state
            turn, motion = (
                state.ori * state.refOri.conjugate(),
                (1.0 * state.vel, 1.0 * state.angVel),
            )
            # It stops the clump, and chooses other axes for it.
            O.bodies.addToClump([sphere], self.clumps[piece])
            self._weigh(piece, state)
            state.vel, state.angVel = motion
            state.refOri = turn.conjugate() * state.ori

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
        for index, spheres in enumerate(members):
            piece = self.assembly.pieces[index]
            spheres.append(self._add_sphere(Vector3(piece.centre_m), radius, heavy))
            clumps.append(int(O.bodies.clump(spheres)))
            state = O.bodies[clumps[-1]].state
            self._weigh(index, state)
            state.refPos, state.refOri = state.pos, state.ori  # displacements count from here
            if piece.fixed:
                O.bodies[clumps[-1]].dynamic = False
                state.blockedDOFs = "xyzXYZ"
        return clumps

    def _weigh(self, piece: int, state: Any) -> None:
        """Give a clump's ``state`` the mass and inertia of its piece, by index."""
        state.mass = self.assembly.pieces[piece].mass_kg
        # The same about all axes: the clump's frame may be turned against the cuboid's.
        state.inertia = self.assembly.pieces[piece].inertia_kgm2 * Vector3.Ones

    # --- loads and measurements ------------------------------------------------------------------
    @property
    def met(self) -> str | None:
        """Which two pieces have met, in words."""
        return self.surroundings.met

    def apply(self, load: float, permanent: float) -> None:
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
        if self.assembly.support:
            self._move_support(self.assembly.support, load)

    def undamp(self, damping: float) -> None:
        """Give Cundall's damping another value, from now on."""
        O.engines[-1].damping = damping

    def shake(self, acceleration: Vector) -> None:
        """Put the permanent loads on the pieces, and their inertia against that of the ground."""
        for index in self.assembly.free:
            piece = self.assembly.pieces[index]
            force = Vector3(piece.force_N) - piece.mass_kg * Vector3(acceleration)
            O.forces.setPermF(self.clumps[index], force)

    def _move_support(self, support: SupportMove, movement: float) -> None:
        """Give the support the velocity that brings it there (m or rad) in the next slice."""
        state, duration = O.bodies[self.clumps[support.piece]].state, SLICE * O.dt
        centre = self.assembly.pieces[support.piece].centre_m
        state.vel = (Vector3(support.place(centre, movement)) - state.pos) / duration
        if support.about_m is not None:
            turned = self._motion(support.piece).rotation
            state.angVel = (movement * Vector3(support.along) - Vector3(turned)) / duration

    def reaction(self) -> float:
        """Force (N) of the pieces on the support along its movement, or moment (N m) about it."""
        support = self.assembly.support
        assert support is not None
        clump = self.clumps[support.piece]
        along, force = Vector3(support.along), O.forces.f(clump, sync=True)
        if support.about_m is None:
            return float(along.dot(force))
        arm = O.bodies[clump].state.pos - Vector3(support.about_m)
        return float(along.dot(O.forces.t(clump) + arm.cross(force)))

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
        load = 0.0 if self.assembly.support else load
        return float(total / len(self.free) / max(load, self.assembly.permanent_N))

    def node_forces(self) -> list[NodeForce]:
        """Forces of all nodes."""
        return [node_force(*each) for each in zip(self.pairs, self.face_of, strict=True)]

    def broken(self) -> int:
        """Number of nodes whose bond has broken."""
        bonded = (force.bonded for force in self.node_forces())
        return sum(face.cohesive for face in self.face_of) - sum(bonded)

    # --- the way to equilibrium ------------------------------------------------------------------
    def raised(self, start: float, end: float, permanent: tuple[float, float]) -> EngineOutcome:
        """Raise the load smoothly from start to end (N) and wait for the outcome."""
        self.history.attempts += 1
        rise = end - start + (permanent[1] - permanent[0]) * self.assembly.permanent_N
        ramp, follows = self.search.ramp(rise, end), 0.0
        if self.assembly.support:
            turns = self.assembly.support.about_m is not None
            follows = (end - start) * (self.assembly.length_m if turns else 1.0)  # m
            ramp = max(ramp, self.slowly(follows))
        limit = self.search.collapse_m
        fall = Fall(self.assembly, limit + FOLLOWS * follows, self.motions())
        for step in range(SLICE, ramp + SLICE, SLICE):
            share = 0.5 - 0.5 * math.cos(math.pi * min(1.0, step / ramp))
            load = start + share * (end - start)
            self.apply(load, permanent[0] + share * (permanent[1] - permanent[0]))
            if outcome := self._goes_on(fall):
                return self._ended(load, outcome)
        if self.assembly.support:
            self.apply(end, permanent[1])  # it stays there
            fall = Fall(self.assembly, limit, self.motions())
        self.record(end, "loaded")
        for _ in range(0, self.search.hold_steps, SLICE):
            if outcome := self._goes_on(fall):
                return self._ended(end, outcome)
            rests = self.unbalanced_ratio(end) < self.search.unbalanced_ratio
            if rests and not self._lost(self.motions(), at_rest=True):
                return self._ended(end, EngineOutcome.EQUILIBRIUM)
        return self._ended(end, self.surroundings.at_last(fall, self.motions()))

    def slowly(self, far: float) -> int:
        """Time steps in which inertia hardly matters to what moves ``far`` (m), smoothly."""
        mass = math.fsum(self.assembly.pieces[index].mass_kg for index in self.assembly.free)
        acceleration = SLOW * self.assembly.permanent_N / mass
        return math.ceil(math.pi * math.sqrt(far / 2.0 / acceleration) / O.dt)

    def _goes_on(self, fall: Fall) -> EngineOutcome | None:
        """Advance by a slice of time steps; the outcome if pieces fall or meet."""
        motions = self.advance()
        if fall.sees(motions, SLICE):
            return fall.outcome(motions)
        return EngineOutcome.MEETING if self.met else None

    def advance(self) -> list[PieceMotion]:
        """Motions after a slice of time steps; nodes whose vertex has left its side are lost."""
        for _ in range(SLICE):
            O.step()  # O.run(SLICE, wait=True) would sleep 40 ms at each call
        self.history.time_steps += SLICE
        motions = self.motions()
        self._lost(motions)
        return motions

    def _lost(self, motions: Sequence[PieceMotion], *, at_rest: bool = False) -> bool:
        """Whether nodes have left the sides of pieces; those not lost go on where they are now."""
        if not (nodes := self.surroundings.look(motions, at_rest=at_rest)):
            return False
        touched = [(node, c) for node in nodes if (c := contact(self.pairs[node]))]
        shear = [(node, 1.0 * found.phys.shearForce) for node, found in touched]
        for node in nodes:
            O.interactions.erase(*self.pairs[node])  # which only opens it
            if node not in self.surroundings.lost:
                self._replace(node, motions)
        O.interactions.eraseNonReal()
        self._watch_all()
        O.step()
        for node, force in shear:
            if found := contact(self.pairs[node]):
                found.phys.shearForce = force
        return True

    def _watch_all(self) -> None:
        """Have every node that is not lost looked at in each step."""
        lost = self.surroundings.lost
        watch([pair for node, pair in enumerate(self.pairs) if node not in lost])

    def _ended(self, load: float, outcome: EngineOutcome) -> EngineOutcome:
        self.record(load, outcome.value)
        return outcome

    def record(self, load: float, stage: str) -> None:
        """Add a row: of a support that moves by the ``load``, the reaction over this."""
        ratio, nodes = self.unbalanced_ratio(load), self.node_forces()
        row = (self.reaction(), load) if self.assembly.support else (load, self.displacement())
        self.history.record(row[0], stage, row[1], ratio, nodes)

    def keep(self) -> None:
        """Keep the present state."""
        O.saveTmp("equilibrium")
        self.kept = list(self.pairs), self.surroundings.copy()

    def go_back(self) -> None:
        """Return to the state that was kept last."""
        O.loadTmp("equilibrium")
        pairs, surroundings = self.kept
        self.pairs, self.surroundings = list(pairs), surroundings.copy()
        self._watch_all()  # open nodes are not saved
