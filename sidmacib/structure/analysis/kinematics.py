r"""Finite motion of a structure of rigid blocks, by limit analysis on the displaced geometry.

The movement of a load or a support is given, step by step. In a step of h the blocks move by
:math:`\Delta u` so that their potential energy rises least while no contact closes beyond its gap
g. The dual of that is limit analysis of the displaced structure, in which a force may act across a
gap that the step can close, at a cost:

.. math::

    \max_{\lambda, s} \quad \lambda - \tfrac{1}{h} g^T s_n
    \quad \text{subject to} \quad
    M s + p + \lambda q = 0, \quad |s_t| \le \mu s_n

M has the contacts where they are now, see `sidmacib.structure.analysis.contacts`. The multipliers
of equilibrium are :math:`\Delta u / h`, normalised by :math:`q^T \Delta u = h`. Associated friction
opens a joint that slides by at most :math:`\mu h`, once: the gap is there in the next step. So
sliding does not dilate as steps become small (Anitescu, Mathematical Programming 105, 2006,
113-143, doi:10.1007/s10107-005-0590-7).

The capacity curve is the load over the motion of the mechanism of limit analysis, down to zero.
Joints are rigid and dry.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import cvxpy as cp
import numpy as np
from scipy.sparse import csr_array, vstack

from sidmacib.errors import CapacityError, InfeasibleError, SolverError, UnboundedError
from sidmacib.mechanics.admissible import balanced, in_units, within
from sidmacib.mechanics.assembly import Assembly, Floats
from sidmacib.mechanics.contact_law import Cone
from sidmacib.mechanics.crushing import crushed_faces
from sidmacib.mechanics.equilibrium import free_rows, moments_of, row_units
from sidmacib.mechanics.limit import LimitState, limit_load, require_standing
from sidmacib.mechanics.loads import Loads
from sidmacib.mechanics.optimisation import solve
from sidmacib.structure.analysis.contacts import (
    Contacts,
    Placement,
    contacts_of,
    meeting,
    sides_of,
)
from sidmacib.structure.loads import PointForce, StructureLoads, SupportMotion

STEP = 0.01  # largest motion of a point in a step, over the length of the assembly
LEAP = 0.25  # of the load at the start: a larger change in one step of a curve is a leap
SHORTEST = 1 / 64  # of a step: precision of the movement at which blocks fall
MOST_STEPS = 500
FAR = 300.0  # steps: contacts that are further open are left out
ACCURACIES = 1e-9, 1e-7, 1e-5
MOTION_DIGITS = 9
PRESSED = 1e-6  # of the weight: least force of an interface that counts
TWISTED = 0.01  # of the driving force at the start: less by limits of torque counts as none
STILL = 0.02  # of the largest relative motion: less counts as none
WHAT = "finite displacements"
FALL, WEDGE, LEAPS = "fall", "wedge", "leap"
MEET, REACHED, FURTHER = "meet", "reached", "further"


class LeapError(CapacityError):
    """The load would change by more than `LEAP` in one step."""


@dataclass(frozen=True, eq=False)
class Position:
    """A position of the blocks, and limit analysis there.

    ``moved``: the driving movement to there, m or rad. ``load``: the driving force that balances
    all others, N or N m. ``motion``: how the pieces go on to move per m or rad of that movement,
    (P, 6). ``contacts``, their ``force``, (K, 3) in N, and their ``rate``, (K, 3): how the vertices
    move from the flat sides, along the frames, per m or rad.
    """

    placed: Placement
    moved: float
    load: float
    motion: Floats
    contacts: Contacts
    force: Floats
    rate: Floats


@dataclass(frozen=True)
class Path:
    """Positions one after the other, and why there are no more.

    ``end``: blocks `FALL` or `WEDGE`, or go on in another way, at once (`LEAPS`); two that did not
    touch `MEET`; what was sought is `REACHED`, or not within `MOST_STEPS`. ``met``: the names of
    those that meet.
    """

    positions: tuple[Position, ...]
    end: str
    met: tuple[str, str] | None = None


class Kinematics:
    """The blocks of ``assembly`` and their joints under ``loads``, which drive them.

    `CapacityError` where gravity turns or blocks may be crushed, and of bonds.
    """

    def __init__(self, assembly: Assembly, loads: Loads) -> None:
        gravity = CapacityError(f"{WHAT}: gravity turns; give an acceleration or a force")
        loads.raised.require_newtons(gravity)
        if crushed_faces(assembly):
            raise CapacityError(f"{WHAT}: blocks are not crushed; leave out compressive_strength")
        self.assembly, self.loads = assembly, loads
        self.sides = [sides_of(assembly, face) for face in assembly.faces]

    def start(self) -> Position:
        """Where the blocks were built; errors of `position`."""
        return self.position(Placement.of(self.assembly), 0.0, 1.0)

    def limit(self) -> LimitState:
        """The limit state at the start: torque of faces is limited. Errors of `limit_load`.

        `InfeasibleError` if the blocks do not stand.
        """
        loads, driven = self.loads, None
        if isinstance(loads, SupportMotion):
            driven = np.zeros_like(loads.permanent)
            driven[loads.support] = loads.motion(self.assembly.pieces[loads.support].centre)
            loads = Loads(loads.permanent, loads.variable, loads.scale)
        require_standing(self.assembly, loads, friction=True)
        return limit_load(self.assembly, loads, friction=True, driven=driven)

    def path(self, reached: Callable[[Position], bool]) -> Path:
        """Positions from the start until one has ``reached`` what is sought, which is the last.

        Errors of `start` and `limit`; `CapacityError` where the torque of faces decides there.
        """
        found: list[Position] = [self.start()]
        limit = self.limit()
        if limit.untwisted is not None and limit.load < limit.untwisted - TWISTED * abs(limit.load):
            raise CapacityError(f"{WHAT}: blocks that twist on their faces are not followed")
        steepest = math.inf if isinstance(self.loads, SupportMotion) else LEAP * abs(found[0].load)
        failed: list[CapacityError] = []
        step = first = self.step(found[0].motion)
        while not reached(found[-1]):
            if met := meeting(self.assembly, found[-1].placed):
                return Path(tuple(found), MEET, met)
            if len(found) > MOST_STEPS:
                return Path(tuple(found), FURTHER)
            if step < SHORTEST * first:  # or the blocks move ever faster
                return Path(tuple(found), _verdict(failed))
            try:
                after = self.after(found[-1], step)
                if abs(after.load - found[-1].load) > steepest:
                    raise LeapError(f"{WHAT}: the load leaps")
                found.append(after)
            except CapacityError as error:
                failed.append(error)
                step /= 2
            else:
                most = self.step(found[-1].motion)
                step = min(step, most) if failed else most
        return Path(tuple(found), REACHED)

    def after(self, here: Position, step: float) -> Position:
        """The position after a ``step`` (m or rad) of the movement, by the midpoint rule."""
        half = here.placed.moved(step / 2 * here.motion)
        middle = self.position(half, here.moved + step / 2, step)
        return self.position(here.placed.moved(step * middle.motion), here.moved + step, step)

    def step(self, motion: Floats) -> float:
        """The driving movement by which a point moves by `STEP` of the assembly's length."""
        size = motion.reshape(-1, 2, 3) * np.array([1.0, self.assembly.length])[:, None]
        return STEP * self.assembly.length / float(np.linalg.norm(size, axis=2).max())

    def position(self, placed: Placement, moved: float, step: float) -> Position:
        """Limit analysis where the pieces are ``placed``, over a ``step`` of the driving movement.

        `InfeasibleError` if no forces balance the permanent loads, `UnboundedError` if the driving
        force has no limit, as blocks wedge.
        """
        scale = self.loads.scale
        directions, units, permanent, driving, unit = self._freedoms(placed)
        closing = step * unit / scale  # of the order of what closes in the step, m
        contacts = contacts_of(self.assembly, self.sides, placed).closer(FAR * closing)
        every = contacts.matrix(placed.centre)
        M = in_units((directions @ every).tocsr(), units, np.full(len(contacts.gap), scale))
        load, s = cp.Variable(), cp.Variable((len(contacts.gap), 3))
        balance = balanced(M, s, -permanent / units - load * (driving * unit / units))
        objective = cp.Maximize(load - contacts.gap / closing @ s[:, 0])
        solve(cp.Problem(objective, [balance, *_admissible(contacts, s)]), WHAT, *ACCURACIES)
        multipliers = balance.dual_value / units
        motion = directions.T @ (multipliers / float(multipliers @ driving))
        return Position(
            placed,
            moved,
            float(load.value) * unit,
            np.round(motion.reshape(-1, 6), MOTION_DIGITS) + 0.0,
            contacts,
            scale * s.value,
            np.asarray(every.T @ motion).reshape(-1, 3),
        )

    def stands_without(self, piece: int, here: Position) -> bool:
        """Whether contacts that are closed at a position, none of a ``piece``, carry all loads."""
        contacts = here.contacts.without(piece).closer(STILL * STEP * self.assembly.length)
        rows, scale = free_rows(self.assembly), self.loads.scale
        units, of_forces = scale * row_units(self.assembly), np.full(len(contacts.gap), scale)
        s = cp.Variable((len(contacts.gap), 3))
        permanent = self._permanent(here.placed).ravel()[rows] / units
        M = in_units(contacts.matrix(here.placed.centre)[rows], units, of_forces)
        try:
            constraints = [balanced(M, s, -permanent), *_admissible(contacts, s)]
            problem = cp.Problem(cp.Minimize(0), constraints)
            solve(problem, WHAT, *ACCURACIES)
        except InfeasibleError:
            return False
        return True

    def _permanent(self, placed: Placement) -> Floats:
        """Permanent forces and moments on the pieces, (P, 6), which act where these have moved."""
        always = self.loads.permanent.copy()
        if isinstance(self.loads, StructureLoads):
            always[:, 3:] = moments_of(placed.turn @ self.loads.beside.levers)
        return always

    def _freedoms(self, placed: Placement) -> tuple[csr_array, Floats, Floats, Floats, float]:
        """What can move, and the forces along it: the free pieces, and the support that moves.

        Directions of the pieces (m and rad about their centroids) per unit of each freedom,
        (R, 6 P); units of the forces along them (N or N m), the permanent ones, and those per unit
        of the driving force, (R,) each; and its unit. It acts on the support, if one moves; else
        the points where it acts move with the pieces.
        """
        loads, rows, width = self.loads, free_rows(self.assembly), 6 * len(self.assembly.pieces)
        ones = csr_array((np.ones(len(rows)), (np.arange(len(rows)), rows)), (len(rows), width))
        units, driving = row_units(self.assembly) * loads.scale, loads.variable.copy()
        permanent = self._permanent(placed).ravel()[rows]
        if isinstance(loads, SupportMotion):
            moves = np.zeros((1, width))
            moves[0, 6 * loads.support :][:6] = loads.motion(placed.centre[loads.support])
            unit = loads.scale * (self.assembly.length if loads.turns else 1.0)
            both = vstack([ones, csr_array(moves)], format="csr")
            alone = np.append(np.zeros(len(rows)), 1.0)
            return both, np.append(units, unit), np.append(permanent, 0.0), alone, unit
        if isinstance(loads, PointForce):
            arms = np.einsum("pij,pj->pi", placed.turn, loads.arms)
            driving[:, 3:] = np.cross(arms, driving[:, :3])
        return ones, units, permanent, driving.ravel()[rows], loads.scale

    def moving(self, here: Position) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Names of the interfaces that are hinges at a position, and of those that slide.

        They are pressed; a hinge opens on one side, one that slides moves where it is closed.
        """
        opening, sliding = here.rate[:, 0], np.hypot(here.rate[:, 1], here.rate[:, 2])
        least = STILL * float(np.linalg.norm(here.rate, axis=1).max())
        hinges, slides = [], []
        for number, face in enumerate(self.assembly.faces):
            on_face = here.contacts.face == number
            pressed = on_face & (here.force[:, 0] > PRESSED * self.loads.scale)
            if pressed.any() and sliding[pressed].min() > least:
                slides.append(face.name)
            elif pressed.any() and opening[on_face].max() > least:
                hinges.append(face.name)
        return tuple(hinges), tuple(slides)


def _admissible(contacts: Contacts, s: cp.Variable) -> list[cp.Constraint]:
    """Contact forces ``s``, (K, 3), press, and are within the cones of friction."""
    none = np.zeros_like(contacts.friction)
    cone = Cone(none, contacts.friction, none)
    return within(cone, s[:, 0], s[:, 1:], np.arange(len(none)))


def _verdict(failed: Sequence[CapacityError]) -> str:
    """Why no step follows, however short; the error of a solver that proved no reason.

    Close to where blocks fall, a solver may be unable to prove that they do. Where a lever shrinks,
    a block that turned slides on and may turn back: there is equilibrium, which steps leap over.
    """
    proven = [error for error in failed if not isinstance(error, SolverError)]
    if failed and not proven:
        raise failed[-1]
    if not failed or isinstance(proven[0], LeapError):
        return LEAPS
    return WEDGE if isinstance(proven[-1], UnboundedError) else FALL


@dataclass(frozen=True, eq=False)
class CapacityCurve:
    """The load (N) over the ``displacement`` along it (m), both (K,).

    The displacement is that on which the load does work: of the point where a force acts; the mean
    by mass under an acceleration. ``rotation``: the largest of a block, in degrees, (K,). ``path``:
    the positions, whose last carries less than nothing if the load falls to 0; the last point of
    the curve is at 0 then. ``hinges``, ``slides``: names of interfaces at the start.
    """

    displacement: Floats
    load: Floats
    rotation: Floats
    path: Path
    hinges: tuple[str, ...]
    slides: tuple[str, ...]

    @property
    def end(self) -> str:
        """What happens at the last displacement, in words."""
        last = f"{self.displacement[-1]:.4g} m"
        words = {
            REACHED: f"the load falls to 0 at {last}",
            FALL: f"the blocks fall at {last}, whatever the load",
            LEAPS: f"the blocks go on in another way at {last}, where the curve ends",
            WEDGE: f"the blocks wedge at {last}: the load grows without limit",
            MEET: f"{' and '.join(self.path.met or ())} meet at {last}, where the curve ends",
            FURTHER: f"followed to {last}",
        }
        return words[self.path.end]


def capacity_curve(assembly: Assembly, loads: Loads) -> CapacityCurve:
    """Follow the mechanism of ``assembly`` under the variable ``loads`` until they fall to 0.

    `sidmacib.errors.CapacityError` where gravity turns, for interfaces that are not dry, and
    without a limit load. ValueError where a support moves.
    """
    if isinstance(loads, SupportMotion):
        loads.require_proportional()
    kinematics = Kinematics(assembly, loads)
    path = kinematics.path(lambda position: position.load <= 0.0)
    found = path.positions
    load, moved = np.array([(each.load, each.moved) for each in found]).T
    cosine = (np.trace([each.placed.turn for each in found], axis1=2, axis2=3) - 1.0) / 2.0
    turned = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))).max(axis=1)
    if path.end == REACHED and len(load) > 1:
        part = load[-2] / (load[-2] - load[-1])
        for each in (moved, turned, load):
            each[-1] = each[-2] + part * (each[-1] - each[-2])
    return CapacityCurve(moved, load, turned, path, *kinematics.moving(found[0]))
