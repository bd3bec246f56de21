"""The checked result of a case, in the same form for all models, and the files of a case by name.

Engines, models solved in this process and programs run elsewhere all give an `Outcome`.
`record_of` checks it against its case and turns it into a `Record`; nothing else reaches a table.
"""

import csv
import dataclasses
import importlib
import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar

from sidmacib.errors import ResultError
from sidmacib.problem import Outcome, Problem, checked_share
from sidmacib.quantities import rounded
from sidmacib.validation import dataclass_from
from workflow.case import SUBJECTS, Case, JointSubject

CASE, RECORD = "case.json", "record.json"
BROKE_DOWN = "broke-down"  # mark beside a record: the engine did, and may not do so again
BENCHMARKS = "benchmarks"  # folder of Snakemake's measurements
BATCH_RECORDS, BATCH_NODES, BATCH_HISTORY = "records.jsonl", "nodes.parquet", "history.parquet"

Part = TypeVar("Part")


@dataclass(frozen=True)
class Record(Generic[Part]):
    """The result of a case of a ``kind``, see `workflow.case.SUBJECTS`.

    Loads are along the case's direction, in N: ``load_N`` the one that counts, ``peak_N`` the
    largest at equilibrium, ``failed_load_N`` the smallest known not to be carried,
    ``first_failure_load_N`` where the first node fails; where gravity turns, the angle in radians
    times the weight. ``mode``: how the pieces give way. ``peak_spread``: of the static model's
    peaks, the lowest of which is ``peak_N``. ``unbalanced_share``: largest force (or moment over a
    length) left on a piece, over the load. ``path``: loads (N) and displacements (m, the one that
    the load does work on). What a model does not give is None or empty. ``refused``: why the model
    cannot do the case, or that it never falls; ``error``: why there is no result, in one line; all
    numbers are None in both, and ``raised`` is the class of what ended a model, see
    `sidmacib.errors`. ``part``: what only joints or only structures have.
    """

    kind: str
    model: str
    variant: str
    name: str
    case_digest: str
    physics: str  # digest of the subject: the same for all models of a case
    part: Part
    load_N: float | None = None
    peak_N: float | None = None
    failed_load_N: float | None = None
    first_failure_load_N: float | None = None
    mode: str | None = None
    peak_spread: float | None = None
    unbalanced_share: float | None = None
    path: tuple[tuple[float, float | None], ...] = ()
    versions: dict[str, str] = dataclasses.field(default_factory=dict)
    refused: str | None = None
    error: str | None = None
    raised: str | None = None

    @property
    def folder(self) -> str:
        """The folder of the case's files, below the results folder: the identity of the case."""
        return f"{self.kind}/{self.model}/{self.name}"

    def columns(self) -> dict[str, Any]:
        """All that stands in the record and its part, by name."""
        versions = ", ".join(f"{k} {v}" for k, v in sorted(self.versions.items())) or None
        found = {**vars(self), **vars(self.part), "versions": versions}
        del found["part"]
        return found

    def to_json(self) -> str:
        """One line of JSON; infinity is written as Python's json does."""
        return json.dumps(asdict(self))

    @classmethod
    def from_json(cls, text: str) -> "Record[Part]":
        """The record that `to_json` wrote."""
        data = json.loads(text)
        data["part"] = dataclass_from(part_of(data["kind"]), data["part"])
        data["path"] = tuple((load, moved) for load, moved in data["path"])
        return cls(**data)


def part_of(kind: str) -> Any:
    """The class of the part of the records of a kind of cases, imported by name.

    Its ``without_result`` says what is known of a case, ``of`` what an outcome adds to that, and
    ``balance`` takes the noise of processors from an unbalanced share.
    """
    return importlib.import_module(SUBJECTS[kind].part).PART


def record_without_result(
    case: Case[Any],
    *,
    refused: str | None = None,
    error: str | None = None,
    raised: Exception | None = None,
) -> Record[Any]:
    """The record of a case that the model refuses, or that ended without a result."""
    part = part_of(case.subject.kind).without_result(case)
    why = {"refused": _in_a_line(refused), "error": _in_a_line(error)}
    return _record(case, part, **why, raised=raised and type(raised).__name__)


def record_of(
    case: Case[Any], problem: Problem, outcome: Outcome, versions: dict[str, str]
) -> Record[Any]:
    """The record of ``outcome``; raises `ResultError` where it cannot be the result of ``case``."""
    assembly, loads, state = outcome.cells or problem.assembly, problem.loads, outcome.state
    part, share = part_of(case.subject.kind), checked_share(problem, outcome)
    return _record(
        case,
        part.of(case, assembly, loads, outcome),
        load_N=rounded(state.load),
        peak_N=rounded_or_none(outcome.peak_load),
        failed_load_N=rounded(outcome.failed_load),
        first_failure_load_N=rounded_or_none(outcome.first_failure_load),
        mode=outcome.mode,
        peak_spread=outcome.peak_spread,
        unbalanced_share=None if share is None else part.balance(share),
        path=tuple(
            (rounded(each.load), rounded_or_none(each.displacement)) for each in outcome.path
        ),
        versions=versions,
    )


def read_records(paths: Sequence[Path]) -> list[Record[Any]]:
    """All records in files that hold one per line.

    `sidmacib.errors.ResultError` that names a file which does not.
    """
    found: list[Record[Any]] = []
    for path in paths:
        try:
            found += map(Record.from_json, path.read_text().splitlines())
        except (ValueError, KeyError, TypeError) as error:
            fault = f"{type(error).__name__}: {error}"
            raise ResultError(f"{path}: damaged, not the record of a case ({fault})") from None
    return found


def rounded_or_none(value: float | None) -> float | None:
    """`rounded`, of a ``value`` if there is one."""
    return None if value is None else rounded(value)


def _record(case: Case[Any], part: Any, **values: Any) -> Record[Any]:
    return Record(
        kind=case.subject.kind,
        model=case.model,
        variant=case.variant,
        name=case.name,
        case_digest=case.digest(),
        physics=case.physics(),
        part=part,
        **values,
    )


def _in_a_line(reason: str | None) -> str | None:
    return None if reason is None else " ".join(reason.split())


def read_times(results: Path) -> Iterator[tuple[str, float, float]]:
    """Kind of each job that Snakemake measured, its time on the clock and of processors, in s."""
    for path in sorted((results / BENCHMARKS).rglob("*.tsv")):
        (row,) = csv.DictReader(path.read_text().splitlines(), delimiter="\t")
        kind, *inside = path.relative_to(results / BENCHMARKS).parts
        kind = inside[0] if kind == JointSubject.kind else kind  # the model
        if row["cpu_time"] != "NA":  # it ended before it was looked at
            yield kind, float(row["s"]), float(row["cpu_time"])
