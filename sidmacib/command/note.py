"""A calculation note of one joint: data, equations with numbers, checks and the verdict, in HTML.

The note is a page without links that prints on A4. It has no date, so that the same input gives the
same file; whoever signs it writes the date.
"""

import math
import shlex
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from importlib.metadata import version
from pathlib import Path
from string import Template

from sidmacib.answers.joint import joint_answer, joint_mesh_error
from sidmacib.command.note_drawing import drawing
from sidmacib.command.note_mathml import equation, fraction, name, number, root
from sidmacib.command.output import refused_in_one_line, write_text
from sidmacib.errors import CapacityError
from sidmacib.joint import Direction, Joint, UpperBody
from sidmacib.joint.loading import Loading, Push
from sidmacib.joint.parameters import PARAMETERS
from sidmacib.mechanics.solution import Mode
from sidmacib.rule import (
    PATH,
    SPANS,
    JointFailure,
    LawCapacity,
    below_meshes,
    first_failure,
    law,
    margin_of,
    safe,
    spans_of,
    weak_failures,
    weakened,
)
from sidmacib.rule.reliability import (
    Characteristic,
    Reliability,
    Scatter,
    characteristic,
    design_resistance,
)

TEMPLATE = Path(__file__).with_name("note.html")
SLIGHT = 0.01  # of the largest utilisation: locks below carry next to nothing


@dataclass(frozen=True)
class Case:
    """What a note is of; ``needed``: the load to carry along ``direction`` (N), if there is one."""

    joint: Joint
    direction: Direction
    push: Push
    reliability: Reliability
    needed: float | None = None

    def both(self, load: float) -> str:
        """A load along the direction as V and M."""
        shear, torque = load * self.direction.shear, load * self.direction.torque * self.joint.a
        parts = [f"V = {shear:.4g} N"] if self.direction.shear else []
        return ", ".join([*parts, f"M = {torque:.4g} N m"])


def write_note(case: Case, path: Path) -> None:
    """Write the note of ``case``; what makes it impossible is an error of click."""
    with refused_in_one_line():
        write_text(joint_note(case, shlex.join(["multilock", *sys.argv[1:]])), path, "--note")


def joint_note(case: Case, command: str) -> str:
    """The note of ``case``, in HTML; ``command``: what it was made by.

    Errors of `sidmacib.rule.reliability.design_resistance`.
    """
    joint, direction, push = case.joint, case.direction, case.push
    found = None
    if case.reliability.variation:
        found = characteristic(joint, direction, case.reliability.variation, push)
    resistance = design_resistance(joint, direction, case.reliability, push)
    title = f"Calculation note: joint of {joint.locks} interlocking locks"
    parts = (
        f"<h1>{title}</h1>",
        signatures(),
        _verdict(case, resistance),
        "<h2>1 Joint and load</h2>",
        drawing(joint, direction, str(push)),
        _data(case),
        "<h2>2 Resistance</h2>",
        *_resistance(case, found, resistance),
        "<h2>3 Checks</h2>",
        _checks(case, resistance),
        "<h2>4 Assumptions</h2>",
        _assumptions(case),
        f'<p class="small">multilock {version("multilock")}; <code>{escape(command)}</code></p>',
    )
    return Template(TEMPLATE.read_text()).substitute(title=title, body="\n".join(parts))


def table(head: Sequence[str], rows: Iterable[Sequence[str]], numeric: bool = False) -> str:
    """A table, whose cells behind the first are numbers if ``numeric``."""

    def line(cells: Sequence[str], tag: str) -> str:
        kinds = ["", *[' class="n"' if numeric else ""] * (len(cells) - 1)]
        return "".join(
            f"<{tag}{kind}>{cell}</{tag}>" for cell, kind in zip(cells, kinds, strict=True)
        )

    body = "".join(f"<tr>{line(row, 'td')}</tr>" for row in rows)
    top = f"<thead><tr>{line(head, 'th')}</tr></thead>" if head else ""
    return f'<div class="wide"><table>{top}<tbody>{body}</tbody></table></div>'


def signatures() -> str:
    """The row for project, author and who checked."""
    cells = "".join(f"<th>{words}</th><td></td>" for words in ("Project", "By, date", "Checked"))
    return f"""<div class="wide"><table class="sign"><tr>{cells}</tr></table></div>"""


def _verdict(case: Case, resistance: LawCapacity) -> str:
    words = f"Design resistance: {case.both(resistance.load)}"
    factor = case.reliability.partial_factor
    factors = [f"model margin {margin_of(case.joint):g}", f"gamma_M = {factor:g}"]
    if case.reliability.variation:
        factors.insert(0, f"scatter {100.0 * case.reliability.variation:g} % (5 % fractile)")
    words += f" ({', '.join(factors)}).{_compared(case, resistance)}"
    return f'<p class="verdict">{words}</p>'


def _compared(case: Case, resistance: LawCapacity) -> str:
    """What is needed over what is there."""
    if case.needed is None:
        return ""
    usage = case.needed / resistance.load
    passed = "verified" if usage <= 1.0 else "NOT verified"
    return f" Action: {case.both(case.needed)}. Utilisation {usage:.3f}: {passed}."


def _data(case: Case) -> str:
    joint, direction = case.joint, case.direction
    rows = []
    for each in PARAMETERS.values():
        value = each.of(joint)
        if value is not None:
            unit = each.number.unit if each.number and each.number.unit else ""
            shown = f"{value:g}" if isinstance(value, float | int) else str(value)
            if each.name == "hold_down":
                shown = escape(str(value.spelled))
            rows.append((each.words, shown, unit))
    half = -(-len(rows) // 2)
    pairs = [
        (*rows[place], *(rows[place + half] if place + half < len(rows) else ("",) * 3))
        for place in range(half)
    ]
    if math.isinf(direction.eccentricity):
        load = "Pure torsion, torque M about the vertical axis"
    else:
        ratio, arm = direction.eccentricity, direction.eccentricity * joint.a
        load = f"V at e = {ratio:g} a = {1e3 * arm:g} mm, so M = V e"
    stand = (
        f"means, with a coefficient of variation of {case.reliability.variation:g}"
        if case.reliability.variation
        else "characteristic values"
        if case.reliability.partial_factor != 1.0
        else "design values"
    )
    return (
        f"<p>Load: {load}, pushing along {case.push}. "
        f"Cohesion and tensile strength are {stand}.</p>"
        + table(("parameter", "value", "unit") * 2, pairs)
    )


def _resistance(case: Case, found: Characteristic | None, resistance: LawCapacity) -> Iterable[str]:
    joint, direction = case.joint, case.direction
    cohesion = joint.inner.cohesion
    product = number(cohesion), number(joint.a), number(joint.b), number(joint.T0, "N")
    left = name("T", "0"), name("τ", "k") + name("a") + name("b")
    yield "<p>Shear strength of one lock:</p>"
    yield equation(*left, "<mo>·</mo>".join(product[:3]), product[3])
    state = first_failure(joint, Loading(direction, push=case.push))
    yield (
        "<p>Up to the first failure the static model follows the forces on every lock, with "
        "friction and opening of dry faces. A lock fails where the shear stress τ or the tension "
        "σ of its root reaches its strength:</p>"
    )
    used = "<mi>max</mi><mo>(</mo>" + fraction("<mi>τ</mi>", name("τ", "k")) + "<mo>,</mo>"
    used += fraction("<mi>σ</mi>", name("σ", "t")) + "<mo>)</mo>"
    yield equation(name("u", "i"), used, number(1.0))
    yield _locks(state, joint)
    how = "" if state.mode is Mode.BONDS else f" (the joint moves away: {state.mode})"
    yield f"<p>First failure with the given strengths{how}: {case.both(state.load)}.</p>"
    weak = joint
    if found is not None:
        yield from _fractile(case, found)
        weak = weakened(joint, found.margin)
    yield from _safe_rule(case, weak)
    if case.reliability.partial_factor != 1.0:
        yield from _factored(case, weak, resistance)


def _locks(state: JointFailure, joint: Joint) -> str:
    """Locks that carry more than next to nothing, in a row each."""
    least = SLIGHT * float(state.utilisation.max())
    rows = [
        (str(lock), f"{x:.4g}", f"{y:.4g}", f"{turn:.3g}", f"{u:.3f}")
        for lock, x, y, turn, u in zip(
            joint.numbers,
            _clean(state.force_x),
            _clean(state.force_y),
            _clean(state.torque),
            state.utilisation,
            strict=True,
        )
        if u >= least
    ]
    head = ("lock", "shear x (N)", "shear y (N)", "torque (N m)", "<i>u</i>")
    return table(head, rows, numeric=True)


def _clean(values: Iterable[float]) -> list[float]:
    """Values without the rounding error of those that balance."""
    numbers = [float(value) for value in values]
    noise = 1e-9 * max(map(abs, numbers))
    return [value if abs(value) > noise else 0.0 for value in numbers]


def _fractile(case: Case, found: Characteristic) -> Iterable[str]:
    variation = case.reliability.variation
    deviation = math.sqrt(math.log1p(variation**2))
    yield (
        "<p>Characteristic resistance: 5 % fractile (EN 1990, 4.2). The strengths of the locks are "
        "independent and lognormal; s is the standard deviation of their logarithms:</p>"
    )
    square = f"<msup>{name('V', 'f')}{number(2.0)}</msup>"
    inside = f"<mi>ln</mi><mo>(</mo>{number(1.0)}<mo>+</mo>{square}<mo>)</mo>"
    yield equation(name("s"), root(inside), number(deviation))
    state = first_failure(
        weakened(case.joint, found.margin), Loading(case.direction, push=case.push)
    )
    survived = Scatter(state.load, state.utilisation / found.margin, variation)
    product = (
        "<munder><mo>∏</mo><mi>i</mi></munder><mo>[</mo>" + number(1.0) + "<mo>−</mo><mi>Φ</mi>"
    )
    product += "<mo>(</mo>" + fraction(
        "<mi>ln</mi>"
        + name("u", "i")
        + "<mo>+</mo>"
        + "<msup><mi>s</mi><mn>2</mn></msup><mo>/</mo><mn>2</mn>",
        "<mi>s</mi>",
    )
    product += "<mo>)</mo><mo>]</mo>"
    share = survived.survival(state.load)
    yield equation(
        "<mi>P</mi><mo>(</mo><mtext>no lock fails</mtext><mo>)</mo>", product, number(share)
    )
    yield (
        f"<p>holds at {case.both(found.capacity.load)}, the first failure of the joint with all "
        f"strengths divided by {found.margin:.4g}. This is the characteristic resistance.</p>"
    )


def _safe_rule(case: Case, weak: Joint) -> Iterable[str]:
    loads, _ = weak_failures(weak, case.direction, case.push)
    margin, safe_load = margin_of(weak), safe(weak, case.direction, case.push).load
    found = ", ".join(f"{load:.4g} N" for load in loads)
    yield (
        f"<p>Margin for the model: strengths are divided by {margin:g} as well. Load along the "
        f"direction, √(V² + (M/a)²), on {len(loads)} meshes: {found}. What they differ by is "
        "subtracted from the lowest:</p>"
    )
    symbol = name("F", "d" if case.reliability.partial_factor == 1.0 else "s")
    terms, numbers = (
        f"{least}<mo>−</mo><mo>(</mo>{most}<mo>−</mo>{least}<mo>)</mo>"
        for least, most in (
            (name("F", "min"), name("F", "max")),
            (number(min(loads)), number(max(loads))),
        )
    )
    difference = below_meshes(loads)
    yield equation(symbol, terms, numbers, number(difference, "N"))
    if safe_load < difference:
        whole = law(weak, case.direction, case.push).load
        yield (
            f"<p>Strengths hardly matter here: at most the first failure without this margin, "
            f"{whole:.4g} N, divided by {PATH:g}.</p>"
        )
    yield f"<p>This is {case.both(safe_load)}.</p>"


def _factored(case: Case, weak: Joint, resistance: LawCapacity) -> Iterable[str]:
    factor = case.reliability.partial_factor
    load = safe(weak, case.direction, case.push).load
    yield (
        "<p>Design resistance (EN 1990, 6.3.5): the partial factor divides the resistance (6.6c) "
        "or the strengths (6.6a), whichever gives less:</p>"
    )
    term = fraction(name("F", "s"), name("γ", "M"))
    yield equation(
        name("F", "d"), term, fraction(number(load), number(factor)), number(load / factor, "N")
    )
    of_strengths = safe(weakened(weak, factor), case.direction, case.push).load
    yield (
        f"<p>With the factor on the strengths: {of_strengths:.4g} N. The lower one counts: "
        f"{case.both(resistance.load)}.</p>"
    )


def _checks(case: Case, resistance: LawCapacity) -> str:
    joint = case.joint
    spans = spans_of(joint)
    ranges = ", ".join(
        f"{escape(each)} {spans[each]:.3g} ({low:g} to {high:g})"
        for each, (low, high) in list(SPANS.items())[:4]
    )
    rows = [
        ("Ranges that the rule was tested in", f"{ranges}, and {len(SPANS) - 4} others", "within")
    ]
    if joint.elastic is None:
        loading = Loading(case.direction, push=case.push)
        try:
            found, error = joint_answer(joint, loading), joint_mesh_error(joint, loading)
            part = found.first_failure or 1.0
            shown = f"peak {case.both(found.load)}; first failure at {part:.3f} of it"
            shown += f"; mesh error {100.0 * error:.2g} %" if error is not None else ""
            kept = resistance.load <= part * found.load
            rows.append(
                (
                    "Static model on a finer mesh, given strengths",
                    shown,
                    "above" if kept else "BELOW",
                )
            )
        except CapacityError as error:
            rows.append(("Static model on a finer mesh", escape(str(error)), "no answer"))
    if case.needed is not None:
        usage = case.needed / resistance.load
        shown = f"{case.needed:.4g} N / {resistance.load:.4g} N = {usage:.3f}"
        rows.append(
            ("Action over design resistance", shown, "verified" if usage <= 1 else "NOT verified")
        )
    return table(("check", "found", "result"), rows)


def _assumptions(case: Case) -> str:
    joint = case.joint
    pieces = "Blocks are rigid" if joint.elastic is None else "Blocks are linearly elastic"
    body = {
        UpperBody.COLUMNS: "the upper body is cut into a column above each lock",
        UpperBody.MONOLITHIC: "the upper body is one piece",
        UpperBody.JOINED: "the columns of the upper body are joined",
    }[joint.upper_body]
    lines = [
        f"{pieces}; {body}. Each lock is bonded to its own block by its inner face only; all other "
        "faces are dry, with Coulomb friction and without tension.",
        "Bonds are brittle up to the first failure; nothing is counted on behind it.",
        "Loads are static and grow in proportion. Fatigue, creep, impact, moisture and fire are "
        "not covered, nor is the strength of the blocks themselves.",
        "No laboratory test has validated the model; its margin covers the error against detailed "
        "numerical models only.",
    ]
    if case.reliability.variation:
        lines.append(
            "Mean and coefficient of variation are known, and strengths of locks are independent. "
            "Few tests, or blocks of one batch, need a larger scatter."
        )
    else:
        lines.append(
            "The scatter of strengths is covered by the strengths given, not by this note."
        )
    return "<ul>" + "".join(f"<li>{line}</li>" for line in lines) + "</ul>"
