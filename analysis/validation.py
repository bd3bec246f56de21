"""Computed values beside the published ones."""

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from analysis.fit import winner
from analysis.published import Published, read_published
from analysis.pure_shear import pure_shear_weights
from workflow.case import REFERENCE, case_name
from workflow.models import LAWS, first_failure_only
from workflow.results.tables import CAPACITY, FIT, VALIDATION, WEIGHTS, read_table, write_table
from workflow.schema import Study

SWAPPED = "published value of the other of the first two locks, see docs/validation.md"


def validation_table(
    study: Study,
    capacity: pd.DataFrame,
    weights: pd.DataFrame,
    fit: pd.DataFrame,
    published: Published,
) -> pd.DataFrame:
    """One row for each published number that the study can be compared with."""
    # Published are peaks of the pieces.
    short = [name for name in study.model_names if first_failure_only(name)]
    short += LAWS
    rows: list[dict[str, Any]] = []
    for sample in published.samples(study):
        joint = study.joint(sample)
        pure_shear = [case_name(sample, mesh, 0.0) for mesh in study.meshes]
        own = capacity[capacity["case"].isin(pure_shear) & capacity["load_N"].notna()]
        own = own[~own["model"].isin(short)]
        read = pure_shear_weights(study, weights, sample)
        read = {source: each for source, each in read.items() if source[0] not in short}
        found = [
            *_limit_rows(own, published.numbers["limit_pure_shear"][joint.locks]),
            *_peak_rows(own, joint.locks, published),
            *_weight_rows(read, joint.locks, published),
            *_option_rows(fit, sample, published.numbers["best_option"]),
        ]
        setting = "as printed" if published.as_printed(study, sample) else "not as printed"
        same = {"sample": sample, "locks": joint.locks, "friction": joint.dry.friction}
        rows += [{**same, "setting": setting, **row} for row in found]
    table = pd.DataFrame(rows, columns=list(VALIDATION.columns))
    # The number of an option is a name: no difference.
    quantities = table["quantity"] != "best_option"
    table["absolute_difference"] = (table["computed"] - table["published"]).where(quantities)
    table["relative_difference"] = table["absolute_difference"] / table["published"].where(
        table["published"] != 0.0
    )
    return table


def _limit_rows(own: pd.DataFrame, value: float) -> Iterator[dict[str, Any]]:
    rows = own[(own["model"] == "sidmacib") & (own["reduction"] == "none")]
    for row in rows.drop_duplicates("variant").itertuples():
        name = (
            f"sidmacib_pure_shear_{row.option}_{'friction' if row.friction else 'frictionless'}_N"
        )
        yield {
            "quantity": name,
            "model": "sidmacib",
            "published": value,
            "computed": row.shear_N,
        }


def _peak_rows(own: pd.DataFrame, locks: int, published: Published) -> Iterator[dict[str, Any]]:
    peaks = own[(own["variant"] == REFERENCE)]
    for row in peaks.itertuples():
        value = published.dem_pure_shear(locks, float(row.mesh_m))
        if value is not None:
            yield {
                "quantity": "dem_pure_shear_N",
                "model": row.model,
                "mesh_m": row.mesh_m,
                "published": value,
                "computed": row.shear_N,
                "mesh_error": row.mesh_error,
            }


def _weight_rows(
    read: dict[tuple[str, float], list[float]], locks: int, published: Published
) -> Iterator[dict[str, Any]]:
    printed = published.numbers["weights"][locks]
    swapped = [printed[1], printed[0], *printed[2:]]
    for (model, mesh), weights in read.items():
        same = {"model": model, "mesh_m": mesh}
        for lock, (weight, value) in enumerate(zip(weights, printed, strict=True), start=1):
            row = {"quantity": f"weight_lock{lock}", "published": value, "computed": weight}
            yield {**same, **row, "note": "in the printed order" if lock <= 2 else ""}
        for lock in (1, 2):
            row = {"published": swapped[lock - 1], "computed": weights[lock - 1], "note": SWAPPED}
            yield {**same, "quantity": f"weight_lock{lock}_swapped", **row}
        total = math.fsum(weights)
        value = published.numbers["weight_sum"][locks]
        yield {**same, "quantity": "weight_sum", "published": value, "computed": total}
        yield {
            **same,
            "quantity": "weight_sum_rounded_down",
            "published": published.numbers["active_locks"][locks],
            "computed": math.floor(total),
        }


def _option_rows(fit: pd.DataFrame, sample: str, value: int) -> Iterator[dict[str, Any]]:
    """The best option of the paper's revised model, frictionless with (n - 1) / 2 locks."""
    own = fit[(fit["sample"] == sample) & (fit["reduction"] == "half")]
    for model, mesh in own[["model", "mesh_m"]].drop_duplicates().itertuples(index=False):
        best = winner(own[own["model"] == model], sample, mesh, friction=False)
        number = str(best["option"]).removeprefix("option")
        if number.isdigit():
            yield {
                "quantity": "best_option",
                "model": model,
                "mesh_m": mesh,
                "published": value,
                "computed": int(number),
                "note": "revised by (n - 1) / 2, no friction",
            }


def run(
    arguments: Mapping[str, Any], inputs: Mapping[str, Path], outputs: Mapping[str, Path]
) -> None:
    """Write the published numbers beside the computed ones."""
    study = Study.model_validate_json(arguments["study"])
    capacity, weights, fit = (
        read_table(kind, inputs[kind.name]) for kind in (CAPACITY, WEIGHTS, FIT)
    )
    table = validation_table(study, capacity, weights, fit, read_published())
    write_table(VALIDATION, table, outputs["validation"])
