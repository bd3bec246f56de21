"""The explorer's data for a joint: V-M curve, weights of the locks, and a drawing."""

import math
from dataclasses import asdict, dataclass
from functools import lru_cache
from typing import Any

from analysis.drawing.boxes import boxes
from analysis.drawing.labels import label_of
from analysis.explore.state import Settings
from sidmacib.answers.joint import joint_answer, quick_path
from sidmacib.drawing import BLUE, GREY, VM_RATIOS
from sidmacib.errors import CapacityError
from sidmacib.joint.joint import Direction, Joint
from sidmacib.joint.loading import Loading
from sidmacib.joint.weights import lock_weights
from sidmacib.mechanics.assembly import Assembly
from sidmacib.mechanics.solution import Equilibrium
from sidmacib.rule.law import RULES, LawCapacity, first_failure, law

SYMBOLS = {"law": "x", "safe": "star"}


@dataclass(frozen=True)
class Share:
    """A lock by number, its block, and what it carries over its strength."""

    lock: int
    block: str
    weight: float


@dataclass(frozen=True)
class Peak:
    """A load along a direction: shear (N), torque (N m), shares of the locks."""

    shear: float
    torque: float
    shares: tuple[Share, ...]


@dataclass(frozen=True)
class Answers:
    """Answers of the models at the chosen eccentricity, and reasons where there are none."""

    peak: Peak | None
    rules: dict[str, LawCapacity]
    words: str


@dataclass(frozen=True)
class Counted:
    """V (N) of the load that counts, its legend, and a sentence where others were found."""

    shear: float | None = None
    legend: str = ""
    words: str = ""


@lru_cache(maxsize=512)
def peak(joint: Joint, ratio: float) -> Peak | None:
    """The static model's peak, at once: whether it counts is open; None if nothing is carried.

    Of pieces that bend, where it takes minutes, the law's first failure; None where it refuses.
    """
    direction = Direction(ratio)
    return _peak(joint, direction) if joint.elastic is None else _first_failure(joint, direction)


def _first_failure(joint: Joint, direction: Direction) -> Peak | None:
    try:
        law(joint, direction)  # refuses joints outside its tested ranges
        state = first_failure(joint, Loading(direction))
    except (CapacityError, ValueError):
        return None
    shares = tuple(
        Share(lock, "upper" if joint.is_upper(lock) else "lower", math.hypot(x, y) / joint.T0)
        for lock, x, y in zip(joint.numbers, state.force_x, state.force_y, strict=True)
    )
    return Peak(state.load * direction.shear, state.load * direction.torque * joint.a, shares)


def which_counts(state: Settings) -> Counted:
    """The load that counts at the chosen eccentricity, as `multilock capacity` prints it.

    It takes longer than the peak: it comes with the curve, which is drawn last. Nothing of blocks
    that bend, and where there is no answer.
    """
    joint, loading = state.joint, Loading(Direction(state.eccentricity))
    if joint.elastic is not None:
        return Counted()
    try:
        found = joint_answer(joint, loading)
    except CapacityError:
        return Counted()
    shear = found.load * loading.direction.shear
    if not (spread := 100.0 * found.solution.spread):
        return Counted(shear, f" (no lower peak found at {state.eccentricity:g} a)")
    words = f"The load that counts is the {found.why}: V = {shear:.4g} N."
    return Counted(shear, f" (spread {spread:.1f} % at {state.eccentricity:g} a)", words)


def _peak(joint: Joint, direction: Direction) -> Peak | None:
    try:
        assembly, solution = quick_path(joint, Loading(direction))
    except CapacityError:
        return None
    return _at(joint, direction, assembly, solution.peak)


def _at(joint: Joint, direction: Direction, assembly: Assembly, state: Equilibrium) -> Peak:
    load = float(state.load)
    shares = tuple(
        Share(each.lock, each.block, each.weight)
        for each in lock_weights(joint, assembly, state.force)
    )
    return Peak(load * direction.shear, load * direction.torque * joint.a, shares)


def answers(state: Settings) -> Answers:
    """Peak, law and safe rule at the chosen eccentricity; refusals become words."""
    joint, ratio = state.joint, state.eccentricity
    found = peak(joint, ratio)
    rigid = joint.elastic is None
    kind = "peak" if rigid else "first failure"
    nothing = "nothing carries the load." if rigid else "no first failure is known."
    words = f"{joint.locks} locks, e = {ratio:g} a: " + (
        nothing
        if found is None
        else f"{kind} at V = {found.shear:.4g} N, M = {found.torque:.3g} N m."
    )
    rules: dict[str, LawCapacity] = {}
    try:
        for name, rule in RULES.items():
            rules[name] = rule(joint, Direction(ratio))
    except (CapacityError, ValueError) as error:
        return Answers(found, rules, f"{words} No safe rule: {error}.")
    safe = rules["safe"]
    words += f" Safe: V = {safe.shear:.4g} N, M = {safe.torque:.3g} N m. T0 = {joint.T0:.4g} N."
    return Answers(found, rules, words)


def ratios(state: Settings) -> tuple[float, ...]:
    """The directions of the curve, e / a: the chosen one among them."""
    return tuple(sorted({*VM_RATIOS, state.eccentricity}))


def pictures(state: Settings, results: Answers) -> dict[str, Any]:
    """Drawings of the page: points in the V-M plane, weights, the joint from the side (mm)."""
    name = "static" if state.joint.elastic is None else "law"
    kind = "peak" if state.joint.elastic is None else "first failure"
    return {
        "curve": {
            "name": f"{kind}, {label_of(name).name}",
            "colour": label_of(name).colour,
            "shear": [results.peak.shear] if results.peak else [],
            "torque": [results.peak.torque] if results.peak else [],
        },
        "marks": [
            {
                "name": "first failure, law" if name == "law" else label_of(name).name,
                "colour": label_of(name).colour,
                "symbol": SYMBOLS[name],
                "shear": rule.shear,
                "torque": rule.torque,
            }
            for name, rule in results.rules.items()
        ],
        "shares": [asdict(share) for share in (results.peak.shares if results.peak else ())],
        "colours": {"upper": BLUE, "lower": GREY},
        "pieces": [
            {
                "lock": piece.lock,
                "block": "upper" if piece.upper else "lower",
                "low": piece.low[1:],
                "high": piece.high[1:],
            }
            for piece in boxes(state.joint)
        ],
    }
