"""Hold SiDMACIB against brittle models of the joint: which option and which reduction fit best.

Both capacities are loads along the same direction of the (V, M) plane, so their error is the
relative difference of the loads: positive where SiDMACIB promises more than the joint carries
(unsafe), negative where it promises less (safe).
"""

import argparse
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy.optimize import least_squares

from sidmacib.contact_points import ContactOption
from sidmacib.joint import Direction, Joint
from sidmacib.mechanics.assembly import Floats
from sidmacib.programme import Sidmacib, capacities
from workflow.case import REFERENCE
from workflow.results import write_table
from workflow.schema import Study

BEST_COLUMNS = (
    *("model", "sample", "locks", "mesh_m", "friction"),
    *("distance_over_a", "distance_m", "strength_per_lock_N", "locks_that_count"),
    *("misfit", "largest_unsafe_error", "largest_safe_error"),
)


@dataclass(frozen=True)
class Misfit:
    """Relative errors of a curve: root mean square, largest unsafe and largest safe one."""

    misfit: float
    largest_unsafe_error: float
    largest_safe_error: float


def misfit(model: Floats, reference: Floats) -> Misfit:
    """Errors of loads (N) against reference loads in the same directions, both of shape (N,)."""
    error = model / reference - 1.0
    return Misfit(
        float(np.sqrt(np.mean(error**2))),
        float(max(error.max(), 0.0)),
        float(max(-error.min(), 0.0)),
    )


def fit_table(capacity: pd.DataFrame) -> pd.DataFrame:
    """Misfit of every SiDMACIB variant, best first, for each reference, sample and mesh.

    References are the models that SiDMACIB's weights were read from, in the table's order.
    """
    limit = capacity[capacity["model"] == "sidmacib"]
    keys = ["sample", "mesh_m", "eccentricity_m"]
    rows = []
    references = dict(_reference_curves(capacity))
    for model, reference in references.items():
        own = limit[limit["weights_from"] == model]
        both = own.merge(reference[[*keys, "load_N"]], on=keys, suffixes=("", "_reference"))
        if len(both) != len(own):
            raise ValueError(f"{model}: {len(own)} loads of SiDMACIB, {len(both)} to hold against")
        names = ["sample", "locks", "mesh_m", "option", "friction", "reduction"]
        for values, curve in both.groupby(names, sort=False):
            found = misfit(curve["load_N"].to_numpy(), curve["load_N_reference"].to_numpy())
            rows.append({"model": model, **dict(zip(names, values, strict=True)), **vars(found)})
    table = pd.DataFrame(rows)
    table["model"] = pd.Categorical(table["model"], list(references))  # the leading one first
    groups = ["model", "sample", "mesh_m"]
    table["rank"] = table.groupby(groups, observed=True)["misfit"].rank(method="min").astype(int)
    return table.sort_values([*groups, "rank", "option", "friction", "reduction"])


def _reference_curves(capacity: pd.DataFrame) -> Iterator[tuple[str, pd.DataFrame]]:
    used = capacity["weights_from"].dropna().unique()
    own = capacity[(capacity["variant"] == REFERENCE) & capacity["model"].isin(used)]
    for model, rows in own.groupby("model", sort=False):
        yield str(model), rows


def best_pair(
    joint: Joint, overload: float, friction: bool, curve: pd.DataFrame
) -> dict[str, float]:
    """Contact-point distance d and strength per lock that fit a curve of loads best.

    Two points per lock at +-d, every lock of the same strength. ``curve`` has columns
    ``eccentricity_m`` and ``load_N``.
    """
    directions = [Direction(e / joint.a) for e in curve["eccentricity_m"]]
    reference = curve["load_N"].to_numpy()

    def loads(unknowns: Floats) -> Floats:
        option = ContactOption.pair(float(unknowns[0]))
        strength = (float(unknowns[1]),) * joint.locks
        model = Sidmacib(joint, option, strength, friction, overload)
        return np.array([point.load for point in capacities(model, directions)])

    start = [0.25, min(1.0, float(reference.max()) / (joint.locks * joint.T0))]
    found = least_squares(
        lambda unknowns: loads(unknowns) / reference - 1.0,
        start,
        bounds=([0.0, 0.0], [0.5, 1.0]),
        diff_step=1e-3,
        xtol=1e-6,
    )
    distance, factor = (float(value) for value in found.x)
    return {
        "distance_over_a": distance,
        "distance_m": distance * joint.a,
        "strength_per_lock_N": factor * joint.T0,
        "locks_that_count": factor * joint.locks,
        **vars(misfit(loads(found.x), reference)),
    }


def best_table(study: Study, capacity: pd.DataFrame) -> pd.DataFrame:
    """`best_pair` for each reference, sample and mesh, without and with friction."""
    rows: list[dict[str, Any]] = []
    for model, reference in _reference_curves(capacity):
        for (sample, mesh), curve in reference.groupby(["sample", "mesh_m"], sort=False):
            joint = study.joint(str(sample))
            if len(curve) < 3:  # two unknowns would fit two directions whatever they are
                continue
            for friction in (False, True):
                best = best_pair(joint, study.sidmacib.overload, friction, curve)
                names = {"model": model, "sample": sample, "locks": joint.locks, "mesh_m": mesh}
                rows.append({**names, "friction": friction, **best})
    return pd.DataFrame(rows, columns=list(BEST_COLUMNS))


def winner(fit: pd.DataFrame, sample: str, mesh: float, **chosen: object) -> pd.Series:
    """The row of ``fit`` that fits a sample at a mesh best, among those with ``chosen`` values."""
    rows = fit[(fit["sample"] == sample) & fit["mesh_m"].map(lambda m: math.isclose(m, mesh))]
    for column, value in chosen.items():
        rows = rows[rows[column] == value]
    return rows.sort_values("misfit", kind="stable").iloc[0]


def main() -> None:
    """Command line: the two tables to write, the study as JSON, and the capacities."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("fit", type=Path)
    parser.add_argument("best", type=Path)
    parser.add_argument("study", type=Study.model_validate_json)
    parser.add_argument("capacity", type=Path)
    arguments = parser.parse_args()
    capacity = pd.read_csv(arguments.capacity)
    write_table(fit_table(capacity), arguments.fit)
    write_table(best_table(arguments.study, capacity), arguments.best)


if __name__ == "__main__":
    main()
