"""Numbers of `make attack`: the worst joints that an optimiser found for the safe rule."""

from pathlib import Path

import pandas as pd

from studies.markdown import markdown

HEAD = [
    *("space", "joints", "answered", "not solved"),
    *("safe / first failure", "safe / peak, on other nodes"),
]


def worst(results: Path) -> str:
    """A row for each space: the worst of all starts."""
    table = pd.read_csv(results / "tables/attack.csv")
    rows = []
    for space, group in table.groupby("space", sort=False):
        peaks = group.filter(regex=r"^safe_over_peak_\d+$").max(numeric_only=True)
        rows.append(
            [
                str(space),
                f"{group['evaluations'].sum():,}",
                f"{group['answered'].sum():,}",
                f"{group['unsolved'].sum():,}",
                f"{group['safe_over_first_failure'].max():.3f}",
                ", ".join(f"{value:.3f}" for value in peaks),
            ]
        )
    return markdown(HEAD, rows)


BLOCKS = {"attack": worst}
