"""The checked result of a structure: loads, forces on interfaces and motions of blocks."""

import dataclasses
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sidmacib.mechanics.assembly import Assembly, Floats, Kind
from sidmacib.mechanics.contact_law import Flags, NodeState
from sidmacib.mechanics.equilibrium import unbalanced_share
from sidmacib.models.found import Found
from sidmacib.outcome import State
from sidmacib.problem import Problem
from sidmacib.structure.analysis.forces import interface_forces
from sidmacib.structure.loads import free_weight
from workflow.joints.case import CaseId
from workflow.results.files import read_lines
from workflow.results.record import ResultError, check_balance, check_loads, rounded
from workflow.structures.case import FOLDER, StructureCase


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

    ``motion``: what its motion is, see `sidmacib.models.found`; None if there is none.
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
class StructureRecord:
    """The result of a case; loads as in `workflow.results.record.CaseRecord`.

    ``tilts``: whether gravity turns; loads are then the angle in radians times the weight.
    ``load_N`` is the load that ``counts``, the peak or the first failure, and ``because`` says why;
    both are None where the model does not say, and its last load stands there.
    ``given_peak_N`` and ``given_first_failure_N``: on the cells of the file, where the rest is from
    smaller ones. ``mesh_error``: of the load, over it, and ``first_failure_mesh_error``; None where
    no other mesh was solved. ``first_interface``: whose bond fails first. ``refused``: why the
    model cannot do the structure, or that it never falls, ``error``: why there is no result; all
    numbers are None in both.
    """

    model: str
    structure: str
    load: str
    variant: str
    name: str
    case_digest: str
    physics: str
    tilts: bool = False
    load_N: float | None = None
    peak_N: float | None = None
    counts: str | None = None
    because: str | None = None
    weight_N: float | None = None
    failed_load_N: float | None = None
    first_failure_load_N: float | None = None
    given_peak_N: float | None = None
    given_first_failure_N: float | None = None
    first_interface: str | None = None
    mode: str | None = None
    peak_spread: float | None = None
    mesh_error: float | None = None
    first_failure_mesh_error: float | None = None
    unbalanced_share: float | None = None
    nodes: int | None = None
    interfaces: tuple[InterfaceRow, ...] = ()
    blocks: tuple[BlockRow, ...] = ()
    path: tuple[tuple[float, float | None], ...] = ()
    versions: dict[str, str] = dataclasses.field(default_factory=dict)
    refused: str | None = None
    error: str | None = None

    @property
    def id(self) -> CaseId:
        """The identity of the case."""
        return CaseId(self.model, f"{FOLDER}/{self.name}")

    def to_json(self) -> str:
        """One line of JSON."""
        return json.dumps(asdict(self))

    @classmethod
    def from_json(cls, text: str) -> "StructureRecord":
        """The record that `to_json` wrote; `ResultError` if ``text`` is anything else."""
        try:
            data = json.loads(text)
            data["interfaces"] = tuple(InterfaceRow(**each) for each in data["interfaces"])
            blocks = [{**each, "move": tuple(each["move"])} for each in data["blocks"]]
            data["blocks"] = tuple(BlockRow(**each) for each in blocks)
            data["path"] = tuple((load, moved) for load, moved in data["path"])
            return cls(**data)
        except (ValueError, TypeError, KeyError, RecursionError) as error:
            raise ResultError(f"not a structure's record: {error}") from None


def record_without_result(
    case: StructureCase, *, refused: str | None = None, error: str | None = None
) -> StructureRecord:
    """The record of a case that the model refuses, or that ended without a result."""
    return StructureRecord(**_identity(case), refused=_in_a_line(refused), error=_in_a_line(error))


def structure_record(
    case: StructureCase, problem: Problem, found: Found, versions: dict[str, str]
) -> StructureRecord:
    """The record of what was ``found``; `ResultError` where that cannot be a result of ``case``."""
    assembly, loads = found.cells or problem.assembly, problem.loads
    outcome, state, counts = found.outcome, found.state, found.counts
    check_loads(outcome)
    balance = None
    interfaces: tuple[InterfaceRow, ...] = ()
    if state.force is not None:
        if not np.isfinite(state.force).all():
            raise ResultError("a stress is not a finite number")
        balance = unbalanced_share(assembly, loads, state.load, state.force)
        check_balance(balance, state.load, loads)
        failing = {face: load / outcome.path[-1].load for face, load in found.broken_at.items()}
        interfaces = interface_rows(assembly, state, state.force, failing)
    given = found.given
    errors = found.mesh_errors
    return StructureRecord(
        **_identity(case),
        tilts=loads.axis is not None,
        load_N=rounded(state.load),
        peak_N=_rounded(outcome.peak_load),
        counts=None if counts is None else counts.name,
        because=None if counts is None else counts.why,
        weight_N=rounded(free_weight(assembly)),
        failed_load_N=rounded(outcome.failed_load),
        first_failure_load_N=_rounded(outcome.first_failure_load),
        given_peak_N=given and _rounded(given.peak),
        given_first_failure_N=given and _rounded(given.first),
        first_interface=_name(assembly, next(iter(found.broken_at), None)),
        mode=outcome.mode,
        peak_spread=outcome.peak_spread,
        mesh_error=errors.peak if counts is None or counts.peak else errors.first,
        first_failure_mesh_error=errors.first,
        unbalanced_share=None if balance is None else float(f"{balance:.1e}"),
        nodes=len(assembly.nodes.area),
        interfaces=interfaces,
        blocks=block_rows(assembly, found),
        path=tuple((rounded(each.load), _rounded(each.displacement)) for each in outcome.path),
        versions=versions,
    )


def interface_rows(
    assembly: Assembly, at: State, force: Floats, failing: Mapping[int, float]
) -> tuple[InterfaceRow, ...]:
    """Resultants on each interface from node forces, (N, 3) in N in the frame of its face.

    ``failing``: the part of the peak at which the first bond of a face fails, by its index.
    """
    state = None if at.bonded is None else _state(at.bonded)
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


def block_rows(assembly: Assembly, found: Found) -> tuple[BlockRow, ...]:
    """Weight, centroid and motion of each piece."""
    moves: Sequence[Any] = [()] * len(assembly.pieces)
    if found.motion is not None:
        size = float(np.abs(found.motion).max(initial=0.0)) or 1.0
        moves = [tuple(_clean(each, size) for each in row) for row in found.motion.tolist()]
    rows = []
    for piece, move in zip(assembly.pieces, moves, strict=True):
        x, y, z = (_clean(each, assembly.length) for each in piece.centre.tolist())
        weight = rounded(piece.weight)
        rows.append(BlockRow(piece.name, piece.fixed, weight, x, y, z, found.kind, move))
    return tuple(rows)


def read_structure_records(paths: Sequence[Path]) -> list[StructureRecord]:
    """All records in files that hold one per line; `ResultError` names the file and line."""
    return read_lines(paths, StructureRecord.from_json)


def _identity(case: StructureCase) -> dict[str, Any]:
    return {
        "model": case.model,
        "structure": case.structure,
        "load": case.load,
        "variant": case.variant,
        "name": case.name,
        "case_digest": case.digest(),
        "physics": case.physics(),
    }


def _in_a_line(reason: str | None) -> str | None:
    return None if reason is None else " ".join(reason.split())


def _state(bonded: Flags) -> NodeState:
    return NodeState(np.zeros((len(bonded), 2)), bonded.astype(float))


def _share(of_peak: float | None) -> float | None:
    return None if of_peak is None or of_peak > 1.0 else rounded(of_peak)


def _rounded(value: float | None) -> float | None:
    return None if value is None else rounded(value)


def _name(assembly: Assembly, face: int | None) -> str | None:
    return None if face is None else assembly.faces[face].name


def _clean(value: float, size: float) -> float:
    """``value`` without the noise of processors: to 1e-7 of ``size``."""
    unit = 1e-7 * (size or 1.0)
    return rounded(round(value / unit) * unit)
