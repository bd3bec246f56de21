"""Equilibrium of the chain under a load: contacts and friction settle together.

With given limits of friction the equilibrium is the least of a convex energy, so that Newton's
method, with a search along each step, always gets there. The limits are those of the forces that
press at last: some rounds from no friction on, then Newton's method on both at once.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import solve_banded

from sidmacib.chain.contacts import Contacts
from sidmacib.chain.model import ChainModel
from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import Floats

EXACT = 1e-8  # unbalanced force over the loads,
ROUNDING = 1e-14  # and over the largest force in a cut
ROUNDS = 30  # of limits of friction
FREE_ROUNDS = 2  # of them, before they are averaged with the last
STEPS, FEW_STEPS = 30, 8  # of Newton's method, with given limits and with its own
CUTS = 12  # of a step that goes too far
DRAG = (1e-7, 1e-4)  # stiffness on steps that went far too far, over a root's: at first, at most
FAR = 3  # cuts of such a step
ENOUGH = 0.5  # of the slope at a step's begin: where the search ends
SETTLED = 1e-7  # change of the limits over the largest

Limits = tuple[Floats | None, ...]


@dataclass(frozen=True)
class Equations:
    """The chain's equations under a ``load`` (N)."""

    model: ChainModel
    load: float

    @property
    def _contacts(self) -> tuple[Contacts, Contacts, Contacts]:
        return self.model.between, self.model.standing_on, self.model.under_plate

    def _movements(self, unknowns: Floats) -> tuple[Floats, Floats, Floats]:
        """Of the bodies at each of the contacts."""
        own = self.model.own.movements(unknowns)
        return self.model.pairs.movements(unknowns), own, own

    def limits(self, unknowns: Floats) -> tuple[Floats, ...]:
        """What friction may reach at all points, N."""
        moved = self._movements(unknowns)
        return tuple(each.limits(at) for each, at in zip(self._contacts, moved, strict=True))

    def without_slip(self) -> tuple[Floats, ...]:
        """Limits of friction that are never reached."""
        shape = [(self.model.count - 1, len(self._contacts[0].normal))]
        shape += [(self.model.count, len(each.normal)) for each in self._contacts[1:]]
        return tuple(np.full(each, np.inf) for each in shape)

    def balanced(self, force: Floats, unknowns: Floats) -> bool:
        """Whether ``force`` (N) is nothing beside the loads, or what rounding makes of it."""
        inside = self._stiffest * float(np.abs(unknowns).max())
        return float(np.linalg.norm(force)) < EXACT * self._loads + ROUNDING * inside

    @cached_property
    def _loads(self) -> float:
        """Sum of what acts, N."""
        return abs(self.load) + float(np.abs(self.model.weight).sum())

    @cached_property
    def _stiffest(self) -> float:
        """Of the cuts, N/m."""
        return float(np.abs(self.model.pair_stiffness).max())

    def unbalanced(self, unknowns: Floats, limits: Limits) -> tuple[Floats, Floats]:
        """Forces that are not balanced (m,), N, and their derivatives (m, m)."""
        model, moved = self.model, self._movements(unknowns)
        (between, stiff), (foot, firm), (top, topped) = (
            each.forces(at, limit)
            for each, at, limit in zip(self._contacts, moved, limits, strict=True)
        )
        pairs, own, _ = moved
        linear = np.matmul(model.own_stiffness, own[:, :, None])[:, :, 0]
        on_own = linear + foot + top - model.weight - self.load * model.unit
        on_pairs = between + pairs @ model.pair_stiffness
        force = model.own.force(on_own) + model.pairs.force(on_pairs)
        matrix = model.own.stiffness(model.own_stiffness + firm + topped)
        matrix += model.pairs.stiffness(model.pair_stiffness + stiff)
        return force, matrix

    def solved(self, matrix: Floats, force: Floats, drag: float = 0.0) -> Floats:
        """The step that balances ``force``; the matrix is narrow unless the body is one piece.

        ``drag``: what holds the step back, over a root's stiffness.
        """
        size, width = self.model.own.size, self.model.pairs.width
        held = matrix + drag * self.model.root.stiffness[0] * np.eye(size) if drag else matrix
        if 4 * width > size:
            return np.asarray(np.linalg.solve(held, force))
        bands = np.zeros((2 * width + 1, size))
        for off in range(-width, width + 1):
            own = np.diagonal(held, off)
            bands[width - off, max(off, 0) : max(off, 0) + len(own)] = own
        return np.asarray(solve_banded((width, width), bands, force, check_finite=False))


def equilibrium(model: ChainModel, load: float, guess: Floats | None = None) -> Floats:
    """The unknowns (m,) under ``load`` (N); ``guess``: those of a load nearby.

    Where friction may jam locks there are several equilibria. From a guess it is the one nearby,
    without one that which is reached from no friction on, or else from locks that stick.
    `CapacityError` if contacts and friction do not settle.
    """
    equations = Equations(model, load)
    if guess is not None:
        found = _own_limits(equations, guess)
        if found is not None:
            return found
    start = np.zeros(model.own.size) if guess is None else guess
    for limits in (equations.limits(start), equations.without_slip()):
        found = _rounds(equations, start, limits)
        if found is not None:
            return found
    raise CapacityError(
        f"law: contacts and friction of {model.count} locks do not settle at {load:.4g} N"
    )


def _rounds(equations: Equations, unknowns: Floats, limits: tuple[Floats, ...]) -> Floats | None:
    """Equilibrium by rounds of given limits of friction; None if they do not settle."""
    for number in range(ROUNDS):
        unknowns, balanced = _given_limits(equations, unknowns, limits)
        now = equations.limits(unknowns)
        largest = max(float(each.max()) for each in now)
        change = max(float(np.abs(a - b).max()) for a, b in zip(now, limits, strict=True))
        if balanced and change <= SETTLED * largest:
            return unknowns
        if number:
            found = _own_limits(equations, unknowns)
            if found is not None:
                return found
        if number < FREE_ROUNDS:
            limits = now
        else:
            limits = tuple((a + b) / 2.0 for a, b in zip(limits, now, strict=True))
    return None


def _given_limits(equations: Equations, unknowns: Floats, limits: Limits) -> tuple[Floats, bool]:
    """Unknowns with given limits of friction, and whether all is balanced: the least of an energy.

    The energy is convex, so each step with a search along it leads on.
    """
    force, matrix = equations.unbalanced(unknowns, limits)
    drag = 0.0
    for _ in range(STEPS):
        if equations.balanced(force, unknowns):
            return unknowns, True
        step = equations.solved(matrix, force, drag)
        start = -float(force @ step)
        low, high, slopes, part = 0.0, 1.0, [start, 0.0], 1.0
        for number in range(CUTS):
            there = unknowns - part * step
            force, matrix = equations.unbalanced(there, limits)
            slope = -float(force @ step)
            if (slope <= 0.0 and not number) or abs(slope) < ENOUGH * abs(start):
                break
            if slope > 0.0:
                high, slopes[1] = part, slope
            else:
                low, slopes[0] = part, slope
            place = slopes[0] / (slopes[0] - slopes[1])
            part = low + (high - low) * float(np.clip(place, 0.1, 0.9))
        unknowns = there
        least, most = DRAG
        drag = min(max(10.0 * drag, least), most) if number >= FAR else drag / 10.0
        drag = drag if drag > least / 100.0 else 0.0
    return unknowns, equations.balanced(force, unknowns)


def _own_limits(equations: Equations, unknowns: Floats) -> Floats | None:
    """Equilibrium with the limits of its own forces; None if it is not found from here."""
    own: Limits = (None, None, None)
    force, matrix = equations.unbalanced(unknowns, own)
    for _ in range(FEW_STEPS):
        size = float(np.linalg.norm(force))
        if equations.balanced(force, unknowns):
            return unknowns
        step = equations.solved(matrix, force)
        for part in (1.0, 0.5, 0.25, 0.125):
            there = unknowns - part * step
            force, matrix = equations.unbalanced(there, own)
            if np.linalg.norm(force) < size:
                break
        else:
            return None
        unknowns = there
    return unknowns if equations.balanced(force, unknowns) else None
