"""Compare SiDMACIB with the detailed models: which option and which reduction fit best.

Both capacities are loads along the same direction of the (V, M) plane, so their error is the
relative difference of the loads: positive where SiDMACIB promises more than the joint carries
(unsafe), negative where it promises less (safe).
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd

from sidmacib.mechanics.assembly import Floats
from workflow.case import REFERENCE
from workflow.results.tables import FIT


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


def fit_table(capacity: pd.DataFrame) -> pd.DataFrame:
    """Misfit of every SiDMACIB variant, best first, for each detailed model, sample and mesh.

    The detailed models are those that SiDMACIB's weights were read from, in the table's order.
    """
    limit, error = capacity[capacity["model"] == "sidmacib"], "mesh_error_carried"
    rows = []
    detailed = dict(detailed_curves(capacity))
    for model, curves in detailed.items():
        own = limit[limit["weights_from"] == model]
        both = own.merge(
            curves[["case", "load_N", "mesh_error"]], on="case", suffixes=("", "_carried")
        )
        if len(both) != len(own):
            raise ValueError(
                f"{model}: {len(own)} loads of SiDMACIB, but {len(both)} to compare them with"
            )
        both = both.dropna(subset=["load_N_carried"])  # a case without a result
        names = ["sample", "locks", "mesh_m", "option", "friction", "reduction"]
        for values, curve in both.groupby(names, sort=False):
            found = misfit(curve["load_N"].to_numpy(), curve["load_N_carried"].to_numpy())
            named = dict(zip(names, values, strict=True))
            told = {"directions": len(curve), "largest_mesh_error": curve[error].max()}
            rows.append({"model": model, **named, **vars(found), **told})
    if not rows:
        return pd.DataFrame(columns=list(FIT.columns))
    table = pd.DataFrame(rows)
    table["model"] = pd.Categorical(table["model"], list(detailed))  # the leading one first
    groups = ["model", "sample", "mesh_m"]
    table["rank"] = table.groupby(groups, observed=True)["misfit"].rank(method="min").astype(int)
    table = table.sort_values([*groups, "rank", "option", "friction", "reduction"])
    return table.astype({"model": str})


def detailed_curves(capacity: pd.DataFrame) -> Iterator[tuple[str, pd.DataFrame]]:
    """The models that SiDMACIB's weights were read from, with their capacities."""
    used = capacity["weights_from"].dropna().unique()
    own = capacity[(capacity["variant"] == REFERENCE) & capacity["model"].isin(used)]
    for model, rows in own.groupby("model", sort=False):
        yield str(model), rows


def winner(fit: pd.DataFrame, sample: str, mesh: float, **chosen: object) -> pd.Series:
    """The row of ``fit`` that fits a sample at a mesh best, among those with ``chosen`` values."""
    rows = fit[(fit["sample"] == sample) & np.isclose(fit["mesh_m"], mesh)]
    for column, value in chosen.items():
        rows = rows[rows[column] == value]
    return rows.sort_values("misfit", kind="stable").iloc[0]
