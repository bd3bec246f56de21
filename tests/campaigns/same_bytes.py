"""The same bytes: tables and figures of a study, whatever machine and Python it runs on.

    make same PYTHONS="/usr/bin/python3.12 ..."

A study of all models is run again with one core and with all, under each kernel of OpenBLAS that
this processor has, and in other checkouts' environments, whose Python may be another. What differs
from the first run is named in build/same.csv.
"""

import argparse
import hashlib
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import yaml
from campaigns.counts import ROOT, write_counts
from processes import ran
from small import BOTH, SMALL
from test_kernels import NEEDS, can_run

SAMPLES = {"n5": {"locks": 5, "dry": {"friction": 0.1}}}
STUDY = SMALL | BOTH | {"samples": SAMPLES, "models": ["static", "limit", "law", "safe"]}
KINDS = ("tables/*.csv", "figures/*.png", "figures/*.pdf", "cases/*/*/*.csv", "summary.txt")


@dataclass(frozen=True)
class Run:
    """A way to run the study: its name, Python, number of cores, and environment."""

    name: str
    python: Path = Path(sys.executable)
    cores: str = "all"
    environment: dict[str, str] = field(default_factory=dict)


def runs(pythons: list[Path]) -> Iterator[Run]:
    """All ways, the one that the others are held against first."""
    yield Run("all cores")
    yield Run("again")
    yield Run("one core", cores="1")
    for kernel in filter(can_run, NEEDS):
        yield Run(f"kernel {kernel}", environment={"OPENBLAS_CORETYPE": kernel})
    for python in pythons:
        yield Run(f"Python {version(python)}", python)


def version(python: Path) -> str:
    """What a Python says of itself."""
    return ran(python, "--version", check=True).stdout.split()[1]


def digests(run: Run, folder: Path) -> dict[str, str]:
    """Run the study in ``folder``; a digest of each file that counts."""
    study = folder / "study.yaml"
    study.write_text(yaml.safe_dump(STUDY))
    results = folder / "results"
    options = ("--cores", run.cores, "--quiet", "all", "--config", f"results={results}")
    command = (run.python.parent / "snakemake", "--configfile", study, *options)
    ended = ran(*command, PYTHONPATH=str(ROOT), **run.environment)
    if ended.returncode:
        raise SystemExit(f"{run.name}: {ended.stdout[-2000:]}{ended.stderr[-2000:]}")
    digests = {}
    for path in sorted(path for kind in KINDS for path in results.glob(kind)):
        content = path.read_bytes().replace(str(results).encode(), b"results")
        digests[str(path.relative_to(results))] = hashlib.sha256(content).hexdigest()
    return digests


def main() -> None:
    """Run the study in all ways and write what differs; exits with 1 where anything does."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("pythons", nargs="*", type=Path, help="of other environments, bin/python")
    parser.add_argument("--table", type=Path, default=ROOT / "build/same.csv")
    arguments = parser.parse_args()
    first: dict[str, str] = {}
    rows = []
    for run in runs(arguments.pythons):
        with tempfile.TemporaryDirectory(prefix="multilock-same-") as name:
            found = digests(run, Path(name))
        first = first or found
        every = first.keys() | found.keys()
        other = sorted(path for path in every if first.get(path) != found.get(path))
        rows.append((run.name, len(found), len(other), " ".join(other)))
        print(f"{run.name}: {len(found)} files, {len(other)} others {' '.join(other)}", flush=True)
    write_counts(arguments.table, ("run", "files", "others", "which"), rows)
    sys.exit(1 if any(count for _, _, count, _ in rows) else 0)


if __name__ == "__main__":
    main()
