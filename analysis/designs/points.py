"""The points of a study's designs: a joint in a direction, with every model's load over T0."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from workflow.results.tables import POINTS, write_table

KEYS = ["number", "eccentricity_over_a"]


def points_of(design: str, solved: pd.DataFrame, told: pd.DataFrame) -> pd.DataFrame:
    """The points of a ``design``: what the static model found, and what the law says."""
    both = solved.merge(told, on=KEYS, how="left", validate="1:1")
    both.insert(0, "design", design)
    both["stiffness_ratio"] = both["stiffness_ratio"].replace(np.inf, np.nan)  # of rigid pieces
    for column in POINTS.columns:
        if column not in both:
            both[column] = np.nan  # limit analysis, where no joint of a batch has it
    return both[list(POINTS.columns)]


def run(
    arguments: Mapping[str, Any], inputs: Mapping[str, list[Path]], outputs: Mapping[str, Path]
) -> None:
    """Put the batches of all designs together."""
    parts = [
        points_of(design, pd.read_parquet(solved), pd.read_parquet(told))
        for design, solved, told in zip(
            arguments["designs"], inputs["solved"], inputs["law"], strict=True
        )
    ]
    write_table(POINTS, pd.concat(parts, ignore_index=True), outputs["points"])
