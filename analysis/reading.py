"""Read what the workflow left: a model's results for a case, tables, and published numbers."""

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd
import yaml

from sidmacib.pieces import lock_faces
from workflow.case import Case
from workflow.results import NODE_COLUMNS
from workflow.schema import Study
from workflow.schema.assembly import AssemblySection


@dataclass(frozen=True)
class CaseResult:
    """What a model found for a case.

    ``peak_load`` and ``failed_load``: the largest load at equilibrium and the smallest one above
    it that failed, along the case's direction, in N; ``first_failure_load``: where the first node
    failed, None where a model does not tell. ``nodes``: stresses at the peak, one row per node with
    `workflow.results.NODE_COLUMNS`; normal stress is positive in compression, shear is that on the
    piece above. ``history``: one row per look at the joint.
    """

    case: Case
    peak_load: float
    failed_load: float
    first_failure_load: float | None
    nodes: pd.DataFrame
    history: pd.DataFrame

    @property
    def shear(self) -> float:
        """V at the peak, in N."""
        return self.peak_load * self.case.direction.shear

    @property
    def torque(self) -> float:
        """M at the peak, in N m."""
        return self.peak_load * self.case.direction.torque * self.case.joint.a


def read_case(folder: Path) -> CaseResult:
    """The case in ``folder``; ValueError if its nodes lack a column."""
    result = json.loads((folder / "result.json").read_text())
    nodes = pd.read_csv(folder / "nodes.csv")
    if missing := set(NODE_COLUMNS) - set(nodes.columns):
        raise ValueError(f"{folder / 'nodes.csv'}: no column {', '.join(sorted(missing))}")
    case = Case.from_json((folder / "case.json").read_bytes())
    nodes.insert(2, "lock", nodes["face"].map(lock_faces(case.joint)).fillna(0).astype(int))
    return CaseResult(
        case=case,
        peak_load=result["peak_load_N"],
        failed_load=result["failed_load_N"],
        first_failure_load=result.get("first_failure_load_N"),
        nodes=nodes,
        history=pd.read_csv(folder / "history.csv"),
    )


@dataclass(frozen=True)
class Published:
    """The paper's numbers, see published.yaml."""

    numbers: dict[str, Any]

    def covers(self, study: Study, sample: str) -> bool:
        """Whether the paper has numbers for ``sample``, loaded as in ``study``.

        Strength, friction, locks, failure, the cut of the body and the load must be the paper's;
        sizes may differ, as it gives a * b only. Its numbers are for e = 0.
        """
        joint, own = study.joint(sample), self.numbers["sample"]
        return (
            math.isclose(joint.T0, own["T0"])
            and math.isclose(joint.dry.friction, own["friction"])
            and joint.locks in self.numbers["weights"]
            and study.assembly == AssemblySection()
            and 0.0 in study.eccentricities
        )

    def samples(self, study: Study) -> dict[str, int]:
        """Names and numbers of locks of the study's samples that the paper has."""
        return {n: s.locks for n, s in study.samples.items() if self.covers(study, n)}

    def dem_pure_shear(self, locks: int, mesh: float) -> float | None:
        """Published peak V at e = 0, in N, if there is one for this mesh (m)."""
        value: float | None = self.numbers["dem_pure_shear"][locks].get(mesh)
        return value


def read_published() -> Published:
    """The published numbers."""
    return Published(yaml.safe_load(Path(__file__).with_name("published.yaml").read_text()))
