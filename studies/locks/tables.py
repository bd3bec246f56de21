"""Tables of the campaign from its points: a joint in a direction, with every model's load over T0.

Errors of law, safe rule and the paper's rules against the static model, region by region. V-M
interaction curves: do pure shear and pure torsion determine the loads in between? The curve
(V / V0)^p + (M / M0)^p = 1 goes through both ends; p = 1 is the straight line. Gain of bonds that
soften or yield over the first failure, and safety of (n - 1) / 2 with it.

Fit of SiDMACIB's polygon to the peaks, by its free parameters. Without friction, SiDMACIB's load is
that of one lock times the number of locks that count, however the strength is shared among the
locks. So only that number and the contact points can be fitted to the peaks in all directions. The
number with the smallest largest misfit is known in closed form: two over the sum of the largest and
the smallest ratio of load to peak.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from sidmacib.contact_points import OPTIONS, ContactOption
from sidmacib.contact_points.programme import Sidmacib, capacities
from sidmacib.joint import Direction, Joint
from sidmacib.mechanics.assembly import Failure, Floats
from workflow.results.tables import SAMPLINGS, Table, read_table, write_table
from workflow.step import Arguments, Files, step

POINTS = Table(  # loads over T0
    "points",
    (
        *SAMPLINGS.columns[:-1],
        *("pairs", "closed_form", "saturation", "law", "safe", "law_error", "error"),
    ),
    SAMPLINGS.key,
)
ALL = "all"
KNOWN = 0.5  # mesh error from which on the static model has no answer to compare with
GROUPS = ((2, 3), (4, 5), (6, 9), (10, 15), (16, 31))  # numbers of locks in one row of a table
QUANTITIES = {  # what is compared with what
    "law / first failure": ("law", "first_failure"),
    "safe / peak": ("safe", "peak"),
    "closed form / first failure": ("closed_form", "first_failure"),
}
JOINT = ["sampling", "number"]
REGION = ("sampling", "held", "dry_faces", "upper_body", "eccentricity_over_a")
SPREAD = (
    *("points", "mean_error", "mean_absolute_error", "least_error"),
    *("error_5_percent", "error_95_percent", "largest_error"),
)
LAW = Table("law", ("quantity", *REGION, *SPREAD), ("quantity", *REGION), digits=4)
RULE_ERRORS = Table(
    "rules",
    ("rule", "option", "upper_body", "locks", *SPREAD, "unsafe_share"),
    ("rule", "option", "upper_body", "locks"),
    digits=4,
)
EXPONENTS = (1.0, 1.25, 1.5, 2.0)
BETWEEN = ("sampling", "dry_faces", "upper_body", "eccentricity_over_a")
INTERACTION = Table(
    "interaction", ("exponent", *BETWEEN, *SPREAD), ("exponent", *BETWEEN), digits=4
)
ENERGIES = ((1.0, 10.0), (10.0, 100.0), (100.0, 1000.0))  # fracture energy over energy stored
BONDS = Table(
    "bonds",
    (
        *("bonds", "upper_body", "eccentricity_over_a", "points", "mean_peak_over_first_failure"),
        *("largest_peak_over_first_failure", "mean_peak_over_pairs", "unsafe_share_of_half"),
    ),
    ("bonds", "upper_body", "eccentricity_over_a"),
    digits=4,
)
POSITIONS = np.linspace(0.02, 0.5, 25)  # of a pair's points, over a
ENDS = np.linspace(0.05, 0.5, 10)  # the same, beside a third point in the middle,
MIDDLES = np.linspace(0.1, 0.9, 9)  # and what that has of the strength
RULE, ONE, EACH, THIRD = "half with option4", "one pair for all", "own pair", "own three points"
FREEDOMS = Table(
    "freedoms",
    (
        *("sampling", "freedom", "upper_body", "locks", "joints", "mean_misfit"),
        *("misfit_95_percent", "locks_that_count", "position_over_a", "middle_share"),
    ),
    ("sampling", "freedom", "upper_body", "locks"),
    digits=4,
)


def points_of(solved: pd.DataFrame, answers: Sequence[pd.DataFrame]) -> pd.DataFrame:
    """The table of samplings, joined with the batches of the law's ``answers``."""
    points = solved.merge(pd.concat(answers), on=[*SAMPLINGS.key], how="left", validate="1:1")
    return points[list(POINTS.columns)]


def spread(error: "pd.Series[float]") -> dict[str, float]:
    """Mean, mean size, extremes and quantiles of relative errors."""
    means = len(error), float(error.mean()), float(error.abs().mean())
    values = *means, *error.quantile([0.0, 0.05, 0.95, 1.0]).tolist()
    return dict(zip(SPREAD, values, strict=True))


def known(points: pd.DataFrame) -> "pd.Series[bool]":
    """Points with a static answer governed by bonds that is nearly the same on both meshes."""
    decided = points["first_failure"].gt(0.0) & points["mode"].eq("bonds")
    return decided & points["first_failure_mesh_error"].abs().lt(KNOWN)


def by_region(
    points: pd.DataFrame, error: "pd.Series[float]", *groups: Sequence[str]
) -> Iterator[dict[str, Any]]:
    """Spread of the ``error`` at ``points`` in each region of each of ``groups`` of columns.

    A column of the first group is `ALL` where another group lacks it.
    """
    for keys in groups:
        for values, part in error.groupby([points[key] for key in keys], sort=True):
            region = dict.fromkeys(groups[0], ALL) | dict(zip(keys, values, strict=True))
            yield {**region, **spread(part)}


def table_of(table: Table, rows: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Rows of regions as a table; an eccentricity may be `ALL`."""
    frame = pd.DataFrame(rows, columns=list(table.columns))
    return frame.astype({"eccentricity_over_a": str})


def dry_faces(points: pd.DataFrame) -> Sequence[str]:
    """Whether the dry faces of each point's joint are rough or smooth."""
    return ["rough" if friction > 0.0 else "smooth" for friction in points["friction"]]


def law_table(points: pd.DataFrame) -> pd.DataFrame:
    """One row for each quantity and region, and for all regions of a sampling together.

    Points that are not `known` are left out. The closed form is compared in pure shear of smooth
    joints under a plate only, for which it is derived.
    """
    points = points[known(points)]
    points = points.assign(
        held=points["plate"].map({True: "plate", False: "pressed"}), dry_faces=dry_faces(points)
    )
    both_bodies = [name for name in REGION if name != "upper_body"]
    rows: list[dict[str, Any]] = []
    for name, (value, reference) in QUANTITIES.items():
        part = points[points[value].gt(0.0) & points[reference].gt(0.0)]
        if value == "closed_form":
            smooth = part["held"].eq("plate") & part["dry_faces"].eq("smooth")
            part = part[smooth & part["eccentricity_over_a"].eq(0.0)]
        error = part[value] / part[reference] - 1.0
        regions = by_region(part, error, REGION, both_bodies, ["sampling"])
        rows += [{"quantity": name, **row} for row in regions]
    return table_of(LAW, rows)


def unit_loads(option: ContactOption, ratios: Sequence[float]) -> Floats:
    """SiDMACIB's load over T0 for each lock that counts, along directions e / a, (D,).

    Without friction, loads are proportional to the number of locks that count.
    """
    joint = Joint(3)
    model = Sidmacib(joint, option, friction=False)
    loads = [point.load for point in capacities(model, [Direction(ratio) for ratio in ratios])]
    return np.array(loads) / (joint.locks * joint.T0)


def brittle_odd_joints(points: pd.DataFrame) -> pd.DataFrame:
    """The joints that the paper's rules are for: odd, under a plate, with brittle bonds."""
    chosen = points["plate"] & points["peak"].gt(0.0) & points["locks"].mod(2).eq(1)
    return points[chosen & points["failure"].eq("brittle")]


def counted_locks(points: pd.DataFrame) -> dict[str, Floats]:
    """Number of locks that count by each of the paper's rules, at each of ``points``, (N,).

    Weights are those of the same joint in pure shear.
    """
    pure = points[points["eccentricity_over_a"].eq(0.0)].set_index(JOINT)
    joint = pd.MultiIndex.from_frame(points[JOINT])
    weights = pure[["weight_sum", "lower_weight_sum"]].reindex(joint).to_numpy()
    locks = points["locks"].to_numpy(dtype=float)
    return {
        "none": locks,
        "half": (locks - 1.0) / 2.0,
        "floor_of_sum": np.floor(weights[:, 0]),
        "lower_sum": weights[:, 1],
    }


def rule_errors(points: pd.DataFrame, option: str) -> dict[str, "pd.Series[float]"]:
    """Load by each rule with an ``option`` over the brittle peak, less one, by point."""
    ratios = sorted(set(points["eccentricity_over_a"]))
    loads = dict(zip(ratios, unit_loads(OPTIONS[option], ratios), strict=True))
    of_one = points["eccentricity_over_a"].map(loads) / points["peak"]
    return {rule: locks * of_one - 1.0 for rule, locks in counted_locks(points).items()}


def rules_table(points: pd.DataFrame) -> pd.DataFrame:
    """The paper's rules against the brittle peak: odd joints under a plate, by number of locks."""
    points = brittle_odd_joints(points)
    rows = []
    for option in OPTIONS:
        for rule, error in rule_errors(points, option).items():
            for (body, locks), chosen in by_locks(points):
                part = error[chosen].dropna()
                if len(part):
                    names = {"rule": rule, "option": option, "upper_body": body, "locks": locks}
                    unsafe = float((part > 0.0).mean())
                    rows.append({**names, **spread(part), "unsafe_share": unsafe})
    return pd.DataFrame(rows, columns=list(RULE_ERRORS.columns))


def by_locks(joints: pd.DataFrame) -> Iterator[tuple[tuple[str, str], "pd.Series[bool]"]]:
    """Each upper body and group of numbers of locks, and which rows of ``joints`` belong to it."""
    for body, (least, most) in product(sorted(set(joints["upper_body"])), GROUPS):
        chosen = joints["upper_body"].eq(body) & joints["locks"].between(least, most)
        yield (body, f"{least} to {most}"), chosen


def interaction_table(points: pd.DataFrame) -> pd.DataFrame:
    """Errors of the curves, by region and for all directions of a region together."""
    points = points[points["plate"] & known(points) & points["failure"].eq("brittle")]
    points = points.assign(dry_faces=dry_faces(points))
    by_ratio = points.set_index([*JOINT, "eccentricity_over_a"])["first_failure"]

    def at(ratio: float) -> Floats:
        """First failures of each point's joint in another direction; nan: unknown."""
        joints = points[JOINT].assign(ratio=ratio)
        return by_ratio.reindex(pd.MultiIndex.from_frame(joints)).to_numpy()

    between = points.assign(shear=at(0.0), torsion=at(math.inf)).dropna(subset=["shear", "torsion"])
    between = between[between["eccentricity_over_a"].between(0.0, math.inf, inclusive="neither")]
    ratio = between["eccentricity_over_a"]
    size = np.hypot(1.0, ratio)
    shear, torque = 1.0 / size / between["shear"], ratio / size / between["torsion"]
    rows: list[dict[str, Any]] = []
    for exponent in EXPONENTS:
        loads = (shear**exponent + torque**exponent) ** -(1.0 / exponent)
        error = loads / between["first_failure"] - 1.0
        regions = by_region(between, error, BETWEEN, BETWEEN[:-1])
        rows += [{"exponent": exponent, **row} for row in regions]
    return table_of(INTERACTION, rows)


def bonds_table(points: pd.DataFrame) -> pd.DataFrame:
    """Peaks over first failures and over numbers of pairs, of joints under a plate, by bonds."""
    bears = points["plate"] & points["peak"].gt(0.0) & points["pairs"].gt(0)
    points = points[bears & points["stiffness_ratio"].isna()]
    points = points.assign(
        bonds=[_kind(*each) for each in points[["failure", "energy_ratio"]].values],
        over_first=points["peak"] / points["first_failure"],
        over_pairs=points["peak"] / points["pairs"],
    )
    odd = points["locks"].mod(2).eq(1) & points["eccentricity_over_a"].eq(0.0)
    unsafe = points["over_pairs"].lt(1.0 - 1e-3).astype(float).where(odd)
    groups = points.assign(unsafe=unsafe).groupby(list(BONDS.key), sort=True)
    table = groups.agg(
        points=("number", "size"),
        mean_peak_over_first_failure=("over_first", "mean"),
        largest_peak_over_first_failure=("over_first", "max"),
        mean_peak_over_pairs=("over_pairs", "mean"),
        unsafe_share_of_half=("unsafe", "mean"),
    )
    return table.reset_index()


def _kind(failure: str, ratio: float) -> str:
    if failure != Failure.SOFTENING:
        return failure
    least, most = next((span for span in ENERGIES if ratio <= span[1]), ENERGIES[-1])
    return f"softening, {least:g} to {most:g}"


# --- SiDMACIB by its free parameters -------------------------------------------------------------
def fits(peaks: Floats, locks: Floats, ratios: Sequence[float]) -> dict[str, pd.DataFrame]:
    """Fit of ``peaks`` (N, D) over T0 with each freedom, for joints with so many ``locks``, (N,).

    A row for each joint. ``misfit``: the largest of load over peak, less 1, in all directions;
    ``position_over_a``: of the outer points; ``middle_share``: of the middle point in the lock's
    strength.
    """

    def fixed(option: ContactOption) -> pd.DataFrame:
        ratio = unit_loads(option, ratios) / peaks
        most, least = ratio.max(axis=1), ratio.min(axis=1)
        return pd.DataFrame(
            {
                "misfit": (most - least) / (most + least),
                "locks_that_count": 2.0 / (most + least),
                "position_over_a": option.positions[-1],
                "middle_share": option.portions[1] if len(option.portions) == 3 else 0.0,
            }
        )

    half = (locks - 1.0) / 2.0
    rule = np.abs(unit_loads(OPTIONS["option4"], ratios) * half[:, None] / peaks - 1.0).max(axis=1)
    points = {"position_over_a": 0.25, "middle_share": 0.0}
    every = {RULE: pd.DataFrame({"misfit": rule, "locks_that_count": half, **points})}
    every |= {name: fixed(option) for name, option in OPTIONS.items()}
    pairs = [fixed(ContactOption.pair(position)) for position in POSITIONS.tolist()]
    triples = [
        fixed(ContactOption((-end, 0.0, end), ((1.0 - part) / 2.0, part, (1.0 - part) / 2.0)))
        for end, part in product(ENDS.tolist(), MIDDLES.tolist())
    ]
    every[ONE] = min(pairs, key=lambda each: float(each["misfit"].mean()))
    every[EACH] = _best(pairs)
    every[THIRD] = _best([*pairs, *triples])
    return every


def _best(fitted: Sequence[pd.DataFrame]) -> pd.DataFrame:
    """The fit of least misfit, joint by joint."""
    every = pd.concat(fitted).reset_index(names="joint")
    return every.loc[every.groupby("joint")["misfit"].idxmin()].reset_index(drop=True)


def freedoms_table(points: pd.DataFrame) -> pd.DataFrame:
    """Misfits by freedom, body and number of locks: odd joints under a plate, all directions."""
    rows = []
    for sampling, part in brittle_odd_joints(points).groupby("sampling", sort=True):
        peaks = part.pivot_table(
            index=["number", "upper_body", "locks"], columns="eccentricity_over_a", values="peak"
        ).dropna()
        ratios = [float(ratio) for ratio in peaks.columns]
        if len(ratios) < 3 or peaks.empty:  # two loads are always fitted
            continue
        joints = peaks.index.to_frame(index=False)
        fitted = fits(peaks.to_numpy(), joints["locks"].to_numpy(dtype=float), ratios)
        for (freedom, fit), ((body, locks), group) in product(fitted.items(), [*by_locks(joints)]):
            own = fit[group]
            misfit = own.pop("misfit")
            if own.empty:
                continue
            rows.append(
                {
                    "sampling": sampling,
                    "freedom": freedom,
                    "upper_body": body,
                    "locks": locks,
                    "joints": len(own),
                    "mean_misfit": misfit.mean(),
                    "misfit_95_percent": misfit.quantile(0.95),
                    **own.median(),
                }
            )
    return pd.DataFrame(rows, columns=list(FREEDOMS.columns))


# --- steps ----------------------------------------------------------------------------------------
def run(arguments: Arguments, inputs: Arguments, outputs: Files) -> None:
    """Write the table of the points, and all others from it as it is written."""
    solved, answers = (
        read_table(SAMPLINGS, inputs["samplings"]),
        map(pd.read_parquet, inputs["law"]),
    )
    write_table(POINTS, points_of(solved, [*answers]), outputs["points"])
    points = read_table(POINTS, outputs["points"])
    for form, table in (
        (LAW, law_table),
        (RULE_ERRORS, rules_table),
        (INTERACTION, interaction_table),
        (BONDS, bonds_table),
    ):
        write_table(form, table(points), outputs[form.name])


def write_freedoms(arguments: Arguments, inputs: Files, outputs: Files) -> None:
    """Write the table of the freedoms."""
    write_table(FREEDOMS, freedoms_table(read_table(POINTS, inputs["points"])), outputs["freedoms"])


if __name__ == "__main__":
    step(run, freedoms=write_freedoms)
