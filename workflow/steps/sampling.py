"""Solve a batch of a sampling's joints in all directions, on two meshes, and write their rows.

Then join the batches of all samplings: one row for each joint and direction, loads over T0.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from sidmacib.errors import CapacityError, ResultError
from sidmacib.joint.joint import Direction, Joint
from sidmacib.joint.loading import Loading
from sidmacib.mechanics.assembly import NodeLayout
from sidmacib.models import limit, static
from workflow.case import REFERENCE, Case, JointSubject, case_name
from workflow.results.joint_part import JointRecord
from workflow.results.tables import SAMPLINGS, write_table
from workflow.sampling import SampledJoint, joints_of
from workflow.step import Arguments, FileLists, Files, step
from workflow.steps.solve import solved

BELOW = 0.999  # of a side: a mesh must be less than the side
# Without the spread of the static model's peaks, which would take longer than all else.
SOLVED = {"static": static.solve_once, "limit": limit.solve}


def run(arguments: Arguments, inputs: Files, outputs: Files) -> None:
    """Write the rows of a batch."""
    asked = (arguments[key] for key in ("eccentricities", "cells", "limited"))
    rows = pd.DataFrame(solved_rows(joints_of(arguments), *asked))
    rows.insert(0, "sampling", arguments["name"])
    rows.to_parquet(outputs["joints"], compression="zstd")


def solved_rows(
    joints: Iterable[SampledJoint],
    eccentricities: Sequence[float],
    cells: Sequence[int],
    limited: int,
) -> Iterator[dict[str, Any]]:
    """Parameters and loads over T0 of each joint along each direction e / a.

    ``cells``: numbers of cells along the shorter side of a lock, on two meshes, from which the mesh
    error is found. Every ``limited``-th joint is solved by limit analysis too, on the coarser mesh.
    """
    for one, ratio in product(joints, map(float, eccentricities)):
        row: dict[str, Any] = {**parameters(one), "eccentricity_over_a": ratio, "error": None}
        try:
            coarse, fine = (_record(one, ratio, count, "static") for count in cells)
            row |= _loads(one.joint, coarse, fine)
            if one.number % limited == 0:
                load = _record(one, ratio, cells[0], "limit").load_N
                row["limit"] = None if load is None else load / one.joint.T0
        except (CapacityError, ResultError, ValueError) as error:
            row["error"] = str(error)
        yield row


def parameters(one: SampledJoint) -> dict[str, Any]:
    """The joint's parameters; ratios as in `workflow.sampling.Sampling`."""
    joint, inner = one.joint, one.joint.inner
    stored = inner.cohesion**2 / (2.0 * inner.shear_stiffness)
    return {
        "number": one.number,
        "locks": joint.locks,
        "push": str(one.push),
        "upper_body": str(joint.upper_body),
        "failure": str(joint.failure),
        "a_over_b": joint.a / joint.b,
        "h_over_b": joint.h / joint.b,
        "H_over_b": joint.H / joint.b,
        "shear_over_normal": inner.shear_stiffness / inner.normal_stiffness,
        "dry_over_inner": joint.dry.normal_stiffness / inner.normal_stiffness,
        "friction": joint.dry.friction,
        "pressure_over_cohesion": joint.hold_down.amount / inner.cohesion,
        "plate": joint.pressing_force is None,
        "stiffness_ratio": joint.stiffness_ratio,
        "energy_ratio": inner.fracture_energy / stored,
    }


def _record(one: SampledJoint, ratio: float, cells: int, model: str) -> JointRecord:
    """The checked result of a model, on a mesh of so many cells along the shorter side."""
    joint, mesh = one.joint, BELOW * one.joint.least_side / cells
    name = f"d{one.number}"
    case = Case(
        name=case_name(name, mesh, ratio),
        model=model,
        variant=REFERENCE,
        subject=JointSubject(
            sample=name,
            joint=joint,
            mesh=mesh,
            nodes=NodeLayout.LOBATTO,
            loading=Loading(Direction(ratio), push=one.push),
        ),
        numerics=None,
    )
    return solved(case, SOLVED[model])[0]


def _loads(joint: Joint, coarse: JointRecord, fine: JointRecord) -> dict[str, Any]:
    """First failure and peak on the finer mesh, over T0, with their mesh errors, and weights."""
    assert coarse.load_N and fine.load_N and fine.first_failure_load_N is not None
    assert coarse.first_failure_load_N is not None
    weights = [asdict(each) for each in fine.part.weights]
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


def samplings_table(batches: Sequence[pd.DataFrame]) -> pd.DataFrame:
    """The rows of all ``batches``."""
    table = pd.concat(batches, ignore_index=True).reindex(columns=SAMPLINGS.columns)
    table["stiffness_ratio"] = table["stiffness_ratio"].replace(np.inf, np.nan)  # rigid pieces
    return table


def join_batches(arguments: Arguments, inputs: FileLists, outputs: Files) -> None:
    """Put the batches of all samplings together."""
    table = samplings_table([*map(pd.read_parquet, inputs["batches"])])
    write_table(SAMPLINGS, table, outputs["samplings"])


if __name__ == "__main__":
    step(run, samplings=join_batches)
