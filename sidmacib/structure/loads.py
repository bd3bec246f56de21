"""Loads on a structure: self-weight, and an acceleration or a force that is raised.

Or a support that moves.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sidmacib.mechanics.assembly import Assembly, Floats, Loads, self_weight
from sidmacib.validation import refused, require_direction


@dataclass(frozen=True)
class PointForce(Loads):
    """A force at a point that moves with its piece.

    ``arms``: from the centroids to the points (m), (P, 3), 0 for pieces without a force.
    """

    arms: Floats | None = None


@dataclass(frozen=True)
class SupportMotion(Loads):
    """Self-weight, while a fixed piece moves: along a displacement, or about an axis.

    ``support``: its index. ``along``: of length 1, the direction in which it moves by m, or the
    axis about which it turns by rad, by the right-hand rule; ``about``: a point of this axis (m),
    None for a displacement. The variable load is 0.
    """

    support: int = 0
    along: tuple[float, ...] = (0.0, 0.0, 0.0)
    about: tuple[float, ...] | None = None

    def motion(self, centre: Floats) -> Floats:
        """How the support moves per m or rad, (6,), where its centroid is at ``centre`` (m)."""
        along = np.array(self.along)
        if self.about is None:
            return np.concatenate([along, np.zeros(3)])
        return np.concatenate([np.cross(along, centre - np.array(self.about)), along])

    @property
    def turns(self) -> bool:
        """Whether the support turns."""
        return self.about is not None

    def require_proportional(self) -> None:
        """ValueError: no load is raised."""
        raise ValueError("loads: a support moves; use least_reaction or support_path")


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
    number, along = _number(assembly, name, fixed=False), _unit(direction)
    arms = np.zeros((len(assembly.pieces), 3))
    arms[number] = np.array(point, float) - assembly.pieces[number].centre
    variable = np.zeros((len(arms), 6))
    variable[number] = [*along, *np.cross(arms[number], along)]
    return PointForce(weight_of_free(assembly), variable, free_weight(assembly), arms=arms)


def support_moves(assembly: Assembly, name: str, displacement: Sequence[float]) -> SupportMotion:
    """Self-weight, while the fixed piece called ``name`` moves along ``displacement``.

    ValueError unless there is such a piece, and the displacement has a length.
    """
    return _support(assembly, name, displacement, None)


def support_turns(
    assembly: Assembly, name: str, axis: Sequence[float], about: Sequence[float] | None = None
) -> SupportMotion:
    """Self-weight, while the fixed piece called ``name`` turns about an ``axis``.

    ``about``: a point of the axis (m), by default the centroid. Errors of `support_moves`.
    """
    number = _number(assembly, name, fixed=True)
    point = assembly.pieces[number].centre if about is None else np.array(about, float)
    return _support(assembly, name, axis, tuple(point.tolist()))


def _support(
    assembly: Assembly, name: str, along: Sequence[float], about: tuple[float, ...] | None
) -> SupportMotion:
    number = _number(assembly, name, fixed=True)
    weight = weight_of_free(assembly)
    return SupportMotion(
        weight,
        np.zeros_like(weight),
        free_weight(assembly),
        support=number,
        along=tuple(_unit(along).tolist()),
        about=about,
    )


def _number(assembly: Assembly, name: str, *, fixed: bool) -> int:
    """Index of the piece called ``name``; ValueError unless it is there, and ``fixed`` or not."""
    names = [piece.name for piece in assembly.pieces]
    if name not in names:
        raise refused("block", name, "the name of a block")
    number = names.index(name)
    if assembly.pieces[number].fixed is not fixed:
        raise refused("block", name, f"a block that is {'' if fixed else 'not '}fixed")
    return number


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
