"""The table of all models of the joint's pieces beside each other."""

import argparse
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from analysis.reading import CaseResult, read_case
from analysis.weights import case_columns, lock_weights
from workflow.case import REFERENCE
from workflow.results import write_table

SHARES = (0.25, 0.5, 0.75)  # of the given loads over the leading model's first failure
KEYS = ["sample", "mesh_m", "eccentricity_m"]


def friction_share(result: CaseResult) -> float:
    """Share of V that reaches the lower body other than by its locks; nan in pure torsion."""
    weights = lock_weights(result)
    by_locks = abs(float(weights.loc[weights["block"] == "lower", "shear_y_N"].sum()))
    return 1.0 - by_locks / result.shear if result.shear > 0.0 else float("nan")


def displacements_at(result: CaseResult, loads: Iterable[float]) -> list[float]:
    """Displacement (m) that the load works on, at given loads (N); nan for a rigid model."""
    history = result.history
    if "stage" in history:
        history = history[history["stage"] == "equilibrium"]
    path = history.sort_values("load_N")
    return [float(np.interp(x, path["load_N"], path["displacement_m"])) for x in loads]


def models_table(results: Iterable[CaseResult]) -> pd.DataFrame:
    """One row for each case of the reference variant, the models of a case one after the other.

    Given loads are shares of the first failure in the model that comes first.
    """
    rows: list[dict[str, Any]] = []
    given: dict[tuple[Any, ...], float] = {}
    for result in results:
        columns = case_columns(result)
        if columns.pop("variant") != REFERENCE:
            continue
        failure = result.first_failure_load
        known = failure if failure is not None else result.peak_load
        load = given.setdefault(tuple(columns[key] for key in KEYS), known)
        moved = displacements_at(result, [share * load for share in SHARES])
        weights = lock_weights(result)
        rows.append(
            columns
            | {
                "load_N": result.peak_load,
                "first_failure_load_N": failure,
                "friction_share": friction_share(result),
                "given_load_N": load,
            }
            | {
                f"displacement_at_{100 * share:g}_percent_m": value
                for share, value in zip(SHARES, moved, strict=True)
            }
            | {f"weight_lock{row.lock}": row.weight for row in weights.itertuples()}
        )
    table = pd.DataFrame(rows)
    order = table.groupby(KEYS, sort=False).ngroup()
    return table.iloc[np.argsort(order, kind="stable")]


def main() -> None:
    """Command line: the table to write, and the folders of the cases."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("models", type=Path)
    parser.add_argument("cases", type=Path, nargs="+", help="folder of each case")
    arguments = parser.parse_args()
    write_table(models_table(read_case(path) for path in arguments.cases), arguments.models)


if __name__ == "__main__":
    main()
