"""What a structure has in reserve under permanent loads alone: whether it stands, and by how much.

The geometrical safety factor: thickness of the interfaces over the least with which it stands. All
points of an interface are moved towards its middle until no admissible forces balance the permanent
loads, which stay as they are. Of an arch this is its thickness over the least one in which a line
of thrust fits (Heyman, The Stone Skeleton, Cambridge, 1995).

The least horizontal acceleration, of all directions: accelerations that are carried beside the
permanent loads are a convex set, and the mechanism at its edge is normal to it: the set lies behind
the tangent there. From some directions the search goes on along the normal of the nearest tangent,
as long as it gets nearer. Limit analysis may overestimate it; the static model, which follows
elastic joints and finite motions, is asked in the directions in which limit analysis finds least.
"""

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from shapely.affinity import scale

from sidmacib.errors import (
    DOES_NOT_STAND,
    CapacityError,
    InfeasibleError,
    NoEquilibriumError,
    UnboundedError,
)
from sidmacib.mechanics.assembly import Assembly, Floats, Vector
from sidmacib.mechanics.crushing import CrushedMaterial, crushed_faces
from sidmacib.mechanics.equilibrium import is_dry
from sidmacib.mechanics.limit import limit_load, require_standing
from sidmacib.mechanics.loads import Loads
from sidmacib.mechanics.polygons import Polygon
from sidmacib.mechanics.solution import Mode
from sidmacib.mechanics.static import first_failure_of, solver_of
from sidmacib.problem import Problem
from sidmacib.structure.analysis.forces import interface_forces
from sidmacib.structure.loads import StructureLoads, free_weight, naming_permanent, pushed
from sidmacib.structure.structure import refined, with_dry_joints

MOST = 100.0  # geometrical safety factor: beyond, there is no limit
PRECISION = 1e-4  # of it, over itself
DIRECTIONS = 8  # horizontal ones that the search begins with
NEARER = 1e-3  # gain of a step of the search, over the acceleration, at which it ends
STEPS = 10  # of the search, at most
# Over the least acceleration in the static model: directions with more in limit analysis are left.
FURTHER = 1.25
SQUARE: tuple[Vector, ...] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0), (0.0, -1.0, 0.0))


@dataclass(frozen=True, eq=False)
class Push:
    """The least horizontal acceleration (g) that fells a structure, its direction, and how.

    ``mechanism``: as in `sidmacib.mechanics.limit.LimitState`. ``tilt``: the same as a tilt, in
    degrees; None where that is another load.
    """

    acceleration: float
    direction: Vector
    mechanism: Floats
    tilt: float | None


def geometrical_factor(assembly: Assembly, loads: Loads) -> float | None:
    """The geometrical safety factor of a structure that stands.

    None where interfaces could be points, or are not dry.
    """
    if not is_dry(assembly):
        return None
    return _largest(lambda factor: _stands(_smaller(assembly, factor), loads))


def strength_factor(assembly: Assembly, loads: Loads) -> float | None:
    """Compressive strength over the strength needed, of a structure that stands.

    None where there is none, or no limit up to `MOST`.
    """
    if not crushed_faces(assembly):
        return None
    return _largest(lambda factor: _stands(_weaker(assembly, factor), loads))


def _largest(stands: Callable[[float], bool]) -> float | None:
    """The largest factor at which a structure ``stands``; None from `MOST` on."""
    low, high = 1.0, MOST
    if stands(high):
        return None
    while high / low > 1.0 + PRECISION:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if stands(middle) else (low, middle)
    return low


def _smaller(assembly: Assembly, factor: float) -> Assembly:
    """With interfaces that are smaller by a ``factor``."""
    nodes, part = assembly.nodes, 1.0 / factor
    middle = np.array([face.middle for face in assembly.faces])[nodes.face]
    smaller = replace(nodes, position=middle + part * (nodes.position - middle))
    faces = []
    for face in assembly.faces:
        assert isinstance(face, Polygon), "a structure has polygons"
        faces.append(replace(face, outline=scale(face.outline, part, part, origin=(0.0, 0.0))))
    return replace(assembly, faces=tuple(faces), nodes=smaller)


def _weaker(assembly: Assembly, factor: float) -> Assembly:
    """With compressive strengths that are lower by a ``factor``."""
    faces = list(assembly.faces)
    for number, face, strength in crushed_faces(assembly):
        assert isinstance(face.material, CrushedMaterial)
        law = replace(face.material, compressive_strength=strength / factor)
        faces[number] = replace(face, material=law)
    return replace(assembly, faces=tuple(faces))


def _stands(assembly: Assembly, loads: Loads) -> bool:
    try:
        require_standing(assembly, loads, friction=True)
    except InfeasibleError:
        return False
    return True


def pushes(
    assembly: Assembly, loads: StructureLoads, tell: Callable[[str], object] = str
) -> tuple[Push, ...]:
    """Accelerations beside permanent ``loads`` that fell a structure, in `DIRECTIONS`.

    None in those where limit analysis finds none. ``tell`` is told each. Errors of `limit_load`.
    """
    found = []
    for turn in (2.0 * math.pi * np.arange(DIRECTIONS) / DIRECTIONS).tolist():
        way = np.array([math.cos(turn), math.sin(turn), 0.0])
        if push := _push(assembly, loads, way):
            found.append(push)
            x, y, _ = push.direction
            tell(f"falls at {push.acceleration:.4g} g towards ({x:.3g}, {y:.3g})")
    return tuple(found)


def least_push(assembly: Assembly, loads: StructureLoads, tried: Sequence[Push]) -> Push | None:
    """The least of all horizontal accelerations, from those that were ``tried``; None of none."""
    found = list(tried)
    mass = np.array([0.0 if piece.fixed else piece.mass for piece in assembly.pieces])
    for _ in range(STEPS if found else 0):
        normals = np.array([mass @ push.mechanism[:, :2] for push in found])
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        edge = np.array([np.multiply(push.acceleration, push.direction[:2]) for push in found])
        tangents = (normals * edge).sum(axis=1)
        nearest, best = int(tangents.argmin()), min(push.acceleration for push in found)
        if tangents[nearest] > best * (1.0 - NEARER):
            break
        push = _push(assembly, loads, np.append(normals[nearest], 0.0))
        if push is None:
            break
        found.append(push)
    return min(found, key=lambda push: push.acceleration, default=None)


def _push(assembly: Assembly, loads: StructureLoads, way: Floats) -> Push | None:
    """The acceleration along a horizontal ``way``, of length 1, at which it falls."""
    x, y, z = (np.round(way, 9) + 0.0).tolist()
    try:
        state = limit_load(assembly, pushed(assembly, loads, (x, y, z)), friction=True)
    except UnboundedError:
        return None
    acceleration = max(state.load, 0.0) / free_weight(assembly)
    # Without strengths and other loads forces are a cone: gravity and push may be scaled together.
    dry = is_dry(assembly) and not crushed_faces(assembly)
    cone = dry and not loads.beside.wrenches.any()
    tilt = math.degrees(math.atan(acceleration)) if cone else None
    return Push(acceleration, (x, y, z), state.mechanism, tilt)


class Followed(NamedTuple):
    """The least horizontal acceleration (g) in the static model, and its direction.

    ``bonds``: whether a bond fails there, after which it may carry more; else it falls.
    """

    acceleration: float
    direction: Vector
    bonds: bool


@dataclass(frozen=True, eq=False)
class Reserve:
    """What limit analysis and the static model answer without a load that is raised.

    ``factor``: the geometrical safety factor; None where it has no limit, or bonds or locks are
    there. ``least``: the least horizontal acceleration by limit analysis; None if there is none;
    ``tried``: others. ``followed``: the least by the static model; None without an answer.
    ``static``: what the static model says against it, or nothing; ``falls``: whether that is that
    it does not stand, or that a bond fails. ``strength``: compressive strength over the strength
    needed; None where there is none, or no limit. ``bonds``: how far bonds reach, where the same
    blocks with dry joints carry more: all else is then of these; else nothing.
    """

    factor: float | None
    least: Push | None
    tried: tuple[Push, ...]
    followed: Followed | None
    static: str
    falls: bool
    strength: float | None
    bonds: str = ""


def reserve(problem: Problem, tell: Callable[[str], object]) -> Reserve:
    """The reserve of a structure; `CapacityError` if it does not stand in limit analysis.

    Where a bond fails first, that with dry joints, if they carry more. ``tell`` is told what is
    found.
    """
    found = _reserve(problem, tell)
    first = found.followed
    if not (found.falls or (first and first.bonds)) or is_dry(problem.assembly):
        return found
    try:
        tell("with dry joints ...")
        dry = _reserve(with_dry_joints(problem), tell)
    except CapacityError:
        return found
    most = dry.followed
    if dry.falls or (first and not (most and most.acceleration > first.acceleration)):
        return found
    fails = found.static if first is None else f"the first fails at {first.acceleration:.3g} g"
    return replace(dry, bonds=f"with bonds, {fails}")


def _reserve(problem: Problem, tell: Callable[[str], object]) -> Reserve:
    """The reserve with the bonds that there are; the rest as `reserve`."""
    assembly, loads = problem
    assert isinstance(loads, StructureLoads), "loads of a structure"
    with naming_permanent(loads):
        require_standing(assembly, loads, friction=True)
        tell("stands in limit analysis; horizontal accelerations ...")
        tried = pushes(assembly, loads, tell)
        tell("geometrical safety factor ...")
        factor, least = geometrical_factor(assembly, loads), least_push(assembly, loads, tried)
        strength = strength_factor(assembly, loads)
    static, falls, found = "", False, None
    try:
        with naming_permanent(loads):
            _require_static(problem)
            found = _followed(problem, least, tried, tell)
    except CapacityError as error:
        static, falls = str(error), isinstance(error, NoEquilibriumError)
    return Reserve(factor, least, tried, found, static, falls, strength)


def _followed(
    problem: Problem, least: Push | None, tried: Sequence[Push], tell: Callable[[str], object]
) -> Followed | None:
    """The least acceleration that the static model carries.

    In the directions in which limit analysis finds up to `FURTHER` times as much, and where that
    finds none along x and y.
    """
    assembly, loads = problem
    assert isinstance(loads, StructureLoads), "loads of a structure"
    ways = {push.direction: push.acceleration for push in (*filter(None, (least,)), *tried)}
    ways = ways or dict.fromkeys(SQUARE, 0.0)
    best: Followed | None = None
    for way, most in sorted(ways.items(), key=lambda each: each[1]):
        if best is not None and most > FURTHER * best.acceleration:
            break
        with suppress(UnboundedError):
            found = first_failure_of(solver_of(refined(assembly, 1), pushed(assembly, loads, way)))
            acceleration = found.point.load / free_weight(assembly)
            bonds = found.mode is Mode.BONDS
            what = "a bond fails" if bonds else "falls"
            tell(f"static model: {what} at {acceleration:.4g} g towards ({way[0]:g}, {way[1]:g})")
            if best is None or acceleration < best.acceleration:
                best = Followed(acceleration, way, bonds)
    return best


def _require_static(problem: Problem) -> None:
    """`CapacityError` unless the structure stands in the static model, and no bond fails."""
    assembly = refined(problem.assembly, 1)
    try:
        state = solver_of(assembly, problem.loads).start()
    except NoEquilibriumError:
        raise NoEquilibriumError(DOES_NOT_STAND) from None
    for face in interface_forces(assembly, state.force):
        if face.bonded_share and (face.utilisation or 0.0) > 1.0:
            raise NoEquilibriumError(f"the bond of {face.interface} fails under its own weight")
