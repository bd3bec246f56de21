"""The files that an engine leaves: read, checked, and held against the static model."""

import csv
import json
import math
from pathlib import Path

import numpy as np

from sidmacib.engines.scripts.records import HISTORY, MODES, NODES, RESULT
from sidmacib.errors import ResultError
from sidmacib.mechanics.assembly import Assembly, Floats, Nodes
from sidmacib.mechanics.equilibrium import face_frames
from sidmacib.problem import FIRST_FAILURE, PEAK, Failures, Outcome, State

BROKEN = "_broken_share"  # suffix of a history's columns of broken bonds
POSITION = ("x_m", "y_m", "z_m")
STRESS = ("normal_Pa", "shear_x_Pa", "shear_y_Pa", "shear_z_Pa")
NODE_COLUMNS = ("face", "kind", *POSITION, "area_m2", *STRESS, "bonded")
Rows = list[dict[str, str]]
UNREADABLE = (ValueError, OverflowError, TypeError, KeyError, AttributeError, RecursionError)
MOST_LETTERS = 100  # letters, of what is wrong with a file
SAME = 1e-9  # of a load that stands in two files
BEYOND = 10.0  # over the peak: no load so large is tried with success
APART = 0.1  # of a load of the static model: what differs by more is said
LEAST_OF_FIRST_FAILURE = 0.8  # peak of an engine over the first failure of the static model
SLACK = 1e-6  # of a tolerance: rounding
CLOSE = 1e-6  # of the assembly's length or a node's area: printed numbers are rounded


def read_outcome(folder: Path, assembly: Assembly) -> Outcome:
    """The outcome that an engine left in ``folder``; `ResultError` names file and line."""
    peak, failed, first, mode = _read_result(folder / RESULT)
    nodes = read_nodes(folder / NODES, assembly)
    rows, path = read_history(folder)
    _check_history(path, peak, assembly)
    at_peak = State(peak, path[-1].displacement if path else None, *nodes)
    before = [state for state in path if state.load < peak * (1.0 - 1e-12)]
    broken = _broken_at(folder / HISTORY, rows, assembly)
    return Outcome((*before, at_peak), failed, first, mode, peak_load=peak, broken_at=broken)


def check_bracket(outcome: Outcome, tolerance: float, least: float) -> None:
    """Raise `ResultError` where the failed load is further above the peak than ``tolerance``.

    ``least``: load (N) that the tolerance refers to where the peak is smaller.
    """
    peak, failed = outcome.path[-1].load, outcome.failed_load
    allowed = tolerance * max(peak, least)
    if not failed - peak <= allowed * (1.0 + SLACK):
        raise ResultError(
            f"failed load {failed:g} N is not allowed; it must be at most {allowed:g} N, the "
            f"tolerance, above the peak of {peak:g} N"
        )


def check_first_failure(outcome: Outcome, expected: float) -> None:
    """Raise `ResultError` where the peak is far below the load at which a node should fail first.

    ``expected``: that load in the static model, in N. First failures agree within 1 % where both
    models see the same, so an engine that gives way at much less has seen something else.
    """
    peak = outcome.path[-1].load
    if peak < LEAST_OF_FIRST_FAILURE * expected:
        raise ResultError(
            f"peak of {peak:g} N contradicts the static model, in which nothing fails up to "
            f"{expected:g} N; it must be at least {LEAST_OF_FIRST_FAILURE:g} of that"
        )


def disagreement(peak: float | None, first: float | None, static: Failures) -> str:
    """In which load an engine differs from the ``static`` model, in words; nothing if in none.

    ``peak``, ``first``: those of the engine, None if it does not say; all loads in one unit. Of the
    static model, a load that is not known is nan. A peak below its first failure matters most, then
    the peak.
    """
    if peak is not None and peak < (1.0 - APART) * static.first:
        return _difference(PEAK, peak, FIRST_FAILURE, static.first)
    for which, found, expected in ((PEAK, peak, static.peak), (FIRST_FAILURE, first, static.first)):
        if found is not None and abs(found - expected) > APART * expected:
            return _difference(which, found, which, expected)
    return ""


def _difference(which: str, found: float, other: str, expected: float) -> str:
    way = "below" if found < expected else "above"
    apart = f"{100.0 * abs(found / expected - 1.0):.0f} %" if expected else "far"
    return f"disagrees with the static model: {which} {apart} {way} its {other}"


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


def read_table(path: Path, columns: tuple[str, ...]) -> Rows:
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


def _numbers(path: Path, rows: Rows, columns: tuple[str, ...]) -> Floats:
    """The ``columns`` as finite numbers, (rows, columns); `ResultError` names one that is not."""
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
    values = _numbers(path, rows, NODE_COLUMNS[2:])
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


def read_history(folder: Path) -> tuple[Rows, tuple[State, ...]]:
    """Rows of the history in ``folder``; loads and displacements of the equilibria among them."""
    columns = "load_N", "displacement_m"
    rows = read_table(folder / HISTORY, columns)
    at_rest = [row for row in rows if row.get("stage", "equilibrium") == "equilibrium"]
    values = _numbers(folder / HISTORY, at_rest, columns)
    return rows, tuple(State(float(load), float(moved)) for load, moved in values)


def _broken_at(history: Path, rows: Rows, assembly: Assembly) -> dict[int, float]:
    """The least load (N) with a broken share of each face; in the order of loads, then shares."""
    faces = {f"{face.name}{BROKEN}": number for number, face in enumerate(assembly.faces)}
    names = [name for name in faces if rows and name in rows[0]]
    loads, *shares = _numbers(history, rows, ("load_N", *names)).T.tolist()
    broken = sorted(
        (load, -share, faces[name])
        for name, own in zip(names, shares, strict=True)
        for load, share in zip(loads, own, strict=True)
        if share > 0.0
    )
    found: dict[int, float] = {}
    for load, _, number in broken:
        found.setdefault(number, load)
    return found
