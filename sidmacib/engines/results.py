"""The files that an engine leaves, read and held against the static model."""

import csv
import json
from pathlib import Path

import numpy as np

from sidmacib.engines.scripts.records import HISTORY, NODES, RESULT, EngineOutcome
from sidmacib.errors import ResultError
from sidmacib.mechanics.assembly import Assembly, Floats, Nodes
from sidmacib.mechanics.equilibrium import face_frames
from sidmacib.problem import FIRST_FAILURE, PEAK, Failures, Outcome, State

STRESS = ("normal_Pa", "shear_x_Pa", "shear_y_Pa", "shear_z_Pa")
NODE_COLUMNS = ("face", "kind", "x_m", "y_m", "z_m", "area_m2", *STRESS, "bonded")
Rows = list[dict[str, str]]
UNREADABLE = (OSError, csv.Error, ValueError, TypeError, LookupError, ArithmeticError)
MOST_LETTERS = 100  # letters, of what is wrong with a file
APART = 0.1  # of a load of the static model: what differs by more is said
LEAST_OF_FIRST_FAILURE = 0.8  # peak of an engine over the first failure of the static model


def read_outcome(folder: Path, assembly: Assembly) -> Outcome:
    """The outcome that an engine left in ``folder``; `ResultError` if its files are unreadable."""
    try:
        result = json.loads((folder / RESULT).read_text())
        peak, failed = float(result["peak_load_N"]), float(result["failed_load_N"])
        first, mode = result["first_failure_load_N"], str(result["mode"])
        first = None if first is None else float(first)
        nodes = _read_nodes(folder / NODES, assembly)
        rows, path = read_history(folder)
        at_peak = State(peak, path[-1].displacement, *nodes)
        broken = _broken_at(rows, assembly)
    except UNREADABLE as error:
        raise ResultError(f"results unreadable: {str(error)[:MOST_LETTERS]}") from None
    before = [state for state in path if state.load < peak * (1.0 - 1e-12)]
    return Outcome((*before, at_peak), failed, first, mode, peak_load=peak, broken_at=broken)


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


def _rows(path: Path) -> Rows:
    with path.open(newline="") as stream:
        return list(csv.DictReader(stream))


def _read_nodes(path: Path, assembly: Assembly) -> tuple[Floats, np.ndarray]:
    """Forces (N, 3) in the frame of the face, in N on the piece above, and bonds (N,)."""
    columns = (*STRESS, "bonded")
    values = np.array([[float(row[name]) for name in columns] for row in _rows(path)])
    return stress_to_force(assembly.nodes, face_frames(assembly), values[:, :4]), values[:, 4] > 0


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
    rows = _rows(folder / HISTORY)
    at_rest = [row for row in rows if row["stage"] == EngineOutcome.EQUILIBRIUM.value]
    return rows, tuple(State(float(r["load_N"]), float(r["displacement_m"])) for r in at_rest)


def _broken_at(rows: Rows, assembly: Assembly) -> dict[int, float]:
    """The least load (N) with a broken share of each face; in the order of loads, then shares."""
    broken = sorted(
        (float(row["load_N"]), -float(share), number)
        for row in rows
        for number, face in enumerate(assembly.faces)
        if float(share := row.get(f"{face.name}_broken_share", 0.0)) > 0.0
    )
    found: dict[int, float] = {}
    for load, _, number in broken:
        found.setdefault(number, load)
    return found
