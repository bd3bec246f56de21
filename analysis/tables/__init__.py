"""Rows of tables at the meshes and directions that a study asks for, and how far curves are apart.

Without a solver: steps that only read fits load none.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from sidmacib.mechanics.assembly import Floats
from workflow.case import REFERENCE
from workflow.schema import Study


def study_points(study: Study, rows: pd.DataFrame) -> pd.DataFrame:
    """The ``rows`` at the meshes and directions of ``study``, with ``eccentricity_over_a``.

    Cases that were run for the mesh error alone are left out. ``rows`` have the columns ``sample``,
    ``mesh_m`` and ``eccentricity_m``; meshes and ratios e / a become exactly those of the study,
    which tables have to ten digits.
    """
    lengths = {sample: study.joint(sample).a for sample in study.samples}
    ratio = rows["eccentricity_m"].astype(float) / rows["sample"].map(lengths).astype(float)
    placed = rows.assign(
        mesh_m=_nearest(rows["mesh_m"].astype(float), study.meshes),
        eccentricity_over_a=_nearest(ratio, study.eccentricities),
    )
    return placed.dropna(subset=["mesh_m", "eccentricity_over_a"])


def _nearest(values: pd.Series, allowed: tuple[float, ...]) -> pd.Series:
    """Those ``allowed`` that the ``values`` are rounded from; nan for others."""
    exact = pd.Series(np.nan, index=values.index)
    for value in allowed:
        exact[np.isclose(values, value, rtol=1e-9, atol=1e-12)] = value
    return exact


def pure_shear_weights(
    study: Study, weights: pd.DataFrame, sample: str
) -> dict[tuple[str, float], list[float]]:
    """Weights of a sample's locks by model and mesh, in the reference variant.

    They are read at the smallest eccentricity of the study: pure shear, as in the paper.
    """
    rows = weights[(weights["variant"] == REFERENCE) & (weights["sample"] == sample)]
    rows = study_points(study, rows)
    rows = rows[rows["eccentricity_over_a"] == min(study.eccentricities)]
    return {
        (str(model), float(str(mesh))): locks.sort_values("lock")["weight"].tolist()
        for (model, mesh), locks in rows.groupby(["model", "mesh_m"], sort=False)
    }


@dataclass(frozen=True)
class LoadErrors:
    """Relative errors of a curve: root mean square, largest unsafe and largest safe one."""

    misfit: float
    largest_unsafe_error: float
    largest_safe_error: float


def misfit(promised: Floats, carried: Floats) -> LoadErrors:
    """Errors of SiDMACIB's loads against those of a detailed model, both in N, of shape (N,)."""
    error = promised / carried - 1.0
    return LoadErrors(
        float(np.sqrt(np.mean(error**2))),
        float(max(error.max(), 0.0)),
        float(max(-error.min(), 0.0)),
    )


def winner(fit: pd.DataFrame, sample: str, mesh: float, **chosen: object) -> pd.Series:
    """The row of ``fit`` that fits a sample at a mesh best, among those with ``chosen`` values."""
    rows = fit[(fit["sample"] == sample) & np.isclose(fit["mesh_m"], mesh)]
    for column, value in chosen.items():
        rows = rows[rows[column] == value]
    return rows.sort_values("misfit", kind="stable").iloc[0]
