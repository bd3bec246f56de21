"""A joint from what is given on a command line or in a file."""

import math
from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from enum import StrEnum
from pathlib import Path
from typing import Any

import click

from sidmacib.hold_down import Hold, HoldDown
from sidmacib.joint import Direction, Joint, UpperBody
from sidmacib.loading import Push
from sidmacib.mechanics.assembly import Elastic, Failure
from sidmacib.unit_warnings import unit_warnings
from sidmacib.validation import refused

MOST_LOCKS = 300  # that a command takes: the static model of more takes minutes
NO_FLAGS = {"inner", "dry", "elastic", "different", "first"}  # of a Joint, given in parts or not
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
        type=click.Path(path_type=Path),
        help="YAML file with the same names as the flags. Flags override the file.",
    ),
)


def joint_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command all options of a joint."""
    for option in reversed(_OPTIONS):
        command = option(command)
    return command


def joint_of(given: Mapping[str, Any]) -> Joint:
    """The joint of these flags, by name; those that are None are not given.

    `click.UsageError` that names the flag or the file's key, the value and what is allowed.
    """
    flags = {key: value for key, value in given.items() if value is not None}
    path = flags.pop("file", None)
    in_file = _from_file(path) if path is not None else {}
    try:
        joint = _joint({**in_file, **flags})
    except (ValueError, TypeError) as error:
        key, colon, rest = str(error).partition(":")
        key = key.partition(" ")[0]
        if not colon:
            raise click.UsageError(str(error)) from None
        if key in in_file and key not in flags:
            raise _in_file(path, f"{key}:{rest}") from None
        flag = FLAGS.get(key, f"--{key.replace('_', '-')}")
        raise click.UsageError(f"{flag}:{rest}") from None
    for doubt in unit_warnings(joint):
        click.echo(f"Note: {doubt}", err=True)
    return joint


def _joint(given: Mapping[str, Any]) -> Joint:
    """The joint of these names and values; ValueError that begins with the name."""
    values = dict(given)
    locks = values.pop("locks", 5)
    joint = Joint(locks)
    if locks > MOST_LOCKS:
        raise refused("locks", locks, f"at most {MOST_LOCKS} on the command line")
    for key, (face, names) in FACES.items():
        if key in values:
            value = values.pop(key)
            try:
                law = replace(getattr(joint, face), **dict.fromkeys(names, value))
            except ValueError as error:
                raise ValueError(f"{key}:{str(error).partition(':')[2]}") from None
            joint = replace(joint, **{face: law})
    young, poisson = values.pop("young", None), values.pop("poisson", None)
    if young is not None:
        elastic = Elastic(young) if poisson is None else Elastic(young, poisson)
        joint = replace(joint, elastic=elastic)
    elif poisson is not None:
        raise ValueError(f"poisson: {poisson!r} has no effect on rigid pieces; give young too")
    for key, kind in (("upper_body", UpperBody), ("failure", Failure)):
        if key in values:
            values[key] = _member(kind, key, values[key])
    return replace(joint, **values)


def _member(kind: type[StrEnum], key: str, value: Any) -> StrEnum:
    try:
        return kind(value)
    except ValueError:
        raise refused(key, _short(value), " or ".join(kind)) from None


def _from_file(path: Path) -> dict[str, Any]:
    """Names and values in a file; `click.UsageError` names what is wrong with it."""
    # Not needed, and not loaded, where there is no file.
    from sidmacib.yaml_text import TextError, read_yaml

    try:
        content = read_yaml(path)
    except TextError as error:
        raise _in_file(path, str(error)) from None
    if not isinstance(content, dict):
        raise _in_file(path, "it must have names and values, as in locks: 5")
    known = {*(field.name for field in fields(Joint)), *FACES, "young", "poisson"} - NO_FLAGS
    for key in content:
        if key not in known:
            allowed = ", ".join(sorted(known))
            raise _in_file(path, f"{_short(key)} is not known; it must be one of {allowed}")
    try:
        return {key: _value(key, value) for key, value in content.items()}
    except ValueError as error:
        raise _in_file(path, str(error)) from None


def _in_file(path: Path, words: str) -> click.UsageError:
    return click.UsageError(f"--file {_short(str(path), 100)}: {words}")


def _short(value: Any, most: int = 60) -> str:
    """A value in a message: one line, not long; text without quotes."""
    shown = value if isinstance(value, str) and value.isprintable() else repr(value)
    return shown if len(shown) <= most else f"{shown[:most]}..."


def _value(key: str, value: Any) -> Any:
    """The value of a file's ``key``, of the right kind; ValueError."""
    if key == "hold_down":
        return _hold_down(value)
    if key in ("upper_body", "failure"):
        if not isinstance(value, str):
            raise refused(key, _short(value), "a name")
        return value
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"{key}: {_short(value)} is not a number")
    return value if key == "locks" else float(value)


def _hold_down(value: Any) -> HoldDown:
    """What holds the joint down: a word, or a mapping of one word to an amount."""
    given: tuple[Any, ...] = (value,) if isinstance(value, str) else ()
    if isinstance(value, Mapping) and len(value) == 1:
        given = next(iter(value.items()))
    try:
        return HoldDown(Hold(given[0]), *given[1:])
    except (IndexError, TypeError, ValueError):
        allowed = "plate, weight, {force: 2000} (N) or {pressure: 2e4} (Pa)"
        raise refused("hold_down", _short(value), f"one of {allowed}") from None
