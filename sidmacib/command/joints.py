"""A joint from what is given on a command line or in a file."""

import math
from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from enum import StrEnum
from pathlib import Path
from typing import Any

import click
import yaml

from sidmacib.doubts import doubts
from sidmacib.hold_down import Hold, HoldDown
from sidmacib.joint import Direction, Joint, UpperBody
from sidmacib.loading import Push
from sidmacib.mechanics.assembly import Elastic, Failure

BIGGEST_FILE = 100_000  # bytes
FACES = {  # what a flag changes: the face's law, and its keys
    "cohesion": ("inner", ("cohesion",)),
    "tensile_strength": ("inner", ("tensile_strength",)),
    "normal_stiffness": ("inner", ("normal_stiffness",)),
    "shear_stiffness": ("inner", ("shear_stiffness",)),
    "fracture_energy": ("inner", ("fracture_energy",)),
    "dry_stiffness": ("dry", ("normal_stiffness", "shear_stiffness")),
    "friction": ("dry", ("friction",)),
}
FLAGS = {  # of the keys in messages
    **{key: f"-{key}" for key in "abhH"},
    "inner.cohesion": "--cohesion",
    "dry.friction": "--friction",
    "young": "--young",
    "poisson": "--poisson",
}


class EccentricityType(click.ParamType[float]):
    """e / a, or torsion."""

    name = "e/a"

    def convert(self, value: Any, param: Any, ctx: Any) -> float:
        """The ratio; infinite for torsion."""
        if value == "torsion":
            return math.inf
        try:
            return Direction(float(value)).eccentricity
        except (TypeError, ValueError):
            return float(
                self.fail(f"{value!r} is neither a number (e / a) nor torsion", param, ctx)
            )


class HoldDownType(click.ParamType[HoldDown]):
    """What holds the joint down."""

    name = "hold-down"

    def convert(self, value: Any, param: Any, ctx: Any) -> HoldDown:
        """plate, weight, force:N or pressure:Pa."""
        if isinstance(value, HoldDown):
            return value
        kind, given, amount = str(value).partition(":")
        try:
            return HoldDown(Hold(kind), float(amount) if given else 0.0)
        except ValueError:
            allowed = "plate, weight, force:2000 (N) or pressure:2e4 (Pa)"
            return HoldDown(self.fail(f"{value!r} is not one of {allowed}", param, ctx))


def _choice(kind: type[StrEnum]) -> click.Choice[str]:
    return click.Choice([str(member) for member in kind])


def _number(flag: str, words: str, key: str = "") -> Callable[..., Any]:
    names = (flag, key) if key else (flag,)
    return click.option(*names, type=float, help=words)


_OPTIONS = (
    click.option("-n", "--locks", type=int, help="Number of locks.  [default: 5]"),
    _number("-a", "Length of a lock (x), m.  [default: 0.06]"),
    _number("-b", "Width of a lock (y), m.  [default: 0.05]"),
    _number("-h", "Height of a lock (z), m.  [default: 0.008]"),
    _number("-H", "Height of the body above the locks, m.  [default: 0.027]", "H"),
    _number("--cohesion", "Of inner faces (tau_k), Pa.  [default: 8e4]"),
    _number("--tensile-strength", "Of inner faces, Pa.  [default: 3.7e5]"),
    _number("--normal-stiffness", "Of inner faces, Pa/m.  [default: 1e10]"),
    _number("--shear-stiffness", "Of inner faces, Pa/m.  [default: 1e10]"),
    _number("--fracture-energy", "Of bonds that soften, J/m2.  [default: 0]"),
    _number("--dry-stiffness", "Of dry faces, both ways, Pa/m.  [default: 1e10]"),
    _number("--friction", "Coefficient of friction of dry faces.  [default: 0.3]"),
    _number("--density", "kg/m3.  [default: 1400]"),
    _number("--young", "Young's modulus of pieces that bend, Pa.  [default: rigid pieces]"),
    _number("--poisson", "Their Poisson's ratio.  [default: 0.2]"),
    click.option(
        "--upper-body", type=_choice(UpperBody), help="How it is cut.  [default: columns]"
    ),
    click.option("--failure", type=_choice(Failure), help="Of the bonds.  [default: brittle]"),
    click.option(
        "--hold-down",
        type=HoldDownType(),
        help="plate, weight, force:N or pressure:Pa.  [default: plate]",
    ),
    click.option(
        "--push", type=_choice(Push), default="+y", show_default=True, help="Side of the load."
    ),
    click.option(
        "--file",
        type=click.Path(exists=True, dir_okay=False, path_type=Path),
        help="A joint as YAML, with the same names; what a flag says counts more.",
    ),
)


def joint_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command all options of a joint."""
    for option in reversed(_OPTIONS):
        command = option(command)
    return command


def joint_of(given: Mapping[str, Any]) -> Joint:
    """The joint of these flags, by name; those that are None are not given.

    `click.UsageError` that names flag, value and what is allowed.
    """
    told = {key: value for key, value in given.items() if value is not None}
    path = told.pop("file", None)
    try:
        joint = _joint({**(_from_file(path) if path else {}), **told})
        for doubt in doubts(joint):
            click.echo(f"Note: {doubt}", err=True)
        return joint
    except (ValueError, TypeError) as error:
        key, colon, rest = str(error).partition(":")
        flag = FLAGS.get(key, f"--{key.replace('_', '-')}")
        raise click.UsageError(f"{flag}{colon}{rest}" if colon else str(error)) from None


def _joint(given: Mapping[str, Any]) -> Joint:
    values = dict(given)
    joint = Joint(values.pop("locks", 5))
    for key, (face, names) in FACES.items():
        if key in values:
            value = values.pop(key)
            law = replace(getattr(joint, face), **dict.fromkeys(names, value))
            joint = replace(joint, **{face: law})
    young, poisson = values.pop("young", None), values.pop("poisson", 0.2)
    if young is not None:
        joint = replace(joint, elastic=Elastic(young, poisson))
    for key, kind in (("upper_body", UpperBody), ("failure", Failure)):
        if key in values:
            values[key] = kind(values[key])
    return replace(joint, **values)


def _from_file(path: Path) -> dict[str, Any]:
    """Names and values in a file; ValueError names what is wrong with it."""
    if path.stat().st_size > BIGGEST_FILE:
        raise ValueError(f"file: {path} is too large; it must have {BIGGEST_FILE} bytes or fewer")
    try:
        content = yaml.safe_load(path.read_text())
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise ValueError(f"file: {path} is no YAML: {' '.join(str(error).split())}") from None
    if not isinstance(content, dict):
        raise ValueError(f"file: {path} must have names and values, as in locks: 5")
    known = {
        *(field.name for field in fields(Joint)),
        *(*FACES, "young", "poisson"),
    } - {"inner", "dry", "elastic", "different", "first"}
    for key in content:
        if key not in known:
            raise ValueError(
                f"file: {key} is no name of a joint's; they are {', '.join(sorted(known))}"
            )
    return {key: _value(key, value) for key, value in content.items()}


def _value(key: str, value: Any) -> Any:
    """A value of a file: YAML takes 8e4 for text."""
    if key == "hold_down":
        amount = (
            f"{value}" if isinstance(value, str) else ":".join(map(str, next(iter(value.items()))))
        )
        return HoldDownType().convert(amount, None, None)
    if isinstance(value, str) and key not in ("upper_body", "failure"):
        try:
            return float(value)
        except ValueError:
            raise ValueError(f"{key}: {value!r} is not a number") from None
    return value
