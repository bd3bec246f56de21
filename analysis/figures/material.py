"""Data that figures are drawn from."""

from dataclasses import dataclass

import pandas as pd

from analysis.figures import IN_THE_PAPER, FigureSpec
from analysis.published import read_published
from analysis.tables import study_points
from workflow.case import REFERENCE, JointCase
from workflow.results.joint_part import JointRecord
from workflow.schema import Study


@dataclass(frozen=True)
class Stresses:
    """The case that a stress map shows: its record and its nodes, in `NODE_COLUMNS`."""

    case: JointCase
    record: JointRecord
    nodes: pd.DataFrame


@dataclass(frozen=True)
class FigureData:
    """A figure's specification, the study, its tables, and the stresses that the figure shows.

    ``detailed``: the models that SiDMACIB is compared with, the leading one first. ``table``: the
    models beside each other.
    """

    spec: FigureSpec
    study: Study
    detailed: tuple[str, ...]
    capacity: pd.DataFrame
    validation: pd.DataFrame
    table: pd.DataFrame
    envelopes: pd.DataFrame
    variants: pd.DataFrame
    stresses: Stresses | None

    @property
    def models(self) -> tuple[str, ...]:
        """The models of the joint's pieces, the leading one first, those from elsewhere last."""
        rows = self.table
        if self.spec.sample is not None:
            rows = rows[rows["sample"] == self.spec.sample]
        names = rows["model"].unique()
        ordered = [m for m in (*self.detailed, *self.study.models) if m in names]
        return *dict.fromkeys(ordered), *(model for model in names if model not in ordered)

    def detailed_of(self, sample: str) -> tuple[str, ...]:
        """The detailed models that run on the whole of a sample, the leading one first."""
        names = self.study.models_of(sample)
        whole = (model for model in self.detailed if self.study.whole_curve(sample, model))
        return tuple(model for model in whole if model in names)

    @property
    def leading(self) -> str:
        """The model that SiDMACIB is shown against."""
        return self.detailed_of(self.sample)[0]

    def in_order(self, table: pd.DataFrame, sample: str, mesh: float) -> pd.DataFrame:
        """Rows of ``table`` for a sample at a mesh (m), from pure shear to pure torsion."""
        rows = study_points(self.study, table[table["sample"] == sample])
        return rows[rows["mesh_m"] == mesh].sort_values("eccentricity_over_a", kind="stable")

    def curve(self, model: str, sample: str, mesh: float) -> pd.DataFrame:
        """Capacities of a model in the reference variant, from pure shear to pure torsion."""
        rows = self.capacity[
            (self.capacity["model"] == model) & (self.capacity["variant"] == REFERENCE)
        ]
        return self.in_order(rows, sample, mesh).dropna(subset=["load_N"])

    @property
    def sample(self) -> str:
        """The sample that the figure shows."""
        assert self.spec.sample is not None, f"{self.spec.name} shows no single sample"
        return self.spec.sample

    @property
    def assumed_geometry(self) -> str:
        """Words on geometry and friction where they stand for the paper's."""
        published = read_published()
        samples = published.samples(self.study)
        if not samples:
            return ""
        shown = [s for s in samples if self.spec.sample in (None, s)]
        other = [s for s in shown if not published.as_printed(self.study, s)]
        words = "Assumed: a, b, h and H (the paper's text gives a·b only)."
        if other:
            frictions = {f"{self.study.joint(s).dry.friction:.4g}" for s in other}
            words += (
                f" {', '.join(other)}: friction {', '.join(sorted(frictions))} on dry faces, to "
                f"fit, not the printed {published.numbers['sample']['friction']:g}."
            )
        return words

    @property
    def place_in_paper(self) -> str:
        """A sentence that names the figure of the paper this redraws; empty if none."""
        numbers = IN_THE_PAPER.get(self.spec.kind, {})
        published = read_published().samples(self.study)
        shown = self.spec.sample
        locks = [n for sample, n in published.items() if shown in (None, sample)]
        found = [numbers[n] for n in locks if n in numbers]
        return f"{' and '.join(dict.fromkeys(found))} of the paper, redrawn. " if found else ""
