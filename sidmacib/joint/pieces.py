"""The joint as an assembly: pieces that meet across inner and dry faces, and the locks' weights.

The paper (section 4) defines the weight of a lock as the mean shear stress on its inner face over
the cohesion. Under torque the resultant can vanish while the stress does not, so the mean
magnitude and the largest value are given as well.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from sidmacib.joint import Hold, Joint, UpperBody
from sidmacib.mechanics.assembly import (
    CLOSE,
    Assembly,
    Cuboid,
    FaceMaterial,
    Floats,
    Kind,
    NodeLayout,
    Nodes,
    Rectangle,
)
from sidmacib.mechanics.contact_nodes import cells_along, contact_nodes, corners
from sidmacib.mechanics.equilibrium import face_frames
from sidmacib.validation import require_positive

LOWER, PLATE, BODY = "lower", "plate", "body"  # names of pieces
# Largest opening of a face, over the height of a lock. Locks that have moved apart by so much grip
# each other over 5 % less of it; the margin of the safe rule covers that. In LIGGGHTS four smooth
# locks, held by their weight, come apart at a quarter of the load that they carry in place.
APART = 0.05
# Largest displacement of a block before a bond fails, over the width of a lock: locks that have
# moved along each other by so much bear over a few per cent less of their length than is computed,
# which the margin of the safe rule covers.
FAR = 0.03
JOINED = 1e3  # stiffness between joined columns over that of inner faces: almost rigid


def assemble(
    joint: Joint, mesh: float, nodes: NodeLayout = NodeLayout.LOBATTO, *, least: int | None = None
) -> Assembly:
    """Cut ``joint`` into pieces and put ``nodes`` on cells of their faces no longer than ``mesh``.

    ``mesh``: the longest side of a cell, m. ``least``: cells along every side of a face, however
    short; by default one under a plate, which holds the upper block level, and else as many as
    along the shorter side of a lock and at least two: without a plate the load may hang on the
    height at which locks bear. ValueError unless the mesh is above 0 and at most the shorter side
    of the locks' horizontal faces; less than that side except for Lobatto points, as one row of
    other nodes would be a hinge.
    """
    most, nodes = joint.least_side, NodeLayout(nodes)
    one_cell = nodes is NodeLayout.LOBATTO
    if not mesh > 0 or (mesh > most if one_cell else cells_along(np.array([most]), mesh)[0] < 2):
        raise ValueError(
            f"mesh: must be more than 0 and {'at most' if one_cell else 'less than'} {most} m, the "
            f"shorter side of a lock's horizontal face (got {mesh} m)"
        )
    plate = joint.hold_down.kind is Hold.PLATE
    if least is None:
        least = 1 if plate else max(2, int(cells_along(np.array([most]), mesh)[0]))
    pieces = cut_pieces(joint)
    faces = tuple(_faces(joint, pieces))
    opening = APART * joint.h if joint.interlocking and not plate else math.inf
    at = contact_nodes(faces, mesh, nodes, least)
    # Flanks bear on each other all the same: no lock is preferred.
    return Assembly(pieces, faces, at, joint.a, joint.failure, mesh, nodes, opening, share=0.5)


def reassemble(joint: Joint, assembly: Assembly) -> Assembly:
    """``joint`` with the nodes of ``assembly``, of a joint that differs in sizes and materials.

    Every node stays at the same part of its face, whatever the mesh, so that what is computed on
    both is a smooth function of the sizes.
    """
    pieces, before = cut_pieces(joint), assembly.rectangles
    faces = tuple(_faces(joint, pieces))
    (low, high), (new_low, new_high) = corners(before), corners(faces)
    larger = np.array([new.area / old.area for new, old in zip(faces, before, strict=True)])
    face = assembly.nodes.face
    side = np.where(high > low, high - low, 1.0)
    part = (assembly.nodes.position - low[face]) / side[face]
    position = new_low[face] + part * (new_high - new_low)[face]
    nodes = Nodes(face, position, assembly.nodes.area * larger[face])
    return replace(assembly, pieces=pieces, faces=faces, nodes=nodes, length=joint.a)


def lock_name(lock: int) -> str:
    """Name of the piece that is lock number ``lock``."""
    return f"lock{lock}"


def body_above(joint: Joint, lock: int) -> str:
    """Name of the piece of the upper main body above lock number ``lock``."""
    return BODY if joint.upper_body is UpperBody.MONOLITHIC else f"column{lock}"


def upper_bodies(joint: Joint) -> tuple[str, ...]:
    """Names of the pieces of the upper main body, from lock 1 on."""
    return tuple(dict.fromkeys(body_above(joint, lock) for lock in joint.numbers))


def upper_block(joint: Joint) -> tuple[str, ...]:
    """Names of the pieces of the upper block: its locks and its main body."""
    return *map(lock_name, joint.upper_locks), *upper_bodies(joint)


def lock_faces(joint: Joint) -> dict[str, int]:
    """Numbers of the locks by the name of each one's inner (horizontal) face."""
    found = {}
    for lock in joint.numbers:
        name, upper = lock_name(lock), joint.is_upper(lock)
        below, above = (name, body_above(joint, lock)) if upper else (LOWER, name)
        found[f"{Kind.INNER}-{below}-{above}"] = lock
    return found


def roots(joint: Joint, assembly: Assembly) -> list[int]:
    """Indices of the inner (horizontal) faces of the locks, in the order of their numbers."""
    index = {face.name: number for number, face in enumerate(assembly.faces)}
    return [index[name] for name in lock_faces(joint)]


def cut_pieces(joint: Joint) -> tuple[Cuboid, ...]:
    """Lower body, plate (if any), locks, and upper body or its columns, in this order."""
    x, width, top = joint.a / 2, joint.total_width, joint.h + joint.H

    def cuboid(
        name: str,
        y: tuple[float, float],
        z: tuple[float, float],
        fixed: bool = False,
        density: float = joint.density,
    ) -> Cuboid:
        volume = joint.a * (y[1] - y[0]) * (z[1] - z[0])
        low, high = (-x, y[0], z[0]), (x, y[1], z[1])
        elastic = None if fixed else joint.elastic
        return Cuboid(name, low, high, density * volume, fixed, elastic)

    # The lower body and the plate are fixed and rigid: their thickness is immaterial.
    pieces = [cuboid(LOWER, (0.0, width), (-joint.H, 0.0), fixed=True)]
    if joint.hold_down.kind is Hold.PLATE:
        pieces.append(cuboid(PLATE, (0.0, width), (top, top + joint.h), fixed=True))
    strips = {lock: (joint.edge(lock - 1), joint.edge(lock)) for lock in joint.numbers}
    for lock, strip in strips.items():
        density = joint.lock_density(lock)
        pieces.append(cuboid(lock_name(lock), strip, (0.0, joint.h), density=density))
    if joint.upper_body is UpperBody.MONOLITHIC:
        return *pieces, cuboid(BODY, (0.0, width), (joint.h, top))
    columns = (cuboid(body_above(joint, n), strip, (joint.h, top)) for n, strip in strips.items())
    return *pieces, *columns


def _faces(joint: Joint, pieces: tuple[Cuboid, ...]) -> Iterator[Rectangle]:
    index = {piece.name: i for i, piece in enumerate(pieces)}
    monolithic = joint.upper_body is UpperBody.MONOLITHIC
    plate = joint.hold_down.kind is Hold.PLATE
    laws = {kind: joint.material_of(kind) for kind in (Kind.INNER, Kind.DRY, Kind.PLATE)}
    between = laws[Kind.INNER]
    if joint.upper_body is UpperBody.JOINED:
        between = replace(
            between,
            normal_stiffness=JOINED * between.normal_stiffness,
            shear_stiffness=JOINED * between.shear_stiffness,
        )

    def face(
        kind: Kind, below: str, above: str, name: str = "", inner: FaceMaterial = between
    ) -> Rectangle:
        pair = index[below], index[above]
        law = {**laws, Kind.INNER: inner}[kind]
        return shared_face(name or f"{kind}-{below}-{above}", kind, law, pieces, pair)

    for lock in joint.numbers:
        foot, head = (Kind.DRY, Kind.INNER) if joint.is_upper(lock) else (Kind.INNER, Kind.DRY)
        body, inner = body_above(joint, lock), joint.inner_of(lock)
        yield face(foot, LOWER, lock_name(lock), inner=inner)
        yield face(head, lock_name(lock), body, inner=inner)
        if plate and not monolithic:
            yield face(Kind.PLATE, body, PLATE, f"plate-{body}")
    for lock in range(1, joint.locks):
        yield face(Kind.DRY, lock_name(lock), lock_name(lock + 1))
        if not monolithic:
            pair = body_above(joint, lock), body_above(joint, lock + 1)
            yield face(Kind.INNER, *pair)
    if plate and monolithic:
        yield face(Kind.PLATE, BODY, PLATE, "plate-body")


def shared_face(
    name: str, kind: Kind, material: FaceMaterial, pieces: tuple[Cuboid, ...], pair: tuple[int, int]
) -> Rectangle:
    """The rectangle in which the first of ``pair``, indices of pieces, touches the second.

    ValueError if they do not touch across a plane, to 1e-9 of their size.
    """
    first, second = pieces[pair[0]], pieces[pair[1]]
    low = [*map(max, first.low, second.low)]
    high = [*map(min, first.high, second.high)]
    near = CLOSE * max(high - low for low, high in zip(first.low, first.high, strict=True))
    touching = [k for k in range(3) if abs(first.high[k] - second.low[k]) <= near]
    sides = [k for k in range(3) if high[k] - low[k] > near]
    if len(touching) != 1 or len(sides) != 2:
        raise ValueError(f"{name}: {first.name} does not touch {second.name} from below")
    axis = touching[0]
    low[axis] = high[axis] = first.high[axis]
    corners = (low[0], low[1], low[2]), (high[0], high[1], high[2])
    return Rectangle(name, kind, material, *pair, axis, *corners)


@dataclass(frozen=True)
class LockWeight:
    """The shear on the inner face of one lock.

    ``weight``: resultant over the lock's strength. ``mean_shear_ratio``: mean magnitude of the
    shear stress over the cohesion. ``max_shear_ratio``: its largest value over the cohesion.
    ``shear_x_N`` and ``shear_y_N``: the resultant on the piece above the face.
    """

    lock: int
    block: str  # upper or lower
    weight: float
    mean_shear_ratio: float
    max_shear_ratio: float
    shear_x_N: float
    shear_y_N: float


def lock_weights(joint: Joint, assembly: Assembly, force: Floats) -> tuple[LockWeight, ...]:
    """Weights of all locks, by number.

    ``force``: (N, 3) in N, what the piece below each node exerts on the piece above, in the frame
    of the face. ValueError for a lock without cohesion.
    """
    shear = np.einsum("nt,ntx->nx", force[:, 1:], face_frames(assembly)[:, 1:])[:, :2]
    size = np.hypot(shear[:, 0], shear[:, 1])
    weights = []
    for lock, face in zip(joint.numbers, roots(joint, assembly), strict=True):
        nodes, cohesion = assembly.nodes.face == face, joint.inner_of(lock).cohesion
        require_positive(**{f"cohesion of lock {lock}": cohesion})
        x, y = (float(value) for value in shear[nodes].sum(axis=0))
        weights.append(
            LockWeight(
                lock,
                "upper" if joint.is_upper(lock) else "lower",
                float(np.hypot(x, y)) / joint.strength(lock),
                float(size[nodes].sum()) / joint.strength(lock),
                float((size[nodes] / assembly.nodes.area[nodes]).max()) / cohesion,
                x,
                y,
            )
        )
    return tuple(weights)
