"""Rows of tables at the meshes and directions that a study asks for, and how far curves are apart.

Without a solver: steps that only read fits load none.
"""

import numpy as np
import pandas as pd

from sidmacib.mechanics.assembly import Floats
from workflow.case import REFERENCE
from workflow.results.tables import ERRORS
from workflow.schema import Study


def study_points(study: Study, rows: pd.DataFrame) -> pd.DataFrame:
    """The ``rows`` at the meshes and directions of ``study``.

    Cases that were run for the mesh error alone are left out. Meshes (``mesh_m``) and ratios e / a
    (``eccentricity_over_a``) become exactly those of the study, which tables have to ten digits.
    """
    placed = rows.assign(
        mesh_m=_nearest(rows["mesh_m"].astype(float), study.meshes),
        eccentricity_over_a=_nearest(
            rows["eccentricity_over_a"].astype(float), study.eccentricities
        ),
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


def load_errors(promised: Floats, carried: Floats) -> dict[str, float]:
    """Errors of SiDMACIB's loads against those of a detailed model, both in N, of shape (N,).

    By `ERRORS`: their root mean square, the largest unsafe and the largest safe one, relative.
    """
    error = promised / carried - 1.0
    found = np.sqrt(np.mean(error**2)), max(error.max(), 0.0), max(-error.min(), 0.0)
    return dict(zip(ERRORS, map(float, found), strict=True))


def winner(fit: pd.DataFrame, sample: str, mesh: float, **chosen: object) -> pd.Series:
    """The row of ``fit`` that fits a sample at a mesh best, among those with ``chosen`` values."""
    rows = fit[(fit["sample"] == sample) & np.isclose(fit["mesh_m"], mesh)]
    for column, value in chosen.items():
        rows = rows[rows[column] == value]
    return rows.sort_values("misfit", kind="stable").iloc[0]
