"""Results of solvers and the static model: equilibria, first failure, path to the peak."""

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from sidmacib.errors import NoEquilibriumError
from sidmacib.mechanics.assembly import Floats
from sidmacib.mechanics.contact_law import ContactLaw, Flags, NodeState
from sidmacib.quantities import four_digits

LARGEST_STEP = 1e5  # Newton step over the displacements of the unbroken assembly
LEAST_INCREMENT = 1e-5  # over the load: precision of the first failure and of the peak


@dataclass(frozen=True)
class Equilibrium:
    """An equilibrium of the assembly.

    ``load``: along the direction of loading, in N. ``unknowns``: of its solver, (U,), see there.
    ``displacement``: along the load, in m. ``force``: (N, 3) in N, the force of the piece below
    each node on the piece above in the frame of the face: normal (compression positive) and two
    tangents. ``state``: of the nodes. ``rotation`` (rad), ``moved`` (m): the largest rotation and
    displacement of the centroid of a piece; of an elastic one on average. ``opening``, ``closing``:
    the largest of a face, at a node, in m.
    """

    load: float
    unknowns: Floats
    displacement: float
    force: Floats
    state: NodeState
    rotation: float
    moved: float
    opening: float
    closing: float = 0.0


class Solver:
    """Finds equilibria of an assembly along a path of loading.

    ``contact_law``: of its nodes. ``scale``: of its loads, in N. ``size``: of the pieces, in m.
    ``finite``: whether it follows them as they move. ``drifts``: whether it looks for places where
    pieces that drift away come to rest. ``precision``: of the loads at which a path turns, over
    them. ``most_opening``: of a face, see `sidmacib.mechanics.assembly.Assembly`, in m. ``fell``:
    load (N) of the last top of a path beyond which pieces did not come to rest elsewhere.
    """

    contact_law: ContactLaw
    scale: float
    size, finite, drifts = math.inf, False, False
    precision = LEAST_INCREMENT
    fell = math.nan
    most_opening = math.inf

    def start(self) -> Equilibrium:
        """Equilibrium under the permanent loads alone."""
        raise NotImplementedError

    def solve(
        self, load: float, guess: Floats, state: NodeState, *, thorough: bool = False
    ) -> Equilibrium:
        """Equilibrium at ``load`` (N), from a ``guess`` of the unknowns and the nodes' state.

        Raises `NoEquilibriumError` if none is found. ``thorough``: try every method of the solver
        before giving up, which takes longer.
        """
        raise NotImplementedError

    def at_displacement(
        self, displacement: float, guess: Equilibrium, state: NodeState
    ) -> Equilibrium:
        """Equilibrium at a ``displacement`` along the load (m), from a ``guess`` and nodes' state.

        `NoEquilibriumError` if none is found, as by a solver that cannot look for it.
        """
        raise NoEquilibriumError(f"no equilibrium {displacement:g} m along the load")

    def lift(self, point: Equilibrium, load: float) -> float:
        """Fraction of the pieces' motion that lifts them when they move away under ``load`` (N)."""
        raise NotImplementedError

    def stable(self, point: Equilibrium) -> bool:
        """Whether the pieces return to ``point`` where they are moved a little, as far as known."""
        return True

    def stable_only(self) -> None:
        """Find only equilibria that are `stable` from here on."""


class OtherSearches(Solver):
    """Searches for equilibria by a ``solver`` that accept or begin otherwise."""

    def __init__(self, solver: Solver) -> None:
        self.solver, self.contact_law = solver, solver.contact_law
        self.scale, self.precision = solver.scale, solver.precision
        self.most_opening, self.size = solver.most_opening, solver.size
        self.finite, self.drifts = solver.finite, solver.drifts

    def start(self) -> Equilibrium:
        """Equilibrium under the permanent loads alone."""
        return self.solver.start()

    def lift(self, point: Equilibrium, load: float) -> float:
        """As of the ``solver``."""
        return self.solver.lift(point, load)

    def at_displacement(
        self, displacement: float, guess: Equilibrium, state: NodeState
    ) -> Equilibrium:
        """As of the ``solver``."""
        return self.solver.at_displacement(displacement, guess, state)

    def stable(self, point: Equilibrium) -> bool:
        """As of the ``solver``."""
        return self.solver.stable(point)

    def stable_only(self) -> None:
        """As of the ``solver``."""
        self.solver.stable_only()


class SmallMotions(OtherSearches):
    """A ``solver`` that finds no equilibria where pieces have turned, or faces opened, too far.

    Elastic pieces balance where they were built, and locks that part bear on less than is computed:
    what it finds there need not exist. ``rotation`` (rad) and ``opening`` (m): the largest that are
    allowed. ``exceeded``: whether the last search ended with such an equilibrium.
    """

    def __init__(
        self, solver: Solver, rotation: float = math.inf, opening: float = math.inf
    ) -> None:
        super().__init__(solver)
        self.rotation, self.opening, self.exceeded = rotation, opening, False

    def solve(
        self, load: float, guess: Floats, state: NodeState, *, thorough: bool = False
    ) -> Equilibrium:
        """Equilibrium at ``load`` (N), see `Solver`."""
        self.exceeded = False
        found = self.solver.solve(load, guess, state, thorough=thorough)
        self.exceeded = found.rotation > self.rotation or found.opening > self.opening
        if self.exceeded:
            raise NoEquilibriumError(
                f"at {four_digits(load)} N a piece turns by {found.rotation:.2g} rad, and a face "
                f"opens by {found.opening:.2g} m"
            )
        return found


def farthest_motion(motion: Floats) -> tuple[float, float]:
    """The largest rotation and displacement in a ``motion`` of pieces, (6 P,), in its units."""
    each = motion.reshape(-1, 2, 3)
    moved, turned = np.sqrt((each * each).sum(axis=2).max(axis=0))
    return float(turned), float(moved)


def lifted_part(weight: Floats, motion: Floats) -> float:
    """Fraction of a motion that lifts: cosine between it and the opposite of permanent loads."""
    size = float(np.linalg.norm(weight) * np.linalg.norm(motion))
    return -float(weight @ motion) / size if size else 0.0


class Mode(StrEnum):
    """The reason why the load cannot rise beyond the peak."""

    BONDS = "bonds"  # bonds fail, and no equilibrium follows
    MECHANISM = "mechanism"  # pieces slide although no bond is at its strength
    ROCKING = (
        "rocking"  # pieces are lifted against the permanent loads, and no bond is at its strength
    )
    TURNED = "turned"  # a piece has turned too far to be where it was built, and nothing has failed
    PRESSED = "pressed in"  # faces close by a part of the pieces' size, and nothing has failed
    APART = "apart"  # locks come apart too far to be held as they are, and no bond has failed


MOVED = Mode.MECHANISM, Mode.ROCKING  # any way, at the load


@dataclass(frozen=True)
class FirstFailure:
    """The end of the path on which all bonds are whole.

    ``point``: the last equilibrium. ``failing``: the nodes that are about to fail there, (N,); none
    if the load cannot rise for another reason. ``mode``: the reason. ``increment``: the largest of
    the load on the path, over the loads' scale.
    """

    point: Equilibrium
    failing: Flags
    mode: Mode
    increment: float


@dataclass(frozen=True)
class StaticSolution:
    """The path of the assembly to its peak.

    ``first_failure_load``: in N, where the first node fails, or the peak if none does. ``path``:
    the equilibria; the last is the peak. ``mode``: why the load does not rise further.
    ``refinement``: the factor on the increments of the load at which the first failure converged.
    ``spread``: of the peaks that were found, the highest less the lowest, over the lowest; see
    `sidmacib.mechanics.static.peaks`. ``turns``: whether it ends because a piece would turn too
    far, with no bond at its strength, see `SmallMotions`.
    """

    first_failure_load: float
    path: tuple[Equilibrium, ...]
    mode: Mode
    refinement: float = 1.0
    spread: float = 0.0
    turns: bool = False

    @property
    def peak(self) -> Equilibrium:
        """The equilibrium at the largest load."""
        return self.path[-1]

    @property
    def failed_load(self) -> float:
        """The load just above the peak, for which there is no equilibrium, in N."""
        return self.peak.load * (1.0 + LEAST_INCREMENT)
