"""How blocks move in time: steps from where they were built, and where they are on the way.

A block has fallen that has turned by 45 degrees, or whose centroid has sunk by half of its least
width. Contacts are those of convex solids, wherever they meet; see `sidmacib.dynamics.impulses`.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import Rotation

from sidmacib.dynamics.bodies import State
from sidmacib.dynamics.collide import POINTS
from sidmacib.dynamics.contacts import Contacts, Pairs
from sidmacib.dynamics.impulses import Acting, steps
from sidmacib.dynamics.roots import bodies_of, roots_of
from sidmacib.dynamics.shapes import Shapes
from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import GRAVITY, Assembly, Floats, Integers, Kind
from sidmacib.mechanics.crushing import crushed_faces
from sidmacib.structure.shaking import TimeLoads

REACH = 0.005  # over the mean size of solids: gaps that may close before pairs are sought again
FALLEN = math.radians(45.0)
SUNK = 0.5  # of a block's least width, between planes along one of its sides
KEPT = 0.002  # s: between positions that are kept
TOLD = 5  # positions: of which one is told of
AFTER = 0.5  # s: for which blocks are followed once one has fallen
WHAT = "in time"


@dataclass(frozen=True, eq=False)
class History:
    """Where pieces are at some times (s), (T,).

    ``shift``: of the centroids from where they were built, m, (T, P, 3); ``turn``: rotation
    vectors, rad, (T, P, 3). ``fallen``: the time at which each piece has fallen, inf of others,
    (P,). ``energy``: kinetic and potential, J, (T,), from that at the start. ``pressed``: the
    deepest that solids reach into each other, m; ``thin``: the least width of a free piece, m.
    ``left``: the largest change of an impulse in the last sweep of a step, over the largest one.
    ``roots``: pieces that are one body with another, (R,), and what their bonds carried at most, as
    long as nothing had fallen, over their strength and over what they surely carry: ``used``,
    (2, R), see `sidmacib.dynamics.roots`.
    """

    time: Floats
    shift: Floats
    turn: Floats
    fallen: Floats
    energy: Floats
    pressed: float
    thin: float
    left: float
    roots: Integers
    used: Floats

    @property
    def stands(self) -> bool:
        """Whether nothing has fallen."""
        return self.first_fallen is None

    @property
    def holds(self) -> bool:
        """Whether nothing has fallen, and bonds surely carry what they have to."""
        return self.stands and bool((self.used[1] <= 1.0).all())

    @property
    def first_fallen(self) -> int | None:
        """The index of the piece that falls first; None if all stand."""
        first = int(self.fallen.argmin())
        return first if math.isfinite(self.fallen[first]) else None


def history(
    assembly: Assembly,
    loads: TimeLoads,
    factor: float = 1.0,
    *,
    until_it_falls: bool = False,
    progress: Callable[[str], object] = str,
) -> History:
    """What happens to ``assembly`` under ``loads``; ``factor``: on the accelerations of the ground.

    ``until_it_falls``: no further; else for `AFTER`. ``progress`` is told how far it is.
    `CapacityError` for chains of bonds, condensed locks and blocks that may be crushed.
    """
    if reason := assembly.without_stiffness:
        raise CapacityError(f"{WHAT}: {reason}")
    if crushed_faces(assembly):
        raise CapacityError(f"{WHAT}: blocks are not crushed; leave out compressive_strength")
    motion = _Motion(assembly, loads)
    ground = loads.accelerations(factor)
    every = max(round(KEPT / loads.step), 1)
    kept = [motion.state_now()]
    kept_on = 0.0 if until_it_falls else AFTER
    for start in range(0, len(ground), every):
        if len(kept) % TOLD == 1:
            progress(f"{loads.step * start:.3g} of {loads.duration:g} s")
        motion.run(ground[start : start + every])
        kept.append(motion.state_now())
        motion.note_fallen(loads.step * min(start + every, len(ground)))
        if kept_on <= (len(kept) - 1) * every * loads.step - float(motion.fallen.min()):
            break
    time = np.minimum(np.arange(len(kept)) * every, len(ground)) * loads.step
    if not np.isfinite(kept[-1].centre).all():
        raise CapacityError(f"{WHAT}: the numbers are too large; check the loads")
    shifts, turns, energy = motion.positions(kept)
    fallen = motion.fallen[motion.body]
    return History(
        *(time, shifts, turns, fallen, energy - energy[0]),
        pressed=max(0.0, -float(motion.told[1])),
        thin=float(motion.least[motion.shapes.bodies.mass > 0.0].min(initial=math.inf)),
        left=float(motion.told[0]),
        roots=motion.held,
        used=motion.used,
    )


def _require_known_bonds(assembly: Assembly, loads: TimeLoads, body: Integers) -> None:
    """`CapacityError`, with its name, for a bonded piece on which more than its weight acts."""
    held = body != np.arange(len(body))
    acts = loads.speed.any() & np.ones_like(held)
    acts |= (loads.beside.levers + loads.arms).any(axis=(1, 2)) | loads.sudden.any(axis=1)
    if loads.lost is not None:
        acts |= body == loads.lost
    for piece in np.flatnonzero(held & acts)[:1].tolist():
        name = assembly.pieces[piece].name
        raise CapacityError(
            f"{WHAT}: {name} is bonded; with bonds no blow may act, no support be lost that they "
            "hold on to, and no force on what they hold"
        )


@dataclass(eq=False)
class _Motion:
    """The state of all pieces, and the contacts that are known."""

    assembly: Assembly
    loads: TimeLoads
    told: Floats = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))

    def __post_init__(self) -> None:
        assembly, loads = self.assembly, self.loads
        self.body = bodies_of(assembly, WHAT)
        _require_known_bonds(assembly, loads, self.body)
        self.shapes = Shapes.of(assembly, self.body)
        self.near = REACH * float(self.shapes.solids.size.mean())
        self.built, body = self.shapes.centre, self.body
        count = len(self.built)
        turn = np.zeros((count, 4))
        turn[:, 0] = 1.0
        self.state = State(self.built.copy(), turn, loads.speed.copy(), np.zeros((count, 3)))
        self.unit = GRAVITY * loads.step
        forces = (loads.permanent + loads.sudden)[:, :3]
        self.forces, self.levers = np.zeros((count, 3)), np.zeros((count, 3, 3))
        self.arms = np.array([piece.centre for piece in assembly.pieces]) - self.built[body]
        np.add.at(self.forces, body, forces)
        np.add.at(self.levers, body, loads.beside.levers + loads.arms)
        np.add.at(self.levers, body, self.arms[:, :, None] * forces[:, None, :])
        self.roots, self.held = roots_of(assembly, body, self.built[body], self.shapes.part, forces)
        self.used = np.zeros((2, len(self.held)))
        self.fallen = np.full(count, math.inf)
        self.least = self.shapes.least
        self.pairs = Pairs(np.zeros((0, 2), np.int64), np.zeros(0), np.zeros(0, np.int64))
        self.contacts = self._room(0)
        self.friction: dict[frozenset[int], float] = {}
        dry = (face for face in assembly.faces if face.kind is Kind.DRY)
        for face in dry:  # the least of several of a pair
            pair = frozenset((face.below, face.above))
            known = self.friction.get(pair, math.inf)
            self.friction[pair] = min(known, face.material.friction)
        self.other_friction = min(self.friction.values(), default=0.0)

    def state_now(self) -> State:
        """A copy of the state."""
        return State(*(each.copy() for each in self.state))

    def positions(self, kept: Sequence[State]) -> tuple[Floats, Floats, Floats]:
        """Shifts and rotation vectors, both (T, P, 3), and energy (J), (T,)."""
        centre, turn, speed, spin = (np.array(each) for each in zip(*kept, strict=True))
        bodies, shift = self.shapes.bodies, centre - self.built
        free = bodies.mass > 0.0
        rotation = Rotation.from_quat(turn.reshape(-1, 4), scalar_first=True)
        R = rotation.as_matrix().reshape(*turn.shape[:2], 3, 3)
        own = np.einsum("tpji,tpj->tpi", R, spin)[:, free]
        energy = 0.5 * np.einsum("p,tpi->t", bodies.mass, speed**2)
        energy += 0.5 * np.einsum("tpi,pij,tpj->t", own, bodies.inertia[free], own)
        energy -= np.einsum("pi,tpi->t", self.forces, shift)
        turned = R - np.eye(3)
        energy -= np.einsum("tpij,pji->t", turned, self.levers)
        shift = shift[:, self.body] + np.einsum("tpij,pj->tpi", turned[:, self.body], self.arms)
        return shift, rotation.as_rotvec().reshape(centre.shape)[:, self.body], energy

    def note_fallen(self, time: float) -> None:
        """Keep the ``time`` (s) of pieces that have fallen."""
        sunk = self.built[:, 2] - self.state.centre[:, 2] > SUNK * self.least
        down = sunk | (np.abs(self.state.turn[:, 0]) < math.cos(0.5 * FALLEN))
        self.fallen[down & np.isinf(self.fallen)] = time

    def run(self, ground: Floats) -> None:
        """One step for each of the accelerations of the ``ground`` (m/s2), (K, 3)."""
        shapes, loads, done = self.shapes, self.loads, 0
        used = self.used if np.isinf(self.fallen).all() else self.used.copy()
        while done < len(ground):
            if self.told[2]:
                self._find_pairs()
                self.told[2] = 0.0
            acting = Acting(
                *(self.forces, self.levers, ground[done:], loads.step, loads.restitution),
                self.unit,
            )
            made = steps(
                *(shapes.solids, shapes.built, shapes.bodies, self.state, self.pairs),
                *(self.contacts, acting, self.near),
                *(self.start, self.told),
                *(self.roots, used),
            )
            if made % 2:
                self.contacts = self.contacts[::-1]
            done += made

    def _find_pairs(self) -> None:
        """Pairs of solids that may meet before one has moved by ``near``, with their contacts."""
        turns = Rotation.from_quat(self.state.turn, scalar_first=True).as_matrix()
        self.start = self.shapes.places(self.state.centre, turns)
        found = self.shapes.pairs(self.start, 3.0 * self.near)
        if self.loads.lost is not None:
            found = found[
                (self.shapes.solids.piece[found] != self.body[self.loads.lost]).all(axis=1)
            ]
        if np.array_equal(found, self.pairs.solids):
            return
        number = {pair: k for k, pair in enumerate(map(tuple, found.tolist()))}
        known = map(tuple, self.pairs.solids.tolist())
        to = np.array([number.get(pair, -1) for pair in known], np.int64)
        side = np.full(len(found), -1, np.int64)
        side[to[to >= 0]] = self.pairs.side[to >= 0]
        pieces = map(frozenset, self.shapes.part[found].tolist())
        friction = [self.friction.get(each, self.other_friction) for each in pieces]
        old, new = self.contacts[0], self._room(len(found))
        if count := int(old.count[0]):
            kept = np.flatnonzero(to[old.pair[:count]] >= 0)
            for name in Contacts._fields[1:]:
                getattr(new[0], name)[: len(kept)] = getattr(old, name)[kept]
            new[0].pair[: len(kept)] = to[old.pair[kept]]
            new[0].count[0] = len(kept)
        self.pairs = Pairs(np.ascontiguousarray(found), np.array(friction, float), side)
        self.contacts = new

    @staticmethod
    def _room(pairs: int) -> tuple[Contacts, Contacts]:
        """Room for contacts of ``pairs``, before and after a step."""
        room = POINTS * pairs + 1

        def empty() -> Contacts:
            return Contacts(
                count=np.zeros(1, np.int64),
                pair=np.zeros(room, np.int64),
                one=np.zeros(room, np.int64),
                other=np.zeros(room, np.int64),
                frame=np.zeros((room, 3, 3)),
                place=np.zeros((room, 3)),
                gap=np.zeros(room),
                impulse=np.zeros((room, 3)),
                mu=np.zeros(room),
            )

        return empty(), empty()
