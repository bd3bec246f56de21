"""Lock weights: the shear that each inner face carries at the peak, over its strength.

The paper (section 4) defines the weight of a lock as the mean shear stress on its inner face over
the cohesion. Under torque the resultant can vanish while the stress does not, so the mean
magnitude and the largest value are given as well.
"""

import argparse
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from analysis.reading import CaseResult, read_case
from workflow.results import write_table


def case_columns(result: CaseResult) -> dict[str, Any]:
    """Columns that tell which case a row belongs to."""
    case = result.case
    return {
        "model": case.model,
        "variant": case.variant,
        "sample": case.sample,
        "locks": case.joint.locks,
        "mesh_m": case.mesh,
        "eccentricity_m": case.eccentricity_m,
    }


def lock_weights(result: CaseResult) -> pd.DataFrame:
    """One row per lock: resultant / T0, mean magnitude / tau and largest / tau on its inner face.

    ``shear_x_N`` and ``shear_y_N`` are the resultant on the piece above the face.
    """
    joint = result.case.joint
    rows = []
    for lock, nodes in result.nodes[result.nodes.lock > 0].groupby("lock"):
        stress = nodes[["shear_x_Pa", "shear_y_Pa"]].to_numpy()
        area = nodes["area_m2"].to_numpy()
        resultant = area @ stress
        magnitude = np.linalg.norm(stress, axis=1)
        rows.append(
            case_columns(result)
            | {
                "lock": lock,
                "block": "upper" if joint.is_upper(int(str(lock))) else "lower",
                "weight": float(np.linalg.norm(resultant)) / joint.T0,
                "mean_shear_ratio": float(area @ magnitude) / joint.T0,
                "max_shear_ratio": float(magnitude.max()) / joint.inner.cohesion,
                "shear_x_N": float(resultant[0]),
                "shear_y_N": float(resultant[1]),
            }
        )
    return pd.DataFrame(rows)


def weight_sums(weights: pd.DataFrame) -> pd.DataFrame:
    """One row per case: W_sum, W_sum rounded down, and the sum over the lower locks."""
    keys = ["model", "variant", "sample", "locks", "mesh_m", "eccentricity_m"]
    lower = weights["weight"].where(weights["block"] == "lower", 0.0)
    sums = weights.assign(lower=lower).groupby(keys, sort=False)[["weight", "lower"]].sum()
    sums = sums.rename(columns={"weight": "weight_sum", "lower": "lower_weight_sum"})
    sums.insert(1, "weight_sum_floor", np.floor(sums["weight_sum"]).astype(int))
    return sums.reset_index()


COLUMNS = (
    *("model", "locks", "mesh_m", "eccentricity_m", "lock", "block"),
    *("weight", "mean_shear_ratio", "max_shear_ratio"),
    *("variant", "sample", "shear_x_N", "shear_y_N"),
)


def tabulate(results: Iterable[CaseResult]) -> pd.DataFrame:
    """Weights of all ``results``."""
    return pd.concat([lock_weights(result) for result in results])[list(COLUMNS)]


def main() -> None:
    """Command line: the two tables to write, and the folders of the cases."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("weights", type=Path)
    parser.add_argument("sums", type=Path)
    parser.add_argument("cases", type=Path, nargs="+", help="folder of each case")
    arguments = parser.parse_args()
    weights = tabulate(read_case(path) for path in arguments.cases)
    write_table(weights, arguments.weights)
    write_table(weight_sums(weights), arguments.sums)


if __name__ == "__main__":
    main()
