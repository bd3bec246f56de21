"""Time, files and memory of large studies: `make scaling CASES=100000`.

That many cases of the static model are solved and their table is made, and again when there is
nothing to do. Fits, figures and report are left out: they grow with what is asked of them.
Time on the clock and of processors, memory of the largest process, files and bytes are in
tables/scaling.csv, beside those of a tenth and a hundredth of the cases.
"""

import argparse
import sys
import tempfile
from pathlib import Path

import pandas as pd
import yaml

from benchmarks.usage import used
from workflow.results import read_times
from workflow.step import ROOT

MESHES = [0.02, 0.03]
SAMPLES = {f"n{n}": {"locks": n} for n in (3, 5, 7, 9)}


def study(cases: int) -> dict[str, object]:
    """A study of about that many cases of the static model."""
    each = max(1, round(cases / len(MESHES) / len(SAMPLES)))
    return {
        "samples": SAMPLES,
        "meshes": MESHES,
        "eccentricities": [round(2.0 * n / each, 6) for n in range(each)],
        "nodes": "centres",
        "models": ["static"],
        "dem": {"engines": []},
    }


def row(cases: int, folder: Path) -> dict[str, float]:
    """Run a study of about that many cases in ``folder``, twice."""
    config = study(cases)
    path, results = folder / "study.yaml", folder / "results"
    path.write_text(yaml.safe_dump(config))
    command = [
        *(str(Path(sys.executable).parent / "snakemake"), "--quiet", "all"),
        *("--configfile", str(path), "--config", f"results={results}"),
        *("--", f"{results}/tables/cases.csv"),
    ]
    first, again = used(command, ROOT), used(command, ROOT)
    solved = [cpu for kind, _, cpu in read_times(results) if kind == "static"]
    files = [each for each in results.rglob("*") if each.is_file()]
    count = len(pd.read_parquet(results / "tables/cases.parquet"))
    return {
        "cases": count,
        "batches": len(solved),
        "wall_s": first.wall,
        "cpu_s": first.cpu,
        "largest_process_MB": first.memory,
        "cases_cpu_s": sum(solved),
        "again_s": again.wall,
        "files": len(files),
        "MB": sum(each.stat().st_size for each in files) / 1e6,
    }


def main() -> None:
    """Command line: how many cases, and where the table goes."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=100_000)
    parser.add_argument("--results", type=Path, default=ROOT / "results")
    arguments = parser.parse_args()
    path = arguments.results / "tables/scaling.csv"
    path.parent.mkdir(parents=True, exist_ok=True)
    rows = []
    for cases in (arguments.cases // 100, arguments.cases // 10, arguments.cases):
        with tempfile.TemporaryDirectory(prefix="multilock-scaling-") as name:
            rows.append(row(cases, Path(name)))
        print(", ".join(f"{key} {value:.4g}" for key, value in rows[-1].items()), flush=True)
        pd.DataFrame(rows).to_csv(path, index=False, float_format="%.6g")
    print(f"Table: {path}")


if __name__ == "__main__":
    main()
