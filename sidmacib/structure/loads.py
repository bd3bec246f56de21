"""Loads on a structure: self-weight, and an acceleration or a force that is raised."""

import math
from collections.abc import Sequence

import numpy as np

from sidmacib.mechanics.assembly import Assembly, Floats, Loads, self_weight
from sidmacib.validation import refused, require_direction


def acceleration(assembly: Assembly, direction: Sequence[float]) -> Loads:
    """Self-weight, and 1 N along ``direction`` on all free pieces in proportion to their mass.

    A load of k times `free_weight` is a horizontal acceleration of k g, or, in a dry structure, a
    tilt of atan(k). ValueError unless the direction has a length.
    """
    mass = np.array([0.0 if piece.fixed else piece.mass for piece in assembly.pieces])
    variable = np.zeros((len(mass), 6))
    variable[:, :3] = (mass / mass.sum())[:, None] * _unit(direction)
    return Loads(weight_of_free(assembly), variable, free_weight(assembly))


def force_at(
    assembly: Assembly, name: str, point: Sequence[float], direction: Sequence[float]
) -> Loads:
    """Self-weight, and 1 N along ``direction`` at a ``point`` (m) of the piece called ``name``.

    ValueError unless there is such a piece that can move, and the direction has a length.
    """
    names = [piece.name for piece in assembly.pieces]
    if name not in names:
        raise refused("block", name, "the name of a block")
    number, along = names.index(name), _unit(direction)
    if assembly.pieces[number].fixed:
        raise refused("block", name, "a block that is not fixed")
    arm = np.array(point, float) - assembly.pieces[number].centre
    variable = np.zeros((len(names), 6))
    variable[number] = [*along, *np.cross(arm, along)]
    return Loads(weight_of_free(assembly), variable, free_weight(assembly))


def free_weight(assembly: Assembly) -> float:
    """Weight of all pieces that can move, in N."""
    return math.fsum(piece.weight for piece in assembly.pieces if not piece.fixed)


def weight_of_free(assembly: Assembly) -> Floats:
    """Weight of the pieces that can move, as forces (N) and moments (N m), (P, 6)."""
    weight = self_weight(assembly.pieces)
    weight[[piece.fixed for piece in assembly.pieces]] = 0.0
    return weight


def _unit(direction: Sequence[float]) -> Floats:
    require_direction(direction=direction)
    along = np.array(direction, float)
    return np.asarray(along / np.linalg.norm(along))
