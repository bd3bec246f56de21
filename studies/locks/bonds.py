"""Gain of bonds that soften or yield over the first failure, and safety of (n - 1) / 2 with it."""

import numpy as np
import pandas as pd

from sidmacib.mechanics.assembly import Failure
from studies.locks.points import POINTS
from workflow.results.tables import Table, read_table, write_table
from workflow.step import Arguments, Files, step

ENERGIES = (
    (1.0, 10.0),
    (10.0, 100.0),
    (100.0, 1000.0),
)  # fracture energy over energy stored
BONDS = Table(
    "bonds",
    (
        *("bonds", "upper_body", "eccentricity_over_a", "points", "mean_peak_over_first_failure"),
        *("largest_peak_over_first_failure", "mean_peak_over_pairs", "unsafe_share_of_half"),
    ),
    ("bonds", "upper_body", "eccentricity_over_a"),
    digits=4,
)


def bonds_table(points: pd.DataFrame) -> pd.DataFrame:
    """Peaks over first failures and over numbers of pairs, of joints under a plate, by bonds."""
    bears = points["plate"] & points["peak"].gt(0.0) & points["pairs"].gt(0)
    points = points[bears & points["stiffness_ratio"].isna()]
    points = points.assign(
        bonds=[_kind(*each) for each in points[["failure", "energy_ratio"]].values],
        more=points["peak"] / points["first_failure"] - 1.0,
        of_pairs=points["peak"] / points["pairs"],
    )
    rows = []
    keys = ["bonds", "upper_body", "eccentricity_over_a"]
    for values, group in points.groupby(keys, sort=True):
        odd = group[group["locks"].mod(2).eq(1) & group["eccentricity_over_a"].eq(0.0)]
        below = odd["of_pairs"] < 1.0 - 1e-3
        rows.append(
            {
                **dict(zip(keys, values, strict=True)),
                "points": len(group),
                "mean_peak_over_first_failure": 1.0 + float(group["more"].mean()),
                "largest_peak_over_first_failure": 1.0 + float(group["more"].max()),
                "mean_peak_over_pairs": float(group["of_pairs"].mean()),
                "unsafe_share_of_half": float(below.mean()) if len(odd) else np.nan,
            }
        )
    return pd.DataFrame(rows, columns=list(BONDS.columns))


def _kind(failure: str, ratio: float) -> str:
    if failure != Failure.SOFTENING:
        return failure
    least, most = next((span for span in ENERGIES if ratio <= span[1]), ENERGIES[-1])
    return f"softening, {least:g} to {most:g}"


def run(arguments: Arguments, inputs: Files, outputs: Files) -> None:
    """Write the table."""
    write_table(BONDS, bonds_table(read_table(POINTS, inputs["points"])), outputs["bonds"])


if __name__ == "__main__":
    step(run)
