"""Supports that settle, spread or turn: their reactions, and where the structure falls.

The reaction is the force (N) of the structure on the support along its movement, or the moment
(N m) about the axis about which it turns. As a support yields, the reaction drops to the least that
limit analysis admits (as it is pushed back, it rises to the greatest): the structure becomes a
mechanism that follows the support. Its blocks are then followed as they move, see
`sidmacib.structure.analysis.kinematics`, until no forces balance their weight. Joints are rigid and
dry.

In the static model the support becomes a free piece on a spring to ground, much stiffer than the
joints, and the force that moves the spring by as much is the load. The path follows the history of
friction.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from sidmacib.errors import (
    DOES_NOT_STAND,
    CapacityError,
    InfeasibleError,
    NoEquilibriumError,
    UnboundedError,
)
from sidmacib.mechanics.assembly import Assembly, FaceMaterial, Floats, Kind, Nodes
from sidmacib.mechanics.equilibrium import equilibrium_matrix
from sidmacib.mechanics.loads import Loads
from sidmacib.mechanics.polygons import Polygon
from sidmacib.mechanics.rigid import RigidSolver
from sidmacib.mechanics.solution import Equilibrium
from sidmacib.quantities import some_of
from sidmacib.structure.analysis.kinematics import (
    FALL,
    LEAPS,
    PRESSED,
    REACHED,
    STILL,
    Kinematics,
    Path,
    Position,
)
from sidmacib.structure.blocks import Block, Compound
from sidmacib.structure.loads import SupportMotion, naming_permanent

MOST_JOINTS = 6  # names in a note
# Of the static model.
STIFFER = 1e3  # stiffness of the spring over that of the stiffest joint
STRONG = 1e30  # Pa: the spring never fails
GROUND = "ground below the support"
FIRST = 0.1  # of the movement that the softest joint makes under the weight
GROWTH = 1.3  # of the movement from one equilibrium to the next
SETTLED = 0.01  # of the drop to the least reaction: what may be left of it
SMALL = 0.01  # of the assembly's length: largest movement
STUCK = 100.0  # friction coefficient of a joint that does not slide


@dataclass(frozen=True, eq=False)
class Reaction:
    """A reaction (N or N m), the mechanism, (P, 6) per m or rad, and its joints by name."""

    size: float
    mechanism: Floats
    hinges: tuple[str, ...]
    slides: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class SupportPath:
    """The reaction (N or N m) over the ``movement`` of the support (m or rad), both (K,).

    ``hinges``, ``slides``: at the last movement. ``path``: the positions.
    """

    movement: Floats
    reaction: Floats
    hinges: tuple[str, ...]
    slides: tuple[str, ...]
    path: Path

    @property
    def falls(self) -> bool:
        """Whether the structure falls at the last movement."""
        return self.path.end == FALL

    @property
    def free(self) -> bool:
        """Whether the structure stands without the support, which no longer carries anything."""
        return self.path.end == REACHED


def least_reaction(assembly: Assembly, loads: SupportMotion) -> Reaction:
    """The reaction when the support yields.

    `InfeasibleError` if the structure does not stand, `CapacityError` for interfaces that are not
    dry.
    """
    return _reaction(assembly, loads, -1.0)


def greatest_reaction(assembly: Assembly, loads: SupportMotion) -> Reaction | None:
    """The reaction when the support is pushed back; None without limit. Errors of the least."""
    against = replace(loads, along=tuple(-each for each in loads.along))
    try:
        return _reaction(assembly, against, 1.0)
    except UnboundedError:
        return None


def _reaction(assembly: Assembly, loads: SupportMotion, sign: float) -> Reaction:
    kinematics = Kinematics(assembly, loads)
    try:
        start = kinematics.start()
    except InfeasibleError:
        raise InfeasibleError(DOES_NOT_STAND) from None
    limit = kinematics.limit()
    twisted = limit.untwisted is not None
    size = sign * (limit.load if twisted else start.load) + 0.0
    return Reaction(size, start.motion, *kinematics.moving(start))


def support_path(assembly: Assembly, loads: SupportMotion) -> SupportPath:
    """Follow the structure as the support yields, until it falls or no longer needs the support.

    Errors of `least_reaction`.
    """
    kinematics = Kinematics(assembly, loads)
    free = [number for number, piece in enumerate(assembly.pieces) if not piece.fixed]

    def stands_alone(here: Position) -> bool:
        moves = np.abs(here.motion[free].reshape(-1, 2, 3)).max(axis=(0, 2)) @ [1, assembly.length]
        rests = abs(here.load) <= PRESSED * loads.scale and bool(moves <= STILL)
        return rests and kinematics.stands_without(loads.support, here)

    try:
        path = kinematics.path(stands_alone)
    except InfeasibleError:
        raise InfeasibleError(DOES_NOT_STAND) from None
    movement, load = np.array([(each.moved, each.load) for each in path.positions]).T
    return SupportPath(movement, -load, *kinematics.moving(path.positions[-1]), path)


def static_reactions(
    assembly: Assembly, loads: SupportMotion, least: float
) -> tuple[Floats, Floats]:
    """Move the support until its reaction has dropped to the ``least`` (N or N m).

    Or until no equilibrium follows, or the displacements are no longer small. The movement (m or
    rad) and the reaction (N or N m) over it, (K,) each, from rest on.
    `NoEquilibriumError` if the structure does not stand before.
    """
    sprung, moving = _on_spring(assembly, loads)
    solver = RigidSolver(sprung, moving)
    try:
        point = solver.start()
    except NoEquilibriumError:
        raise NoEquilibriumError(DOES_NOT_STAND) from None
    # What the piece above exerts on the support, along its movement, per node force.
    on_support = equilibrium_matrix(assembly)[6 * loads.support : 6 * loads.support + 6]
    along = -(loads.motion(assembly.pieces[loads.support].centre) @ on_support)

    def reaction(at: Equilibrium) -> float:
        return float(along @ at.force[: len(assembly.nodes.area)].ravel())

    softest = min(
        face.area * min(face.material.normal_stiffness, face.material.shear_stiffness)
        for face in assembly.faces
    )
    step = FIRST * loads.scale / softest / (assembly.length if loads.turns else 1.0)
    found = [(0.0, reaction(point))]
    largest = SMALL * (1.0 if loads.turns else assembly.length)
    while found[-1][0] < largest and not _dropped(found[-1][1], found[0][1], least):
        try:
            point = solver.solve(found[-1][0] + step, point.unknowns, point.state, thorough=True)
        except NoEquilibriumError:
            break
        found.append((point.load, reaction(point)))
        step = max(step, (GROWTH - 1.0) * point.load)
    movement, reactions = np.array(found).T
    if reactions[-1] < least:  # on cells that resist more torque: the path ends there
        movement[-1] = np.interp(-least, -reactions[-2:], movement[-2:])
        reactions[-1] = least
    return movement, reactions


def _on_spring(assembly: Assembly, loads: SupportMotion) -> tuple[Assembly, Loads]:
    """The assembly with its support on a spring to ground, and the force per movement."""
    support = assembly.pieces[loads.support]
    assert isinstance(support, Block | Compound)
    size, middle = assembly.length, support.centre
    # No stiffer than needed: forces are balanced to digits of that in the spring.
    stiffest = max(
        face.area * max(face.material.normal_stiffness, face.material.shear_stiffness)
        for face in assembly.faces
    )
    stiffness = STIFFER * stiffest / size**2
    half = size / 2.0
    pieces = list(assembly.pieces)
    pieces[loads.support] = replace(support, fixed=False)
    pieces.append(replace(support, name=GROUND))
    law = FaceMaterial(stiffness, stiffness, 0.0, STRONG, STRONG)
    ends, square = (len(pieces) - 1, loads.support), shapely.box(-half, -half, half, half)
    spring = Polygon(GROUND, Kind.INNER, law, *ends, np.eye(3), middle.tolist(), square)
    corners = np.array([(0.0, p, q) for p in (-half, half) for q in (-half, half)])
    nodes = Nodes(
        np.append(assembly.nodes.face, [len(assembly.faces)] * 4),
        np.concatenate([assembly.nodes.position, middle + corners]),
        np.append(assembly.nodes.area, [size**2 / 4.0] * 4),
    )
    motion = loads.motion(middle)
    turning = size**2 / 4.0 * np.array([2.0, 1.0, 1.0])  # second moments of the nodes' areas
    permanent, variable = np.zeros((2, len(pieces), 6))
    permanent[:-1] = loads.permanent
    wrench = np.concatenate([motion[:3], turning * motion[3:]])
    variable[loads.support] = stiffness * size**2 * wrench
    sprung = replace(assembly, pieces=tuple(pieces), faces=(*assembly.faces, spring), nodes=nodes)
    return sprung, Loads(permanent, variable, loads.scale)


@dataclass(frozen=True)
class SupportAnswer:
    """A reaction (N or N m) in an ``answer`` of a model, after a movement (m or rad), and a note.

    Each is None where there is none.
    """

    answer: str
    reaction: float | None
    movement: float | None
    note: str


def support_answers(
    assembly: Assembly, loads: SupportMotion
) -> tuple[list[SupportAnswer], SupportPath | CapacityError]:
    """The answers, and the reaction over the movement, or why there is none.

    `CapacityError` if the structure does not stand, or an interface is not dry.
    """
    with naming_permanent(loads):
        least, greatest = least_reaction(assembly, loads), greatest_reaction(assembly, loads)
    yields = f"the support yields; {joints_in_words(least.hinges, least.slides)}"
    back, pushed = None, "no limit: the support can be pushed back with any force"
    if greatest:
        joints = joints_in_words(greatest.hinges, greatest.slides)
        back, pushed = _clean(greatest.size, loads), f"the support is pushed back; {joints}"
    answers = [
        *_static(assembly, loads, least.size),
        SupportAnswer("limit, least", _clean(least.size, loads), None, yields),
        SupportAnswer("limit, greatest", back, None, pushed),
    ]
    try:
        path = support_path(assembly, loads)
    except CapacityError as error:
        return [*answers, SupportAnswer("kinematics", None, None, str(error))], error
    movement, reaction = float(path.movement[-1]), _clean(path.reaction[-1], loads)
    answers.append(SupportAnswer("kinematics", reaction, movement, _end(path)))
    return [*answers, *_one_slides(assembly, loads, least.slides, movement)], path


def _clean(reaction: float, loads: SupportMotion) -> float:
    """A ``reaction`` without what rounding leaves of none."""
    return float(reaction) if abs(reaction) > PRESSED * loads.scale else 0.0


def _one_slides(
    assembly: Assembly, loads: SupportMotion, slides: Sequence[str], movement: float
) -> Iterator[SupportAnswer]:
    """Where the structure falls if only one of several joints slides, if before ``movement``.

    Rigid blocks do not say how a movement is shared by joints that slide: the pressure on them,
    which decides, is not determined.
    """
    found = []
    for name in slides if len(slides) > 1 else ():
        faces = [
            replace(face, material=replace(face.material, friction=STUCK))
            if isinstance(face, Polygon) and face.name in slides and face.name != name
            else face
            for face in assembly.faces
        ]
        try:
            path = support_path(replace(assembly, faces=tuple(faces)), loads)
        except CapacityError:
            continue
        if path.falls and path.movement[-1] < (1.0 - SETTLED) * movement:
            found.append((float(path.movement[-1]), float(path.reaction[-1]), name))
    if found:
        least, reaction, name = min(found)
        note = f"if only {name} slides: rigid blocks do not determine which joint does"
        yield SupportAnswer("kinematics, least", reaction, least, note)


def _static(assembly: Assembly, loads: SupportMotion, least: float) -> Iterator[SupportAnswer]:
    try:
        movement, reaction = static_reactions(assembly, loads, least)
    except CapacityError as error:
        yield SupportAnswer("static", None, None, " ".join(str(error).split()))
        return
    rest, last = (_clean(each, loads) for each in (reaction[0], reaction[-1]))
    yield SupportAnswer("static, at rest", rest, 0.0, "elastic joints")
    ends = "the reaction has dropped to the least"
    if not _dropped(reaction[-1], reaction[0], least):
        ends = "followed to here; then no equilibrium is found, or displacements are large"
    yield SupportAnswer("static, yields", last, float(movement[-1]), ends)


def _dropped(reaction: float, rest: float, least: float) -> bool:
    """Whether a ``reaction`` (N or N m), ``rest`` at first, has dropped to the ``least``."""
    return bool(reaction <= least + SETTLED * (rest - least))


def _end(path: SupportPath) -> str:
    if path.falls:
        return f"the structure falls; {joints_in_words(path.hinges, path.slides)}"
    if path.free:
        return "the support carries nothing more: the structure stands without it"
    if path.path.end == LEAPS:
        return "the blocks go on in another way at once, and may fall; it was followed no further"
    if path.path.met:
        return f"{' and '.join(path.path.met)} meet; it was followed no further"
    return "the structure still stands; it was followed no further"


def joints_in_words(hinges: Sequence[str], slides: Sequence[str]) -> str:
    """Names of hinges and of joints that slide."""
    both = [
        f"{words} {some_of(names, MOST_JOINTS)}"
        for words, names in (("hinges at", hinges), ("sliding at", slides))
        if names
    ]
    return ", ".join(both) or "no joint opens or slides"
