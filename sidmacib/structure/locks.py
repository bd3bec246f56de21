"""Interfaces with locks: cut out of the blocks, or condensed into contact points.

A row of locks lies across the plane of an interface, half of their height on either side. They
belong to the two blocks in turn, as in a `sidmacib.Joint`: each meets its own block across a
bonded inner face, and the other block and its neighbours across dry faces.

Where the law or the safe rule limits the shear and the torque of condensed locks, their row is a
joint on its interface. Its upper body is the smaller of the two blocks, whole and held down as the
user says; the rule's loads in several directions are corners of a polygon in the (V, M) plane,
inside which the resultant of the locks' forces has to stay. A force or a pressure that holds the
joint down is asked of the interface in return: it must be compressed as much. That a plate holds it
down is an assumption.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import accumulate

import numpy as np
import shapely
from scipy.spatial import ConvexHull

from sidmacib.contact_points import OPTIONS, ContactOption
from sidmacib.errors import CapacityError
from sidmacib.joint import DRY, FIXED_PLATE, INNER, Direction, HoldDown, Joint, Side, UpperBody
from sidmacib.joint.loading import Push
from sidmacib.mechanics.assembly import FaceMaterial, Floats, Vector
from sidmacib.mechanics.polygons import ResultantLimits
from sidmacib.quantities import Count, Length
from sidmacib.rule import RULES, LawCapacity
from sidmacib.structure.blocks import Block, Compound
from sidmacib.structure.cutting import Plane, clipped, cut, sides
from sidmacib.structure.interfaces import Interface
from sidmacib.validation import refused, require_kinds

SHORT = 1e-6  # over the size of an interface: rounding of widths that are to fill it
ALL = math.inf  # as many locks as there are
SAFE = "safe"  # the rule for locks that are condensed
ANGLES = np.linspace(0.0, math.pi / 2, 13)  # in the (V, M / a) plane, from shear to torque
STRAIGHT = 1e-6  # over the area of an interface: what it may lack of a rectangle


@dataclass(frozen=True)
class Locks:
    """A row of locks across an interface of two blocks.

    ``count``: number of locks. ``height`` in m. ``row``: the direction in which locks follow one
    another, and which they block, or else ``run``: the direction in which each runs; either need
    not lie in the interface and is projected onto it. ``first``: name of the block that lock 1
    belongs to; by default the one below. ``widths`` along the row in m, which fill the interface;
    by default equal. ``inner``: of the faces across which locks meet their own block; ``dry``: of
    all other faces of locks. ``condensed``: contact points, which limit analysis only can use;
    None: each lock is a piece of its own, cut out of the blocks. ValueError for a number out of its
    range.
    """

    count: Count
    height: Length
    row: Vector | None = None
    run: Vector | None = None
    first: str | None = None
    widths: tuple[float, ...] | None = None
    inner: FaceMaterial = INNER
    dry: FaceMaterial = DRY
    condensed: "Condensed | None" = None

    def __post_init__(self) -> None:
        require_kinds(self)
        if (self.row is None) == (self.run is None):
            raise ValueError("row: must be given, or else run, and not both")
        if self.widths is not None and len(self.widths) != self.count:
            raise refused("widths", list(self.widths), f"one for each of the {self.count} locks")
        working = self.condensed.working if self.condensed else None
        if working not in (None, ALL) and working > self.count:
            raise refused("condensed.working", working, f"at most {self.count}")


@dataclass(frozen=True)
class Condensed:
    """Contact points of SiDMACIB in place of locks.

    ``working``: how many locks work, `ALL` or fewer. ``option``: where the points are. ``rule``: a
    name in `sidmacib.rule.RULES`, of the rule whose V and M limit the resultant of the points'
    forces, for a joint that is held down by ``hold_down``. By default `SAFE`, which stays lowest
    beside locks that are cut out: for 3 to 9 of them 0.85 to 1.04 of their first failure, where
    (n - 1) / 2 working locks are 0.98 to 1.06 and all of them 2.1 to 2.9.
    ValueError if both ``working`` and ``rule`` are given.
    """

    working: float | None = None
    option: ContactOption = field(default=OPTIONS["option3"])
    rule: str | None = None
    hold_down: HoldDown = FIXED_PLATE

    def __post_init__(self) -> None:
        if self.rule is not None and self.working is not None:
            raise ValueError(
                "working: must not be given beside rule, which says how many locks work"
            )
        if self.rule is None and self.working is None:
            object.__setattr__(self, "rule", SAFE)


@dataclass(frozen=True, eq=False)
class Row:
    """Positions of the locks of an interface.

    ``run``, ``across``: unit vectors along each lock and along the row, (3,). ``edges``: between
    locks, along the row from the interface's middle, in m, (n + 1,).
    """

    locks: Locks
    interface: Interface
    run: Floats
    across: Floats
    edges: Floats

    @classmethod
    def of(cls, locks: Locks, interface: Interface, name: str) -> "Row":
        """The row of ``locks`` on ``interface``, called ``name``; ValueError if it has no room."""
        normal = interface.axes[0]
        given = np.array(locks.row if locks.run is None else locks.run, float)
        flat = given - (given @ normal) * normal
        if not np.linalg.norm(flat) > SHORT * np.linalg.norm(given):
            key = "run" if locks.row is None else "row"
            raise refused(f"{name}: {key}", given.tolist(), "a direction not across the interface")
        flat /= np.linalg.norm(flat)
        if locks.row is None:
            run, across = flat, np.cross(normal, flat)
        else:
            run, across = np.cross(flat, normal), flat
        along = shapely.get_coordinates(interface.outline) @ interface.axes[1:] @ across
        low, high = float(along.min()), float(along.max())
        widths = locks.widths or ((high - low) / locks.count,) * locks.count
        if abs(math.fsum(widths) - (high - low)) > SHORT * (high - low):
            allowed = f"numbers that add up to {high - low:g} m"
            raise refused(f"{name}: widths", list(widths), allowed)
        edges = low + np.array([0.0, *accumulate(widths)])
        return cls(locks, interface, run, across, edges)

    @property
    def middle(self) -> Floats:
        """Centroid of the interface, in m, (3,)."""
        return np.array(self.interface.middle)

    @property
    def outline(self) -> shapely.Polygon:
        """The interface in coordinates (m) along ``run`` and ``across`` from its middle."""
        flat = shapely.get_coordinates(self.interface.outline.exterior) @ self.interface.axes[1:]
        return shapely.Polygon(flat @ np.array([self.run, self.across]).T)

    def strips(self, rest: Block | None) -> Iterator[tuple[int, Block]]:
        """The parts of a solid that lie in each lock, with the number of the lock, from 0."""
        for number, edge in enumerate(self.edges[1:-1].tolist()):
            if rest is not None:
                here, rest = cut(rest, self.middle + edge * self.across, self.across)
                if here is not None:
                    yield number, here
        if rest is not None:
            yield self.locks.count - 1, rest


@dataclass(frozen=True)
class LockPart:
    """The part of a lock, with its number from 0, that lies in one of the two blocks.

    ``beside``: planes across which it meets the rest of that block, with outward normals.
    """

    number: int
    solid: Block
    beside: tuple[Plane, ...]


def cut_off(row: Row, solids: list[Block], side: float) -> tuple[list[Block], list[LockPart]]:
    """What remains of the ``solids`` of a block, and the parts of locks that lie in it.

    ``side``: -1 of the block below the interface, 1 of that above. ValueError unless they are
    convex.
    """
    normal, half = row.interface.axes[0], row.locks.height / 2
    corners = shapely.get_coordinates(row.interface.outline.exterior)[:-1]
    outline = row.middle + corners @ row.interface.axes[1:]
    left: list[Block] = []
    parts: list[LockPart] = []
    for solid in solids:
        if (number := solid.reentrant) is not None:
            raise ValueError(f"{solid.name}, face {number}: must be convex where locks are cut")
        near, far = cut(solid, row.middle + side * half * normal, side * normal)
        left += [far] if far else []
        if near is not None:
            beside = tuple(sides(near, outline, normal))
            inside, others = clipped(near, beside)
            left += others
            parts += [LockPart(number, part, beside) for number, part in row.strips(inside)]
    return left, parts


def cut_rows(
    blocks: Sequence[Block], rows: Iterable[Row]
) -> tuple[dict[str, list[Block]], list[tuple[list[LockPart], list[LockPart]]]]:
    """What the locks of ``rows`` leave of each of ``blocks``, by name, and their parts.

    The parts of each row's locks in the block below, and in that above. ValueError unless both
    blocks are convex, and the locks lower than the blocks.
    """
    left, found = {block.name: [block] for block in blocks}, []
    for row in rows:
        parts: list[list[LockPart]] = []
        for end, side in ((row.interface.below, -1.0), (row.interface.above, 1.0)):
            name = blocks[end].name
            left[name], of_side = cut_off(row, left[name], side)
            if not left[name]:
                raise refused(f"{name}: height of locks", row.locks.height, "less than the block's")
            parts.append(of_side)
        found.append((parts[0], parts[1]))
    return left, found


def condensed_points(row: Row, option: ContactOption) -> tuple[Floats, Floats]:
    """Places (m) of the contact points along run and row from the middle, (K, 2), and areas (m2).

    The area of a point is its share of its lock's, so that the cohesion times it is the strength.
    """
    outline = row.outline
    low, _, high, _ = outline.bounds
    places, areas = [], []
    for start, end in zip(row.edges[:-1].tolist(), row.edges[1:].tolist(), strict=True):
        strip = outline.intersection(shapely.box(low, start, high, end))
        left, _, right, _ = strip.bounds
        centre = shapely.get_coordinates(strip.centroid)[0]
        for position, portion in zip(option.positions, option.portions, strict=True):
            places.append((centre[0] + position * (right - left), centre[1]))
            areas.append(portion * strip.area)
    return np.array(places), np.array(areas)


def rule_limits(
    row: Row, rule: str, hold_down: HoldDown, solids: Sequence[Block | Compound], name: str
) -> ResultantLimits:
    """The limits that ``rule``, one of `RULES`, sets to the locks of ``row``.

    ``solids``: the two blocks; ``name``: of the interface, for errors. ValueError where the rule
    refuses the joint, in any direction, and for locks of several widths or an interface that is no
    rectangle along them, which no rule was tested on.
    """
    joint = _joint(row, rule, hold_down, solids, name)
    try:
        points = _loads(joint, RULES[rule])
    except (CapacityError, ValueError) as error:
        why = f"has no answer: {' '.join(str(error).split())}"
        raise ValueError(f"locks of {name}: condensed.rule: {rule} {why}") from None
    normals = _half_planes(points / (1.0, joint.a)) / (1.0, joint.a)
    pressing = hold_down.force_on(joint.a * joint.total_width) or 0.0
    return ResultantLimits(normals[:, 0], normals[:, 1], pressing)


def _joint(
    row: Row, rule: str, hold_down: HoldDown, solids: Sequence[Block | Compound], name: str
) -> Joint:
    locks, area = row.locks, row.interface.outline.area
    widths = np.diff(row.edges)
    if np.ptp(widths) > STRAIGHT * widths.max():
        raise refused(f"locks of {name}: widths", widths.tolist(), "equal with condensed.rule")
    flat = shapely.get_coordinates(row.interface.outline.exterior) @ row.interface.axes[1:]
    length = float(np.ptp(flat @ row.run))
    if abs(length * widths.sum() - area) > STRAIGHT * area:
        needs = "needs an interface that is a rectangle along the locks"
        raise ValueError(f"locks of {name}: condensed.rule: {rule} {needs}")
    first = solids[1].name == locks.first
    return Joint(
        locks.count,
        a=length,
        b=float(widths.mean()),
        h=locks.height,
        H=min(each.volume for each in solids) / area,
        density=max(each.mass / each.volume for each in solids),
        inner=locks.inner,
        dry=locks.dry,
        upper_body=UpperBody.MONOLITHIC,
        first=Side.UPPER if first else Side.LOWER,
        hold_down=hold_down,
    )


@lru_cache(maxsize=256)  # the interfaces of a wall are often alike
def _loads(joint: Joint, rule: Callable[[Joint, Direction, Push], LawCapacity]) -> Floats:
    """V (N) and M (N m) along `ANGLES` and their mirror images, for both pushes, (K, 2)."""
    points = []
    for push, sign in ((Push.PLUS_Y, 1.0), (Push.MINUS_Y, -1.0)):
        for angle in ANGLES.tolist():
            torsion = angle == ANGLES[-1]
            direction = Direction(math.inf if torsion else math.tan(angle))
            found = rule(joint, direction, push)
            points += [(sign * found.shear, found.torque), (sign * found.shear, -found.torque)]
    return np.array(points)


def _half_planes(points: Floats) -> Floats:
    """Normals n, (K, 2), of a convex polygon n p <= 1 in which every line to a point ends.

    Were the points not the corners of a convex polygon, their hull would promise more than some of
    them: it is shrunk until it does not.
    """
    equations = ConvexHull(points).equations  # n p + c <= 0
    normals = equations[:, :2] / -equations[:, 2:]
    return np.asarray(normals / float((points @ normals.T).max(axis=1).min()))
