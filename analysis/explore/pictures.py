"""The explorer's data for a joint: V-M curve, weights, a drawing, and what each slider shows.

Sliders show the ranges that law and safe rule were tested in, and effects on the first failure.
"""

from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from analysis.drawing import boxes, label_of
from analysis.explore.state import SLIDERS, Figure, Settings
from sidmacib.answers.joint import joint_answer, meshes, quick_path
from sidmacib.drawing import BLUE, GREY, VM_RATIOS
from sidmacib.errors import CapacityError
from sidmacib.joint import Direction, Joint
from sidmacib.joint.effects import FIELDS as OF_JOINTS
from sidmacib.joint.effects import Field, sensitivity
from sidmacib.joint.loading import Loading
from sidmacib.joint.pieces import lock_weights
from sidmacib.quantities import four_digits
from sidmacib.rule import RULES, LawCapacity, first_failure
from sidmacib.rule.reliability import resistances
from sidmacib.rule.spans import require_covered

SYMBOLS = {"law": "x", "safe": "star", "characteristic": "diamond", "design": "circle"}
DESIGN_WITH = {  # as far as they are known, the one to design with first
    "design": "design resistance",
    "characteristic": "characteristic resistance",
    "safe": "safe rule",
}
MOST_VALUES = 41  # of a slider, that are tried
# What a slider changes; the tensile strength goes with the cohesion.
FIELDS = tuple(
    replace(each, places=(*each.places, "inner.tensile_strength"))
    if each.name == "cohesion"
    else each
    for each in OF_JOINTS
    if each.name in SLIDERS
)
PRESSURE = Field("pressure", ("hold_down.amount",), "Pa")


@dataclass(frozen=True)
class Peak:
    """A load along a direction: shear (N), torque (N m), weights of the locks by number."""

    shear: float
    torque: float
    weights: dict[int, float]


@dataclass(frozen=True)
class Answers:
    """Answers of the models at the chosen eccentricity, and reasons where there are none."""

    peak: Peak | None
    rules: dict[str, LawCapacity]
    words: str


@dataclass(frozen=True)
class Counted:
    """V (N) of the load that counts, its legend, a sentence where others were found, and why."""

    shear: float | None = None
    legend: str = ""
    words: str = ""
    why: str | None = None


@lru_cache(maxsize=512)
def peak(joint: Joint, ratio: float) -> Peak | None:
    """The static model's peak, at once: whether it counts is open; None if nothing is carried.

    Of pieces that bend, where it takes minutes, the law's first failure; None where it refuses.
    """
    direction = Direction(ratio)
    if joint.elastic is not None:
        return _first_failure(joint, direction)
    try:
        assembly, solution = quick_path(joint, Loading(direction))
    except CapacityError:
        return None
    found = lock_weights(joint, assembly, solution.peak.force)
    weights = {each.lock: each.weight for each in found}
    return _peak(joint, direction, float(solution.peak.load), weights)


def _first_failure(joint: Joint, direction: Direction) -> Peak | None:
    try:
        require_covered(joint)
        state = first_failure(joint, Loading(direction))
    except (CapacityError, ValueError):
        return None
    weights = np.hypot(state.force_x, state.force_y) / joint.T0
    own = dict(zip(joint.numbers, weights.tolist(), strict=True))
    return _peak(joint, direction, state.load, own)


def _peak(joint: Joint, direction: Direction, load: float, weights: dict[int, float]) -> Peak:
    return Peak(load * direction.shear, load * direction.torque * joint.a, weights)


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
        legend = f" (no lower peak found at {state.eccentricity:g} a)"
        return Counted(shear, legend, why=found.why)
    words = f"The load that counts is the {found.why}: V = {four_digits(shear)} N."
    legend = f" (spread {spread:.1f} % at {state.eccentricity:g} a)"
    return Counted(shear, legend, words, found.why)


def answers(state: Settings) -> Answers:
    """Peak, law and safe rule at the chosen eccentricity; refusals become words."""
    joint, direction = state.joint, Direction(state.eccentricity)
    found, rigid = peak(joint, state.eccentricity), joint.elastic is None
    if found is None:
        last = "nothing carries the load" if rigid else "no first failure is known"
    else:
        last = f"{'peak' if rigid else 'first failure'} at {_in_words(found)}"
    rules: dict[str, LawCapacity] = {}
    why = ""
    try:
        for name, rule in (RULES | resistances(state.reliability)).items():
            rules[name] = rule(joint, direction)
    except (CapacityError, ValueError) as error:
        why = f" No {'resistance' if 'safe' in rules else 'safe rule'}: {error}."
    known = [name for name in DESIGN_WITH if name in rules]
    told = [f"{DESIGN_WITH[name]} {_in_words(rules[name])}" for name in known]
    if known and known[0] != "characteristic" and not why:
        told[0] = f"design with {_in_words(rules[known[0]])} ({DESIGN_WITH[known[0]]})"
    words = f"{joint.locks} locks, e = {state.eccentricity:g} a: {'; '.join([*told, last])}.{why}"
    return Answers(found, rules, f"{words} T0 = {four_digits(joint.T0)} N.")


def _in_words(load: Peak | LawCapacity) -> str:
    return f"V = {four_digits(load.shear)} N, M = {four_digits(load.torque)} N m"


def results(state: Settings, found: Answers, counted: Counted | None = None) -> dict[str, Figure]:
    """What a joint carries, by names; ``counted``: None if not known yet."""
    rules = {_mark(name): rule for name, rule in found.rules.items()}
    told: dict[str, Figure] = {
        f"{name}: V (N)": None if load is None else load.shear
        for name, load in {_curve(state): found.peak, **rules}.items()
    }
    told[f"{_curve(state)}: M (N m)"] = None if found.peak is None else found.peak.torque
    if counted is not None and counted.why is not None:
        told |= {"load that counts": counted.why, "load that counts: V (N)": counted.shear}
    return {**told, "strength of a lock T0 (N)": state.joint.T0}


def _curve(state: Settings) -> str:
    of = ("peak", "static") if state.joint.elastic is None else ("first failure", "law")
    return f"{of[0]}, {label_of(of[1]).name}"


def _mark(name: str) -> str:
    return f"first failure, {label_of(name).name}" if name == "law" else label_of(name).name


def ratios(state: Settings) -> tuple[float, ...]:
    """The directions of the curve, e / a: the chosen one among them."""
    return tuple(sorted({*VM_RATIOS, state.eccentricity}))


def pictures(state: Settings, results: Answers) -> dict[str, Any]:
    """Drawings of the page: points in the V-M plane, weights, the joint from the side (mm)."""
    name = "static" if state.joint.elastic is None else "law"
    blocks = {True: "upper", False: "lower"}
    return {
        "curve": {
            "name": _curve(state),
            "colour": label_of(name).colour,
            "shear": [results.peak.shear] if results.peak else [],
            "torque": [results.peak.torque] if results.peak else [],
        },
        "marks": [
            {
                "name": _mark(name),
                "colour": label_of(name).colour,
                "symbol": SYMBOLS[name],
                "shear": rule.shear,
                "torque": rule.torque,
            }
            for name, rule in results.rules.items()
        ],
        "shares": [
            {"lock": lock, "block": blocks[state.joint.is_upper(lock)], "weight": weight}
            for lock, weight in (results.peak.weights if results.peak else {}).items()
        ],
        "colours": {"upper": BLUE, "lower": GREY},
        "pieces": [
            {
                "lock": piece.lock,
                "block": blocks[piece.upper],
                "low": piece.low[1:],
                "high": piece.high[1:],
            }
            for piece in boxes(state.joint)
        ],
    }


def covered(state: Settings) -> dict[str, tuple[float, float] | None]:
    """The least and the largest value of each slider at which law and safe rule take the joint.

    The other sliders stay as they are. None where no value does; choices are left out.
    """
    found: dict[str, tuple[float, float] | None] = {}
    for name, slider in SLIDERS.items():
        if slider.choices:
            continue
        steps = round((slider.most - slider.least) / slider.step)
        places = np.unique(np.linspace(0, steps, min(MOST_VALUES, steps + 1)).round())
        values = [round(slider.least + float(place) * slider.step, 9) for place in places]
        inside = []
        for value in values:
            changed = replace(state, **{name: int(value) if name == "locks" else value})
            with suppress(ValueError):
                require_covered(changed.joint)
                inside.append(value)
        found[name] = (inside[0], inside[-1]) if inside else None
    return found


def effects(state: Settings) -> dict[str, str]:
    """Below each slider: an arrow, and the change of the first failure for 1 % more.

    Nothing of a slider at 0, and of blocks that bend, whose static model is not shown.
    """
    fields = (*FIELDS, PRESSURE) if state.pressure else FIELDS
    if not state.friction:
        fields = tuple(each for each in fields if each.name != "friction")
    return _effects(state.joint, state.eccentricity, fields)


@lru_cache(maxsize=512)
def _effects(joint: Joint, ratio: float, fields: tuple[Field, ...]) -> dict[str, str]:
    if joint.elastic is not None:
        return {}
    try:
        found = sensitivity(joint, Loading(Direction(ratio)), meshes(joint)[1], fields=fields)
    except CapacityError:
        return {}
    return {each.name: effect_words(each.more) for each in found.effects if each.more is not None}


def effect_words(more: float) -> str:
    """An arrow towards a larger load, and the change (%) for 1 % more; no arrow for none."""
    shown = f"{more:+.2f} %".replace("-", "\N{MINUS SIGN}")
    if float(f"{more:.2f}") == 0.0:
        return "0.00 %"
    return f"\N{RIGHTWARDS ARROW} {shown}" if more > 0.0 else f"\N{LEFTWARDS ARROW} {shown}"
