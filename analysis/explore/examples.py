"""The structures on the page: examples of studies/, their sliders, and each as YAML and a link."""

import math
from collections.abc import Mapping
from copy import deepcopy
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

import yaml

from analysis.explore.state import Checked, Slider, in_note, nearest_values
from sidmacib.yaml_text import read_yaml

STUDIES = Path(__file__).parents[2] / "studies"
STRUCTURE_MODELS = ("static", "limit")  # of which one is drawn
Key = tuple[str | int, ...]  # of a description, from outside in

STRUCTURE_SLIDERS = {
    "friction": Slider(0, 1, 0.01, "friction"),
    "cohesion": Slider(0, 300, 1, "cohesion (kPa)"),
    "tensile_strength": Slider(0, 500, 1, "tensile strength (kPa)"),
    "locks": Slider(1, 15, 1, "locks n"),
    "azimuth": Slider(-180, 180, 5, "direction in plan, x to y (°)"),
    "slope": Slider(-90, 90, 5, "direction upwards (°)"),
}
UNITS = {"cohesion": 1e3, "tensile_strength": 1e3}  # Pa; angles are in degrees
_LAW: dict[str, Key] = {
    name: ("interfaces", name) for name in ("friction", "cohesion", "tensile_strength")
}


@dataclass(frozen=True)
class Example:
    """A file of studies/, and the key of its description that each slider stands for.

    ``load``: the key of the load's direction. ``words``: what the sliders change.
    """

    title: str
    file: str
    words: str
    load: Key = ("load", "acceleration")
    keys: Mapping[str, Key] = field(default_factory=lambda: _LAW)

    @property
    def tilts(self) -> bool:
        """Whether gravity turns in place of a load that rises."""
        return "tilt" in self.load

    @property
    def sliders(self) -> dict[str, Slider]:
        """The sliders that it has."""
        angles = ("azimuth",) if self.tilts else ("azimuth", "slope")
        return {
            name: each
            for name, each in STRUCTURE_SLIDERS.items()
            if name in self.keys or name in angles
        }


EXAMPLES = {
    "arch": Example(
        "arch of five voussoirs",
        "arch/arch.yaml",
        "Horizontal acceleration. Friction and bond apply to every joint.",
    ),
    "wall": Example(
        "wall in running bond",
        "wall/wall.yaml",
        "Horizontal acceleration. Friction and bond apply to every joint.",
    ),
    "trilith": Example(
        "trilith",
        "structures/trilith.yaml",
        "Horizontal acceleration. Only the lintel and its left post are bonded.",
        keys={
            "friction": ("interfaces", "friction"),
            "cohesion": ("special", 0, "cohesion"),
            "tensile_strength": ("special", 0, "tensile_strength"),
        },
    ),
    "keyed": Example(
        "block on locks",
        "structures/keyed.yaml",
        "Horizontal force on the block. Cohesion and tensile strength apply to the roots of the "
        "locks, friction to their other faces.",
        ("load", "force", "direction"),
        {
            "locks": ("locks", 0, "count"),
            "friction": ("locks", 0, "dry", "friction"),
            "cohesion": ("locks", 0, "inner", "cohesion"),
            "tensile_strength": ("locks", 0, "inner", "tensile_strength"),
        },
    ),
    "vault": Example(
        "flat vault of Abeille's blocks",
        "flat_vault/vault3.yaml",
        "Force on the middle block. Friction applies to every joint. Takes some seconds.",
        ("load", "force", "direction"),
        {"friction": ("interfaces", "friction")},  # with bonds up to half a minute
    ),
    "stack": Example(
        "tilted stack of blocks",
        "structures/stack.yaml",
        "The ground tilts. Friction and bond apply to every joint.",
        ("load", "tilt", "axis"),
    ),
}
FIRST = next(iter(EXAMPLES))


@dataclass(frozen=True)
class Chosen:
    """An example, the value of each of its sliders, and the model that is drawn.

    Angles in degrees, stresses in kPa.
    """

    example: str = FIRST
    values: tuple[tuple[str, float], ...] = ()
    model: str = STRUCTURE_MODELS[0]

    @property
    def path(self) -> Path:
        """The file of the example."""
        return STUDIES / EXAMPLES[self.example].file

    @property
    def description(self) -> dict[str, Any]:
        """The structure and its load, as in a file for `multilock assembly`."""
        example, values = EXAMPLES[self.example], dict(self.values)
        found = deepcopy(_original(self.example))
        for name, key in example.keys.items():
            value = values[name] * UNITS.get(name, 1.0)
            _part(found, key[:-1])[key[-1]] = int(value) if name == "locks" else value
        _part(found, example.load[:-1])[example.load[-1]] = _direction(values, example.tilts)
        return found

    @property
    def text(self) -> str:
        """The description as YAML, with a line that says what it is."""
        body = yaml.safe_dump(self.description, sort_keys=False, default_flow_style=None, width=110)
        head = f"studies/{EXAMPLES[self.example].file}, changed in the explorer; SI units."
        return f"# {head}\n# multilock assembly FILE\n{body}"

    @property
    def chosen(self) -> dict[str, Any]:
        """All that is chosen, as the page has it."""
        return {"structure": self.example, "model": self.model, **dict(self.values)}

    @property
    def told(self) -> dict[str, float | str]:
        """The title, and the values by the labels of their sliders."""
        labels = {STRUCTURE_SLIDERS[name].words: value for name, value in self.values}
        return {"structure": EXAMPLES[self.example].title, **labels}

    @property
    def query(self) -> str:
        """The query of a link: the example, and what differs from its file."""
        first = defaults(self.example)
        given = {name: f"{value:g}" for name, value in self.values if value != first[name]}
        model = {} if self.model == STRUCTURE_MODELS[0] else {"model": self.model}
        return urlencode({"structure": self.example} | given | model)


def checked_choice(given: Mapping[str, object]) -> Checked[Chosen]:
    """The structure nearest to ``given`` that the page allows; the rest is as in its file."""
    given, notes = dict(given), []
    choices = {"structure": tuple(EXAMPLES), "model": STRUCTURE_MODELS}
    for name, allowed in choices.items():
        value = given.setdefault(name, allowed[0])
        if value not in allowed:
            notes.append(
                f"{name}: {in_note(value)} is not one of {', '.join(allowed)}; "
                f"{allowed[0]} is shown."
            )
            given[name] = allowed[0]
    example = str(given.pop("structure"))
    model = str(given.pop("model"))
    values, more = nearest_values(given, defaults(example), EXAMPLES[example].sliders)
    return Checked(Chosen(example, tuple(values.items()), model), (*notes, *more))


def defaults(name: str) -> dict[str, float]:
    """The sliders' values for an example as its file has it."""
    example, found = EXAMPLES[name], _original(name)
    values = {
        slider: _part(found, key[:-1]).get(key[-1], 0.0) / UNITS.get(slider, 1.0)
        for slider, key in example.keys.items()
    }
    x, y, z = _part(found, example.load)
    if example.tilts:
        x, y = -y, x  # towards which gravity turns, by the right-hand rule about the axis
    values["azimuth"] = math.degrees(math.atan2(y, x))
    values["slope"] = math.degrees(math.atan2(z, math.hypot(x, y)))
    return {slider: values[slider] for slider in example.sliders}


def _direction(values: Mapping[str, float], tilts: bool) -> list[float]:
    """The unit vector of the push, or the axis about which gravity turns towards it."""
    azimuth, slope = (math.radians(values.get(name, 0.0)) for name in ("azimuth", "slope"))
    x, y = math.cos(azimuth) * math.cos(slope), math.sin(azimuth) * math.cos(slope)
    vector = (y, -x, 0.0) if tilts else (x, y, math.sin(slope))
    return [round(each, 9) + 0.0 for each in vector]  # without -0


@cache
def _original(name: str) -> dict[str, Any]:
    """The description in the file of an example; not to be changed."""
    found: dict[str, Any] = read_yaml(STUDIES / EXAMPLES[name].file)
    return found


def _part(description: Any, key: Key) -> Any:
    for each in key:
        description = description[each]
    return description
