"""Options that commands share, and the headings that they stand under in the help."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from sidmacib.command.output import FORMATS, UNITS
from sidmacib.quantities import plain_unit, quantity_of

# In the order of the help; options without a group come first.
OWN, LOAD, GEOMETRY, MATERIAL, OUTPUT = "Options", "Load", "Geometry", "Material", "Input, output"
GROUPS = (OWN, LOAD, GEOMETRY, MATERIAL, OUTPUT)


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
        """As click does; `click.UsageError` for an option that is there twice."""
        if not ctx.resilient_parsing:  # of completion
            _, _, order = self.make_parser(ctx).parse_args(list(args))
            for option in order:
                once = isinstance(option, click.Option) and not option.multiple
                if once and order.count(option) > 1:
                    words = "is given more than once; it must be given once"
                    raise click.UsageError(f"{option.opts[0]} {words}", ctx)
        return super().parse_args(ctx, args)


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


WRITTEN = click.Path(dir_okay=False, path_type=Path)
PICTURE, PAGE = Written(".png", ".svg", ".pdf"), Written(".html")
EXISTING = click.Path(exists=True, dir_okay=False, path_type=Path)


def _keep_units(ctx: click.Context, param: click.Parameter, value: str | None) -> None:
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
