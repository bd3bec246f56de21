"""Comparison of measured loads with those of all models in the same direction."""

import math
from typing import Any

import pandas as pd

from analysis.tables.study_points import study_points
from workflow.results.tables import CAPACITY, MEASURED, read_table, write_table
from workflow.schema import Study
from workflow.step import Arguments, Files, step


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
    """Write the table."""
    study = Study.model_validate_json(arguments["study"])
    capacity = read_table(CAPACITY, inputs["capacity"])
    write_table(MEASURED, measured_table(study, capacity), outputs["measured"])


if __name__ == "__main__":
    step(run)
