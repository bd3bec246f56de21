"""What a structure has in reserve under permanent loads alone: whether it stands, and by how much.

The geometrical safety factor: thickness of the interfaces over the least with which it stands. All
points of an interface are moved towards its middle until no admissible forces balance the permanent
loads, which stay as they are. Of an arch this is its thickness over the least one in which a line
of thrust fits (Heyman, The Stone Skeleton, Cambridge, 1995).

The least horizontal acceleration, of all directions: accelerations that are carried beside the
permanent loads are a convex set, and the mechanism at its edge is normal to it: the set lies behind
the tangent there. From some directions the search goes on along the normal of the nearest tangent,
as long as it gets nearer. Limit analysis may overestimate it: `sidmacib.answers.reserve` asks the
static model too.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from shapely.affinity import scale

from sidmacib.errors import InfeasibleError, UnboundedError
from sidmacib.mechanics.assembly import Assembly, Floats, Vector
from sidmacib.mechanics.crushing import CrushedMaterial, crushed_faces
from sidmacib.mechanics.equilibrium import is_dry
from sidmacib.mechanics.limit import limit_load, require_standing
from sidmacib.mechanics.loads import Loads
from sidmacib.mechanics.polygons import Polygon
from sidmacib.structure.loads import StructureLoads, free_weight, pushed

MOST = 100.0  # geometrical safety factor: beyond, there is no limit
PRECISION = 1e-4  # of it, over itself
DIRECTIONS = 8  # horizontal ones that the search begins with
NEARER = 1e-3  # gain of a step of the search, over the acceleration, at which it ends
STEPS = 10  # of the search, at most


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
