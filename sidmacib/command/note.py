"""A calculation note of one joint: data, equations with numbers, checks and the verdict, in HTML.

The note is a page without links that prints on A4. It has no date, so that the same input gives the
same file; whoever signs it writes the date.
"""

import math
import shlex
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from typing import Any

import click
import numpy as np

from sidmacib.answers.joint import joint_answer, joint_mesh_error
from sidmacib.command.output import (
    Appended,
    Formula,
    in_asked_words,
    refused_in_one_line,
    write_text,
)
from sidmacib.errors import CapacityError
from sidmacib.joint import AMOUNTS, Direction, Joint
from sidmacib.joint.loading import Loading, Push
from sidmacib.joint.parameters import PARAMETERS
from sidmacib.quantities import four_digits
from sidmacib.rule import (
    MOVES,
    JointFailure,
    first_failure,
    law,
    margin_of,
    path_of,
    safe,
    weak_failure,
    weakened,
)
from sidmacib.rule.reliability import (
    Reliability,
    Scatter,
    characteristic,
    design_resistance,
    log_deviation,
)
from sidmacib.rule.spans import SPANS, spans_of
from sidmacib.scene.page import rendered

TEMPLATE = Path(__file__).with_name("joint_note.html.j2")
# Of the drawing, in its units:
WIDE = 560.0  # of a view
LEFT, TOP = 90.0, 46.0  # corner of the elevation
GAP = 16.0  # between a view and a line of dimensions
LEAST = 14.0  # height of the lower block
SLIGHT = 0.01  # of the largest utilisation: locks below carry next to nothing
Cells = tuple[object, ...]


@dataclass(frozen=True)
class Case:
    """What a note is of; ``needed``: the load to carry along ``direction`` (N), if there is one."""

    joint: Joint
    direction: Direction
    push: Push
    reliability: Reliability
    needed: float | None = None

    def both(self, load: float) -> str:
        """A load along the direction as V and M, in the units that were asked for."""
        shear, torque = load * self.direction.shear, load * self.direction.torque * self.joint.a
        parts = [f"V = {four_digits(shear)} N"] if self.direction.shear else []
        return in_asked_words(", ".join([*parts, f"M = {four_digits(torque)} N m"]))


def write_note(case: Case, path: Path) -> None:
    """Write the note of ``case``; what makes it impossible is an error of click."""
    options = click.get_current_context().params
    with refused_in_one_line():
        given = [options["file"]] if options["file"] else []
        command = shlex.join(["multilock", *sys.argv[1:]])
        write_text(joint_note(case, command, given), path, "--note")


def joint_note(case: Case, command: str, inputs: Sequence[Path]) -> str:
    """The note of ``case``, in HTML; ``command``: what it was made by, with files, ``inputs``.

    Its equations and the parameters in them are in SI units, whatever units were asked for.

    Errors of `sidmacib.rule.reliability.design_resistance`.
    """
    joint, direction, push = case.joint, case.direction, case.push
    resistance = design_resistance(joint, direction, case.reliability, push).load
    weak, fractile = joint, None
    if variation := case.reliability.variation:
        found = characteristic(joint, direction, variation, push)
        weak = weakened(joint, found.margin)
        lost = first_failure(weak, Loading(direction, push=push))
        scatter = Scatter(lost.load, lost.bonds / found.margin, variation)
        fractile = {
            "deviation": log_deviation(variation),
            "survival": scatter.survival(lost.load),
            "load": found.capacity.load,
            "margin": found.margin,
        }
    state = first_failure(joint, Loading(direction, push=push))
    failure = weak_failure(weak, direction, push)
    ratio = direction.eccentricity
    load = f"V at e = {ratio:g} a = {1e3 * ratio * joint.a:g} mm, so M = V e"
    if math.isinf(ratio):
        load = "Pure torsion, torque M about the vertical axis"
    return rendered(
        TEMPLATE,
        title=f"Calculation note: joint of {joint.locks} interlocking locks",
        case=case,
        joint=joint,
        resistance=resistance,
        margin=margin_of(joint),
        at=_drawing(joint, direction, push),
        load=load,
        parameters=_parameters(joint),
        locks=_locks(state, joint),
        first=state.load,
        moves=MOVES.get(state.mode, ""),
        fractile=fractile,
        loads=failure.loads,
        difference=failure.load,
        safe_load=safe(weak, direction, push).load,
        whole=law(weak, direction, push).load,
        path_margin=path_of(case.joint),
        of_strengths=safe(weakened(weak, case.reliability.partial_factor), direction, push).load,
        checks=[*_checks(case, resistance)],
        command=command,
        inputs=[*map(Appended.of, inputs)],
    )


def _drawing(joint: Joint, direction: Direction, push: Push) -> dict[str, Any]:
    """Where elevation, plan and load along ``direction`` are drawn by the template."""
    scale = min(WIDE / joint.total_width, 90.0 / (joint.h + joint.H), 130.0 / joint.a)
    right, deep = LEFT + scale * joint.total_width, scale * joint.a
    foot = TOP + scale * joint.H + scale * joint.h
    below = max(0.5 * scale * joint.H, LEAST)
    plan = foot + below + 40.0
    middle, off = plan + deep / 2, 0.0
    if direction.shear:
        off = min(max(direction.eccentricity * deep, -0.5 * deep - 30), 0.5 * deep + 30)
    from_left = push is Push.PLUS_Y
    return {
        "left": LEFT,
        "right": right,
        "top": TOP,
        "roots": TOP + scale * joint.H,
        "foot": foot,
        "below": below,
        "locks": [
            (LEFT + scale * joint.edge(lock - 1), LEFT + scale * joint.edge(lock))
            for lock in joint.numbers
        ],
        "plan": plan,
        "deep": deep,
        "middle": middle,
        "off": off,
        "sign": 1 if from_left else -1,
        "start": LEFT - 46 if from_left else right + 46 + GAP,
        "end": LEFT - 4 if from_left else right + 4,
        "dimensions": right + GAP,
        "wide": right + 110.0,
        "high": max(plan + deep, middle + off) + 20.0,
    }


def _parameters(joint: Joint) -> list[Cells]:
    """Words, value and unit of each parameter that ``joint`` has, two in a row."""
    cells: list[Cells] = []
    for each in PARAMETERS.values():
        value = each.of(joint)
        if value is not None:
            unit = each.number.unit if each.number else ""
            if each.name == "hold_down":
                value = str(joint.hold_down.kind)
                if amount := AMOUNTS.get(joint.hold_down.kind):
                    value, unit = f"{value} of {joint.hold_down.amount:g}", amount.unit
            cells.append((each.words, f"{value:g}" if isinstance(value, float) else value, unit))
    half = -(-len(cells) // 2)
    pairs = zip_longest(cells[:half], cells[half:], fillvalue=("",) * 3)
    return [(*left, *right) for left, right in pairs]


def _locks(state: JointFailure, joint: Joint) -> list[Cells]:
    """Locks that carry more than next to nothing, in a row each."""
    least = SLIGHT * float(state.utilisation.max())
    # Without the rounding error of forces that balance.
    x, y, turn = (
        np.where(np.abs(each) > 1e-9 * np.abs(each).max(), each, 0.0)
        for each in (state.force_x, state.force_y, state.torque)
    )
    return [
        (lock, *map(four_digits, (x[k], y[k], turn[k])), f"{used:.3f}")
        for k, (lock, used) in enumerate(zip(joint.numbers, state.utilisation, strict=True))
        if used >= least
    ]


def _checks(case: Case, resistance: float) -> Iterator[Cells]:
    """Each check: what, the formula with numbers, the result, and whether it is kept.

    ``resistance``: N, along the direction.
    """
    spans = spans_of(case.joint)
    ranges = ", ".join(
        f"{each} {spans[each]:.3g} ({low:g} to {high:g})"
        for each, (low, high) in list(SPANS.items())[:4]
    )
    found = f"{ranges}, and {len(SPANS) - 4} others"
    yield "The joint is in the ranges that the rule was tested in", found, "", "verified"
    if case.joint.elastic is None:
        yield "First failure on a finer mesh is above the resistance", *_static(case, resistance)
    if case.needed is not None:
        yield _ratio("Action over design resistance", "E", case.needed, "R", resistance)


def _ratio(what: str, over: str, one: float, under: str, other: float) -> Cells:
    """The check that ``one`` load (N) is at most the ``other``."""
    symbols = f"<i>F</i><sub>{over}</sub> / <i>F</i><sub>{under}</sub>"
    formula = Formula(f"{symbols} = {four_digits(one)} N / {four_digits(other)} N")
    kept = "verified" if one <= other else "NOT verified"
    return what, formula, f"{one / other:.3f}", f"≤ 1: {kept}"


def _static(case: Case, resistance: float) -> tuple[object, str, str]:
    """What the static model says of the given strengths, and whether that is enough."""
    loading = Loading(case.direction, push=case.push)
    try:
        found, error = joint_answer(case.joint, loading), joint_mesh_error(case.joint, loading)
    except CapacityError as failure:
        return str(failure), "", "no answer"
    part = found.first_failure or 1.0
    shown = f"peak {case.both(found.load)}; first failure at {part:.3f} of it"
    shown += f"; mesh error {100.0 * error:.2g} %" if error is not None else ""
    _, formula, ratio, kept = _ratio("", "R", resistance, "1", part * found.load)
    return Formula(f"{shown}; {formula}"), str(ratio), str(kept)
