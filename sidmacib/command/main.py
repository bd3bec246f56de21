"""The command `multilock`."""

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from sidmacib.command.groups import LOAD, OUTPUT, Grouped, GroupedCommand
from sidmacib.command.joints import (
    EccentricityType,
    joint_of,
    joint_options,
    reliability_of,
    reliability_options,
)
from sidmacib.command.output import (
    FORMATS,
    bars,
    curves,
    draw,
    note_of,
    refused_in_one_line,
    status_line,
    text_of,
)
from sidmacib.drawing import VM_RATIOS
from sidmacib.joint.joint import Direction
from sidmacib.joint.loading import Push

MODELS = ("safe", "law", "static", "limit", "sidmacib")
CONTEXT = {"help_option_names": ["--help"], "max_content_width": 80}

_format = click.option(
    "--format",
    "form",
    type=click.Choice(FORMATS),
    default="table",
    show_default=True,
    help="Format of the printed answer; json and csv have all digits.",
    cls=Grouped,
    group=OUTPUT,
)
_picture = click.option(
    "--picture",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Draw the answer into this file: .png, .svg or .pdf.",
    cls=Grouped,
    group=OUTPUT,
)
_note = click.option(
    "--note",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write a calculation note into this file: .html, to be printed or sent.",
    cls=Grouped,
    group=OUTPUT,
)
_models = click.option(
    "-m",
    "--model",
    "models",
    multiple=True,
    type=click.Choice(MODELS),
    help="Model to use; may be repeated.",
)


# A line with \b alone has click leave the paragraph as it is.
HELP = """Compute the shear and torsion capacity of a joint with several interlocking locks.

\b
  multilock capacity -n 9 -e 0.3       capacity of nine locks at e = 0.3 a
  multilock envelope --picture vm.png  V-M curve
  multilock weights -n 5               load carried by each lock
  multilock sensitivity -n 5 -e 0.3    effect of each size on first failure
  multilock law -n 9 -H 0.06           effective number of locks
  multilock joint -V 200 -e 0.3        fewest locks that carry V = 200 N
  multilock assembly arch.yaml         capacity of an arch or a wall of blocks
  multilock design vault.yaml          locks that an arch or a vault needs

Lengths in m, forces in N, stresses in Pa. Defaults are those of the published
study. "multilock COMMAND --help" describes a command. For completion in bash:
eval "$(_MULTILOCK_COMPLETE=bash_source multilock)" (zsh, fish: zsh_source,
fish_source).
"""


class Once(GroupedCommand):
    """A command that refuses an option given twice, of which click would take the last."""

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


class Commands(click.Group):
    """Commands of that kind."""

    command_class = Once


@click.group(cls=Commands, context_settings=CONTEXT, help=HELP)
@click.version_option(package_name="multilock")
def main() -> None:
    """Everything but the help is in the commands."""


@main.command()
@joint_options
@click.option(
    "-e",
    "--eccentricity",
    "ratios",
    multiple=True,
    type=EccentricityType(),
    default=(0.0,),
    help="e / a, or torsion; may be repeated.  [default: 0, pure shear]",
    cls=Grouped,
    group=LOAD,
)
@_models
@reliability_options
@_format
@_picture
@_note
def capacity(
    ratios: Sequence[float],
    models: Sequence[str],
    variation: float | None,
    factor: float | None,
    form: str,
    picture: Path | None,
    note: Path | None,
    push: str,
    **flags: Any,
) -> None:
    """Compute the shear and torsion capacity of a joint.

    safe: the law less a margin for the error of the model. law: estimate of the first bond failure.
    static: peak load of a model with brittle bonds. limit: limit analysis with ductile bonds.
    sidmacib: the published rule. Default: safe, law and static; for elastic blocks safe and law
    only, as static takes minutes.

    Columns: "first failure / load" is the load at the first bond failure, "mesh error / load" the
    estimated discretisation error, "peak spread" the range of the peaks found, each divided by the
    load.

    If the strengths are means, --scatter adds the characteristic value, which 5 % of joints do not
    reach; --gamma-m adds the design resistance. The last line says what strengths are taken for.
    """
    from sidmacib.command.answers import capacity_rows, meaning, resistances, usual_models

    joint, reliability = joint_of(flags), reliability_of(variation, factor)
    asked = list(dict.fromkeys(models or usual_models(joint)))
    directions = list(dict.fromkeys(ratios))
    if note is not None and len(directions) > 1:
        raise click.UsageError("--note: needs one direction, -e once")
    with status_line() as progress:
        others = resistances(reliability)
        rows = capacity_rows(joint, directions, asked, Push(push), progress, others)
    if picture is not None:
        draw(curves(rows, f"{joint.locks} locks", note_of(joint), joined=False), picture)
    if note is not None:
        from sidmacib.command.note import Case, write_note

        write_note(Case(joint, Direction(directions[0]), Push(push), reliability), note)
    click.echo(text_of(rows, form))
    if form == "table":
        click.echo(meaning(reliability))
    _require_answer(rows)


def _show(rows: Sequence[dict[str, Any]], form: str) -> None:
    """Print loads; an exit code of 1 if no model gives any."""
    click.echo(text_of(rows, form))
    _require_answer(rows)


def _require_answer(rows: Sequence[dict[str, Any]]) -> None:
    """End with status 1 if no model has a number."""
    if all(row[key] is None for row in rows for key in row.keys() - {"e/a", "model", "note"}):
        sys.exit(1)


@main.command()
@joint_options
@_models
@_format
@_picture
def envelope(
    models: Sequence[str], form: str, picture: Path | None, push: str, **flags: Any
) -> None:
    """Compute the V-M curve from pure shear to pure torsion."""
    from sidmacib.command.answers import capacity_rows

    joint = joint_of(flags)
    asked = list(dict.fromkeys(models or ("safe", "law")))
    with status_line() as progress:
        rows = capacity_rows(joint, VM_RATIOS, asked, Push(push), progress)
    if picture is not None:
        draw(curves(rows, f"{joint.locks} locks", note_of(joint)), picture)
    _show(rows, form)


@main.command()
@joint_options
@click.option(
    "-e",
    "--eccentricity",
    "ratio",
    type=EccentricityType(),
    default=0.0,
    help="e / a, or torsion.  [default: 0, pure shear]",
    cls=Grouped,
    group=LOAD,
)
@_format
@_picture
def weights(ratio: float, form: str, picture: Path | None, push: str, **flags: Any) -> None:
    """Compute the load of each lock / its strength (static model)."""
    from sidmacib.command.answers import weight_rows

    joint = joint_of(flags)
    with refused_in_one_line():
        rows = weight_rows(joint, ratio, Push(push))
    if picture is not None:
        draw(bars(rows, f"weights of {joint.locks} locks"), picture)
    click.echo(text_of(rows, form))


@main.command()
@joint_options
@click.option(
    "-e",
    "--eccentricity",
    "ratio",
    type=EccentricityType(),
    default=0.0,
    help="e / a, or torsion.  [default: 0, pure shear]",
    cls=Grouped,
    group=LOAD,
)
@_format
def sensitivity(ratio: float, form: str, push: str, **flags: Any) -> None:
    """Compute the effect of each size on the first failure.

    Each row has the change of V at the first failure of the static model, in %, for +1 % and -1 %
    of one parameter at constant e / a, and the derivative of V; in pure torsion those of M. Largest
    effects come first. A note says why a parameter has no derivative.
    """
    from sidmacib.command.answers import effect_rows

    joint = joint_of(flags)
    with refused_in_one_line(), status_line() as progress:
        words, rows = effect_rows(joint, ratio, Push(push), progress)
    if form == "table":
        click.echo(f"{words}\n")
        rows = [
            {key: row[key] for key in row if not key.startswith("first failure")} for row in rows
        ]
    click.echo(text_of(rows, form))


@main.command()
@joint_options
@_format
def law(form: str, push: str, **flags: Any) -> None:
    """Compute the effective number of locks in pure shear."""
    from sidmacib.command.answers import law_rows

    joint = joint_of(flags)
    with refused_in_one_line():
        click.echo(text_of(law_rows(joint, Push(push)), form))


@main.command("joint")
@joint_options
@click.option(
    "-V",
    "--shear",
    type=float,
    default=0.0,
    help="Shear force to carry, N.",
    cls=Grouped,
    group=LOAD,
)
@click.option(
    "-M", "--torque", type=float, default=0.0, help="Torque to carry, N m.", cls=Grouped, group=LOAD
)
@click.option(
    "-e",
    "--eccentricity",
    "ratio",
    type=float,
    help="e / a of V, instead of -M.",
    cls=Grouped,
    group=LOAD,
)
@click.option(
    "--vary",
    multiple=True,
    metavar="NAME=VALUES",
    help="Values to choose from (m): locks, a, b, h or H, as in a=0.04:0.12:0.01 (from:to:step) or "
    "locks=3,5,7; may be repeated.",
)
@click.option(
    "--price",
    multiple=True,
    metavar="NAME=PRICE",
    help="Price of area (per m2 of the joint), volume (per m3 cut) or bonded (per m2); may be "
    "repeated.  [default: area=1]",
)
@click.option("--all", "every", is_flag=True, help="List all joints of --vary.")
@reliability_options
@_format
@_picture
@_note
def inverse(
    shear: float,
    torque: float,
    ratio: float | None,
    vary: Sequence[str],
    price: Sequence[str],
    every: bool,
    variation: float | None,
    factor: float | None,
    form: str,
    picture: Path | None,
    note: Path | None,
    push: str,
    **flags: Any,
) -> None:
    """Find the fewest locks or the cheapest sizes for V and M.

    A joint is strong enough if the safe rule gives at least this load. Without --vary, the fewest
    locks of the given sizes; each smaller number is listed with its capacity, or why the rule does
    not apply. With --vary, the cheapest of all combinations. --picture draws all joints of --vary
    over the first two names, such as locks and a. With --scatter or --gamma-m the design resistance
    counts. The exit status is 1 if no joint is strong enough.
    """
    with refused_in_one_line():
        from sidmacib.command import inverse as answers
        from sidmacib.command.answers import meaning

        reliability = reliability_of(variation, factor)
        demand = answers.demand_of(shear, torque, ratio, reliability)
        values, prices = answers.values_of(vary), answers.prices_of(price)
        if flags["locks"] is not None and (not vary or "locks" in values):
            remedy = "--vary locks" if vary else "use --vary for other sizes"
            raise click.UsageError(f"-n: joint finds the number of locks; remove -n or {remedy}")
        if not vary and (price or every):
            raise click.UsageError(f"{'--price' if price else '--all'}: needs --vary")
        joint = joint_of(flags)
        found, tried = answers.sought(
            joint, demand, values, prices, Push(push), every or (bool(vary) and picture is not None)
        )
        if picture is not None:
            draw(answers.chart(found, tried, values), picture)
        shown = tried if every or not vary else (found,) if found is not None else ()
        if shown:
            rows = answers.candidate_rows(shown, values, prices, reliability)
            click.echo(text_of(rows, form))
        if shown and form == "table":
            click.echo(meaning(reliability))
        if note is not None and found is not None:
            from sidmacib.command.note import Case, write_note

            case = Case(found.joint, found.direction, Push(push), reliability, found.needed)
            write_note(case, note)
    if found is None:
        raise click.ClickException(answers.why_none(tried))


@main.command()
@click.argument("file", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option(
    "--interfaces",
    is_flag=True,
    help="Print the forces at each interface instead, at the load of the static model.",
)
@click.option(
    "--fixed", help="Blocks that cannot move, by names, numbers or patterns: 'left,base*'."
)
@click.option("--friction", type=float, help="Coefficient of friction of all interfaces.")
@click.option("--density", type=float, help="In kg/m3, of blocks whose material has none.")
@click.option("--unit", help="Unit of lengths in a file of blocks: m, cm, mm, in, ft.")
@click.option("--up", help="Axis of a file of blocks that points upwards: x, y, z.")
@click.option("--tolerance", type=float, help="Largest gap of faces that touch, over a block.")
@click.option("--from-file", is_flag=True, help="Take the interfaces that a file of COMPAS has.")
@click.option(
    "--compas",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write forces and mechanism of limit analysis as JSON, as Results of compas_dem.",
)
@_format
def assembly(file: Path, interfaces: bool, compas: Path | None, form: str, **options: Any) -> None:
    """Compute the load capacity of a block structure.

    FILE describes the blocks, the interfaces and the load in YAML, or has the blocks: OBJ, STL,
    PLY, OFF, Rhino's 3dm, or JSON of COMPAS. Options, or a YAML file of the same name beside it,
    then add what it lacks: --fixed, --friction, locks, a load other than a push along x.

    limit: limit analysis with associated friction; may overestimate. static: raises the load on
    elastic interfaces with path-dependent friction, up to first failure and peak. For a tilt load,
    both report the largest angle in equilibrium. The exit status is 1 if no model has a result.
    """
    with refused_in_one_line():
        from sidmacib.command.structures import (
            added_keys,
            interface_rows,
            limit_of,
            structure_notes,
            structure_rows,
        )
        from sidmacib.structure.files.structure_file import description_in, structure_of

        description = description_in(file, added_keys(**options))
        problem = structure_of(description, file.parent)
        for note in structure_notes(problem, description):
            click.echo(f"Note: {note}", err=True)
        limit = None if interfaces and compas is None else limit_of(problem)
        rows = interface_rows(problem) if interfaces else structure_rows(problem, limit)
        click.echo(text_of(rows, form))
        if compas is not None:
            from sidmacib.structure.files.compas_results import write_compas_results

            write_compas_results(problem, file, compas, limit)
    _require_answer(rows)


@main.command()
@click.argument("file", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option(
    "--output",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write the structure with its locks and the load of the first case into this YAML file, "
    "for multilock assembly; each other case goes into a file beside it.",
)
@click.option("--quiet", is_flag=True, help="Print no progress.")
@click.option(
    "--format", "form", type=click.Choice(("table", "json")), default="table", show_default=True
)
def design(file: Path, output: Path | None, quiet: bool, form: str) -> None:
    """Design the locks of a block structure.

    Finds the number and the direction of the locks in each interface. FILE is a structure as for
    assembly, with a key design: load cases, locks, candidate directions. The design is checked by
    limit analysis and by the static model with the locks modelled as solids, and comes with an
    order in which the blocks can be placed. The exit status is 1 if a check fails.
    """
    with refused_in_one_line():
        from sidmacib.command.designs import design_tables, verdict
        from sidmacib.design.designed import design_of
        from sidmacib.design.file import read_task, write_designed

        task = read_task(file)
        found = design_of(task, lambda line: None if quiet else click.echo(line, err=True))
        if output is not None:
            write_designed(task, found.choice, output)
    tables = design_tables(found)
    if form == "json":
        click.echo(json.dumps({"verdict": verdict(found), **tables}, indent=1))
    else:
        click.echo(verdict(found))
        for name, rows in tables.items():
            if rows:
                click.echo(f"\n{name}\n{text_of(rows, form)}")
    if not found.passes:
        sys.exit(1)
