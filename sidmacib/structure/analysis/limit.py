"""Limit analysis of structures, also under gravity that turns, and mesh errors of limit loads.

The angle above which no admissible forces carry gravity is an upper bound where friction is
associated: blocks that wedge each other carry any load in limit analysis, but in a path of loading
only if something presses them together first.

Apart from the static model, in `sidmacib.structure.analysis.tilt` and `sidmacib.mesh_error`, so
that no path is followed again where this changes, and following one loads no solver of programmes.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from sidmacib.errors import CapacityError, UnboundedError
from sidmacib.mechanics.assembly import Assembly, Floats, Kind, NodeLayout
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.crushing import crushed_faces
from sidmacib.mechanics.equilibrium import has_bonds
from sidmacib.mechanics.limit import LimitState, limit_load, require_standing
from sidmacib.mechanics.loads import Loads
from sidmacib.mechanics.polygons import CondensedLocks
from sidmacib.problem import Problem
from sidmacib.structure.analysis.tilt import LARGEST, LEVEL, turned, turning
from sidmacib.structure.loads import beside_of, free_weight, naming_permanent
from sidmacib.structure.structure import refined

SECTOR = 60.0  # degrees that one programme of limit analysis sees
SCAN = 5.0  # degrees between programmes where what they see is no sector
LIMIT_PRECISION = 1e-4  # degrees
AT_CORNERS = (NodeLayout.VERTICES, NodeLayout.LOBATTO)
MOST_NODES = 5000  # of the finer mesh: more take longer than the answer
FACTOR = 2.0  # on the change from a mesh to the finer one: all that errors of first order have left
DIGITS = 9  # of the error after the decimal point; the rest is the solver's


def limit_state(assembly: Assembly, loads: Loads, most: float | None = None) -> LimitState:
    """The state at the largest load that forces can balance, or at ``most`` (N), with friction.

    `sidmacib.errors.CapacityError` if there is none, or if the structure does not stand.
    """
    with naming_permanent(loads):
        require_standing(assembly, loads, friction=True)
        return limit_load(assembly, loads, friction=True, most=most)


def assumes(assembly: Assembly) -> str:
    """What limit analysis assumes that may put its load too high or too low."""
    if any(isinstance(face, CondensedLocks) and face.limits for face in assembly.faces):
        held = "locks limited by the rule under their hold_down, a plate by default"
        return f"{held}; the first lock to fail governs"
    if has_bonds(assembly):
        laws = (face.material for face in assembly.faces if face.kind is Kind.INNER)
        rough = any(law.friction_in_bonds for law in laws)
        bonds = "ductile bonds" if rough else "ductile, frictionless bonds"
        return f"{bonds}: neither an upper nor a lower bound for brittle bonds"
    return "associated friction: may overestimate"


@dataclass(frozen=True)
class LimitTilt:
    """The angle (degrees) up to which admissible forces exist, and the mechanism there, (P, 6).

    Without a mechanism they exist up to 180 degrees.
    """

    angle: float
    mechanism: Floats | None = None

    @property
    def load(self) -> float:
        """The angle."""
        return self.angle


def limit_tilt(assembly: Assembly, loads: Loads, most: float | None = None) -> LimitTilt:
    """The smallest angle above which limit analysis finds no admissible forces in ``assembly``.

    ``loads``: by `tilting`. Friction is associated. Angles without such forces that are less than 5
    degrees apart may be missed where there are bonds, compressive strengths or permanent loads
    beside weight, or where the axis is not horizontal. ``most``: found at once if it has forces.
    `InfeasibleError` if there are no forces before gravity turns; other errors of `limit_load`.
    """
    if most is not None and short_of(assembly, loads, most) is None:
        return LimitTilt(most)
    assert loads.raised.axis, "gravity turns"
    require_standing(assembly, turned(loads, 0.0), friction=True)
    strong = ContactLaw.of(assembly).cohesive.any() or assembly.without_stiffness
    level = abs(loads.raised.axis[2]) <= LEVEL
    if level and not beside_of(loads).wrenches.any() and not strong and not crushed_faces(assembly):
        return _by_sectors(assembly, loads)
    return _by_scan(assembly, loads)


def _by_sectors(assembly: Assembly, loads: Loads) -> LimitTilt:
    """`limit_tilt` of an assembly without strengths about a horizontal axis.

    Directions of gravity that admissible forces carry are a convex cone, in the plane in which
    gravity turns a sector. Its end is the largest tangent of an angle: one programme.
    """
    weight = free_weight(assembly)
    for begin in np.arange(0.0, LARGEST, SECTOR).tolist():
        try:  # the largest load beside gravity, where it turns to
            state = limit_load(assembly, turning(loads, begin), friction=True)
        except UnboundedError:
            continue
        further = math.degrees(math.atan(state.load / weight))
        if further < SECTOR:
            return LimitTilt(begin + max(further, 0.0), state.mechanism)
    return LimitTilt(LARGEST)


def _by_scan(assembly: Assembly, loads: Loads) -> LimitTilt:
    """`limit_tilt` of any assembly: angles one after the other, then bisection."""
    low = high = 0.0
    state: LimitState | None = None
    while state is None:
        low, high = high, high + SCAN
        if high > LARGEST:
            return LimitTilt(LARGEST)
        state = short_of(assembly, loads, high)
    while high - low > LIMIT_PRECISION:
        middle = (low + high) / 2
        found = short_of(assembly, loads, middle)
        low, high, state = (middle, high, state) if found is None else (low, middle, found)
    return LimitTilt(low, state.mechanism)


def short_of(assembly: Assembly, loads: Loads, angle: float) -> LimitState | None:
    """The limit state on the way from upright gravity to that at ``angle``; None if it gets there.

    The way is straight. It leads to ``angle`` if that has admissible forces, as the directions and
    sizes of gravity that have them are a convex set.
    """
    upright, weight = turned(loads, 0.0), free_weight(assembly)
    change = turned(loads, angle).permanent - upright.permanent
    try:
        state = limit_load(assembly, replace(upright, variable=change / weight), friction=True)
    except UnboundedError:
        return None
    return None if state.load >= weight else state


def limit_or_tilt(problem: Problem, most: float | None = None) -> LimitState | LimitTilt:
    """The limit load, or the angle where gravity turns, see `limit_tilt`.

    `CapacityError` if there is none.
    """
    assembly, loads = problem
    if loads.raised.axis is None:
        return limit_state(assembly, loads)
    with naming_permanent(loads):
        return limit_tilt(assembly, loads, most)


def limit_mesh_error(problem: Problem, load: float) -> float | None:
    """Mesh error of a limit ``load`` (N) with friction, over itself; None where it is unknown.

    0 without bonds: what a dry face can carry at any place its nodes carry too, if all its corners
    are nodes, as forces inside a face are means of forces at its corners. With bonds, from the load
    on cells of half the size.
    """
    assembly, loads = problem
    if not ContactLaw.of(assembly).cohesive.any():
        return 0.0 if assembly.layout in AT_CORNERS else None
    fine = refined(assembly)
    if loads.raised.axis or not load > 0.0 or len(fine.nodes.area) > MOST_NODES:
        return None
    try:
        change = limit_load(fine, loads, friction=True).load / load - 1.0
    except CapacityError:
        return None
    return round(FACTOR * abs(change), DIGITS)
