"""One case's result in words."""

import argparse
from pathlib import Path

from analysis.reading import CaseResult, read_case
from analysis.weights import lock_weights


def describe(result: CaseResult) -> str:
    """Peak load and lock weights of a case."""
    case = result.case
    lines = [
        f"{case.name} ({case.model}): V = {result.shear:.2f} N, M = {result.torque:.4f} N m",
        f"  load along the path: {result.peak_load:.2f} N stands, {result.failed_load:.2f} N fails",
        "  lock  block  weight  mean shear / tau  largest / tau",
    ]
    lines += [
        f"  {row.lock:>4}  {row.block:5}  {row.weight:6.3f}  {row.mean_shear_ratio:16.3f}"
        f"  {row.max_shear_ratio:13.3f}"
        for row in lock_weights(result).itertuples()
    ]
    return "\n".join(lines)


def main() -> None:
    """Command line: the case's folder."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    arguments = parser.parse_args()
    print(describe(read_case(arguments.folder)))
    print(f"  all of it: {arguments.folder}")


if __name__ == "__main__":
    main()
