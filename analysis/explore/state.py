"""What a page shows: its sliders, the joint that they give, and a comparison with one that is kept.

The same joint is given as a configuration, as Python and as a link.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, make_dataclass
from typing import Any, Generic, TypeVar
from urllib.parse import parse_qsl, urlencode

from sidmacib.answers.joint import meshes
from sidmacib.joint import INNER, HoldDown, Joint, UpperBody
from sidmacib.joint.parameters import PARAMETERS, Parameter, with_parameters
from sidmacib.mechanics.assembly import NodeLayout
from sidmacib.quantities import four_digits
from sidmacib.rule.reliability import DESIGN_VALUES, Reliability

FIRST = Joint(5)
KEPT = "kept"  # in a link: the query of what is kept for comparison
SHORT = 24  # letters of a value or a name in a note
EQUAL = 1e-9  # of the larger of two numbers
MOST_INPUTS = 20  # of a comparison

Figure = float | str | None
Figures = Mapping[str, Figure]


@dataclass(frozen=True)
class Slider:
    """The range and step of a parameter, and its label with the unit.

    ``choices``: what the values 0, 1 … stand for, if it is no number.
    """

    least: float
    most: float
    step: float
    words: str
    choices: tuple[str, ...] = ()

    def nearest(self, value: float) -> float:
        """The value of the slider that is nearest to ``value``, which may be infinite."""
        inside = min(max(value, self.least), self.most)
        return round(self.least + round((inside - self.least) / self.step) * self.step, 9)


LABELS = {"locks": "locks n", "H": "height of the body H (mm)", "young": "E (GPa), 0: rigid"}


def _slider(parameter: Parameter, span: tuple[float, float, float], unit: str = "") -> Slider:
    words = parameter.words.partition(" (")[0] if len(parameter.name) == 1 else ""
    label = f"{words} {parameter.name}{f' ({unit})' if unit else ''}".strip()
    return Slider(*span, LABELS.get(parameter.name, label))


_SHOWN = {each: each.slider for each in PARAMETERS.values() if each.slider}
SLIDERS = {
    **{each.name: _slider(each, slider[:3], *slider[3:4]) for each, slider in _SHOWN.items()},
    "pressure": Slider(0, 200, 5, "pressure on top (kPa), 0: fixed plate"),
    "eccentricity": Slider(0, 3, 0.05, "eccentricity e / a"),
    "one_piece": Slider(0, 1, 1, "upper body", ("cut into columns", "one piece")),
    "scatter": Slider(0, 40, 1, "scatter of the strengths (%), 0: none"),
    "gamma_m": Slider(1, 3, 0.05, "partial factor \N{GREEK SMALL LETTER GAMMA}_M"),
}
UNITS = {each.name: slider[4] if slider[3:] else 1.0 for each, slider in _SHOWN.items()}  # in SI

_FIRST = {  # values of the sliders at first; no Young's modulus: rigid
    **{name: (PARAMETERS[name].of(FIRST) or 0.0) / unit for name, unit in UNITS.items()},
    **{"locks": FIRST.locks, "pressure": 0.0, "eccentricity": 0.3, "one_piece": True},
    **{"scatter": 0.0, "gamma_m": 1.0},
}
_VALUES: Any = make_dataclass(
    "Values", [(name, type(value), value) for name, value in _FIRST.items()], frozen=True
)


class Settings(_VALUES):
    """The sliders' values. Lengths in mm, stresses in kPa, E in GPa (0: rigid), e over a."""

    @property
    def joint(self) -> Joint:
        """The joint; pressure 0 stands for the fixed plate. ValueError as for a `Joint`."""
        given = {name: getattr(self, name) * unit for name, unit in UNITS.items()}
        values: dict[str, Any] = {name: float(f"{value:.12g}") for name, value in given.items()}
        values["locks"] = self.locks
        if not values["young"]:
            del values["young"]
        strength = values["cohesion"] * INNER.tensile_strength / INNER.cohesion
        values |= {
            "tensile_strength": strength,
            "upper_body": UpperBody.MONOLITHIC if self.one_piece else UpperBody.COLUMNS,
            "hold_down": (
                HoldDown.pressure(1e3 * self.pressure) if self.pressure else HoldDown.plate()
            ),
        }
        return with_parameters(FIRST, values)

    @property
    def reliability(self) -> Reliability:
        """What the strengths stand for, and the partial factor."""
        return Reliability(self.scatter / 100.0, self.gamma_m)

    @property
    def values(self) -> dict[str, float]:
        """The value of each slider."""
        return {name: float(value) for name, value in asdict(self).items()}

    @property
    def name(self) -> str:
        """The joint in a legend."""
        return f"{self.locks} locks, {self.a:g} \N{MULTIPLICATION SIGN} {self.b:g} mm"

    @property
    def told(self) -> dict[str, float | str]:
        """The values by the labels of their sliders; choices in words."""
        of = {slider.words: (slider.choices, self.values[name]) for name, slider in SLIDERS.items()}
        return {
            words: choices[int(value)] if choices else value
            for words, (choices, value) in of.items()
        }

    @property
    def query(self) -> str:
        """The query of a link: the settings that differ from the default."""
        first = Settings().values
        return urlencode({k: f"{v:g}" for k, v in self.values.items() if v != first[k]})


State = TypeVar("State", bound=Any)


@dataclass(frozen=True)
class Checked(Generic[State]):
    """The state that answers a request, and a note for each value that had to be changed.

    ``kept``: what it is compared with, if anything is.
    """

    state: State
    notes: tuple[str, ...]
    kept: State | None = None

    @property
    def states(self) -> tuple[State, ...]:
        """The state, and the one that is kept, if there is one."""
        return (self.state,) if self.kept is None else (self.state, self.kept)

    @property
    def query(self) -> str:
        """The query of a link to the state, beside the one that is kept."""
        shown: Any = self.state
        kept: Any = self.kept
        beside = "" if kept is None else urlencode({KEPT: kept.query})
        return "&".join(filter(None, (shown.query, beside)))

    def comparison(self, results: Sequence[Figures]) -> list[list[Any]]:
        """`compared` with what is kept, by the ``results`` of both; no line if nothing is."""
        if self.kept is None:
            return []
        shown, kept = self.states
        return compared((shown.told, kept.told), (results[0], results[1]))


Read = Callable[[Mapping[str, object]], Checked[State]]


def checked(given: Mapping[str, object]) -> Checked[Settings]:
    """The settings nearest to ``given`` that the sliders allow; others have their default."""
    values, notes = nearest_values(given, Settings().values, SLIDERS)
    whole = {"locks": int(values["locks"]), "one_piece": bool(values["one_piece"])}
    return Checked(Settings(**values | whole), tuple(notes))


def nearest_values(
    given: Mapping[str, object], first: Mapping[str, float], sliders: Mapping[str, Slider]
) -> tuple[dict[str, float], list[str]]:
    """The values nearest to ``given`` that ``sliders`` allow, ``first`` for others; and notes."""
    values, notes = dict(first), []
    for name, value in given.items():
        if name not in sliders:
            notes.append(f"{in_note(name)} is no parameter.")
            continue
        number = _number(value)
        slider = sliders[name]
        values[name] = first[name] if number is None else slider.nearest(number)
        shown = f"; {values[name]:g} is shown."
        if number is None:
            notes.append(f"{name}: {in_note(value)} is not a number{shown}")
        elif not slider.least <= number <= slider.most:
            notes.append(
                f"{name}: {number:g} is outside {slider.least:g} to {slider.most:g}{shown}"
            )
        elif not math.isclose(values[name], number, abs_tol=1e-9):
            notes.append(f"{name}: {number:g} lies between steps of {slider.step:g}{shown}")
    return values, notes


def _number(value: object) -> float | None:
    """A number, infinite if it is too large; None if ``value`` is none."""
    try:
        number = float(str(value)) if isinstance(value, str | int | float) else math.nan
    except ValueError:
        return None
    return None if math.isnan(number) else number


def in_note(value: object) -> str:
    """``value`` in a note: printable, and cut if it is long."""
    text = value if isinstance(value, str) else type(value).__name__
    text = "".join(letter if letter.isprintable() else "?" for letter in text[: SHORT + 1])
    return f"'{text}'" if len(text) <= SHORT else f"'{text[:SHORT]}…'"


def from_query(query: str, read: Read[State]) -> Checked[State]:
    """What the query of a link shows and keeps; ``read``: as for values that are posted."""
    given = dict(parse_qsl(query.lstrip("?"), keep_blank_values=True))
    kept = given.pop(KEPT, None)
    there = None if kept is None else dict(parse_qsl(kept, keep_blank_values=True))
    return read_both(read, given, there)


def read_both(
    read: Read[State], given: Mapping[str, object], kept: Mapping[str, object] | None
) -> Checked[State]:
    """What is ``given``, beside what is ``kept``, if anything is."""
    found = read(given)
    if kept is None:
        return found
    there = read(kept)
    return Checked(found.state, (*found.notes, *(f"Kept: {n}" for n in there.notes)), there.state)


# Fields of a joint that sliders set; the tensile strength is set with the cohesion.
FIELDS = (*(place for each in _SHOWN for place in each.fields), "inner.tensile_strength")


def _given(joint: Joint, part: str, sign: str) -> str:
    """Fields of a ``part`` of ``joint`` that sliders set, with a ``sign`` before each value."""
    whole = getattr(joint, part) if part else joint
    names = [name for of, _, name in (place.rpartition(".") for place in FIELDS) if of == part]
    return ", ".join(f"{name}{sign}{getattr(whole, name):g}" for name in names if name != "locks")


def as_configuration(state: Settings) -> str:
    """A study of the joint, as YAML, on the meshes of the page."""
    joint = state.joint
    elastic = f"\n  {_given(joint, 'elastic', ': ')}" if joint.elastic else ""
    hold = f"{{pressure: {1e3 * state.pressure:g}}}" if state.pressure else "plate"
    pieces = ", pieces: elastic" if state.young else ""
    chosen = f"{state.eccentricity:g}, " if state.eccentricity else ""
    return f"""samples:
  mine: {{locks: {state.locks}}}
geometry: {{{_given(joint, "", ": ")}}}
materials:{elastic}
  inner: {{{_given(joint, "inner", ": ")}}}
  dry: {{{_given(joint, "dry", ": ")}}}
assembly: {{upper_body: {joint.upper_body}, hold_down: {hold}{pieces}}}
meshes: [{", ".join(f"{mesh:g}" for mesh in meshes(joint))}]
nodes: {NodeLayout.LOBATTO}
eccentricities: [0, {chosen}torsion]
models: [static, law, safe]
dem: {{engines: []}}
sidmacib: {{reductions: [none, lower_sum]}}
"""


def as_python(state: Settings) -> str:
    """The joint as Python."""
    joint, reliability = state.joint, state.reliability
    imported = "\nfrom sidmacib import UpperBody" if not state.one_piece else ""
    given = [f"{state.locks}", _given(joint, "", "="), "inner=inner", "dry=dry"]
    if joint.elastic:
        given.append(f"elastic=sidmacib.Elastic({joint.elastic.young:g})")
    if not state.one_piece:
        given.append("upper_body=UpperBody.COLUMNS")
    if state.pressure:
        given.append(f"hold_down=sidmacib.HoldDown.pressure({1e3 * state.pressure:g})")
    design = (
        ""
        if reliability == DESIGN_VALUES
        else f"""
reliability = sidmacib.Reliability({reliability.variation:g}, {reliability.partial_factor:g})
print(sidmacib.design_resistance(joint, direction, reliability))"""
    )
    return f"""from dataclasses import replace
import sidmacib{imported}

inner = replace(sidmacib.Joint(3).inner, {_given(joint, "inner", "=")})
dry = replace(sidmacib.Joint(3).dry, {_given(joint, "dry", "=")})
joint = sidmacib.Joint({", ".join(given)})
direction = sidmacib.Direction({state.eccentricity:g})
print(sidmacib.law(joint, direction), sidmacib.safe(joint, direction)){design}"""


def compared(inputs: tuple[Figures, Figures], results: tuple[Figures, Figures]) -> list[list[Any]]:
    """Lines: name, kept, shown, difference, and that in percent of what is kept.

    ``inputs`` and ``results`` of the variant that is shown, and of the one that is kept: inputs
    only where they differ, the first `MOST_INPUTS` of them.
    """
    lines = [_line(name, *pair) for name, pair in _paired(*inputs).items() if _differ(*pair)]
    if (more := len(lines) - MOST_INPUTS) > 0:
        lines[MOST_INPUTS:] = [[f"and {more} more", "", "", "", ""]]
    return lines + [_line(name, *pair) for name, pair in _paired(*results).items()]


def _paired(shown: Figures, kept: Figures) -> dict[str, tuple[Figure, Figure]]:
    return {name: (kept.get(name), shown.get(name)) for name in {**shown, **kept}}


def _differ(one: Figure, other: Figure) -> bool:
    if isinstance(one, str | None) or isinstance(other, str | None):
        return one != other
    return abs(other - one) > EQUAL * max(abs(one), abs(other))


def _line(name: str, kept: Figure, shown: Figure) -> list[Any]:
    given = ["\N{EN DASH}" if value is None else value for value in (kept, shown)]
    if isinstance(kept, str | None) or isinstance(shown, str | None):
        return [name, *given, "", ""]
    change = 0.0 if four_digits(kept) == four_digits(shown) else shown - kept
    share = _signed(f"{round(100.0 * change / abs(kept), 1) + 0.0:.1f} %") if kept else ""
    return [name, *given, _signed(four_digits(change)), share]


def _signed(text: str) -> str:
    if text.startswith("-"):
        return text.replace("-", "\N{MINUS SIGN}", 1)
    return f"+{text}" if text.strip("0. %") else text
