"""Forces on each interface of a structure and motions of its blocks, from forces at nodes."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from sidmacib.mechanics.assembly import Assembly, Face, Floats, Kind
from sidmacib.mechanics.contact_law import ContactLaw, NodeState
from sidmacib.mechanics.contact_law.kernels import utilisation
from sidmacib.mechanics.crushing import crushing_use
from sidmacib.mechanics.polygons import hull_sides
from sidmacib.problem import AT_THE_LOAD, Outcome
from sidmacib.quantities import clean, rounded

ROUNDING = 1e-9  # of the largest node force: nodes below carry nothing
LEVERAGE = 1e-3  # of all normal forces: what they add up to, if they act anywhere
HINGE = 0.93  # eccentricity over the distance to the edge: a tenth of the depth is pressed, or less
SLIDES, CRUSHED = 0.99, 1.0 - 1e-4  # of what friction and the blocks' strength allow
ALONG = "force_x_N", "force_y_N", "force_z_N"
NEXT_TO_NOTHING = 0.01  # of the largest force of an interface, as in drawings


@dataclass(frozen=True)
class InterfaceRow:
    """An interface: its law, and the resultants (N, N m about its centroid) that it carries.

    ``normal_N``: compression, negative in tension; ``shear_N``: size of the resultant along the
    interface. ``torsion_Nm``: about its normal; ``bending_Nm``: size of the moment in its plane.
    ``eccentricity``: of the resultant from the centroid, over the distance to the edge that way: 1
    where it acts at the edge, near it in a hinge; None where it acts nowhere.
    ``utilisation``, 1 at failure: where any of it is bonded, shear or tension over strength at the
    bonded node that is used most; of a dry interface the larger of the eccentricity and of shear
    and torsion over what friction allows; of blocks with a compressive strength that of it, if it
    is larger; None without a strength to compare with. Forces at dry nodes are not unique,
    resultants are.
    ``mode``: open, closed, bonded, or how it gives way: crushed, hinge, slides, or the last two.
    ``bonded_share``: the part of its area that is bonded. ``fails_at``: part of the peak load at
    which its first bond fails; None if none does. ``force_x_N`` …: the resultant on the block
    above; ``at_x_m`` …: the point of the interface's plane through which it acts, torsion apart;
    None where compression and tension leave next to none of either.
    """

    interface: str
    kind: str
    area_m2: float
    friction: float
    cohesion_Pa: float
    tensile_strength_Pa: float
    normal_N: float
    shear_N: float
    torsion_Nm: float
    bending_Nm: float
    eccentricity: float | None
    utilisation: float | None
    mode: str
    bonded_share: float
    fails_at: float | None
    force_x_N: float
    force_y_N: float
    force_z_N: float
    at_x_m: float | None
    at_y_m: float | None
    at_z_m: float | None


def interface_forces(
    assembly: Assembly, force: Floats, state: NodeState | None = None
) -> tuple[InterfaceRow, ...]:
    """Resultants of each face of ``assembly`` under node forces, (N, 3) in N as in `Equilibrium`.

    ``state``: of the nodes; by default all bonds are whole.
    """
    law, area = ContactLaw.of(assembly), assembly.nodes.area
    limit = law.friction * force[:, 0]
    state = state or NodeState.initial(law.cohesive)
    used = np.where(state.bonded, utilisation(law, state, force), 0.0)
    nothing = ROUNDING * float(np.abs(force).max(initial=0.0))
    crushing = crushing_use(assembly, force)
    found = []
    for number, face in enumerate(assembly.faces):
        nodes = assembly.nodes.face == number
        places, on_nodes, material = assembly.nodes.position[nodes], force[nodes], face.material
        whole, middle = on_nodes.sum(axis=0), np.array(face.middle)
        moment = np.cross((places - middle) @ face.axes.T, on_nodes).sum(axis=0)
        normal, *shear = whole.tolist()
        bonded = float(area[nodes & state.bonded].sum() / area[nodes].sum())
        at, off, most = None, None, float(used[nodes].max())
        ways = "bonded" if bonded else "closed" if normal > nothing else "open"
        if abs(normal) > LEVERAGE * float(np.abs(pressing := force[nodes, 0]).sum()):
            at = pressing @ places / float(pressing.sum())
            outward, reach = hull_sides((face.corners - middle) @ face.axes[1:].T)
            off = float((outward @ (face.axes[1:] @ (at - middle)) / reach).max())
            if not bonded and normal > nothing:
                rubbing = _rubbing(face, places - at, on_nodes, limit[nodes], nothing)
                most = max(off, rubbing)
                slides = rubbing >= SLIDES and face.kind is not Kind.LOCKED  # locks carry shear
                gives = {"hinge": off >= HINGE, "slides": slides}
                ways = ", ".join(way for way, so in gives.items() if so) or ways
        if number in crushing:
            most = max(most, crushing[number])
            ways = "crushed" if crushing[number] >= CRUSHED else ways
        force_x, force_y, force_z = (whole @ face.axes).tolist()
        at_x, at_y, at_z = (None,) * 3 if at is None else at.tolist()
        found.append(
            InterfaceRow(
                interface=face.name,
                kind=str(face.kind),
                area_m2=rounded(face.area),
                friction=material.friction,
                cohesion_Pa=material.cohesion,
                tensile_strength_Pa=material.tensile_strength,
                normal_N=normal,
                shear_N=float(np.hypot(*shear)),
                torsion_Nm=float(moment[0]),
                bending_Nm=float(np.hypot(*moment[1:])),
                eccentricity=off,
                utilisation=most,
                mode=ways,
                bonded_share=bonded,
                fails_at=None,
                force_x_N=force_x,
                force_y_N=force_y,
                force_z_N=force_z,
                at_x_m=at_x,
                at_y_m=at_y,
                at_z_m=at_z,
            )
        )
    return tuple(found)


def _rubbing(face: Face, arms: Floats, force: Floats, limit: Floats, nothing: float) -> float:
    """Shear, and torsion about the point of action, over what friction allows.

    Both together on an ellipse, which is near what a face that slides and turns carries.
    ``arms``: of the nodes from there, m, (K, 3); ``force``: of the nodes, N, (K, 3); ``limit``: of
    their friction, N, (K,).
    """
    flat = arms @ face.axes[1:].T
    torsion = abs(float((flat[:, 0] * force[:, 2] - flat[:, 1] * force[:, 1]).sum()))
    lever = np.hypot(*flat.T)
    reach = float(lever.max())
    pairs = (
        (float(np.hypot(*force[:, 1:].sum(axis=0))), float(limit.sum()), nothing),
        (torsion, float((limit * lever).sum()), nothing * reach),
    )
    return math.hypot(
        *(
            (demand / limit if limit > 0.0 else math.inf) if demand > least else 0.0
            for demand, limit, least in pairs
        )
    )


OF_LAW = {"interface", "kind", "mode", "area_m2", "friction", "cohesion_Pa", "tensile_strength_Pa"}


@dataclass(frozen=True)
class BlockRow:
    """A block or a part of one: its weight, centroid (m), displacement (m) and rotation (rad).

    ``motion``: what its motion is, see `sidmacib.problem.Outcome`; None if there is none.
    """

    block: str
    fixed: bool
    weight_N: float
    x_m: float
    y_m: float
    z_m: float
    motion: str | None
    move: tuple[float, ...] = ()


def interfaces_of(assembly: Assembly, outcome: Outcome) -> tuple[InterfaceRow, ...]:
    """Resultants on each interface at the load of an ``outcome`` that counts; none without forces.

    ``assembly``: on the cells that the outcome is from.
    """
    force, bonded, peak = outcome.state.force, outcome.state.bonded, outcome.path[-1].load
    if force is None:
        return ()
    motion = outcome.motion if outcome.motion_kind == AT_THE_LOAD else outcome.state.motion
    turned = np.zeros((len(assembly.pieces), 3)) if motion is None else motion[:, 3:]
    turns = Rotation.from_rotvec(turned)
    state = None if bonded is None else NodeState.initial(bonded)
    failing = {face: load / peak for face, load in outcome.broken_at.items()}
    size = float(np.abs(force).max(initial=0.0))
    units = {"N": size, "Nm": size * assembly.length, "m": assembly.length}
    rows = []
    for number, row in enumerate(interface_forces(assembly, force, state)):
        numbers = {name: value for name, value in vars(row).items() if name not in OF_LAW}
        # Frames turn with the pieces below, see `sidmacib.mechanics.equilibrium.unbalanced_forces`.
        along = turns[assembly.faces[number].below].apply([numbers[name] for name in ALONG])
        numbers |= zip(ALONG, along.tolist(), strict=True)
        if assembly.faces[number].kind is Kind.LOCKED or not math.isfinite(row.utilisation or 0.0):
            numbers["utilisation"] = None  # no strength in shear along locks, or none at all
        for name, value in numbers.items():
            if value is not None:
                numbers[name] = _clean(value, units.get(name.rpartition("_")[2], 1.0))
        if failing.get(number, math.inf) <= 1.0:
            numbers["fails_at"] = rounded(failing[number])
        rows.append(replace(row, **numbers))
    return tuple(rows)


def block_rows(assembly: Assembly, outcome: Outcome) -> tuple[BlockRow, ...]:
    """Weight, centroid and motion of each piece."""
    moves: Sequence[Any] = [()] * len(assembly.pieces)
    if outcome.motion is not None:
        size = float(np.abs(outcome.motion).max(initial=0.0)) or 1.0
        moves = [tuple(_clean(each, size) for each in row) for row in outcome.motion.tolist()]
    rows = []
    for piece, move in zip(assembly.pieces, moves, strict=True):
        x, y, z = (_clean(each, assembly.length) for each in piece.centre.tolist())
        weight = rounded(piece.weight)
        rows.append(BlockRow(piece.name, piece.fixed, weight, x, y, z, outcome.motion_kind, move))
    return tuple(rows)


def _clean(value: float, size: float) -> float:
    """``value`` without the noise of processors: to 1e-7 of ``size``."""
    return clean(value, 1e-7 * (size or 1.0))


def most_used(interfaces: Iterable[InterfaceRow]) -> str | None:
    """The interface with the largest utilisation among those that carry a force.

    What carries next to nothing may be at its limit without a meaning. None where all are dry: at
    their peak several slide or turn.
    """
    interfaces = tuple(interfaces)
    if not any(each.bonded_share for each in interfaces):
        return None
    carried = [math.hypot(each.normal_N, each.shear_N) for each in interfaces]
    least = NEXT_TO_NOTHING * max(carried, default=0.0)
    loaded = [each for each, force in zip(interfaces, carried, strict=True) if force > least]
    most = max(loaded, key=lambda each: each.utilisation or 0.0, default=None)
    return most.interface if most and most.utilisation else None
