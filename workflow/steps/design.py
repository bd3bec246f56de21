"""Solve a batch of a design's joints in all directions, on two meshes, and write rows of them."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from sidmacib.errors import CapacityError
from sidmacib.joint import Direction, Joint
from sidmacib.loading import Loading
from sidmacib.mechanics.assembly import NodeLayout
from workflow.case import REFERENCE, Case, case_name
from workflow.design import Designed
from workflow.results.record import CaseRecord, ResultError
from workflow.solvers import limit, static
from workflow.steps.joints import write_rows
from workflow.steps.solve import solved

WHOLE = 0.999  # of a side: a mesh must be less than it
# The static model without the spread of its peaks, which would take longer than all else.
SOLVED = {"static": static.solve_once, "limit": limit.solve}


def run(
    arguments: Mapping[str, Any], inputs: Mapping[str, Path], outputs: Mapping[str, Path]
) -> None:
    """Write the rows of the joints from ``start`` to before ``stop``."""
    write_rows(arguments, joint_rows, outputs["joints"])


def joint_rows(
    one: Designed, eccentricities: Sequence[float], cells: Sequence[int], limited: int
) -> Iterator[dict[str, Any]]:
    """What one joint is, and carries along each direction e / a; loads over T0.

    ``cells``: along the shorter side of a lock, on two meshes, which tell the mesh error. Every
    ``limited`` th joint has limit analysis too, on the coarser one.
    """
    told = parameters(one)
    for ratio in map(float, eccentricities):
        row: dict[str, Any] = {**told, "eccentricity_over_a": ratio, "error": None}
        try:
            coarse, fine = (_record(one, ratio, count, "static") for count in cells)
            row |= _loads(one.joint, coarse, fine)
            if one.number % limited == 0:
                load = _record(one, ratio, cells[0], "limit").load_N
                row["limit"] = None if load is None else load / one.joint.T0
        except (CapacityError, ResultError, ValueError) as error:
            row["error"] = str(error)
        yield row


def parameters(one: Designed) -> dict[str, Any]:
    """The joint's parameters; ratios are those of `workflow.design.Design`."""
    joint, law = one.joint, one.joint.inner
    stored = law.cohesion**2 / (2.0 * law.shear_stiffness)
    return {
        "number": one.number,
        "locks": joint.locks,
        "push": str(one.push),
        "upper_body": str(joint.upper_body),
        "failure": str(joint.failure),
        "a_over_b": joint.a / joint.b,
        "h_over_b": joint.h / joint.b,
        "H_over_b": joint.H / joint.b,
        "shear_over_normal": law.shear_stiffness / law.normal_stiffness,
        "dry_over_inner": joint.dry.normal_stiffness / law.normal_stiffness,
        "friction": joint.dry.friction,
        "pressure_over_cohesion": joint.hold_down.amount / law.cohesion,
        "plate": joint.pressing_force is None,
        "stiffness_ratio": joint.stiffness_ratio,
        "energy_ratio": law.fracture_energy / stored,
    }


def _record(one: Designed, ratio: float, cells: int, model: str) -> CaseRecord:
    """The checked result of a model, on a mesh of so many cells along the shorter side."""
    joint, mesh = one.joint, WHOLE * one.joint.least_side / cells
    name = f"d{one.number}"
    case = Case(
        name=case_name(name, mesh, ratio),
        model=model,
        variant=REFERENCE,
        sample=name,
        joint=joint,
        mesh=mesh,
        nodes=NodeLayout.LOBATTO,
        loading=Loading(Direction(ratio), push=one.push),
        numerics=None,
    )
    return solved(case, SOLVED[model])[0]


def _loads(joint: Joint, coarse: CaseRecord, fine: CaseRecord) -> dict[str, Any]:
    """First failure and peak on the finer mesh, over T0, with their mesh errors, and weights."""
    assert coarse.load_N and fine.load_N and fine.first_failure_load_N is not None
    assert coarse.first_failure_load_N is not None
    weights = [asdict(each) for each in fine.weights]
    return {
        "first_failure": fine.first_failure_load_N / joint.T0,
        "peak": fine.load_N / joint.T0,
        "first_failure_mesh_error": coarse.first_failure_load_N / fine.first_failure_load_N - 1.0,
        "peak_mesh_error": coarse.load_N / fine.load_N - 1.0,
        "mode": fine.mode,
        "unbalanced_share": fine.unbalanced_share,
        "weight_sum": math.fsum(each["weight"] for each in weights),
        "lower_weight_sum": math.fsum(e["weight"] for e in weights if e["block"] == "lower"),
    }
