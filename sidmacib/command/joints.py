"""A joint from what is given on a command line or in a file."""

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import click

from sidmacib.command.options import GEOMETRY, LOAD, MATERIAL, OUTPUT, grouped
from sidmacib.joint import HoldDown, Joint
from sidmacib.joint.loading import Push
from sidmacib.joint.parameters import PARAMETERS, SIZES, Parameter, unit_warnings, with_parameters
from sidmacib.mechanics.assembly import Elastic
from sidmacib.quantities import Number, meant, number_in, shown

DEFAULT = Joint(5)
# Further names of flags: -h is a height here, while other programs take it for help.
LONG = {"a": ("--length",), "b": ("--width",), "h": ("--height",), "H": ("--body-height",)}
GROUP_OF = dict.fromkeys(("locks", *SIZES, "upper_body"), GEOMETRY) | {"hold_down": LOAD}
SLENDER = 100  # largest size over the shorter side of a lock: the models' cells are about as long
LOCKS = Number(at_least=1, at_most=300, whole=True)  # the static model of more takes minutes


class Reading(click.ParamType[Any]):
    """What a function reads, whose ValueError says what is allowed; ``name``: of its kind."""

    def __init__(self, name: str, read: Callable[[Any], Any]) -> None:
        self.name, self.read = name, read

    def convert(self, value: Any, param: Any, ctx: Any) -> Any:
        """What is read; `click.UsageError` that begins with the flag."""
        try:
            return self.read(value)
        except ValueError as error:
            raise click.UsageError(f"{param.opts[0]}: {error}", ctx) from None


def quantity(number: Number) -> Reading:
    """A number of a range, in SI units, or with a unit such as 80mm."""
    return Reading("float", number.read)


def ratio_in(value: Any) -> float:
    """A ratio e / a; infinite for torsion."""
    number = math.inf if value == "torsion" else number_in(str(value))
    if number is None:
        raise ValueError(f"{shown(value)} is neither a number (e / a) nor torsion")
    return float(number)


def hold_down_in(value: Any) -> HoldDown:
    """The hold-down that is spelled: plate, weight, force:N or pressure:Pa."""
    kind, colon, amount = str(value).partition(":")
    try:
        return HoldDown.read({kind: amount} if colon else value)
    except ValueError:
        allowed = "plate, weight, force:2000 (N) or pressure:2e4 (Pa)"
        raise ValueError(f"{shown(value)} is not one of {allowed}") from None


RATIO = Reading("e/a", ratio_in)


def flag_of(name: str) -> str:
    """The flag of a parameter, as messages name it."""
    return f"-{name}" if len(name) == 1 else f"--{name.replace('_', '-')}"


def _option(parameter: Parameter) -> Callable[..., Any]:
    """The flag of a parameter, with its unit and its default."""
    names = ["-n"] if parameter.name == "locks" else []
    names += [flag_of(parameter.name), *LONG.get(parameter.name, ()), parameter.name]
    words, default = parameter.words, parameter.of(DEFAULT)
    kind: Any = Reading("hold-down", hold_down_in)
    if parameter.number:
        kind = int if parameter.number.whole else quantity(parameter.number)
        words += f", {parameter.number.unit}" if parameter.number.unit else ""
        default = {"young": "rigid pieces", "poisson": Elastic.poisson}.get(parameter.name, default)
    elif parameter.choices:
        kind = click.Choice([str(member) for member in parameter.choices])
    else:
        words += ": plate, weight, force:N or pressure:Pa"
        default = default.spelled
    given = f"{default:g}" if isinstance(default, float) else default
    words = f"{words[0].upper()}{words[1:]}.  [default: {given}]"
    group = GROUP_OF.get(parameter.name, MATERIAL)
    return grouped(group, *names, type=kind, help=words)


def joint_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command all options of a joint."""
    options = (
        *map(_option, PARAMETERS.values()),
        grouped(
            LOAD,
            "--push",
            type=click.Choice([str(push) for push in Push]),
            default="+y",
            show_default=True,
            help="Direction of the load.",
        ),
        grouped(
            OUTPUT,
            "--file",
            type=click.Path(path_type=Path),
            help="YAML file with the same names as the flags. Flags override the file.",
        ),
    )
    for option in reversed(options):
        command = option(command)
    return command


def reliability_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command the scatter of strengths and the partial factor."""
    scatter = click.option(
        "--scatter",
        "variation",
        type=quantity(Number(above=0, at_most=1)),
        help="Coefficient of variation of the locks' strengths, such as 0.2; cohesion and tensile "
        "strength are then means.  [default: strengths are design values]",
    )
    factor = click.option(
        "--gamma-m",
        "factor",
        type=quantity(Number(at_least=1, at_most=10)),
        help="Partial factor for the design resistance. Without --scatter, strengths are "
        "characteristic values.",
    )
    return scatter(factor(command))


def joint_of(given: Mapping[str, Any]) -> Joint:
    """The joint of these flags, by name; those that are None are not given.

    `click.UsageError` that names the flag or the file's key, the value and what is allowed.
    """
    flags = {key: value for key, value in given.items() if value is not None}
    path = flags.pop("file", None)
    values = {**(_from_file(path) if path is not None else {}), **flags}
    read = {}
    for key, value in values.items():
        try:
            if key == "poisson" and "young" not in values:
                raise ValueError(f"{shown(value)} has no effect on rigid pieces; give young too")
            read[key] = LOCKS.read(value) if key == "locks" else PARAMETERS[key].read(value)
        except ValueError as error:
            if key in flags:
                raise click.UsageError(f"{flag_of(key)}: {error}") from None
            raise _in_file(path, f"{key}: {error}") from None
    try:
        joint = with_parameters(DEFAULT, read)
    except ValueError as error:
        raise click.UsageError(str(error)) from None
    for doubt in unit_warnings(joint):
        click.echo(f"Note: {doubt}", err=True)
    _require_stout(joint)
    return joint


def _require_stout(joint: Joint) -> None:
    """`click.UsageError` for a joint of more cells than a command line should wait for."""
    for name in SIZES:
        size, most = getattr(joint, name), SLENDER * joint.least_side
        if size > most:
            raise click.UsageError(
                f"-{name}: {size:g} m is not allowed; it must be at most {most:g} m, {SLENDER} "
                "times the shorter side of a lock (a or b)"
            )


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
    for key in content:
        if key not in PARAMETERS:
            allowed = ", ".join(PARAMETERS)
            near = meant(str(key), PARAMETERS)
            raise _in_file(path, f"{shown(key)}: unknown key; {near}the keys here are {allowed}")
    return content


def _in_file(path: Path, words: str) -> click.UsageError:
    name = str(path)
    if not name.isprintable() or len(name) > 100:
        name = shown(name)
    return click.UsageError(f"--file {name}: {words}")
