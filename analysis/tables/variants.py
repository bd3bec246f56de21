"""The table of variants: capacity, weights and best-fitting option under each change."""

import math
from collections.abc import Iterator
from dataclasses import fields
from typing import Any

import numpy as np
import pandas as pd

from analysis.tables.misfit import LoadErrors, misfit
from workflow.results.tables import CAPACITY, VARIANTS, WEIGHT_SUMS, read_table, write_table
from workflow.schema import Study
from workflow.step import Arguments, Files, step

FEWEST = 3  # directions that an option is judged by


def variants_table(study: Study, capacity: pd.DataFrame, sums: pd.DataFrame) -> pd.DataFrame:
    """One row for each direction that a variant of a model was run in, with the best option.

    ``option``: of SiDMACIB with (n - 1) / 2 locks and without friction, the one with the least
    misfit over all directions of the variant; empty if there are fewer than three, or no such rule
    in the study. ``stiffness_ratio``: E over Kn b, empty if the pieces are rigid.
    """
    carried = capacity[capacity["failed_load_N"].notna() & capacity["load_N"].notna()]
    promised = capacity[(capacity["reduction"] == "half") & ~capacity["friction"].eq(True)]
    keys = ["model", "variant", "case"]
    carried = carried.merge(sums[[*keys, "lower_weight_sum"]], on=keys, how="left", validate="1:1")
    rows = []
    names = ["variant", "sample", "model", "mesh_m"]
    for (variant, sample, *_), curve in carried.groupby(names, sort=False):
        joint = study.joint(str(sample), study.every_variant[str(variant)])
        fit = _best_option(promised, curve)
        described = curve.assign(
            failure=str(joint.failure),
            upper_body=str(joint.upper_body),
            young_Pa=joint.elastic.young if joint.elastic else math.nan,
            stiffness_ratio=joint.stiffness_ratio if joint.elastic else math.nan,
            fracture_energy_J_m2=joint.inner.fracture_energy,
            load_over_T0=curve["load_N"] / joint.T0,
            directions=len(curve),
            **fit,
        )
        rows.append(described[list(VARIANTS.columns)])
    if not rows:
        return pd.DataFrame(columns=list(VARIANTS.columns))
    return pd.concat(rows, ignore_index=True)


def _best_option(promised: pd.DataFrame, curve: pd.DataFrame) -> dict[str, object]:
    """The option that fits ``curve`` best, and its errors; empty if there is none."""
    unknown = dict.fromkeys(("option", *(each.name for each in fields(LoadErrors))))
    return min(_errors(promised, curve), key=lambda each: each["misfit"], default=unknown)


def _errors(promised: pd.DataFrame, curve: pd.DataFrame) -> Iterator[dict[str, Any]]:
    """The errors of each option that was solved in all directions of ``curve``."""
    if len(curve) < FEWEST:
        return
    loads = curve.set_index("case")["load_N"]
    comparable = promised[
        promised["case"].isin(loads.index) & (promised["weights_from"] == curve["model"].iloc[0])
    ]
    for option, rows in comparable.groupby("option", sort=False):
        promised_loads = rows.set_index("case")["load_N"].reindex(loads.index).to_numpy(dtype=float)
        if np.isfinite(promised_loads).all():
            yield {"option": option, **vars(misfit(promised_loads, loads.to_numpy(dtype=float)))}


def run(arguments: Arguments, inputs: Files, outputs: Files) -> None:
    """Write the table."""
    study = Study.model_validate_json(arguments["study"])
    capacity, sums = (read_table(kind, inputs[kind.name]) for kind in (CAPACITY, WEIGHT_SUMS))
    write_table(VARIANTS, variants_table(study, capacity, sums), outputs["variants"])


if __name__ == "__main__":
    step(run)
