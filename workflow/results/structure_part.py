"""The part of a record that only structures have: interfaces and blocks, and what counts."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sidmacib.mechanics.assembly import Assembly, Floats, Kind, Loads
from sidmacib.mechanics.contact_law import NodeState
from sidmacib.problem import Outcome, State
from sidmacib.structure.analysis.forces import interface_forces
from sidmacib.structure.loads import free_weight
from workflow.case import StructureCase
from workflow.results.record import Record, clean, rounded


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


@dataclass(frozen=True)
class StructurePart:
    """The names of a structure's case, which load counts, and interfaces and blocks.

    ``tilts``: whether gravity turns. ``counts``: which load does, the peak or the first failure,
    and ``because`` says why; both are None where the model does not say. ``given_peak_N`` and
    ``given_first_failure_N``: on the cells of the file, where the rest is from smaller ones.
    ``mesh_error``: of the load that counts, over it, and ``first_failure_mesh_error``; None where
    no other mesh was solved. ``first_interface``: whose bond fails first.
    """

    structure: str
    load: str
    tilts: bool = False
    counts: str | None = None
    because: str | None = None
    weight_N: float | None = None
    given_peak_N: float | None = None
    given_first_failure_N: float | None = None
    first_interface: str | None = None
    mesh_error: float | None = None
    first_failure_mesh_error: float | None = None
    nodes: int | None = None
    interfaces: tuple[InterfaceRow, ...] = ()
    blocks: tuple[BlockRow, ...] = ()

    @classmethod
    def without_result(cls, case: StructureCase) -> "StructurePart":
        """The names of ``case``."""
        return cls(case.subject.structure, case.subject.load)

    @classmethod
    def of(
        cls, case: StructureCase, assembly: Assembly, loads: Loads, outcome: Outcome
    ) -> "StructurePart":
        """The names of ``case``, and what its outcome says."""
        state, counts, given = outcome.state, outcome.counts, outcome.given
        errors = outcome.mesh_errors
        interfaces: tuple[InterfaceRow, ...] = ()
        if state.force is not None:
            peak = outcome.path[-1].load
            failing = {face: load / peak for face, load in outcome.broken_at.items()}
            interfaces = interface_rows(assembly, state, state.force, failing)
        return replace(
            cls.without_result(case),
            tilts=loads.axis is not None,
            counts=None if counts is None else counts.name,
            because=None if counts is None else counts.why,
            weight_N=rounded(free_weight(assembly)),
            given_peak_N=given and rounded(given.peak),
            given_first_failure_N=given and rounded(given.first),
            first_interface=next((assembly.faces[face].name for face in outcome.broken_at), None),
            mesh_error=errors.peak if counts is None or counts.peak else errors.first,
            first_failure_mesh_error=errors.first,
            nodes=len(assembly.nodes.area),
            interfaces=interfaces,
            blocks=block_rows(assembly, outcome),
        )

    @staticmethod
    def balance(share: float) -> float:
        """The unbalanced ``share`` without the noise of processors."""
        return float(f"{share:.1e}")


PART = StructurePart
StructureRecord = Record[StructurePart]


def interface_rows(
    assembly: Assembly, at: State, force: Floats, failing: Mapping[int, float]
) -> tuple[InterfaceRow, ...]:
    """Resultants on each interface from node forces, (N, 3) in N in the frame of its face.

    ``failing``: the part of the peak at which the first bond of a face fails, by its index.
    """
    bonded = at.bonded
    state = None if bonded is None else NodeState(np.zeros((len(bonded), 2)), bonded.astype(float))
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
