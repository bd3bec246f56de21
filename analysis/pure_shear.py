"""Weights in pure shear, which the paper prints and the reductions use."""

import pandas as pd

from workflow.case import REFERENCE, case_name
from workflow.schema import Study


def pure_shear_weights(
    study: Study, weights: pd.DataFrame, sample: str
) -> dict[tuple[str, float], list[float]]:
    """Weights of a sample's locks by model and mesh, in the reference variant.

    They are read at the smallest eccentricity of the study: pure shear, as in the paper.
    """
    least = {case_name(sample, mesh, min(study.eccentricities)): mesh for mesh in study.meshes}
    rows = weights[(weights["variant"] == REFERENCE) & weights["case"].isin(least)]
    return {
        (str(model), least[str(case)]): group.sort_values("lock")["weight"].tolist()
        for (model, case), group in rows.groupby(["model", "case"], sort=False)
    }
