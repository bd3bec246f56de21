"""The points of the campaign: a joint in a direction, with every model's load over T0."""

from collections.abc import Sequence

import pandas as pd

from workflow.results.tables import SAMPLINGS, Table, read_table, write_table
from workflow.step import Arguments, Files, step

POINTS = Table(  # loads over T0; sampling, number: which joint
    "points",
    (
        *("sampling", "number", "eccentricity_over_a", "locks", "push", "upper_body", "failure"),
        *("a_over_b", "h_over_b", "H_over_b", "shear_over_normal", "dry_over_inner", "friction"),
        *("pressure_over_cohesion", "plate", "stiffness_ratio", "energy_ratio"),
        *("first_failure", "peak", "mode", "first_failure_mesh_error", "peak_mesh_error"),
        *("unbalanced_share", "limit", "weight_sum", "lower_weight_sum", "pairs", "closed_form"),
        *("saturation", "law", "safe", "law_error", "error"),
    ),
    ("sampling", "number", "eccentricity_over_a"),
)


def points_of(solved: pd.DataFrame, answers: Sequence[pd.DataFrame]) -> pd.DataFrame:
    """The table of samplings, joined with the batches of the law's ``answers``."""
    law = pd.concat(answers, ignore_index=True)
    keys = list(SAMPLINGS.key)
    points = solved.merge(law, on=keys, how="left", validate="1:1")
    return points[list(POINTS.columns)]


def run(arguments: Arguments, inputs: Arguments, outputs: Files) -> None:
    """Write the table."""
    solved = read_table(SAMPLINGS, inputs["samplings"])
    points = points_of(solved, [*map(pd.read_parquet, inputs["law"])])
    write_table(POINTS, points, outputs["points"])


if __name__ == "__main__":
    step(run)
