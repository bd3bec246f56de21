"""The files that hold what a model found for a case, the same from every model and engine."""

import json
from pathlib import Path

import pandas as pd

from workflow.case import Case

OUTPUTS = ("history.csv", "nodes.csv", "result.json")
CASE_FILES = ("case.json", *OUTPUTS)
NODE_COLUMNS = (
    *("face", "kind", "x_m", "y_m", "z_m", "area_m2"),
    *("normal_Pa", "shear_x_Pa", "shear_y_Pa", "shear_z_Pa", "bonded"),
)


def write_results(
    case: Case,
    folder: Path,
    nodes: pd.DataFrame,
    history: pd.DataFrame,
    loads: tuple[float, float, float | None],
) -> None:
    """Write the case, its tables and, at the end, ``loads`` in N: peak, failed, first failure."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "case.json").write_text(case.to_json())
    write_table(nodes, folder / "nodes.csv")
    write_table(history, folder / "history.csv")
    names = ("peak_load_N", "failed_load_N", "first_failure_load_N")
    result = dict(zip(names, loads, strict=True))
    (folder / "result.json").write_text(json.dumps(result, indent=1) + "\n")


def write_table(rows: pd.DataFrame, path: Path) -> None:
    """Write ``rows`` as CSV, numbers with ten digits."""
    path.parent.mkdir(parents=True, exist_ok=True)
    rows.to_csv(path, index=False, float_format="%.10g")
