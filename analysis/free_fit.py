"""SiDMACIB with contact points and strength fitted freely to a model's curve of capacities."""

import math
from collections.abc import Mapping
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy.optimize import least_squares

from analysis.fit import detailed_curves, fit_table, misfit
from sidmacib.contact_points.options import ContactOption
from sidmacib.contact_points.programme import Sidmacib, capacities
from sidmacib.joint import Direction, Joint
from sidmacib.mechanics.assembly import Floats
from workflow.case import case_name
from workflow.results.tables import BEST_FIT, CAPACITY, FIT, read_table, write_table
from workflow.schema import Study


def best_pair(
    joint: Joint, overload: float, friction: bool, curve: pd.DataFrame
) -> dict[str, float]:
    """Contact-point distance d and strength per lock that fit a curve of loads best.

    Two points per lock at +-d, every lock of the same strength. ``curve`` has columns
    ``eccentricity_over_a`` and ``load_N``.
    """
    directions = [Direction(e) for e in curve["eccentricity_over_a"]]
    carried = curve["load_N"].to_numpy()

    def loads(unknowns: Floats) -> Floats:
        option = ContactOption.pair(float(unknowns[0]))
        strength = (float(unknowns[1]),) * joint.locks
        model = Sidmacib(joint, option, strength, friction, overload)
        return np.array([point.load for point in capacities(model, directions)])

    start = [0.25, min(1.0, float(carried.max()) / math.fsum(joint.strengths))]
    found = least_squares(
        lambda unknowns: loads(unknowns) / carried - 1.0,
        start,
        bounds=([0.0, 0.0], [0.5, 1.0]),
        diff_step=1e-3,
        xtol=1e-6,
    )
    # What the search leaves below that differs from one processor to another.
    distance, factor = (round(float(value), 5) for value in found.x)
    return {
        "distance_over_a": distance,
        "distance_m": distance * joint.a,
        "strength_per_lock_N": factor * math.fsum(joint.strengths) / joint.locks,
        "locks_that_count": factor * joint.locks,
        **vars(misfit(loads(np.array([distance, factor])), carried)),
    }


def best_table(study: Study, capacity: pd.DataFrame) -> pd.DataFrame:
    """`best_pair` for each detailed model, sample and mesh, without and with friction."""
    ratios = {
        case_name(sample, mesh, ratio): ratio
        for sample, mesh, ratio in product(study.samples, study.meshes, study.eccentricities)
    }
    found = capacity.dropna(subset=["load_N"])
    found = found.assign(eccentricity_over_a=found["case"].map(ratios))
    found = found.dropna(subset=["eccentricity_over_a"])  # cases for the mesh error only
    rows: list[dict[str, Any]] = []
    for model, curves in detailed_curves(found):
        for (sample, mesh), curve in curves.groupby(["sample", "mesh_m"], sort=False):
            joint = study.joint(str(sample))
            if len(curve) < 3 or not joint.interlocking:  # two unknowns fit any two loads
                continue
            for friction in (False, True):
                best = best_pair(joint, study.sidmacib.overload, friction, curve)
                names = {"model": model, "sample": sample, "locks": joint.locks, "mesh_m": mesh}
                rows.append({**names, "friction": friction, **best})
    return pd.DataFrame(rows, columns=list(BEST_FIT.columns))


def run(
    arguments: Mapping[str, Any], inputs: Mapping[str, Path], outputs: Mapping[str, Path]
) -> None:
    """Write the fits of all options and reductions, and the free fit."""
    study = Study.model_validate_json(arguments["study"])
    capacity = read_table(CAPACITY, inputs["capacity"])
    write_table(FIT, fit_table(capacity), outputs["fit"])
    write_table(BEST_FIT, best_table(study, capacity), outputs["best_fit"])
