"""Files of a script: the history of the search, the stresses at the peak, the result."""

import csv
import json
import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import Enum
from pathlib import Path
from typing import Any

from .assembly import GivenAssembly, Guide, Vector

Row = dict[str, Any]
HISTORY, NODES, RESULT = "history.csv", "nodes.csv", "result.json"
OUTPUTS = (HISTORY, NODES, RESULT)
BONDS = "bonds"  # at the load that failed, bonds broke
MECHANISM = "mechanism"  # the pieces slid or overturned, and no bond broke
FIRST_FAILURE = "first failure"  # bonds would break; what comes after it is not known
FALLS_ALONE = "it does not stand under its permanent loads"
NO_ANSWER = 3  # exit code of a script that says why there is no result


class NoAnswerError(SystemExit):
    """The reason why there is no result; another run would end with the same reason."""

    def __init__(self, reason: str) -> None:
        super().__init__(reason)
        print(reason, file=sys.stderr)
        self.code = NO_ANSWER


class EngineOutcome(Enum):
    """Outcome of raising the load or cutting bonds of an assembly."""

    EQUILIBRIUM = "equilibrium"
    COLLAPSE = "collapse"  # pieces fall
    DRIFT = "drift"  # pieces move off where the load does no work
    MEETING = "meeting"  # pieces touch where they have no contact
    OVERSTRESSED = "overstressed"  # bonds will fail, so that nobody waited for an equilibrium
    UNSETTLED = "no equilibrium"  # it neither came to rest nor moved far


@dataclass(frozen=True)
class NodeForce:
    """Normal force (compression positive), shear on the piece above, in N; whether it is bonded."""

    normal: float
    shear: Vector
    bonded: bool


@dataclass(frozen=True)
class EnginePeak:
    """The largest load carried, in N, and the results at it.

    ``failed_load``: the smallest known that is not carried; ``first_failure_load``: where the first
    node failed, None if none did. ``mode``: how it failed, `BONDS`, `MECHANISM` or `FIRST_FAILURE`.
    ``nodes``: the forces at the peak.
    """

    load: float
    failed_load: float
    first_failure_load: float | None
    mode: str
    nodes: Sequence[NodeForce]


@dataclass
class History:
    """Every equilibrium and failure on the way to the peak."""

    assembly: GivenAssembly
    time_steps: int = 0  # in all, those of failed attempts included
    attempts: int = 0
    rows: list[Row] = field(default_factory=list)

    def record(
        self,
        load: float,
        stage: str,
        displacement: float,
        unbalanced_ratio: float,
        nodes: Sequence[NodeForce],
    ) -> None:
        """Add a row: load (N), displacement (m), shear (N) and broken share of each inner face.

        The shear along z only of faces that are not rectangles along the axes.
        """
        faces = self.assembly.faces
        inner: dict[int, list[NodeForce]] = {k: [] for k, face in enumerate(faces) if face.cohesive}
        for force, node in zip(nodes, self.assembly.nodes, strict=True):
            if node.face in inner:
                inner[node.face].append(force)
        row = {
            "time_step": self.time_steps,
            "attempt": self.attempts,
            "stage": stage,
            "load_N": load,
            "displacement_m": displacement,
            "unbalanced_ratio": unbalanced_ratio,
        }
        for number, forces in inner.items():
            for k, axis in enumerate("xyz" if faces[number].tangents else "xy"):
                shear = sum(force.shear[k] for force in forces)
                row[f"{faces[number].name}_shear_{axis}_N"] = shear
        for number, forces in inner.items():
            bonded = sum(force.bonded for force in forces)
            row[f"{faces[number].name}_broken_share"] = 1.0 - bonded / len(forces)
        self.rows.append(row)

    def write(self, peak: EnginePeak, engine: str, version: str) -> None:
        """Write ``history.csv``, ``nodes.csv`` and at the very end ``result.json``.

        Exits with a reason if a load or a stress is no number.
        """
        table = [node_row(self.assembly, number, force) for number, force in enumerate(peak.nodes)]
        numbers = [value for row in table for value in row.values() if isinstance(value, float)]
        if not all(map(math.isfinite, [peak.load, peak.failed_load, *numbers])):
            raise SystemExit("the computation has diverged: its results are not finite numbers")
        write_table(HISTORY, self.rows)
        write_table(NODES, table)
        result = {
            "peak_load_N": peak.load,
            "failed_load_N": peak.failed_load,
            "first_failure_load_N": peak.first_failure_load,
            "mode": peak.mode,
            "time_steps": self.time_steps,
            "engine": engine,
            "engine_version": version,
        }
        Path(RESULT).write_text(json.dumps(result, indent=1) + "\n")


def require_contacts(outcome: EngineOutcome | None, load: str, met: str | None) -> None:
    """Exit with the reason if pieces have ``met`` at a ``load``: what follows is not known."""
    if outcome is EngineOutcome.MEETING:
        raise NoAnswerError(f"no peak: at {load} {met}, and contacts there are not modelled")


def require_standing(outcome: EngineOutcome, met: str | None, guide: Guide | None) -> None:
    """Exit with the reason if the assembly does not stand without the load.

    ``guide``: of the static model, in which it then does.
    """
    require_contacts(outcome, "0 N", met)
    if outcome is not EngineOutcome.EQUILIBRIUM:
        hint = ", but does in the static model: try a smaller time_step_ratio" if guide else ""
        raise NoAnswerError(f"{FALLS_ALONE}{hint}")


def failure_mode(outcome: EngineOutcome, breaks: bool, load: str, met: str | None) -> str:
    """Mode of failure of the assembly at a ``load``; exits with a reason if it did not fail."""
    require_contacts(outcome, load, met)
    if breaks:
        return BONDS
    if outcome is EngineOutcome.COLLAPSE:
        return MECHANISM
    drifts = outcome is EngineOutcome.DRIFT
    words = "drift off where the load does no work" if drifts else "neither rest nor fall"
    raise NoAnswerError(f"no peak: at {load} no bond breaks, and the pieces {words}")


def node_row(assembly: GivenAssembly, number: int, force: NodeForce) -> Row:
    """A node's place, area and stresses."""
    node = assembly.nodes[number]
    face = assembly.faces[node.face]
    x, y, z = node.position_m
    return {
        "face": face.name,
        "kind": face.kind,
        "x_m": x,
        "y_m": y,
        "z_m": z,
        "area_m2": node.area_m2,
        "normal_Pa": force.normal / node.area_m2,
        "shear_x_Pa": force.shear[0] / node.area_m2,
        "shear_y_Pa": force.shear[1] / node.area_m2,
        "shear_z_Pa": force.shear[2] / node.area_m2,
        "bonded": int(force.bonded),
    }


def write_table(name: str, rows: Sequence[Row]) -> None:
    """Write rows as CSV."""
    with Path(name).open("w", newline="") as stream:
        writer = csv.DictWriter(stream, rows[0])
        writer.writeheader()
        writer.writerows(rows)
