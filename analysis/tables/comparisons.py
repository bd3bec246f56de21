"""Comparisons of capacities: SiDMACIB, variants, published and measured numbers."""

import math
from collections.abc import Iterator
from typing import Any

import pandas as pd

from analysis.published import Published, read_published
from analysis.tables import pure_shear_weights, study_points, winner
from analysis.tables.fit import best_table, fit_table, variants_table
from sidmacib.models import LAWS, first_failure_only
from workflow.case import REFERENCE
from workflow.results.tables import (
    BEST_FIT,
    CAPACITY,
    FIT,
    MEASURED,
    VALIDATION,
    VARIANTS,
    WEIGHT_SUMS,
    WEIGHTS,
    read_table,
    write_table,
)
from workflow.schema import Study
from workflow.step import Arguments, Files, step

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
    no_peaks = [name for name in study.model_names if first_failure_only(name)]
    no_peaks += LAWS
    points = study_points(study, capacity.dropna(subset=["load_N"]))
    pure_shear = points[points["eccentricity_over_a"] == 0.0]
    rows: list[dict[str, Any]] = []
    for sample in published.samples(study):
        joint = study.joint(sample)
        selected = pure_shear[
            (pure_shear["sample"] == sample) & ~pure_shear["model"].isin(no_peaks)
        ]
        sources = pure_shear_weights(study, weights, sample)
        sources = {source: each for source, each in sources.items() if source[0] not in no_peaks}
        compared = [
            *_limit_rows(selected, published.numbers["limit_pure_shear"][joint.locks]),
            *_peak_rows(selected, joint.locks, published),
            *_weight_rows(sources, joint.locks, published),
            *_option_rows(fit, sample, published.numbers["best_option"]),
        ]
        setting = "as printed" if published.as_printed(study, sample) else "not as printed"
        same = {"sample": sample, "locks": joint.locks, "friction": joint.dry.friction}
        rows += [{**same, "setting": setting, **row} for row in compared]
    table = pd.DataFrame(rows, columns=list(VALIDATION.columns))
    # The number of an option is a name: no difference.
    quantities = table["quantity"] != "best_option"
    table["absolute_difference"] = (table["computed"] - table["published"]).where(quantities)
    table["relative_difference"] = table["absolute_difference"] / table["published"].where(
        table["published"] != 0.0
    )
    return table


def _limit_rows(pure_shear: pd.DataFrame, value: float) -> Iterator[dict[str, Any]]:
    rows = pure_shear[(pure_shear["model"] == "sidmacib") & (pure_shear["reduction"] == "none")]
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


def _peak_rows(
    pure_shear: pd.DataFrame, locks: int, published: Published
) -> Iterator[dict[str, Any]]:
    peaks = pure_shear[(pure_shear["variant"] == REFERENCE)]
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
    sources: dict[tuple[str, float], list[float]], locks: int, published: Published
) -> Iterator[dict[str, Any]]:
    printed = published.numbers["weights"][locks]
    swapped = [printed[1], printed[0], *printed[2:]]
    for (model, mesh), weights in sources.items():
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
    selected = fit[(fit["sample"] == sample) & (fit["reduction"] == "half")]
    for model, mesh in selected[["model", "mesh_m"]].drop_duplicates().itertuples(index=False):
        best = winner(selected[selected["model"] == model], sample, mesh, friction=False)
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


def measured_table(study: Study, capacity: pd.DataFrame) -> pd.DataFrame:
    """One row for each measured load and model, on the study's finest mesh.

    ``load_N`` are lengths of (V, M / a). A model without a result has an empty one.
    """
    rows: list[dict[str, Any]] = []
    if study.measured is None:
        return pd.DataFrame(rows, columns=list(MEASURED.columns))
    points = study_points(study, capacity)
    finest = points[points["mesh_m"] == min(study.meshes)]
    for number, load in enumerate(study.measured.loads, start=1):
        a = study.joint(load.sample).a
        shear, torque = load.components(a)
        measured = math.hypot(shear, torque / a)
        same = finest["sample"].eq(load.sample) & finest["eccentricity_over_a"].eq(
            load.eccentricity
        )
        for model in finest[same].itertuples():
            rows.append(
                {
                    "number": number,
                    "specimen": load.specimen,
                    "sample": load.sample,
                    "eccentricity_over_a": load.eccentricity,
                    "measured_shear_N": shear,
                    "measured_torque_Nm": torque,
                    "measured_load_N": measured,
                    "model": model.model,
                    "variant": model.variant,
                    "load_N": model.load_N,
                    "difference": model.load_N / measured - 1.0,
                }
            )
    return pd.DataFrame(rows, columns=list(MEASURED.columns))


def run(arguments: Arguments, inputs: Files, outputs: Files) -> None:
    """Write the fits and all comparisons that the study asks for."""
    study = Study.model_validate_json(arguments["study"])
    capacity, weights, sums = (
        read_table(kind, inputs[kind.name]) for kind in (CAPACITY, WEIGHTS, WEIGHT_SUMS)
    )
    write_table(FIT, fit_table(capacity), outputs["fit"])
    fit = read_table(FIT, outputs["fit"])  # as all others read it
    write_table(BEST_FIT, best_table(study, capacity), outputs["best_fit"])
    write_table(VARIANTS, variants_table(study, capacity, sums), outputs["variants"])
    table = validation_table(study, capacity, weights, fit, read_published())
    write_table(VALIDATION, table, outputs["validation"])
    if study.measured is not None:
        write_table(MEASURED, measured_table(study, capacity), outputs["measured"])


if __name__ == "__main__":
    step(run)
