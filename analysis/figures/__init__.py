"""Figures of a study. To add one: an entry here and a function in a module beside it."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from sidmacib.models import detailed
from workflow.case import REFERENCE, JointCase
from workflow.cases import cases_of
from workflow.schema import Study

MOST_SAMPLES = 12  # that are drawn: a sweep over many has tables

REVISED = ("half", "lower_sum")  # reductions that the figure of revised SiDMACIB has

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
    case: JointCase | None = None


def drawn_files(names: Iterable[str]) -> list[str]:
    """The files of the figures of these ``names``, below the results folder."""
    return [f"figures/{name}.{kind}" for name in names for kind in ("png", "pdf")]


def figures_of(study: Study, cases: Iterable[JointCase] | None = None) -> dict[str, FigureSpec]:
    """All figures of ``study`` by name; ``cases``: its cases, if known already."""
    if cases is None:
        cases = cases_of(study).values()
    return {spec.name: spec for spec in _figures(study, list(cases))}


def shown_samples(study: Study) -> tuple[str, ...]:
    """The samples that figures show: the first ones."""
    return tuple(study.samples)[:MOST_SAMPLES]


def followed_models(study: Study, sample: str) -> tuple[str, ...]:
    """The detailed models that run the whole of a sample, the leading one first."""
    return detailed(study.models_of_whole(sample))


def _figures(study: Study, cases: list[JointCase]) -> Iterator[FigureSpec]:
    for sample in shown_samples(study):
        yield FigureSpec(f"joint-{sample}", "joint", sample)
        interlocking = sample in study.interlocking
        if interlocking:
            yield FigureSpec(f"options-{sample}", "options", sample)
        followed = followed_models(study, sample)
        own_engines = [model for model in study.dem.engines if model in study.models_of(sample)]
        for model in dict.fromkeys((*followed[:1], *own_engines)):
            chosen = _stress_cases(cases, study, model, sample)
            if not chosen:
                continue
            suffix = "" if model == followed[0] else f"-{model}"
            for kind, case in (
                ("shear_stress", _nearest(chosen, 0.0)),
                ("torsion_stress", _nearest(chosen, study.figures.eccentricity)),
            ):
                yield FigureSpec(f"{kind}-{sample}{suffix}", kind, sample, case)
        if interlocking and set(REVISED) & set(study.sidmacib.reductions):
            yield FigureSpec(f"revised-{sample}", "revised", sample)
        yield FigureSpec(f"models-{sample}", "models", sample)
    yield FigureSpec("meshes", "meshes")
    yield FigureSpec("side_by_side", "side_by_side")
    if any(change.young for change in study.variants.values()):
        yield FigureSpec("stiffness", "stiffness")
    if any(change.fracture_energy for change in study.variants.values()):
        yield FigureSpec("fracture_energy", "fracture_energy")


def _stress_cases(cases: list[JointCase], study: Study, model: str, sample: str) -> list[JointCase]:
    """Those of the reference variant, at the mesh of the stress maps."""
    mesh, wanted = study.figures.mesh or min(study.meshes), (model, REFERENCE, sample)
    return [
        case
        for case in cases
        if (case.model, case.variant, case.subject.sample) == wanted
        and math.isclose(case.subject.mesh, mesh)
    ]


def _nearest(chosen: list[JointCase], ratio: float) -> JointCase:
    """The case whose eccentricity over a is next to ``ratio``."""
    return min(chosen, key=lambda case: abs(case.subject.direction.eccentricity - ratio))
