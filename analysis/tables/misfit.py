"""Misfit of SiDMACIB against a detailed model, and its closest rule, without a solver.

Separate from `analysis.tables.fit`, so that steps which only read fits load no solver.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from sidmacib.mechanics.assembly import Floats


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
