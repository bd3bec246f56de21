"""What a figure is drawn from."""

from dataclasses import dataclass

import pandas as pd

from analysis.figures.catalogue import IN_THE_PAPER, FigureSpec
from analysis.reading import CaseResult, read_published
from workflow.case import REFERENCE
from workflow.models import detailed
from workflow.schema import Study


@dataclass(frozen=True)
class Material:
    """A figure's specification, the study, tables, and the stresses that the figure shows.

    ``table``: the models beside each other, as `analysis.models` writes it.
    """

    spec: FigureSpec
    study: Study
    capacity: pd.DataFrame
    validation: pd.DataFrame
    table: pd.DataFrame
    result: CaseResult | None

    @property
    def models(self) -> tuple[str, ...]:
        """The models of the joint's pieces, the leading one first, those from elsewhere last."""
        own = self.table["model"].unique()
        ordered = [m for m in (*detailed(self.study.model_names), *self.study.models) if m in own]
        return *dict.fromkeys(ordered), *(model for model in own if model not in ordered)

    @property
    def leading(self) -> str:
        """The model that SiDMACIB is shown against."""
        return detailed(self.study.model_names)[0]

    def curve(self, model: str, sample: str, mesh: float) -> pd.DataFrame:
        """Capacities of a model in the reference variant, from pure shear to pure torsion."""
        rows = self.capacity[
            (self.capacity["model"] == model)
            & (self.capacity["variant"] == REFERENCE)
            & (self.capacity["sample"] == sample)
            & (self.capacity["mesh_m"] == mesh)
        ]
        return rows.sort_values("eccentricity_m")

    @property
    def sample(self) -> str:
        """The sample that the figure shows."""
        assert self.spec.sample is not None, f"{self.spec.name} shows no single sample"
        return self.spec.sample

    @property
    def assumed_geometry(self) -> str:
        """What to say of the geometry where it stands for the paper's."""
        if read_published().samples(self.study):
            return "Assumed: a, b, h and H (the paper's text gives a·b only)."
        return ""

    @property
    def place_in_paper(self) -> str:
        """Which figure of the paper this redraws, as a sentence; empty if none."""
        numbers = IN_THE_PAPER.get(self.spec.kind, {})
        locks = [s.locks for s in self.study.samples.values()]
        if self.spec.sample is not None:
            locks = [self.study.samples[self.spec.sample].locks]
        found = [numbers[n] for n in locks if n in numbers and self.assumed_geometry]
        return f"{' and '.join(found)} of the paper, redrawn. " if found else ""
