"""How long each model takes for each case, on this machine; run it after a study."""

import argparse
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pandas as pd

from workflow.case import REFERENCE, Case
from workflow.cases import cases_of
from workflow.configuration import read_study_file
from workflow.engines import ENGINES
from workflow.models import detailed
from workflow.results import write_table
from workflow.schema import Study
from workflow.solve import solve_case

REPEATS = 3


def seconds_of(case: Case, benchmarks: Path) -> float | None:
    """Wall time of a case: of its job for an engine, the best of `REPEATS` runs here for others.

    None where an engine has not run the case.
    """
    if case.model in ENGINES:
        record = benchmarks / case.model / f"{case.name}.tsv"
        return float(pd.read_csv(record, sep="\t")["s"].iloc[0]) if record.exists() else None

    def once() -> float:
        start = time.perf_counter()
        solve_case(case)
        return time.perf_counter() - start

    return min(once() for _ in range(REPEATS))


def times(study: Study) -> Iterator[dict[str, Any]]:
    """One row for each case of the reference variant."""
    for case in cases_of(study).values():
        if case.variant == REFERENCE:
            yield {
                "model": case.model,
                "sample": case.sample,
                "mesh_m": case.mesh,
                "eccentricity_m": case.eccentricity_m,
                "time_s": seconds_of(case, Path(study.results) / "benchmarks"),
            }


def describe(table: pd.DataFrame, leading: str) -> str:
    """Times by sample and mesh, and how many times faster than ``leading`` each model is."""
    keys = ["sample", "mesh_m", "eccentricity_m"]
    by_model = table.pivot_table(index=keys, columns="model", values="time_s", sort=False)
    lines = ["Time of a case (s), least to largest, and how many times faster than " + leading]
    for (sample, mesh), rows in by_model.groupby(["sample", "mesh_m"], sort=False):
        for model in by_model.columns:
            ratio = (rows[leading] / rows[model]).dropna()
            faster = f"{ratio.min():.0f} to {ratio.max():.0f} times" if model != leading else ""
            least, largest = rows[model].min(), rows[model].max()
            lines.append(
                f"  {sample} mesh {mesh:g} m  {model:8}{least:9.3f} to {largest:7.3f}  {faster}"
            )
    return "\n".join(lines)


def main() -> None:
    """Command line: the configuration, and perhaps another folder of results."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("config", type=Path)
    parser.add_argument("--results")
    arguments = parser.parse_args()
    study = read_study_file(arguments.config, arguments.results)
    table = pd.DataFrame(times(study))
    write_table(table, Path(study.results) / "tables/times.csv")
    measured = set(table.dropna()["model"])
    leading = next((model for model in detailed(study.model_names) if model in measured), None)
    if leading is None:
        sys.exit(f"{study.results}: no engine has run there, so run make study first")
    print(describe(table, leading))


if __name__ == "__main__":
    main()
