"""Do pure shear and pure torsion determine the loads in between? V-M interaction curves.

The curve (V / V0)^p + (M / M0)^p = 1 goes through both ends; p = 1 is the straight line. Its loads
are compared with first failures of the static model, whose values at the ends are V0 and M0.
"""

import math
from typing import Any

import numpy as np
import pandas as pd

from sidmacib.mechanics.assembly import Floats
from studies.locks.errors import JOINT, SPREAD, by_region, dry_faces, known, table_of
from studies.locks.points import POINTS
from workflow.results.tables import Table, read_table, write_table
from workflow.step import Arguments, Files, step

EXPONENTS = (1.0, 1.25, 1.5, 2.0)
REGION = ("sampling", "dry_faces", "upper_body", "eccentricity_over_a")
INTERACTION = Table("interaction", ("exponent", *REGION, *SPREAD), ("exponent", *REGION), digits=4)


def curve(shear: float, torsion: float, ratio: float, exponent: float) -> float:
    """Load along e / a on the curve through the loads at both ends, in the unit of these.

    ``torsion``: M0 / a. Raises ValueError unless 0 < ``ratio`` < inf.
    """
    if not 0.0 < ratio < math.inf:
        raise ValueError(f"ratio: {ratio:g} is not allowed; it must be more than 0 and finite")
    part = np.array([1.0, ratio]) / math.hypot(1.0, ratio)
    return float(
        ((part[0] / shear) ** exponent + (part[1] / torsion) ** exponent) ** -(1 / exponent)
    )


def interaction_table(points: pd.DataFrame) -> pd.DataFrame:
    """Errors of the curves, by region and for all directions of a region together."""
    points = points[points["plate"] & known(points) & points["failure"].eq("brittle")]
    points = points.assign(dry_faces=dry_faces(points))
    by_ratio = points.set_index([*JOINT, "eccentricity_over_a"])["first_failure"]

    def at(ratio: float) -> Floats:
        """First failures of each point's joint in another direction; nan: unknown."""
        joints = points[JOINT].assign(ratio=ratio)
        return by_ratio.reindex(pd.MultiIndex.from_frame(joints)).to_numpy()

    between = points.assign(shear=at(0.0), torsion=at(math.inf)).dropna(subset=["shear", "torsion"])
    ratio = between["eccentricity_over_a"]
    between = between[ratio.gt(0.0) & ratio.lt(math.inf)]
    directions = between[["shear", "torsion", "eccentricity_over_a"]].to_numpy().tolist()
    rows: list[dict[str, Any]] = []
    for exponent in EXPONENTS:
        loads = [curve(shear, torsion, e, exponent) for shear, torsion, e in directions]
        error = np.array(loads) / between["first_failure"] - 1.0
        regions = by_region(between, error, REGION, REGION[:-1])
        rows += [{"exponent": exponent, **row} for row in regions]
    return table_of(INTERACTION, rows)


def run(arguments: Arguments, inputs: Files, outputs: Files) -> None:
    """Write the table."""
    table = interaction_table(read_table(POINTS, inputs["points"]))
    write_table(INTERACTION, table, outputs["interaction"])


if __name__ == "__main__":
    step(run)
