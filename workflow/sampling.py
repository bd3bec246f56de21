"""Samplings: joints that fill spans of their parameters evenly, by a seeded Sobol sequence.

A job solves a batch of them in all directions, on two meshes; another joins the batches into a
table: one row for each joint and direction, loads over T0.

Any part of a sampling can be made alone, so batches do not depend on each other. Sizes are relative
to the width b of a lock, stiffnesses to the normal stiffness of inner faces, pressures to the
cohesion: first failures over T0 depend on nothing else except the weight, which is small, where
blocks hardly move, as on faces so stiff as these.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np
import pandas as pd
from scipy.stats import qmc

from sidmacib.errors import CapacityError, ResultError
from sidmacib.joint import Direction, HoldDown, Joint, UpperBody
from sidmacib.joint.loading import Loading, Push
from sidmacib.joint.parameters import with_parameters
from sidmacib.mechanics.assembly import Elastic, Failure, NodeLayout
from sidmacib.models import limit, static
from sidmacib.validation import dataclass_from
from workflow.case import REFERENCE, Case, JointSubject, case_name
from workflow.results.joint_part import JointRecord
from workflow.results.tables import SAMPLINGS, write_table
from workflow.schema.sections import SamplingSection
from workflow.solve import solved
from workflow.step import Arguments, FileLists, Files, step

Limits = tuple[float, float]
DIMENSIONS = 13
POISSON = 0.2
HARDLY = 1e-6  # cohesion over (Kn b), at most: so that blocks hardly move before they fail
BELOW = 0.999  # of a side: a mesh must be less than the side
# Without the spread of the static model's peaks, which would take longer than all else.
SOLVED = {"static": static.solve_once, "limit": limit.solve}


@dataclass(frozen=True)
class SampledJoint:
    """A joint of a sampling: its number from 0, and the direction of the push."""

    number: int
    joint: Joint
    push: Push


def sampled_joints(
    sampling: SamplingSection, base: Joint, start: int, stop: int
) -> Iterator[SampledJoint]:
    """The joints of ``sampling`` from ``start`` to before ``stop``, otherwise like ``base``."""
    sequence = qmc.Sobol(DIMENSIONS, scramble=True, rng=np.random.default_rng(sampling.seed))
    places = sequence.random_base2(math.ceil(math.log2(sampling.joints)))  # these are balanced
    for number in range(start, min(stop, sampling.joints)):
        yield _joint(sampling, base, number, places[number].tolist())


def joints_of(arguments: Mapping[str, Any]) -> Iterator[SampledJoint]:
    """The joints of a job's batch, from ``start`` to before ``stop``."""
    sampling = SamplingSection.model_validate_json(arguments["sampling"])
    base = dataclass_from(Joint, arguments["base"])
    return sampled_joints(sampling, base, arguments["start"], arguments["stop"])


def _joint(sampling: SamplingSection, base: Joint, number: int, place: list[float]) -> SampledJoint:
    turn = iter(place)

    def ratio(span: Limits) -> float:
        return _between(span, next(turn))

    def part(share: float) -> bool:
        return next(turn) < share

    least, most = sampling.locks
    locks = min(int(least * ((most + 1) / least) ** next(turn)), most)
    spans = (
        *(sampling.a_over_b, sampling.h_over_b, sampling.H_over_b),
        *(sampling.shear_over_normal, sampling.dry_over_inner),
    )
    a, h, height, shear, dry = (ratio(span) for span in spans)
    rough = next(turn)
    low, largest = sampling.friction
    spread = max(rough - sampling.smooth, 0.0) / (1.0 - sampling.smooth or 1.0)
    friction = 0.0 if rough < sampling.smooth else low + spread * (largest - low)
    one_piece, pressed = part(sampling.one_piece), part(sampling.pressed)
    pressure = base.inner.cohesion * ratio(sampling.pressure_over_cohesion)
    push = Push.MINUS_Y if part(0.5) and locks % 2 == 0 else Push.PLUS_Y
    last = next(turn)
    sized = with_ratios(base, a, h, height, shear, dry, friction)
    energy, elastic = 0.0, None
    if sampling.failure is Failure.SOFTENING:
        energy_ratio = _between(sampling.energy_ratio, last)
        energy = energy_ratio * base.inner.cohesion**2 / (2.0 * sized.inner.shear_stiffness)
    if sampling.stiffness_ratio is not None:
        stiffness = _between(sampling.stiffness_ratio, last)
        elastic = Elastic(stiffness * sized.inner.normal_stiffness * base.b, POISSON)
    joint = replace(
        sized,
        locks=locks,
        inner=replace(sized.inner, fracture_energy=energy),
        failure=sampling.failure,
        upper_body=UpperBody.MONOLITHIC if one_piece else UpperBody.COLUMNS,
        hold_down=HoldDown.pressure(pressure) if pressed else HoldDown.plate(),
        elastic=elastic,
    )
    return SampledJoint(number, joint, push)


def with_ratios(
    base: Joint, a: float, h: float, height: float, shear: float, dry: float, friction: float
) -> Joint:
    """``base`` with other ratios: a, h and H over b, inner Ks and dry stiffness over inner Kn.

    Inner Kn is at least that of blocks that hardly move.
    """
    normal = max(base.inner.normal_stiffness, base.inner.cohesion / (HARDLY * base.b))
    ratios = {
        "normal_stiffness": normal,
        "a": base.b * a,
        "h": base.b * h,
        "H": base.b * height,
        "shear_stiffness": normal * shear,
        "dry_stiffness": normal * dry,
        "friction": friction,
    }
    return with_parameters(base, ratios)


def _between(span: Limits, place: float) -> float:
    """The value at ``place``, 0 to 1, of a ``span`` that is spread evenly in its logarithm."""
    low, high = np.log(span)
    return float(np.exp(low + place * (high - low)))


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
    """The joint's parameters; ratios as in `workflow.schema.sections.SamplingSection`."""
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
    loading = Loading(Direction(ratio), push=one.push)
    subject = JointSubject(name, joint, mesh, NodeLayout.LOBATTO, loading)
    case = Case(case_name(name, mesh, ratio), model, REFERENCE, subject, None)
    return solved(case, SOLVED[model])[0]


def _loads(joint: Joint, coarse: JointRecord, fine: JointRecord) -> dict[str, Any]:
    """First failure and peak on the finer mesh, over T0, with their mesh errors, and weights."""
    assert coarse.load_N and fine.load_N and fine.first_failure_load_N is not None
    assert coarse.first_failure_load_N is not None
    weights = fine.part.weights
    return {
        "first_failure": fine.first_failure_load_N / joint.T0,
        "peak": fine.load_N / joint.T0,
        "first_failure_mesh_error": coarse.first_failure_load_N / fine.first_failure_load_N - 1.0,
        "peak_mesh_error": coarse.load_N / fine.load_N - 1.0,
        "mode": fine.mode,
        "unbalanced_share": fine.unbalanced_share,
        "weight_sum": math.fsum(each.weight for each in weights),
        "lower_weight_sum": math.fsum(e.weight for e in weights if e.block == "lower"),
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
