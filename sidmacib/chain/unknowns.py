"""The chain's unknowns, and what they make of the bodies at each lock or each two neighbours."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sidmacib.chain.movement import UNKNOWNS, Body, displacements
from sidmacib.mechanics.assembly import Floats, Integers

OWN = 2 * UNKNOWNS  # of a lock with its column


@dataclass(frozen=True)
class Unknowns:
    """Movements of G groups of bodies, W each, from ``size`` unknowns.

    ``basis`` (G, W, U) makes the movements from the unknowns at ``places`` (G, U).
    """

    basis: Floats
    places: Integers
    size: int

    def movements(self, unknowns: Floats) -> Floats:
        """Movements (G, W) from the unknowns (size,)."""
        return np.matmul(self.basis, unknowns[self.places][:, :, None])[:, :, 0]

    def force(self, forces: Floats) -> Floats:
        """Sum of ``forces`` (G, W) on the movements, as forces on the unknowns, (size,)."""
        own = np.matmul(forces[:, None, :], self.basis)
        return np.asarray(np.bincount(self.places.ravel(), own.ravel(), self.size), float)

    def stiffness(self, stiffnesses: Floats) -> Floats:
        """Sum of ``stiffnesses`` (G, W, W), as one of the unknowns, (size, size)."""
        own = np.matmul(self.basis.transpose(0, 2, 1), np.matmul(stiffnesses, self.basis))
        whole = np.asarray(np.bincount(self._flat, own.ravel(), self.size**2), float)
        return whole.reshape(self.size, self.size)

    @cached_property
    def _flat(self) -> Integers:
        """Places in a matrix of the unknowns, row by row."""
        return (self.places[:, :, None] * self.size + self.places[:, None, :]).ravel()

    @cached_property
    def width(self) -> int:
        """How far apart unknowns of a group are, at most."""
        return int((self.places.max(axis=1) - self.places.min(axis=1)).max())


def of_columns(count: int) -> Unknowns:
    """Each of ``count`` locks and each column moves for itself."""
    basis = np.tile(np.eye(OWN), (count, 1, 1))
    places = OWN * np.arange(count)[:, None] + np.arange(OWN)
    return Unknowns(basis, places, OWN * count)


def of_one_piece(count: int, width: float) -> Unknowns:
    """All columns, each of this ``width`` (m), move as one body; its unknowns come first."""
    centres = np.zeros((count, 3))
    centres[:, 1] = (np.arange(count) - (count - 1) / 2.0) * width
    basis = np.tile(np.eye(OWN), (count, 1, 1))
    basis[:, :3, :UNKNOWNS] = displacements(Body(0, (0.0, 0.0, 0.0)), centres, 1, width)
    own, lock = np.arange(UNKNOWNS), np.arange(count)[:, None]
    places = np.hstack([np.tile(own, (count, 1)), UNKNOWNS * (lock + 1) + own])
    return Unknowns(basis, places, UNKNOWNS * (count + 1))


def of_neighbours(each: Unknowns) -> Unknowns:
    """The same unknowns, for each two neighbours; those that both share come once."""
    near, far = each.places[:-1], each.places[1:]
    shared = int((near[0] == far[0]).sum()) if len(near) else 0
    basis = np.zeros((len(near), 2 * OWN, 2 * OWN - shared))
    basis[:, :OWN, :OWN] = each.basis[:-1]
    basis[:, OWN:, :shared] = each.basis[1:, :, :shared]
    basis[:, OWN:, OWN:] = each.basis[1:, :, shared:]
    return Unknowns(basis, np.hstack([near, far[:, shared:]]), each.size)
