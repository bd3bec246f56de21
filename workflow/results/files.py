"""The files of a single case: those that an engine writes, and the checked record."""

import csv
import json
import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TypeVar

import numpy as np

from sidmacib.engines.scripts.records import HISTORY, MODES, NODES, RESULT
from sidmacib.mechanics.assembly import Assembly, Floats, Nodes
from sidmacib.mechanics.equilibrium import face_frames
from sidmacib.outcome import Outcome, State
from workflow.results.record import CaseRecord, ResultError

T = TypeVar("T")

CASE, RECORD = "case.json", "record.json"
BROKE_DOWN = "broke-down"  # mark beside a record: the engine did, and may not do so again
BENCHMARKS = "benchmarks"  # folder of Snakemake's measurements
BATCH_RECORDS, BATCH_NODES, BATCH_HISTORY = "records.jsonl", "nodes.parquet", "history.parquet"
NODE_COLUMNS = (
    *("face", "kind", "x_m", "y_m", "z_m", "area_m2"),
    *("normal_Pa", "shear_x_Pa", "shear_y_Pa", "shear_z_Pa", "bonded"),
)
POSITION = ("x_m", "y_m", "z_m")
STRESS = ("normal_Pa", "shear_x_Pa", "shear_y_Pa", "shear_z_Pa")
UNREADABLE = (ValueError, OverflowError, TypeError, KeyError, AttributeError, RecursionError)
MOST_LETTERS = 100  # letters, of what is wrong with a file
SAME = 1e-9  # of a load that stands in two files
BEYOND = 10.0  # over the peak: no load so large is tried with success
CLOSE = 1e-6  # of the assembly's length or a node's area: printed numbers are rounded


def read_outcome(folder: Path, assembly: Assembly) -> Outcome:
    """The outcome that an engine left in ``folder``; `ResultError` names file and line."""
    peak, failed, first, mode = _read_result(folder / RESULT)
    nodes = read_nodes(folder / NODES, assembly)
    path = _read_history(folder / HISTORY)
    _check_history(path, peak, assembly)
    at_peak = State(peak, path[-1].displacement if path else None, *nodes)
    before = [state for state in path if state.load < peak * (1.0 - 1e-12)]
    return Outcome((*before, at_peak), failed, first, mode, peak_load=peak)


def _check_history(path: tuple[State, ...], peak: float, assembly: Assembly) -> None:
    """Raise `ResultError` if the ``peak`` (N) is not one of the equilibria of the history.

    There may be some at higher loads: those at which a bond broke, and that were taken back.
    """
    if not (math.isfinite(peak) and peak > 0.0):
        return  # `record_of` says so
    for state in path:
        moved = state.displacement or 0.0
        if abs(moved) > assembly.length or abs(state.load) > BEYOND * peak:
            raise ResultError(
                f"{HISTORY}: {moved:g} m at {state.load:g} N is not allowed; it must be at most "
                f"{assembly.length:g} m, the length of its locks, and {BEYOND:g} times the peak of "
                f"{peak:g} N"
            )
    if path and not any(abs(state.load - peak) <= SAME * peak for state in path):
        raise ResultError(
            f"{RESULT}: peak load {peak:g} N is not allowed; it must be a load at equilibrium of "
            f"{HISTORY}"
        )


def _read_result(path: Path) -> tuple[float, float, float | None, str | None]:
    """Peak, failed load and first failure (N), and the mode."""
    try:
        found = json.loads(path.read_text())
        peak, failed = (float(found[name]) for name in ("peak_load_N", "failed_load_N"))
        first = found.get("first_failure_load_N")
        mode = found.get("mode")
        if mode is not None and mode not in MODES:
            raise ValueError(f"mode must be one of {', '.join(MODES)}")
        return peak, failed, None if first is None else float(first), mode
    except OSError as error:
        raise ResultError(f"{path.name}: {error.strerror}") from None
    except UNREADABLE as error:
        raise ResultError(f"{path.name}: unreadable: {str(error)[:MOST_LETTERS]}") from None


def read_table(path: Path, columns: tuple[str, ...]) -> list[dict[str, str]]:
    """Rows of a CSV file; `ResultError` names a line that has too few or too many columns."""
    try:
        with path.open(newline="") as stream:
            reader = csv.DictReader(stream, restkey="", restval=None)
            rows = list(reader)
            names = list(reader.fieldnames or ())
    except OSError as error:
        raise ResultError(f"{path.name}: {error.strerror}") from None
    except (ValueError, csv.Error) as error:
        raise ResultError(f"{path.name}: unreadable: {error}") from None
    if missing := [name for name in columns if name not in names]:
        raise ResultError(f"{path.name}, line 1: no column {', '.join(missing)}")
    for number, row in enumerate(rows, start=2):
        if "" in row or None in row.values():
            raise ResultError(f"{path.name}, line {number}: must have {len(names)} columns")
    return rows


def _numbers(path: Path, rows: list[dict[str, str]], columns: tuple[str, ...]) -> Floats:
    """The ``columns`` as finite numbers, (rows, columns); `ResultError` names one that is not."""
    try:
        values = np.array([[float(row[name]) for name in columns] for row in rows], dtype=float)
    except ValueError:
        values = np.array([[_number(row[name]) for name in columns] for row in rows], dtype=float)
    values = values.reshape(len(rows), len(columns))
    if not np.isfinite(values).all():
        row, column = np.argwhere(~np.isfinite(values))[0]
        text = rows[row][columns[column]]
        raise ResultError(
            f"{path.name}, line {row + 2}: {columns[column]} is {text!r}, not a finite number"
        )
    return values


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan


def read_nodes(path: Path, assembly: Assembly) -> tuple[Floats, np.ndarray]:
    """Forces (N, 3) in the frame of the face, in N on the piece above, and bonds (N,).

    `ResultError` unless the nodes are those of ``assembly``, in its order.
    """
    rows = read_table(path, NODE_COLUMNS)
    nodes = assembly.nodes
    if len(rows) != len(nodes.area):
        raise ResultError(f"{path.name}: {len(rows)} nodes, but the case has {len(nodes.area)}")
    values = _numbers(path, rows, (*POSITION, "area_m2", *STRESS, "bonded"))
    names = np.array([assembly.faces[number].name for number in nodes.face])
    apart = np.abs(values[:, :3] - nodes.position).max(axis=1) > CLOSE * assembly.length
    other = np.abs(values[:, 3] - nodes.area) > CLOSE * nodes.area
    wrong = apart | other | (np.array([row["face"] for row in rows]) != names)
    if wrong.any():
        number = int(np.flatnonzero(wrong)[0])
        raise ResultError(
            f"{path.name}, line {number + 2}: must be node {number + 1} of the case, on "
            f"{names[number]}"
        )
    return stress_to_force(nodes, face_frames(assembly), values[:, 4:8]), values[:, 8] > 0


def stress_to_force(nodes: Nodes, frames: Floats, stress: Floats) -> Floats:
    """Forces (N, 3) in N in the frame of the face, from normal and shear stress (Pa), (N, 4)."""
    force = np.empty((len(stress), 3))
    force[:, 0] = stress[:, 0] * nodes.area
    force[:, 1:] = np.einsum("ntx,nx->nt", frames[:, 1:], stress[:, 1:]) * nodes.area[:, None]
    return force


def force_to_stress(nodes: Nodes, frames: Floats, force: Floats) -> Floats:
    """The inverse of `stress_to_force`: normal and shear stress along x, y, z in Pa, (N, 4)."""
    stress = force / nodes.area[:, None]
    shear = np.einsum("nt,ntx->nx", stress[:, 1:], frames[:, 1:])
    return np.column_stack([stress[:, 0], shear])


def _read_history(path: Path) -> tuple[State, ...]:
    """Loads and displacements of the equilibria on the way."""
    rows = read_table(path, ("load_N", "displacement_m"))
    if rows and "stage" in rows[0]:
        rows = [row for row in rows if row["stage"] == "equilibrium"]
    values = _numbers(path, rows, ("load_N", "displacement_m"))
    return tuple(State(float(load), float(moved)) for load, moved in values)


def write_record(record: CaseRecord, path: Path) -> None:
    """Write ``record``, completely or not at all."""
    draft = path.with_suffix(".draft")
    draft.unlink(missing_ok=True)  # it may be a link
    draft.write_text(record.to_json() + "\n")
    draft.replace(path)


def read_records(paths: Sequence[Path]) -> list[CaseRecord]:
    """All records in files that hold one per line; `ResultError` names the file and line."""
    return read_lines(paths, CaseRecord.from_json)


def read_lines(paths: Sequence[Path], record_in: Callable[[str], T]) -> list[T]:
    """`read_records` of any kind: what ``record_in`` finds in each line."""
    records = []
    for path in paths:
        for number, line in enumerate(path.read_text().splitlines(), start=1):
            try:
                records.append(record_in(line))
            except ResultError as error:
                raise ResultError(f"{path}, line {number}: {error}") from None
    return records


def read_times(results: Path) -> Iterator[tuple[str, float, float]]:
    """Kind of each job that Snakemake measured, its time on the clock and of processors, in s."""
    for path in sorted((results / BENCHMARKS).rglob("*.tsv")):
        (row,) = csv.DictReader(path.read_text().splitlines(), delimiter="\t")
        kind = path.relative_to(results / BENCHMARKS).parts[0]
        if row["cpu_time"] != "NA":  # it ended before it was looked at
            yield kind, float(row["s"]), float(row["cpu_time"])
