"""The command `multilock`."""

import json
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import click

from sidmacib.command.joints import EccentricityType, joint_of, joint_options
from sidmacib.command.output import (
    FORMATS,
    bars,
    curves,
    draw,
    note_of,
    status_line,
    text_of,
)
from sidmacib.drawing import VM_RATIOS
from sidmacib.joint.loading import Push

MODELS = ("safe", "law", "static", "limit", "sidmacib")
CONTEXT = {"help_option_names": ["--help"], "max_content_width": 100}

_format = click.option(
    "--format", "form", type=click.Choice(FORMATS), default="table", show_default=True
)
_picture = click.option(
    "--picture",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Draw the answer into this file: .png, .svg or .pdf.",
)
_models = click.option(
    "-m", "--model", "models", multiple=True, type=click.Choice(MODELS), help="May be repeated."
)


# A line with \b alone has click leave the paragraph as it is.
HELP = """Compute the shear and torsion capacity of a joint with several interlocking locks.

\b
  multilock capacity -n 9 -e 0.3         loads of a joint of nine locks at e = 0.3 a
  multilock envelope --picture vm.png    its V-M curve
  multilock weights -n 5                 what each lock carries at the load that counts
  multilock sensitivity -n 5 -e 0.3      how its first failure depends on each size
  multilock law -n 9 -H 0.06             how many locks work
  multilock joint -V 200 -e 0.3          the fewest locks that carry V = 200 N at e = 0.3 a
  multilock assembly arch.yaml           what an arch or a wall of blocks carries
  multilock design vault.yaml            the locks that an arch or a vault needs

Lengths are in m, forces in N, stresses in Pa. What is not given is as in the published study. For
completion in bash: eval "$(_MULTILOCK_COMPLETE=bash_source multilock)".
"""


class Once(click.Command):
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
)
@_models
@_format
@_picture
def capacity(
    ratios: Sequence[float],
    models: Sequence[str],
    form: str,
    picture: Path | None,
    push: str,
    **flags: Any,
) -> None:
    """Shear and torque that a joint carries, by several models.

    safe is for design, law the best estimate of the first failure, static the peak of the joint's
    pieces, limit their load if bonds are ductile, sidmacib the published rule. Default: safe, law
    and static. For elastic pieces: safe and law only (static takes minutes).
    """
    from sidmacib.command.answers import capacity_rows, usual_models

    joint = joint_of(flags)
    asked = list(dict.fromkeys(models or usual_models(joint)))
    directions = list(dict.fromkeys(ratios))
    with status_line() as progress:
        rows = capacity_rows(joint, directions, asked, Push(push), progress)
    if picture is not None:
        draw(curves(rows, f"{joint.locks} locks", note_of(joint), joined=False), picture)
    _show(rows, form)


@contextmanager
def _refused_in_one_line() -> Iterator[None]:
    """Report a model's refusal of a joint as an error of click."""
    from sidmacib.command.answers import ERRORS, reason

    try:
        yield
    except ERRORS as error:
        raise click.ClickException(reason(error)) from None


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
    """The V-M curve from pure shear to pure torsion."""
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
    "-e", "--eccentricity", "ratio", type=EccentricityType(), default=0.0, help="e / a, or torsion."
)
@_format
@_picture
def weights(ratio: float, form: str, picture: Path | None, push: str, **flags: Any) -> None:
    """Load of each lock over its strength, at the load that counts (static model)."""
    from sidmacib.command.answers import weight_rows

    joint = joint_of(flags)
    with _refused_in_one_line():
        rows = weight_rows(joint, ratio, Push(push))
    if picture is not None:
        draw(bars(rows, f"weights of {joint.locks} locks"), picture)
    click.echo(text_of(rows, form))


@main.command()
@joint_options
@click.option(
    "-e", "--eccentricity", "ratio", type=EccentricityType(), default=0.0, help="e / a, or torsion."
)
@_format
def sensitivity(ratio: float, form: str, push: str, **flags: Any) -> None:
    """Effect of each size and property on the first failure (static model).

    Each row has the change of V, in %, for 1 % more and for 1 % less of one parameter at the same
    e / a, and the derivative of V from both; in pure torsion those of M. Largest effects come
    first. A note says why a parameter has no derivative.
    """
    from sidmacib.command.answers import effect_rows

    joint = joint_of(flags)
    with _refused_in_one_line(), status_line() as progress:
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
    """Number of locks that work in pure shear: closed form, law and safe rule."""
    from sidmacib.command.answers import law_rows

    joint = joint_of(flags)
    with _refused_in_one_line():
        click.echo(text_of(law_rows(joint, Push(push)), form))


@main.command("joint")
@joint_options
@click.option("-V", "--shear", type=float, default=0.0, help="Shear force to carry, N.")
@click.option("-M", "--torque", type=float, default=0.0, help="Torque to carry, N m.")
@click.option("-e", "--eccentricity", "ratio", type=float, help="e / a of V, in place of -M.")
@click.option(
    "--vary",
    multiple=True,
    metavar="NAME=VALUES",
    help="Sizes to choose from, m: locks, a, b, h or H, as in a=0.04:0.12:0.01 (from, to, step) or "
    "locks=3,5,7; may be repeated.",
)
@click.option(
    "--price",
    multiple=True,
    metavar="NAME=PRICE",
    help="Of area (per m2 of the joint), volume (per m3 cut), bonded (per m2); may be repeated.  "
    "[default: area=1]",
)
@click.option("--all", "every", is_flag=True, help="Show all joints of --vary.")
@_format
@_picture
def inverse(
    shear: float,
    torque: float,
    ratio: float | None,
    vary: Sequence[str],
    price: Sequence[str],
    every: bool,
    form: str,
    picture: Path | None,
    push: str,
    **flags: Any,
) -> None:
    """The fewest locks, or the cheapest sizes, that carry V and M by the safe rule.

    Without --vary, the fewest locks of the given sizes; each smaller number is shown with what it
    carries, or why the rule refuses it. With --vary, the cheapest of all combinations. A joint is
    no answer where the safe rule refuses it. --picture draws all joints of --vary over the first
    two names, such as locks and a. Ends with status 1 if no joint carries the load.
    """
    with _refused_in_one_line():
        from sidmacib.command import inverse as answers

        demand = answers.demand_of(shear, torque, ratio)
        values, prices = answers.values_of(vary), answers.prices_of(price)
        if flags["locks"] is not None and (not vary or "locks" in values):
            raise click.UsageError("-n: must not be given where the number of locks is sought")
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
            click.echo(text_of(answers.candidate_rows(shown, values, prices), form))
    if found is None:
        raise click.ClickException(answers.why_none(tried))


@main.command()
@click.argument("file", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--interfaces", is_flag=True, help="What each interface carries at the static peak.")
@click.option(
    "--compas",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write forces and mechanism of limit analysis as Results of compas_dem, in JSON.",
)
@click.option(
    "--capacity-curve",
    "curve",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Follow the mechanism at finite displacements; write the load over the displacement, down "
    "to no load, into this CSV file. If a support moves: its reaction over its movement.",
)
@click.option(
    "--picture",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Draw the capacity curve into this file: .png, .svg or .pdf.",
)
@_format
def assembly(
    file: Path,
    interfaces: bool,
    compas: Path | None,
    curve: Path | None,
    picture: Path | None,
    form: str,
) -> None:
    """Capacity of a structure of blocks of any shape; FILE describes it in YAML.

    Or FILE is a model of compas_dem or an assembly of compas_cra, in JSON; a YAML file of the same
    name beside it has what it lacks: interfaces, locks, load.

    limit assumes associated friction, which can overestimate; static follows the load on elastic
    interfaces, with the history of friction, to the first failure and the peak. If gravity turns,
    both give the angle beyond which there is no equilibrium. If a support moves: its reaction, and
    the movement at which the structure falls. Ends with status 1 if no model has an answer.
    """
    with _refused_in_one_line():
        from sidmacib.command.structures import interface_rows, limit_of, structure_rows
        from sidmacib.structure.files.structure_file import read_structure
        from sidmacib.structure.loads import SupportMotion
        from sidmacib.structure.warnings import structure_warnings

        problem = read_structure(file)
        for warning in structure_warnings(problem.assembly):
            click.echo(f"Note: {warning}", err=True)
        if isinstance(problem.loads, SupportMotion):
            if interfaces or compas:
                option = "--interfaces" if interfaces else "--compas"
                raise click.UsageError(f"{option}: must not be given where a support moves")
            from sidmacib.command.displacements import support_rows, write_curve

            rows, moves = support_rows(problem)
            click.echo(text_of(rows, form))
            write_curve(moves, file.stem, curve, picture)
            return
        limit = None if interfaces and compas is None else limit_of(problem)
        rows = interface_rows(problem) if interfaces else structure_rows(problem, limit)
        click.echo(text_of(rows, form))
        if compas is not None:
            from sidmacib.structure.files.compas_results import write_compas_results

            write_compas_results(problem, file, compas, limit)
        if curve is not None or picture is not None:
            from sidmacib.command.displacements import curve_rows, write_curve

            moves, words = curve_rows(problem)
            click.echo(f"Capacity curve: {words}.", err=True)
            write_curve(moves, file.stem, curve, picture)
    _require_answer(rows)


@main.command()
@click.argument("file", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option(
    "--output",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write the structure with its locks and the load of the first case into this YAML file, "
    "for multilock assembly; for each other case, into a file beside it.",
)
@click.option("--quiet", is_flag=True, help="Show no progress.")
@click.option(
    "--format", "form", type=click.Choice(("table", "json")), default="table", show_default=True
)
def design(file: Path, output: Path | None, quiet: bool, form: str) -> None:
    """The locks that a structure needs: how many in each interface, and which way they run.

    FILE is a structure as for assembly, with a key design: load cases, locks, candidate directions.
    The result is checked by limit analysis and by the static model with locks cut out of the
    blocks, and has an order in which blocks can be placed. Ends with status 1 if a check fails.
    """
    with _refused_in_one_line():
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
