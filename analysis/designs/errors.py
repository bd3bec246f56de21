"""How far law, safe rule and the paper's rules are from the static model, region by region."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from sidmacib.contact_points import OPTIONS, ContactOption
from sidmacib.joint import Direction, Joint
from sidmacib.mechanics.assembly import Floats
from sidmacib.programme import Sidmacib, capacities
from workflow.results.tables import LAW, POINTS, RULE_ERRORS, Table, read_table, write_table

ALL = "all"
KNOWN = 0.5  # mesh error from which on the static model has no answer to compare with
GROUPS = ((2, 3), (4, 5), (6, 9), (10, 15), (16, 31))  # numbers of locks that are told together
QUANTITIES = {  # what is held against what
    "law / first failure": ("law", "first_failure"),
    "safe / peak": ("safe", "peak"),
    "closed form / first failure": ("closed_form", "first_failure"),
}


def spread(error: "pd.Series[float]") -> dict[str, float]:
    """Mean, mean size, extremes and quantiles of relative errors."""
    return {
        "points": len(error),
        "mean_error": float(error.mean()),
        "mean_absolute_error": float(error.abs().mean()),
        "least_error": float(error.min()),
        "error_5_percent": float(error.quantile(0.05)),
        "error_95_percent": float(error.quantile(0.95)),
        "largest_error": float(error.max()),
    }


def known(points: pd.DataFrame) -> "pd.Series[bool]":
    """Where the static model has an answer.

    Bonds decide there. It has lost its way where the first failures on two meshes have little to do
    with each other.
    """
    found = points["first_failure"].gt(0.0) & points["mode"].eq("bonds")
    return found & points["first_failure_mesh_error"].abs().lt(KNOWN)


def by_region(
    points: pd.DataFrame, error: "pd.Series[float]", *groups: Sequence[str]
) -> Iterator[dict[str, Any]]:
    """Spread of the ``error`` at ``points`` in each region of each of ``groups`` of columns.

    A column that is in the first group only is `ALL` in the others.
    """
    told = points.assign(error_of=error)
    for keys in groups:
        for values, region in told.groupby(list(keys), sort=True):
            where = dict.fromkeys(groups[0], ALL) | dict(zip(keys, values, strict=True))
            yield {**where, **spread(region["error_of"])}


def table_of(table: Table, rows: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Rows of regions as a table; an eccentricity may be `ALL`."""
    found = pd.DataFrame(rows, columns=list(table.columns))
    found["eccentricity_over_a"] = found["eccentricity_over_a"].astype(str)
    return found


def dry_faces(points: pd.DataFrame) -> Sequence[str]:
    """Whether the dry faces of each point's joint are rough or smooth."""
    return ["rough" if friction > 0.0 else "smooth" for friction in points["friction"]]


def law_table(points: pd.DataFrame) -> pd.DataFrame:
    """One row for each quantity and region, and for all regions of a design together.

    Points that are not `known` are left out. The closed form is told of pure shear of smooth joints
    under a plate, which it is made for.
    """
    told = points.assign(
        held=points["plate"].map({True: "plate", False: "pressed"}), dry_faces=dry_faces(points)
    )
    region = ["design", "held", "dry_faces", "upper_body", "eccentricity_over_a"]
    rows: list[dict[str, Any]] = []
    for name, (ours, theirs) in QUANTITIES.items():
        own = told[told[ours].gt(0.0) & told[theirs].gt(0.0) & known(told)]
        if ours == "closed_form":
            made_for = own["held"].eq("plate") & own["dry_faces"].eq("smooth")
            own = own[made_for & own["eccentricity_over_a"].eq(0.0)]
        error = own[ours] / own[theirs] - 1.0
        groups = region, ["design", "held", "dry_faces", "eccentricity_over_a"], ["design"]
        rows += [{"quantity": name, **row} for row in by_region(own, error, *groups)]
    return table_of(LAW, rows)


def unit_loads(option: ContactOption, ratios: Sequence[float]) -> Floats:
    """SiDMACIB's load of one lock that counts over T0, along directions e / a.

    Without friction its envelope grows with the number of locks that count, and nothing else.
    """
    joint = Joint(3)
    model = Sidmacib(joint, option, friction=False)
    points = capacities(model, [Direction(ratio) for ratio in ratios])
    return np.array([point.load for point in points]) / (joint.locks * joint.T0)


def brittle_odd_joints(points: pd.DataFrame) -> pd.DataFrame:
    """What the paper's rules are about: odd joints under a plate, whose bonds are brittle."""
    chosen = points["plate"] & points["peak"].gt(0.0) & points["locks"].mod(2).eq(1)
    return points[chosen & points["failure"].eq("brittle")]


def counted_locks(own: pd.DataFrame) -> dict[str, Floats]:
    """How many locks count after each of the paper's rules, at each of these points, (N,).

    Weights are those of the same joint in pure shear.
    """
    pure = own[own["eccentricity_over_a"].eq(0.0)].set_index(["design", "number"])
    key = pd.MultiIndex.from_frame(own[["design", "number"]])
    weights = pure[["weight_sum", "lower_weight_sum"]].reindex(key).to_numpy()
    locks = own["locks"].to_numpy(dtype=float)
    return {
        "none": locks,
        "half": (locks - 1.0) / 2.0,
        "floor_of_sum": np.floor(weights[:, 0]),
        "lower_sum": weights[:, 1],
    }


def rule_errors(own: pd.DataFrame, option: str) -> dict[str, "pd.Series[float]"]:
    """What each rule promises with an ``option`` over the brittle peak, less one, by point."""
    ratios = sorted(set(own["eccentricity_over_a"]))
    loads = unit_loads(OPTIONS[option], ratios)
    place = own["eccentricity_over_a"].map({ratio: k for k, ratio in enumerate(ratios)}).to_numpy()
    over = loads[place] / own["peak"].to_numpy()
    return {
        rule: pd.Series(locks * over - 1.0, index=own.index)
        for rule, locks in counted_locks(own).items()
    }


def rules_table(points: pd.DataFrame) -> pd.DataFrame:
    """The paper's rules against the brittle peak: odd joints under a plate, by number of locks."""
    own = brittle_odd_joints(points)
    rows: list[dict[str, Any]] = []
    for option in OPTIONS:
        for rule, error in rule_errors(own, option).items():
            rows += _by_locks(own, error, {"rule": rule, "option": option})
    return pd.DataFrame(rows, columns=list(RULE_ERRORS.columns))


def _by_locks(
    own: pd.DataFrame, error: "pd.Series[float]", names: Mapping[str, str]
) -> Iterator[dict[str, Any]]:
    """Spread of a rule's error for each upper body and group of numbers of locks."""
    for body, (least, most) in product(sorted(set(own["upper_body"])), GROUPS):
        chosen = own["upper_body"].eq(body) & own["locks"].between(least, most)
        found = error[chosen].dropna()
        if len(found):
            where = {"upper_body": body, "locks": f"{least} to {most}"}
            unsafe = float((found > 0.0).mean())
            yield {**names, **where, **spread(found), "unsafe_share": unsafe}


def run(
    arguments: Mapping[str, Any], inputs: Mapping[str, Path], outputs: Mapping[str, Path]
) -> None:
    """Write both tables."""
    points = read_table(POINTS, inputs["points"])
    write_table(LAW, law_table(points), outputs["law"])
    write_table(RULE_ERRORS, rules_table(points), outputs["rules"])
