"""Options that commands share, their headings in the help, and the joint that they describe."""

import math
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import click

from sidmacib.command.output import FORMATS, UNITS
from sidmacib.joint import HoldDown, Joint
from sidmacib.joint.loading import Push
from sidmacib.joint.parameters import PARAMETERS, SIZES, Parameter, unit_warnings, with_parameters
from sidmacib.mechanics.assembly import Elastic
from sidmacib.quantities import Number, meant, number_in, plain_unit, quantity_of, shown

# In the order of the help; options without a group come first.
OWN, LOAD, GEOMETRY, MATERIAL, OUTPUT = "Options", "Load", "Geometry", "Material", "Input, output"
GROUPS = (OWN, LOAD, GEOMETRY, MATERIAL, OUTPUT)
EXISTING = click.Path(exists=True, dir_okay=False, path_type=Path)
DEFAULT = Joint(5)
# Further names of flags: -h is a height here, while other programs take it for help.
LONG = {"a": ("--length",), "b": ("--width",), "h": ("--height",), "H": ("--body-height",)}
GROUP_OF = dict.fromkeys(("locks", *SIZES, "upper_body"), GEOMETRY) | {"hold_down": LOAD}
SLENDER = 100  # largest size over the shorter side of a lock: the models' cells are about as long
OF_ACTION, OF_MATERIAL = Number(above=0, at_most=10), Number(at_least=1, at_most=10)
LOCKS = Number(at_least=1, at_most=300, whole=True)  # the static model of more takes minutes


class Grouped(click.Option):
    """An option under one of the `GROUPS`."""

    def __init__(self, *names: Any, group: str, **more: Any) -> None:
        super().__init__(*names, **more)
        self.group = group


def grouped(group: str, *names: Any, **more: Any) -> Callable[..., Any]:
    """An option as of `click.option`, under one of the `GROUPS`."""
    return click.option(*names, cls=Grouped, group=group, **more)


class Command(click.Command):
    """A command whose help has its options under their headings, each to be given once.

    Of an option that is given twice click would take the last.
    """

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the options, group by group."""
        found: dict[str, list[tuple[str, str]]] = {group: [] for group in GROUPS}
        for param in self.get_params(ctx):
            record = param.get_help_record(ctx)
            if record is not None:
                found[getattr(param, "group", OWN)].append(record)
        for group, records in found.items():
            if records:
                with formatter.section(group):
                    formatter.write_dl(records)

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """As click does; `click.UsageError` for an option that is there twice, and see below."""
        if not ctx.resilient_parsing:  # of completion
            _, _, order = self.make_parser(ctx).parse_args(list(args))
            for option in order:
                once = isinstance(option, click.Option) and not option.multiple
                if once and order.count(option) > 1:
                    words = "is given more than once; it must be given once"
                    raise click.UsageError(f"{option.opts[0]} {words}", ctx)
        left = super().parse_args(ctx, args)
        keep_inputs(path for each, path in _paths(ctx) if not isinstance(each.type, Written))
        return left


def keep_inputs(read: Iterable[Path], more: Iterable[Path] = ()) -> None:
    """`click.UsageError` where the command that runs would write over a file that is ``read``.

    ``more``: what it writes by its --output, beside the files that its options name.
    """
    context, kept = click.get_current_context(), [path for path in read if path.exists()]
    written = [
        (each.opts[-1], path) for each, path in _paths(context) if isinstance(each.type, Written)
    ]
    for flag, path in (*written, *(("--output", path) for path in more)):
        if path.exists() and any(map(path.samefile, kept)):
            words = "is what the command reads; it must be another file"
            raise click.UsageError(f"{flag} {path}: {words}", context)


def _paths(ctx: click.Context) -> Iterator[tuple[click.Parameter, Path]]:
    for each in ctx.command.params:
        if isinstance(path := ctx.params.get(each.name or ""), Path):
            yield each, path


class Written(click.Path):
    """A file to be written, with one of these ``endings``, in a folder that is there.

    What cannot be written is said before the answer is computed.
    """

    def __init__(self, *endings: str) -> None:
        super().__init__(dir_okay=False, path_type=Path)
        self.endings = endings

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        """As click does; `click.UsageError` names the option."""
        path, flag = Path(str(super().convert(value, param, ctx))), param.opts[-1] if param else ""
        if self.endings and path.suffix.lower() not in self.endings:
            raise click.UsageError(f"{flag} {path}: must end in {' or '.join(self.endings)}", ctx)
        if not path.parent.is_dir():
            raise click.UsageError(f"{flag} {path}: No such folder: {path.parent}", ctx)
        return path


PICTURE, PAGE = Written(".png", ".svg", ".pdf"), Written(".html")


def _keep_units(ctx: click.Context, _: click.Parameter, value: str | None) -> None:
    """Keep the unit asked for, and its size, by the SI unit in its place."""
    try:
        for spelled in value.split(",") if value else ():
            quantity, plain = quantity_of(spelled), plain_unit(spelled)
            ctx.meta.setdefault(UNITS, {})[quantity.unit] = plain, quantity.units[plain]
    except ValueError as error:
        raise click.UsageError(f"--units: {error}", ctx) from None


units_option = grouped(
    OUTPUT,
    "--units",
    callback=_keep_units,
    expose_value=False,
    help="Units of the columns of the printed answer, such as kN,kNm,mm; SI units without it.",
)
format_alone = grouped(
    OUTPUT,
    "--format",
    "form",
    type=click.Choice(FORMATS),
    default="table",
    show_default=True,
    help="Format of the printed answer; json and csv have all digits.",
)


def format_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command the format and the units of its printed answer."""
    return format_alone(units_option(command))


picture_option = grouped(
    OUTPUT, "--picture", type=PICTURE, help="Draw the answer into this file: .png, .svg or .pdf."
)
note_option = grouped(
    OUTPUT,
    "--note",
    type=PAGE,
    help="Write a calculation note into this file: .html, to be printed or sent.",
)


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


class Metres(float):
    """An eccentricity e in m, not over a."""


def ratio_in(value: Any) -> float:
    """A ratio e / a, infinite for torsion; or e itself as `Metres`."""
    number = math.inf if value == "torsion" else number_in(str(value))
    if number is not None:
        return float(number)
    try:
        return Metres(Number(unit="m").read(value))
    except ValueError:
        words = "is neither a number (e / a), a length such as 20mm (e), nor torsion"
        raise ValueError(f"{shown(value)} {words}") from None


def over_a(eccentricity: float, joint: Joint) -> float:
    """The ratio e / a of what `ratio_in` read."""
    return eccentricity / joint.a if isinstance(eccentricity, Metres) else eccentricity


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
            help="YAML file of locks, a, b, h, H and other flags, such as upper_body, or - for "
            "standard input. Flags override it.",
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
    words = (
        "Partial factor for the design resistance. Without --scatter, strengths are characteristic "
        "values."
    )
    return scatter(_gamma("m", words, OF_MATERIAL)(command))


def partial_factor_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command the partial factors of structures."""
    permanent = _gamma(
        "g", "Partial factor on weight and permanent loads, such as 1.35.", OF_ACTION
    )
    variable = _gamma("q", "Partial factor on the load to be carried, such as 1.5.", OF_ACTION)
    material = _gamma("m", "Partial factor that divides friction and strengths.", OF_MATERIAL)
    return permanent(variable(material(command)))


def _gamma(symbol: str, words: str, kind: Number) -> Callable[..., Any]:
    return click.option(f"--gamma-{symbol}", type=quantity(kind), help=words)


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
    most = SLENDER * joint.least_side
    for name in SIZES:
        if (size := getattr(joint, name)) > most:
            raise click.UsageError(
                f"-{name}: {size:g} m is not allowed; it must be at most {most:g} m, {SLENDER} "
                "times the shorter side of a lock (a or b)"
            )
    return joint


def _from_file(path: Path) -> dict[str, Any]:
    """Names and values in a file; `click.UsageError` names what is wrong with it."""
    # Not needed, and not loaded, where there is no file.
    from sidmacib.yaml_text import TextError, parsed, read_yaml

    try:
        stdin = str(path) == "-"
        content = parsed(sys.stdin.buffer.read()) if stdin else read_yaml(path)
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
    return click.UsageError(f"--file {path}: {words}")
