"""The files of a single case, by name, and Snakemake's measurements of jobs."""

import csv
from collections.abc import Iterator
from pathlib import Path

from workflow.case import JointSubject

CASE, RECORD = "case.json", "record.json"
BROKE_DOWN = "broke-down"  # mark beside a record: the engine did, and may not do so again
BENCHMARKS = "benchmarks"  # folder of Snakemake's measurements
BATCH_RECORDS, BATCH_NODES, BATCH_HISTORY = "records.jsonl", "nodes.parquet", "history.parquet"


def read_times(results: Path) -> Iterator[tuple[str, float, float]]:
    """Kind of each job that Snakemake measured, its time on the clock and of processors, in s."""
    for path in sorted((results / BENCHMARKS).rglob("*.tsv")):
        (row,) = csv.DictReader(path.read_text().splitlines(), delimiter="\t")
        kind, *inside = path.relative_to(results / BENCHMARKS).parts
        kind = inside[0] if kind == JointSubject.kind else kind  # the model
        if row["cpu_time"] != "NA":  # it ended before it was looked at
            yield kind, float(row["s"]), float(row["cpu_time"])
