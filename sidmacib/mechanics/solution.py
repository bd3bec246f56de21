"""The path of an assembly to its peak: the equilibria on the way, and why it ends."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

import numpy as np

from sidmacib.mechanics.assembly import Floats
from sidmacib.mechanics.contact_law import ContactLaw, Flags, NodeState

LEAST_INCREMENT = 1e-5  # over the load: where the search for a failure or for the peak ends
# Of a peak, see `sidmacib.mechanics.static.peak_spread`; above it the first failure counts.
SPREAD_LIMIT = 0.02


@dataclass(frozen=True)
class Equilibrium:
    """An equilibrium of the assembly.

    ``load``: along the direction of loading, in N. ``unknowns``: those that its solver looks for,
    (U,), see there. ``displacement``: the one that the load does work on, in m. ``force``: (N, 3)
    in N, what the piece below each node exerts on the piece above in the frame of the face: normal
    (compression positive) and two tangents. ``state``: of the nodes.
    """

    load: float
    unknowns: Floats
    displacement: float
    force: Floats
    state: NodeState


class Solver(Protocol):
    """Finds equilibria of an assembly."""

    @property
    def law(self) -> ContactLaw:
        """Of its nodes."""

    def start(self) -> Equilibrium:
        """Equilibrium under the permanent loads alone."""

    def solve(
        self, load: float, guess: Floats, state: NodeState, *, thorough: bool = False
    ) -> Equilibrium:
        """Equilibrium at ``load`` (N), from a ``guess`` of the unknowns and the nodes' state.

        Raises `NoEquilibriumError` where none is found. ``thorough``: all that the solver can do
        is done before it gives up, which takes longer.
        """

    def lift(self, point: Equilibrium, load: float) -> float:
        """Part of the pieces' motion that lifts them where they move off under ``load`` (N)."""


def lifted_part(weight: Floats, moved: Floats) -> float:
    """Part of a motion that lifts: the cosine between it and the opposite of what always acts."""
    size = float(np.linalg.norm(weight) * np.linalg.norm(moved))
    return -float(weight @ moved) / size if size else 0.0


class Mode(StrEnum):
    """Why the load cannot rise beyond the peak."""

    BONDS = "bonds"  # they fail, and no equilibrium follows
    MECHANISM = "mechanism"  # pieces slide although no bond is at its strength
    ROCKING = "rocking"  # pieces are lifted against what always acts, and no bond is either


@dataclass(frozen=True)
class FirstFailure:
    """The end of the path on which all bonds are whole.

    ``point``: the equilibrium at which ``failing``, (N,), nodes are about to fail: none where the
    load cannot rise any more for another reason, which ``mode`` tells.
    """

    point: Equilibrium
    failing: Flags
    mode: Mode


@dataclass(frozen=True)
class StaticSolution:
    """The path of the assembly to its peak.

    ``first_failure_load`` in N: where the first node fails, or that of the peak if none does.
    ``path``: the equilibria on the way; the last is the peak. ``mode``: why it is.
    """

    first_failure_load: float
    path: tuple[Equilibrium, ...]
    mode: Mode

    @property
    def peak(self) -> Equilibrium:
        """The equilibrium at the largest load."""
        return self.path[-1]

    @property
    def failed_load(self) -> float:
        """Just above the peak, where bonds fail and no equilibrium follows, in N."""
        return self.peak.load * (1.0 + LEAST_INCREMENT)
