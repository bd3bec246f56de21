"""Fits of SiDMACIB, and comparisons of variants, published and measured numbers.

SiDMACIB is fitted to the detailed models and to each variant: the best option and reduction. Both
capacities are loads along the same direction of the (V, M) plane, so their error is the relative
difference of the loads: positive where SiDMACIB promises more than the joint carries (unsafe),
negative where it promises less (safe).
"""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd
from scipy.optimize import least_squares

from analysis.published import Published, read_published
from analysis.tables import load_errors, pure_shear_weights, study_points, winner
from sidmacib.contact_points import ContactOption
from sidmacib.contact_points.programme import Sidmacib, pair_loads
from sidmacib.joint import Direction, Joint
from sidmacib.mechanics.assembly import Floats
from sidmacib.models import LAWS, first_failure_only
from workflow.case import REFERENCE
from workflow.results.tables import (
    BEST_FIT,
    ERRORS,
    FIT,
    MEASURED,
    VALIDATION,
    VARIANTS,
    read_table,
    read_tables,
    write_tables,
)
from workflow.schema import MeasuredSection, Study
from workflow.step import Arguments, Files, step

FEWEST = 3  # directions that an option is judged by
IN_ORDER = "in the printed order"
SWAPPED = "published value of the other of the first two locks, see docs/validation.md"


def fit_table(capacity: pd.DataFrame) -> pd.DataFrame:
    """Misfit of every SiDMACIB variant, best first, for each detailed model, sample and mesh.

    The detailed models are those that SiDMACIB's weights were read from, in the table's order.
    """
    carried = detailed_curves(capacity)[["model", "case", "load_N", "mesh_error"]]
    carried = carried.rename(columns={"model": "weights_from"})
    # Names, also where there are none.
    promised = capacity[capacity["model"] == "sidmacib"].astype({"weights_from": "str"})
    both = promised.merge(carried, on=["weights_from", "case"], suffixes=("", "_carried"))
    both = both.dropna(subset=["load_N_carried"])  # a case without a result
    names = ["weights_from", "sample", "locks", "mesh_m", "option", "friction", "reduction"]
    rows = []
    for values, curve in both.groupby(names, sort=False):
        errors = load_errors(curve["load_N"].to_numpy(), curve["load_N_carried"].to_numpy())
        named = dict(zip(names, values, strict=True))
        largest = curve["mesh_error_carried"].max()
        rows.append({**named, **errors, "directions": len(curve), "largest_mesh_error": largest})
    if not rows:
        return pd.DataFrame(columns=list(FIT.columns))
    table = pd.DataFrame(rows).rename(columns={"weights_from": "model"})
    # The leading one first.
    table["model"] = pd.Categorical(table["model"], carried["weights_from"].unique())
    groups = ["model", "sample", "mesh_m"]
    table["rank"] = table.groupby(groups, observed=True)["misfit"].rank(method="min").astype(int)
    table = table.sort_values([*groups, "rank", "option", "friction", "reduction"])
    return table.astype({"model": str})


def detailed_curves(capacity: pd.DataFrame) -> pd.DataFrame:
    """Capacities of the models that SiDMACIB's weights were read from."""
    used = capacity["weights_from"].dropna().unique()
    return capacity[(capacity["variant"] == REFERENCE) & capacity["model"].isin(used)]


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
        return pair_loads(model, directions)

    start = [0.25, min(1.0, float(carried.max()) / math.fsum(joint.strengths))]
    result = least_squares(
        lambda unknowns: loads(unknowns) / carried - 1.0,
        start,
        bounds=([0.0, 0.0], [0.5, 1.0]),
        diff_step=1e-3,
        xtol=1e-6,
    )
    # What the search leaves below that differs from one processor to another.
    distance, factor = (round(float(value), 5) for value in result.x)
    return {
        "distance_over_a": distance,
        "distance_m": distance * joint.a,
        "strength_per_lock_N": factor * math.fsum(joint.strengths) / joint.locks,
        "locks_that_count": factor * joint.locks,
        **load_errors(loads(np.array([distance, factor])), carried),
    }


def best_table(study: Study, capacity: pd.DataFrame) -> pd.DataFrame:
    """`best_pair` for each detailed model, sample and mesh, without and with friction."""
    known = detailed_curves(study_points(study, capacity.dropna(subset=["load_N"])))
    rows: list[dict[str, Any]] = []
    for (model, sample, mesh), curve in known.groupby(["model", "sample", "mesh_m"], sort=False):
        joint = study.joint(str(sample))
        if len(curve) < 3 or not joint.interlocking:  # two unknowns fit any two loads
            continue
        for friction in (False, True):
            best = best_pair(joint, study.sidmacib.overload, friction, curve)
            names = {"model": model, "sample": sample, "locks": joint.locks, "mesh_m": mesh}
            rows.append({**names, "friction": friction, **best})
    return pd.DataFrame(rows, columns=list(BEST_FIT.columns))


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
    unknown = dict.fromkeys(("option", *ERRORS))
    for (variant, sample, *_), curve in carried.groupby(names, sort=False):
        joint = study.joint(str(sample), study.every_variant[str(variant)])
        fit = min(_errors(promised, curve), key=lambda each: each["misfit"], default=unknown)
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
            yield {"option": option, **load_errors(promised_loads, loads.to_numpy(dtype=float))}


def validation_table(
    study: Study,
    capacity: pd.DataFrame,
    weights: pd.DataFrame,
    fit: pd.DataFrame,
    published: Published,
) -> pd.DataFrame:
    """One row for each published number that the study can be compared with."""
    # Published are peaks of the pieces.
    no_peaks = [name for name in study.model_names if first_failure_only(name)]
    no_peaks += LAWS
    points = study_points(study, capacity.dropna(subset=["load_N"]))
    pure_shear = points[points["eccentricity_over_a"] == 0.0]
    rows: list[dict[str, Any]] = []
    for sample in published.samples(study):
        joint = study.joint(sample)
        selected = pure_shear[
            (pure_shear["sample"] == sample) & ~pure_shear["model"].isin(no_peaks)
        ]
        sources = pure_shear_weights(study, weights, sample)
        sources = {source: each for source, each in sources.items() if source[0] not in no_peaks}
        compared = [
            *_limit_rows(selected, published.numbers["limit_pure_shear"][joint.locks]),
            *_peak_rows(selected, joint.locks, published),
            *_weight_rows(sources, joint.locks, published),
            *_option_rows(fit, sample, published.numbers["best_option"]),
        ]
        setting = "as printed" if published.as_printed(study, sample) else "not as printed"
        same = {"sample": sample, "locks": joint.locks, "friction": joint.dry.friction}
        rows += [{**same, "setting": setting, **row} for row in compared]
    table = pd.DataFrame(rows, columns=list(VALIDATION.columns))
    # The number of an option is a name: no difference.
    quantities = table["quantity"] != "best_option"
    table["absolute_difference"] = (table["computed"] - table["published"]).where(quantities)
    table["relative_difference"] = table["absolute_difference"] / table["published"].where(
        table["published"] != 0.0
    )
    return table


def _limit_rows(pure_shear: pd.DataFrame, value: float) -> Iterator[dict[str, Any]]:
    rows = pure_shear[(pure_shear["model"] == "sidmacib") & (pure_shear["reduction"] == "none")]
    for row in rows.drop_duplicates("variant").itertuples():
        name = f"{row.option}_{'friction' if row.friction else 'frictionless'}"
        same = {"quantity": f"sidmacib_pure_shear_{name}_N", "model": "sidmacib"}
        yield {**same, "published": value, "computed": row.shear_N}


def _peak_rows(
    pure_shear: pd.DataFrame, locks: int, published: Published
) -> Iterator[dict[str, Any]]:
    peaks = pure_shear[pure_shear["variant"] == REFERENCE].rename(columns={"shear_N": "computed"})
    for row in peaks[["model", "mesh_m", "computed", "mesh_error"]].to_dict("records"):
        value = published.dem_pure_shear(locks, row["mesh_m"])
        if value is not None:
            yield {**row, "quantity": "dem_pure_shear_N", "published": value}


def _weight_rows(
    sources: dict[tuple[str, float], list[float]], locks: int, published: Published
) -> Iterator[dict[str, Any]]:
    printed = published.numbers["weights"][locks]
    for (model, mesh), weights in sources.items():
        same = {"model": model, "mesh_m": mesh}
        numbered = [*enumerate(zip(printed, weights, strict=True), start=1)]
        total = math.fsum(weights)
        sums = published.numbers["weight_sum"][locks], published.numbers["active_locks"][locks]
        for quantity, value, computed, note in (
            *(
                (f"weight_lock{lock}", *both, IN_ORDER if lock <= 2 else "")
                for lock, both in numbered
            ),
            ("weight_lock1_swapped", printed[1], weights[0], SWAPPED),
            ("weight_lock2_swapped", printed[0], weights[1], SWAPPED),
            ("weight_sum", sums[0], total, None),
            ("weight_sum_rounded_down", sums[1], math.floor(total), None),
        ):
            row = {"quantity": quantity, "published": value, "computed": computed}
            yield {**same, **row, "note": note}


def _option_rows(fit: pd.DataFrame, sample: str, value: int) -> Iterator[dict[str, Any]]:
    """The best option of the paper's revised model, frictionless with (n - 1) / 2 locks."""
    selected = fit[(fit["sample"] == sample) & (fit["reduction"] == "half")]
    for model, mesh in selected[["model", "mesh_m"]].drop_duplicates().itertuples(index=False):
        best = winner(selected[selected["model"] == model], sample, mesh, friction=False)
        number = str(best["option"]).removeprefix("option")
        if number.isdigit():
            yield {
                "quantity": "best_option",
                "model": model,
                "mesh_m": mesh,
                "published": value,
                "computed": int(number),
                "note": "revised by (n - 1) / 2, no friction",
            }


def measured_table(study: Study, measured: MeasuredSection, capacity: pd.DataFrame) -> pd.DataFrame:
    """One row for each measured load and model, on the study's finest mesh.

    ``load_N`` are lengths of (V, M / a). A model without a result has an empty one.
    """
    rows: list[dict[str, Any]] = []
    points = study_points(study, capacity)
    finest = points[points["mesh_m"] == min(study.meshes)]
    for number, load in enumerate(measured.loads, start=1):
        a = study.joint(load.sample).a
        shear, torque = load.components(a)
        size = math.hypot(shear, torque / a)
        ratio = finest["eccentricity_over_a"]
        models = finest[finest["sample"].eq(load.sample) & ratio.eq(load.eccentricity)]
        compared = models.assign(
            number=number,
            specimen=load.specimen,
            measured_shear_N=shear,
            measured_torque_Nm=torque,
            measured_load_N=size,
            difference=models["load_N"] / size - 1.0,
        )
        rows += compared.to_dict("records")
    return pd.DataFrame(rows, columns=list(MEASURED.columns))


def run(arguments: Arguments, inputs: Files, outputs: Files) -> None:
    """Write the fits and all comparisons that the study asks for."""
    study, given = Study.model_validate_json(arguments["study"]), read_tables(inputs)
    capacity = given["capacity"]
    write_tables({"fit": fit_table(capacity)}, outputs)
    fit = read_table(FIT, outputs["fit"])  # as all others read it
    published = validation_table(study, capacity, given["weights"], fit, read_published())
    tables = {
        "best_fit": best_table(study, capacity),
        "variants": variants_table(study, capacity, given["weight_sums"]),
        "validation": published,
    }
    if study.measured is not None:
        tables["measured"] = measured_table(study, study.measured, capacity)
    write_tables(tables, outputs)


if __name__ == "__main__":
    step(run)
