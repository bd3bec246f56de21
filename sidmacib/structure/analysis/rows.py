"""Rows of the interfaces and blocks of a structure: what a model says of each."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sidmacib.mechanics.assembly import Assembly, Kind
from sidmacib.mechanics.contact_law import NodeState
from sidmacib.problem import Outcome
from sidmacib.quantities import clean, rounded
from sidmacib.structure.analysis.forces import interface_forces

NEXT_TO_NOTHING = 0.01  # of the largest force of an interface, as in drawings


@dataclass(frozen=True)
class InterfaceRow:
    """An interface: its law, and the resultants (N, N m about its centroid) that it carries.

    ``normal_N``: compression positive. ``torsion_Nm``: about its normal; ``bending_Nm``: size of
    the moment in its plane. ``eccentricity`` and ``utilisation``: see `InterfaceForce`; None where
    there is no point of action, or no strength to compare with. ``bonded_share``: the part of its
    area that is bonded. ``fails_at``: part of the peak load at which its first bond fails; None if
    none does. ``force_x_N`` …: the resultant on the block above; ``at_x_m`` …: the point of the
    interface's plane through which it acts; None where none does.
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
    bonded_share: float
    fails_at: float | None
    force_x_N: float
    force_y_N: float
    force_z_N: float
    at_x_m: float | None
    at_y_m: float | None
    at_z_m: float | None


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
    state = None
    if bonded is not None:
        state = NodeState(np.zeros((len(bonded), 2)), bonded.astype(float))
    failing = {face: load / peak for face, load in outcome.broken_at.items()}
    size = float(np.abs(force).max(initial=0.0))
    rows = []
    for number, each in enumerate(interface_forces(assembly, force, state)):
        face, at_face = assembly.faces[number], assembly.nodes.face == number
        arms = assembly.nodes.position[at_face] - np.array(face.middle)
        moment = np.cross(arms @ face.axes.T, force[at_face]).sum(axis=0)
        law, shear_only = face.material, face.kind is Kind.LOCKED
        used = None if shear_only or not math.isfinite(each.utilisation) else each.utilisation
        rows.append(
            InterfaceRow(
                interface=each.name,
                kind=str(face.kind),
                area_m2=rounded(face.area),
                friction=law.friction,
                cohesion_Pa=law.cohesion,
                tensile_strength_Pa=law.tensile_strength,
                normal_N=_clean(each.normal, size),
                shear_N=_clean(each.shear, size),
                torsion_Nm=_clean(float(moment[0]), size * assembly.length),
                bending_Nm=_clean(float(np.hypot(*moment[1:])), size * assembly.length),
                eccentricity=None if each.eccentricity is None else _clean(each.eccentricity, 1.0),
                utilisation=None if used is None else _clean(used, 1.0),
                bonded_share=_clean(each.bonded, 1.0),
                fails_at=_share(failing.get(number)),
                force_x_N=_clean(each.resultant[0], size),
                force_y_N=_clean(each.resultant[1], size),
                force_z_N=_clean(each.resultant[2], size),
                at_x_m=_clean(each.at[0], assembly.length) if each.at else None,
                at_y_m=_clean(each.at[1], assembly.length) if each.at else None,
                at_z_m=_clean(each.at[2], assembly.length) if each.at else None,
            )
        )
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


def _share(of_peak: float | None) -> float | None:
    return None if of_peak is None or of_peak > 1.0 else rounded(of_peak)


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
    carried = {each: math.hypot(each.normal_N, each.shear_N) for each in interfaces}
    least = NEXT_TO_NOTHING * max(carried.values(), default=0.0)
    used = {
        each.interface: each.utilisation
        for each, force in carried.items()
        if each.utilisation and force > least
    }
    return max(used, key=lambda name: used[name]) if used else None
