"""Forces on a structure as they are drawn: loads, reactions of supports and lines of thrust."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from sidmacib.mechanics.assembly import Assembly, Face, Floats, Vector
from sidmacib.mechanics.loads import Loads
from sidmacib.problem import Problem
from sidmacib.structure.analysis.forces import InterfaceRow
from sidmacib.structure.loads import PointForce, beside_of, weight_of_free
from sidmacib.structure.structure import owners_of

NOTHING = 1e-9  # of the largest force: no arrow
STEEP = 1e-6  # of a force: a part along the normal below leaves no point of action
Carried = tuple[Face, InterfaceRow, float]  # with the sign of its force


def arrows_of(assembly: Assembly, loads: Loads, load: float | None = None) -> dict[str, Any]:
    """The ``loads`` beside self-weight, as plain values.

    ``variable``: for each block that is loaded its name, ``block``, the place where the force acts,
    ``at`` (m), its ``force`` per newton, and whether that is a ``point``, or the middle of forces
    on the block and its locks; ``permanent``: the same in N. ``axis``: that gravity turns about, in
    place of a load that is raised; ``variable`` then has weights in N; None otherwise. With a
    ``load`` (N), all forces are those under this load, in N.
    """
    others, axis = beside_of(loads).wrenches, loads.raised.axis
    arms = loads.arms if isinstance(loads, PointForce) else None
    raised = loads.raised.drawn(load, weight_of_free(assembly), loads.variable)
    most = float(np.abs(loads.permanent).max())
    # Permanent forces act along lines, which these arms lead to from the centroids, torsion apart.
    square = np.maximum((others[:, :3] ** 2).sum(axis=1), np.finfo(float).tiny)
    lever_arms = np.cross(others[:, :3], others[:, 3:]) / square[:, None]
    return {
        "variable": [*_arrows(assembly, raised, arms)],
        "permanent": [*_arrows(assembly, others, lever_arms, most)],
        "axis": axis and [*axis],
    }


def load_of(problem: Problem) -> str:
    """The load that is raised, in words."""
    found = arrows_of(*problem)
    loaded, beside = found["variable"], ""
    if found["permanent"]:
        together = np.sum([each["force"] for each in found["permanent"]], axis=0)
        beside = f"; permanent loads beside weight, together {_listed(together.tolist())} N"
    if found["axis"] is not None:
        return f"Load: gravity, turned about the axis {_listed(found['axis'])}{beside}"
    if not loaded:
        return f"No load is raised{beside}"
    along = _listed(np.sum([each["force"] for each in loaded], axis=0).tolist())
    if not loaded[0]["point"]:
        return f"Load raised: forces in proportion to the masses, along {along}{beside}"
    shares = [f" ({math.hypot(*each['force']):.3g} of it)" for each in loaded]
    if len(shares) == 1:
        shares = [""]
    on = " and on ".join(
        f"{each['block']} at {_listed(each['at'])} m{share}"
        for each, share in zip(loaded, shares, strict=True)
    )
    return f"Load raised: a force on {on}, along {along}{beside}"


def _listed(vector: Sequence[float]) -> str:
    return f"({', '.join(f'{round(each, 4) + 0.0:g}' for each in vector)})"


def _arrows(
    assembly: Assembly, forces: Floats, arms: Floats | None = None, most: float = 0.0
) -> Iterator[dict[str, Any]]:
    size = np.linalg.norm(forces[:, :3], axis=1)
    least = NOTHING * max(float(size.max(initial=0.0)), most)
    owner = np.array(owners_of(assembly))
    places = np.array([piece.centre for piece in assembly.pieces]) + (0.0 if arms is None else arms)
    for number in np.unique(owner[size > least]):
        parts = (owner == number) & (size > least)
        yield {
            "block": assembly.pieces[number].name,
            "at": (size[parts] @ places[parts] / size[parts].sum()).tolist(),
            "force": forces[parts, :3].sum(axis=0).tolist(),
            "point": arms is not None,
        }


@dataclass(frozen=True)
class Section:
    """What several interfaces carry together.

    ``force`` in N; ``middle`` (m) of the interfaces; ``at``: the point (m) through which the force
    acts in their mean plane, torsion apart; None where it is along that plane. ``reach``: diagonal
    of the box around them, m. ``support``: the fixed block that exerts the force.
    """

    force: Vector
    middle: Vector
    at: Vector | None
    reach: float
    support: str = ""

    @classmethod
    def of(cls, carried: Sequence[Carried], support: str = "") -> "Section":
        """From interfaces, what each carries, and the signs of these forces."""
        area = np.array([face.area for face, _, _ in carried])
        sign = np.array([each for _, _, each in carried])
        places = np.array([face.middle for face, _, _ in carried])
        middle = area @ places / area.sum()
        forces = sign[:, None] * np.array(
            [(row.force_x_N, row.force_y_N, row.force_z_N) for _, row, _ in carried]
        )
        acts = [row_point(row) or tuple(face.middle) for face, row, _ in carried]
        moment = np.cross(np.array(acts) - middle, forces).sum(axis=0)
        force = forces.sum(axis=0)
        normal = (sign * area) @ np.array([face.axes[0] for face, _, _ in carried])
        size, at = float(np.linalg.norm(normal)), None
        if size > 0.0:
            unit = normal / size
            pressed = float(force @ unit)
            if abs(pressed) > STEEP * float(np.linalg.norm(force)):
                at = _vector(middle + np.cross(unit, moment) / pressed)
        corners = np.concatenate([face.corners for face, _, _ in carried])
        reach = float(np.linalg.norm(np.ptp(corners, axis=0)))
        return cls(_vector(force), _vector(middle), at, reach, support)

    @property
    def near(self) -> Vector | None:
        """That point; None where it is out of reach, as where bonds carry the bending."""
        if self.at is None or math.dist(self.at, self.middle) > self.reach:
            return None
        return self.at


def forces_of(assembly: Assembly, rows: Sequence[InterfaceRow]) -> dict[str, Any]:
    """`reactions` and `thrust` as plain values."""
    return {
        "reactions": [asdict(each) for each in reactions(assembly, rows)],
        "thrust": thrust(assembly, rows),
    }


def reactions(assembly: Assembly, rows: Sequence[InterfaceRow]) -> tuple[Section, ...]:
    """The reaction of each fixed block that touches a piece which can move.

    ``rows``: of all interfaces; none if there are no forces.
    """
    fixed = [piece.fixed for piece in assembly.pieces]
    found: dict[int, list[Carried]] = {}
    for face, row in zip(assembly.faces, rows, strict=False):
        if fixed[face.below] != fixed[face.above]:
            support = face.below if fixed[face.below] else face.above
            sign = 1.0 if support == face.below else -1.0
            found.setdefault(support, []).append((face, row, sign))
    return tuple(
        Section.of(carried, assembly.pieces[number].name) for number, carried in found.items()
    )


def total(found: Iterable[Section]) -> Vector:
    """The sum of the forces, N."""
    return _vector(np.sum([each.force for each in found], axis=0))


def thrust(assembly: Assembly, rows: Sequence[InterfaceRow]) -> list[list[dict[str, Any]]]:
    """Lines of thrust: along each row of blocks, as of an arch or a stack, the points of action.

    Each with its ``point`` (m) and the numbers of the two blocks, ``between``. Locks count with
    their blocks. None if a block touches more than two others, without ``rows``, and where a force
    acts out of reach of a joint.
    """
    owners = owners_of(assembly)
    found: dict[tuple[int, int], list[Carried]] = {}
    for face, row in zip(assembly.faces, rows, strict=False):
        one, other = owners[face.below], owners[face.above]
        if one != other:
            sign = 1.0 if one < other else -1.0
            found.setdefault((min(one, other), max(one, other)), []).append((face, row, sign))
    free = {number for number, piece in enumerate(assembly.pieces) if not piece.fixed}
    lines = []
    for chain in chains(list(found), free):
        points = [Section.of(found[pair]).near for pair in chain]
        if len(chain) > 1 and None not in points:
            both = zip(points, chain, strict=True)
            lines.append([{"point": [*at], "between": [*pair]} for at, pair in both if at])
    return lines


def chains(pairs: Sequence[tuple[int, int]], free: set[int]) -> list[list[tuple[int, int]]]:
    """The ``pairs`` of blocks that touch along each row of ``free`` blocks, from a support on.

    None if a block is in more than two of them.
    """
    of_block: dict[int, list[tuple[int, int]]] = {number: [] for number in free}
    for pair in pairs:
        for number in free.intersection(pair):
            of_block[number].append(pair)
    if any(len(own) > 2 for own in of_block.values()):
        return []
    found, left = [], {pair for pair in pairs if not free.isdisjoint(pair)}
    for start in pairs:
        if start not in left or free.issuperset(start):
            continue
        row, here = [start], start
        left.remove(start)
        while ahead := left.intersection(
            pair for number in free.intersection(here) for pair in of_block[number]
        ):
            here = ahead.pop()
            left.remove(here)
            row.append(here)
        found.append(row)
    return found


def row_point(row: InterfaceRow) -> Vector | None:
    """The point (m) of an interface through which its resultant acts, if there is one."""
    if row.at_x_m is None or row.at_y_m is None or row.at_z_m is None:
        return None
    return row.at_x_m, row.at_y_m, row.at_z_m


def _vector(values: Floats) -> Vector:
    x, y, z = values.tolist()
    return x, y, z
