"""Which figures a study has. To add one: an entry here and a function in a module beside it."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from workflow.case import REFERENCE, Case
from workflow.cases import cases_of
from workflow.models import detailed
from workflow.schema import Study

# Figures of the paper that each kind redraws, by number of locks.
IN_THE_PAPER = {
    "options": {3: "Figure 6", 5: "Figure 11"},
    "meshes": {3: "Figure 7"},
    "shear_stress": {3: "Figure 8", 5: "Figure 12"},
    "torsion_stress": {3: "Figure 9", 5: "Figure 13"},
    "revised": {3: "Figure 10", 5: "Figure 14"},
}


@dataclass(frozen=True)
class FigureSpec:
    """A figure: its kind decides how it is drawn; ``case`` is the one whose stresses it shows."""

    name: str
    kind: str
    sample: str | None = None
    case: Case | None = None


def figures_of(study: Study) -> dict[str, FigureSpec]:
    """All figures of ``study`` by name."""
    return {spec.name: spec for spec in _figures(study)}


def _figures(study: Study) -> Iterator[FigureSpec]:
    cases = list(cases_of(study).values())
    for sample in study.samples:
        yield FigureSpec(f"options-{sample}", "options", sample)
        for model in study.dem.engines or detailed(study.model_names)[:1]:
            own = [case for case in cases if case.model == model and case.sample == sample]
            suffix = "" if model == detailed(study.model_names)[0] else f"-{model}"
            for kind, case in (
                ("shear_stress", _stress_case(own, study, lambda ratio: ratio)),
                (
                    "torsion_stress",
                    _stress_case(own, study, lambda ratio: abs(ratio - study.figures.eccentricity)),
                ),
            ):
                yield FigureSpec(f"{kind}-{sample}{suffix}", kind, sample, case)
        yield FigureSpec(f"revised-{sample}", "revised", sample)
        yield FigureSpec(f"models-{sample}", "models", sample)
    yield FigureSpec("meshes", "meshes")
    yield FigureSpec("side_by_side", "side_by_side")


def _stress_case(own: list[Case], study: Study, distance: Callable[[float], float]) -> Case:
    """The reference case, at the mesh of the stress maps, of least ``distance`` in e / a."""
    mesh = study.figures.mesh or min(study.meshes)
    shown = [case for case in own if case.variant == REFERENCE and math.isclose(case.mesh, mesh)]
    return min(shown, key=lambda case: distance(case.direction.eccentricity))
