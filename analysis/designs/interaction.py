"""Whether pure shear and pure torsion are enough to know what lies between: V-M envelopes.

The curve (V / V0)^p + (M / M0)^p = 1 goes through both ends; p = 1 is the straight line. Its loads
are held against first failures of the static model, of which V0 and M0 are those at the ends.
"""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from analysis.designs.errors import by_region, dry_faces, known, table_of
from workflow.results.tables import INTERACTION, POINTS, read_table, write_table

EXPONENTS = (1.0, 1.25, 1.5, 2.0)
JOINT = ["design", "number"]
REGION = ["design", "dry_faces", "upper_body", "eccentricity_over_a"]


def curve(shear: float, torsion: float, ratio: float, exponent: float) -> float:
    """Load along e / a on the curve through the loads at both ends, of the same unit.

    ``torsion`` is M0 over a. ValueError for a direction that is an end itself.
    """
    if not 0.0 < ratio < math.inf:
        raise ValueError(f"ratio: {ratio:g} is not possible; it must be between the ends")
    part = np.array([1.0, ratio]) / math.hypot(1.0, ratio)
    return float(
        ((part[0] / shear) ** exponent + (part[1] / torsion) ** exponent) ** -(1 / exponent)
    )


def interaction_table(points: pd.DataFrame) -> pd.DataFrame:
    """Errors of the curves, by region and for all directions of a design's region together."""
    own = points[points["plate"] & known(points) & points["failure"].eq("brittle")]
    own = own.assign(dry_faces=dry_faces(own))

    def at(ratio: float) -> "pd.Series[float]":
        chosen = own[own["eccentricity_over_a"].eq(ratio)]
        return chosen.set_index(JOINT)["first_failure"]

    joint = pd.MultiIndex.from_frame(own[JOINT])
    ends = own.assign(
        shear=at(0.0).reindex(joint).to_numpy(), torsion=at(math.inf).reindex(joint).to_numpy()
    ).dropna(subset=["shear", "torsion"])
    between = ends[ends["eccentricity_over_a"].gt(0.0) & ends["eccentricity_over_a"].lt(math.inf)]
    rows: list[dict[str, Any]] = []
    for exponent in EXPONENTS:
        loads = [
            curve(shear, torsion, ratio, exponent)
            for shear, torsion, ratio in zip(
                between["shear"], between["torsion"], between["eccentricity_over_a"], strict=True
            )
        ]
        error = np.array(loads) / between["first_failure"] - 1.0
        regions = by_region(between, error, REGION, REGION[:-1])
        rows += [{"exponent": exponent, **row} for row in regions]
    return table_of(INTERACTION, rows)


def run(
    arguments: Mapping[str, Any], inputs: Mapping[str, Path], outputs: Mapping[str, Path]
) -> None:
    """Write the table."""
    write_table(
        INTERACTION, interaction_table(read_table(POINTS, inputs["points"])), outputs["interaction"]
    )
