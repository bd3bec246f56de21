"""Loads on a structure: weight and other permanent loads, and a load that is raised.

That is an acceleration or a force; or a support moves.
"""

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from difflib import get_close_matches

import numpy as np

from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import Assembly, Floats
from sidmacib.mechanics.equilibrium import self_weight
from sidmacib.mechanics.loads import Loads
from sidmacib.quantities import some_of
from sidmacib.validation import refused

NAMES_SAID = 3  # of blocks, where one is not there
OWN, ALL = "its own weight", "its own weight and the other permanent loads"


@dataclass(frozen=True)
class Permanent:
    """Permanent loads beside weight, which keep their directions; their points move with pieces.

    ``wrenches``: forces (N) and moments about the centroids (N m), (P, 6). ``levers``: sums of
    arm from the centroid (m) times force (N), (P, 3, 3), of which moments follow after a turn.
    """

    wrenches: Floats
    levers: Floats

    @classmethod
    def none(cls, pieces: int) -> "Permanent":
        """No such loads on so many ``pieces``."""
        return cls(np.zeros((pieces, 6)), np.zeros((pieces, 3, 3)))

    @classmethod
    def of(cls, pieces: int, number: int, arms: Floats, forces: Floats) -> "Permanent":
        """``forces``, (K, 3) in N, on the piece of this ``number``, at ``arms``, (K, 3) in m."""
        found = cls.none(pieces)
        found.wrenches[number] = [*forces.sum(axis=0), *np.cross(arms, forces).sum(axis=0)]
        found.levers[number] = arms.T @ forces
        return found

    def times(self, factor: float) -> "Permanent":
        """That many times these loads."""
        return Permanent(factor * self.wrenches, factor * self.levers)

    def __add__(self, other: "Permanent") -> "Permanent":
        return Permanent(self.wrenches + other.wrenches, self.levers + other.levers)

    @property
    def size(self) -> float:
        """Sum of the sizes of the forces on the pieces, in N."""
        return float(np.linalg.norm(self.wrenches[:, :3], axis=1).sum())


@dataclass(frozen=True, kw_only=True)
class StructureLoads(Loads):
    """Loads on a structure; ``beside``: the part of the permanent ones that is not weight."""

    beside: Permanent

    def at(self, load: float) -> Floats:
        """As `Loads.at`, but where gravity turns, what is ``beside`` weight stays."""
        fixed = self.beside.wrenches
        return self.raised.forces(load, self.permanent, self.variable, fixed)

    def levers(self) -> Floats:
        """Sums of arm times force, see `Loads.levers`."""
        return np.array([self.beside.levers, np.zeros_like(self.beside.levers)])


@dataclass(frozen=True, kw_only=True)
class PointForce(StructureLoads):
    """A force at a point that moves with its piece.

    ``arms``: from the centroids to the points (m), (P, 3), 0 for pieces without a force.
    """

    arms: Floats

    def levers(self) -> Floats:
        """Sums of arm times force, see `Loads.levers`."""
        return np.array([self.beside.levers, self.arms[:, :, None] * self.variable[:, None, :3]])


@dataclass(frozen=True, kw_only=True)
class SupportMotion(StructureLoads):
    """Permanent loads, while a fixed piece moves: along a displacement, or about an axis.

    ``support``: its index. ``along``: of length 1, the direction in which it moves by m, or the
    axis about which it turns by rad, by the right-hand rule; ``about``: a point of this axis (m),
    None for a displacement. The variable load is 0.
    """

    support: int
    along: tuple[float, ...]
    about: tuple[float, ...] | None

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


def acceleration(
    assembly: Assembly, direction: Sequence[float], beside: Permanent | None = None
) -> StructureLoads:
    """Self-weight, and 1 N along ``direction`` on all free pieces in proportion to their mass.

    ``beside``: permanent loads beside weight, as in all of these functions.

    A load of k times `free_weight` is a horizontal acceleration of k g, or, in a dry structure, a
    tilt of atan(k).
    """
    return pushed(assembly, permanent_only(assembly, beside), direction)


def pushed(
    assembly: Assembly, permanent: StructureLoads, direction: Sequence[float]
) -> StructureLoads:
    """The ``permanent`` loads, and an acceleration as in `acceleration`."""
    mass = np.array([0.0 if piece.fixed else piece.mass for piece in assembly.pieces])
    variable = np.zeros((len(mass), 6))
    variable[:, :3] = (mass / mass.sum())[:, None] * _unit(direction)
    return replace(permanent, variable=variable)


def force_at(
    assembly: Assembly,
    name: str,
    point: Sequence[float],
    direction: Sequence[float],
    beside: Permanent | None = None,
) -> StructureLoads:
    """Self-weight, and 1 N along ``direction`` at a ``point`` (m) of the piece called ``name``.

    ValueError unless there is such a piece that can move.
    """
    number, along = numbered(assembly, name, fixed=False), _unit(direction)
    always = permanent_only(assembly, beside)
    arms, variable = np.zeros((len(assembly.pieces), 3)), always.variable
    arms[number] = np.array(point, float) - assembly.pieces[number].centre
    variable[number] = [*along, *np.cross(arms[number], along)]
    return PointForce(**vars(always), arms=arms)


def permanent_only(assembly: Assembly, beside: Permanent | None = None) -> StructureLoads:
    """Permanent loads alone."""
    weight = weight_of_free(assembly)
    beside, scale = beside or Permanent.none(len(weight)), free_weight(assembly)
    whole = weight + beside.wrenches
    return StructureLoads(whole, np.zeros_like(weight), scale + beside.size, beside=beside)


def support_moves(
    assembly: Assembly,
    name: str,
    displacement: Sequence[float] | None = None,
    rotation: Sequence[float] | None = None,
    about: Sequence[float] | None = None,
    beside: Permanent | None = None,
) -> SupportMotion:
    """Self-weight, while the fixed piece called ``name`` moves along ``displacement``, or turns.

    About the axis ``rotation``, one of the two; ``about``: a point of the axis (m), by default the
    centroid. ValueError unless there is such a piece.
    """
    number = numbered(assembly, name, fixed=True)
    along, point = displacement, None
    if along is None:
        along, centre = rotation, assembly.pieces[number].centre
        point = tuple(np.array(centre if about is None else about, float).tolist())
    assert along is not None, "it moves or turns"
    return SupportMotion(
        **vars(permanent_only(assembly, beside)),
        support=number,
        along=tuple(_unit(along).tolist()),
        about=point,
    )


def permanent_force(
    assembly: Assembly, name: str, point: Sequence[float], direction: Sequence[float], size: float
) -> Permanent:
    """A permanent force of a ``size`` (N); other arguments and errors of `force_at`."""
    number, force = numbered(assembly, name, fixed=False), size * _unit(direction)
    arm = np.array(point, float) - assembly.pieces[number].centre
    return Permanent.of(len(assembly.pieces), number, arm[None], force[None])


def beside_of(loads: Loads) -> Permanent:
    """The part of permanent ``loads`` that is not weight."""
    none = Permanent.none(len(loads.permanent))
    return loads.beside if isinstance(loads, StructureLoads) else none


@contextmanager
def naming_permanent(loads: Loads) -> Iterator[None]:
    """Say of errors that weight and other permanent ``loads`` cause that it is not weight alone."""
    try:
        yield
    except CapacityError as error:
        if not beside_of(loads).wrenches.any() or ALL in str(error):
            raise
        raise type(error)(str(error).replace(OWN, ALL)) from None


def numbered(assembly: Assembly, name: str, *, fixed: bool) -> int:
    """Index of the piece called ``name``; ValueError unless it is there, and ``fixed`` or not."""
    names = [piece.name for piece in assembly.pieces]
    if name not in names:
        those = [piece.name for piece in assembly.pieces if piece.fixed is fixed]
        near = get_close_matches(name, those, NAMES_SAID) or those
        of = f"of a {'fixed' if fixed else 'free'} block, such as {some_of(near, NAMES_SAID)}"
        raise refused("block", name, f"the name {of}")
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
    along = np.array(direction, float)
    return np.asarray(along / np.linalg.norm(along))
