"""Joints that carry a load: reading of the command line, rows, and the chart."""

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import click
import numpy as np

from sidmacib.command.answers import Row
from sidmacib.command.options import LOCKS
from sidmacib.command.output import plot
from sidmacib.drawing import GREEN, ORANGE
from sidmacib.joint import Joint
from sidmacib.joint.loading import Push
from sidmacib.joint.parameters import PARAMETERS, SIZES
from sidmacib.quantities import Number, four_digits, number_in, shown
from sidmacib.rule.inverse import (
    MOST,
    VARIED,
    Candidate,
    Demand,
    Prices,
    all_candidates,
    bonded_area,
    cheapest,
    cheapest_of,
    fewest_locks,
    joint_area,
    volume_cut,
)
from sidmacib.rule.reliability import DESIGN_VALUES, Reliability

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Values = dict[str, tuple[float, ...]]
PRICED = {"area": "per m2", "volume": "per m3", "bonded": "per m2"}
ROUND = 12  # digits of a size after the decimal point: of a step that is no binary fraction
GREY = "0.7"


def demand_of(shear: float, torque: float, ratio: float | None, reliability: Reliability) -> Demand:
    """The demand; `click.UsageError` if there is none, or if it contradicts itself."""
    if not (shear or torque or ratio):
        raise click.UsageError("Give the load: -V, -M, or -V with -e.")
    if torque and not shear and ratio is not None and math.isinf(ratio):
        ratio = None  # the torque alone says that it is torsion
    try:
        return Demand(shear, torque, ratio, reliability)
    except ValueError as error:
        raise click.UsageError(f"-V, -M, -e: {error}") from None


def values_of(given: Sequence[str]) -> Values:
    """The values of each name in --vary; `click.UsageError` names what is wrong."""
    found: Values = {}
    for text in given:
        name, equals, spelled = text.partition("=")
        if not equals or name not in VARIED or name in found:
            words = "is there twice" if name in found else "is not allowed"
            allowed = f"one each of {', '.join(VARIED)}, as in a=0.04:0.12:0.01 or locks=3,5"
            raise click.UsageError(f"--vary: {shown(text)} {words}; it must be {allowed}")
        number = LOCKS if name == "locks" else PARAMETERS[name].number
        assert number is not None
        try:
            parts = spelled.split(":")
            if len(parts) == 1:
                found[name] = tuple(dict.fromkeys(map(number.read, spelled.split(","))))
            else:
                found[name] = _steps(parts, number)
        except ValueError as error:
            raise click.UsageError(f"--vary {name}: {error}") from None
    return found


def _steps(parts: Sequence[str], number: Number) -> tuple[float, ...]:
    """From the least to the largest value of a number, in steps."""
    if len(parts) > 3:
        raise ValueError(f"{shown(':'.join(parts))} is not allowed; it must be from:to:step")
    low, high = number.read(parts[0]), number.read(parts[1])
    if len(parts) == 2 and not number.whole:
        raise ValueError("must have a step, as in 0.04:0.12:0.01")
    steps = Number(above=0, whole=number.whole, unit=number.unit)
    step = steps.read(parts[2] if len(parts) == 3 else "1")
    count = math.floor((high - low) / step * (1.0 + 1e-12) + 1e-9) + 1
    if not 0 < count <= MOST:
        raise ValueError(f"has {max(count, 0)} values; it must have from 1 to {MOST}")
    values = (low + place * step for place in range(count))
    return tuple(int(value) if number.whole else round(value, ROUND) for value in values)


def prices_of(given: Sequence[str]) -> Prices:
    """The prices in --price, 0 of what is not named; `click.UsageError` names what is wrong."""
    found: dict[str, float] = {}
    for text in given:
        name, equals, spelled = text.partition("=")
        price = number_in(spelled)
        if not equals or name not in PRICED or name in found or price is None or price < 0.0:
            kinds = ", ".join(f"{name} ({unit})" for name, unit in PRICED.items())
            allowed = f"one each of {kinds}, as in area=100, at least 0"
            raise click.UsageError(f"--price: {shown(text)} is not allowed; it must be {allowed}")
        found[name] = float(price)
    try:
        return Prices(**{**dict.fromkeys(PRICED, 0.0), **found}) if found else Prices()
    except ValueError as error:
        raise click.UsageError(f"--price: {error}") from None


def sought(
    joint: Joint, demand: Demand, values: Values, prices: Prices, push: Push, every: bool
) -> tuple[Candidate | None, tuple[Candidate, ...]]:
    """The answer, None if no joint is one, and the joints that were tried; ``every``: all."""
    if not values:
        search = fewest_locks(joint, demand, push)
    elif every:
        tried = all_candidates(joint, demand, values, push)
        return cheapest_of(tried, prices), tried
    else:
        search = cheapest(joint, demand, values, prices, push)
    return search.found, search.tried


def candidate_rows(
    candidates: Sequence[Candidate],
    values: Mapping[str, Sequence[float]],
    prices: Prices,
    reliability: Reliability,
) -> list[Row]:
    """Varied parameters, capacity and cost of each joint."""
    units = {"locks": "locks", **{name: f"{name} (m)" for name in SIZES}}
    rows, what = [], "safe" if reliability == DESIGN_VALUES else "design"
    for each in candidates:
        joint = each.joint
        row: Row = {units[name]: getattr(joint, name) for name in values or ("locks",)}
        row[f"{what} V (N)"] = each.shear if each.exact else None
        row[f"{what} M (N m)"] = each.torque if each.exact else None
        row[f"required / {what}"] = each.usage if each.exact else None
        row["area (m2)"], row["volume cut (m3)"] = joint_area(joint), volume_cut(joint)
        if prices.bonded:
            row["bonded area (m2)"] = bonded_area(joint)
        if prices != Prices():
            row["price"] = prices.of(joint)
        row["note"] = note_of(each, values)
        rows.append(row)
    return rows


def note_of(each: Candidate, values: Mapping[str, Sequence[float]]) -> str:
    """Whether a joint meets the demand, or why not."""
    if each.load is None:
        return each.reason
    words = _answer(each)
    if not each.meets:
        most = f"at most {four_digits(each.shear or 0.0)} N, {four_digits(each.torque or 0.0)} N m"
        return words if each.exact else f"{words}: {most}"
    ends = [
        name
        for name, among in values.items()
        if len(among) > 2 and getattr(each.joint, name) in (min(among), max(among))
    ]
    return f"{words}; at the limit of the range: {', '.join(ends)}" if ends else words


def why_none(tried: Sequence[Candidate]) -> str:
    """Reason why none of the joints that were tried carries the load."""
    refused = [each.reason for each in tried if each.load is None]
    usage = [each.usage for each in tried if each.usage is not None]
    locks = [each.joint.locks for each in tried]
    words = [f"none of {len(tried)} joints is strong enough"]
    if len(locks) > 1 and locks == list(range(locks[0], locks[-1] + 1)):
        words = [f"no joint with {locks[0]} to {locks[-1]} locks is strong enough"]
    if usage:
        share = np.format_float_positional(100.0 / min(usage), 3, fractional=False, trim="-")
        words.append(f"the strongest reaches {share} % of the load")
    if refused:
        commonest = max(dict.fromkeys(refused), key=refused.count)
        words.append(f"the rule refuses {len(refused)} of them, for example: {commonest}")
    return "; ".join(words)


def _answer(each: Candidate) -> str:
    if each.meets:
        return "strong enough"
    return "refused" if each.load is None else "too weak"


def chart(
    found: Candidate | None, tried: Sequence[Candidate], values: Mapping[str, Sequence[float]]
) -> "Figure":
    """All joints that were tried over the first two names of ``values``.

    With one name or none: required load over resistance against it. A point stands for several
    joints where more than two names vary; it is strong enough if one of them is.
    """
    names = list(values or ("locks",))
    x, y = names[0], names[1] if len(names) > 1 else None
    labels = [each if each == "locks" else f"{each} (m)" for each in names]
    upwards = labels[1] if y else "required load / resistance"
    figure, axes = plot("joints that were tried", labels[0], upwards, height=4.5)

    def place(each: Candidate) -> tuple[float, float]:
        return getattr(each.joint, x), getattr(each.joint, y) if y else each.usage or 0.0

    points: dict[tuple[float, float], Candidate] = {}
    for each in tried:
        before = points.setdefault(place(each), each)
        if (each.usage or math.inf) < (before.usage or math.inf):
            points[place(each)] = each
    styles = {
        "strong enough": {"color": GREEN},
        "too weak": {"facecolors": "none", "edgecolors": ORANGE},
        "refused": {"color": GREY, "marker": "x"},
    }
    for label, style in styles.items():
        if places := [at for at, each in points.items() if label == _answer(each)]:
            axes.scatter(*zip(*places, strict=True), label=label, **style)
    if found is not None:
        ring = {"s": 160, "facecolors": "none", "edgecolors": "black"}
        axes.scatter(*place(found), label="cheapest" if values else "fewest locks", **ring)
    for name, axis in ((x, axes.xaxis), (y, axes.yaxis)):
        if name == "locks":
            axis.get_major_locator().set_params(integer=True)
    if y is None:
        axes.axhline(1.0, color=GREY, linewidth=1)
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure
