"""The command `multilock`."""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from sidmacib.command.answers import Row, capacity_rows, effect_rows, law_rows, weight_rows
from sidmacib.command.blocks import assembly, build, design
from sidmacib.command.options import (
    LOAD,
    RATIO,
    Command,
    format_alone,
    format_option,
    grouped,
    joint_of,
    joint_options,
    note_option,
    over_a,
    picture_option,
    quantity,
    reliability_options,
)
from sidmacib.command.output import (
    bars,
    curves,
    draw,
    note_of,
    refused_in_one_line,
    require_answer,
    say,
    status_line,
    text_of,
    told_late,
)
from sidmacib.drawing import VM_RATIOS
from sidmacib.joint import Direction
from sidmacib.joint.loading import Push
from sidmacib.models.joint_answers import MODELS, meaning, resistances, usual_models
from sidmacib.quantities import Number
from sidmacib.validation import plain

CONTEXT = {"help_option_names": ["--help"], "max_content_width": 80}

FORCE, TORQUE = Number(at_least=0, unit="N"), Number(unit="N m")
_shear = grouped(
    LOAD, "-V", "--shear", type=quantity(FORCE), default=0.0, help="Shear force to carry, N."
)
_torque = grouped(
    LOAD, "-M", "--torque", type=quantity(TORQUE), default=0.0, help="Torque to carry, N m."
)
_ratio = grouped(
    LOAD,
    "-e",
    "--eccentricity",
    "ratio",
    type=RATIO,
    default=0.0,
    help="e / a, e as a length such as 20mm, or torsion.  [default: 0, pure shear]",
)
_models = click.option(
    "-m",
    "--model",
    "models",
    multiple=True,
    type=click.Choice([*MODELS]),
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
  multilock build -n 5 -o blocks       blocks as solids, to print or to cut

Lengths in m, forces in N, stresses in Pa, unless a unit follows: 80mm, 5kN.
Sizes and materials are by default those of the published study; the upper
block is in one piece. "multilock COMMAND --help" describes a command. The exit
status is 1 if the answer is no or no model has one, and 2 if what was given is
at fault. For completion in bash:
eval "$(_MULTILOCK_COMPLETE=bash_source multilock)" (zsh, fish: zsh_source,
fish_source).
"""


class Commands(click.Group):
    """Commands of that kind."""

    command_class = Command


@click.group(cls=Commands, context_settings=CONTEXT, help=HELP)
@click.version_option(package_name="multilock")
def main() -> None:
    """Everything but the help is in the commands."""


@main.command()
@joint_options
@grouped(
    LOAD,
    "-e",
    "--eccentricity",
    "ratios",
    multiple=True,
    type=RATIO,
    help="e / a, e as a length such as 20mm, or torsion; may be repeated.  [default: 0, pure "
    "shear]",
)
@_shear
@_torque
@_models
@reliability_options
@format_option
@picture_option
@note_option
def capacity(
    ratios: Sequence[float],
    shear: float,
    torque: float,
    models: Sequence[str],
    variation: float | None,
    gamma_m: float | None,
    form: str,
    picture: Path | None,
    note: Path | None,
    push: str,
    **flags: Any,
) -> None:
    """Compute the shear and torsion capacity of a joint.

    safe: the law less a margin for the error of the model. law: estimate of the first bond failure.
    static: peak load of a model with brittle bonds. limit: limit analysis with ductile bonds.
    sidmacib: the published rule. All others: distinct or finite elements, by the program of that
    name, which must be installed. Default: safe, law and static; for elastic blocks safe and law
    only, as static takes minutes.

    Columns: "first failure / load" is the load at the first bond failure, "mesh error / load" the
    estimated discretisation error, "peak spread" the range of the peaks found, each divided by the
    load.

    If the strengths are means, --scatter adds the characteristic value, which 5 % of joints do not
    reach; --gamma-m adds the design resistance. The last line says what strengths are taken for.

    With -V, -M, or -V with -e, the first line says whether the joint carries that load: by the
    design resistance, else by the safe rule. The exit status is 1 if it does not.
    """
    from sidmacib.rule.reliability import Reliability

    joint, reliability = joint_of(flags), Reliability(variation or 0.0, gamma_m or 1.0)
    ratios, demand = [over_a(each, joint) for each in ratios], None
    if shear or torque:
        from sidmacib.command.inverse import demand_of

        if len(ratios) > 1:
            raise click.UsageError("-V, -M: need one direction, -e once")
        ratio = ratios[0] if ratios else None if torque else 0.0
        demand = demand_of(shear, torque, ratio, reliability)
        ratios = (demand.direction(joint).eccentricity,)
    asked = {name: MODELS[name] for name in models or usual_models(joint)}
    asked |= resistances(reliability, decides=demand is not None)
    directions = list(dict.fromkeys(ratios or (0.0,)))
    if note is not None and len(directions) > 1:
        raise click.UsageError("--note: needs one direction, -e once")
    with told_late() as tell, status_line() as progress:
        rows, verdict = capacity_rows(joint, directions, asked, Push(push), progress, demand, tell)
    if picture is not None:
        draw(curves(rows, f"{joint.locks} locks", note_of(joint), joined=False), picture)
    if note is not None:
        from sidmacib.command.note import Case, write_note

        needed = None if demand is None else demand.load(joint)
        write_note(Case(joint, Direction(directions[0]), Push(push), reliability, needed), note)
    told = [*meaning(reliability, joint)]
    about: Row = {"input": {**plain(joint), "push": push}, "notes": told}
    if demand is not None and verdict is not None:
        say(str(verdict), form)
        direction, load = demand.direction(joint), demand.load(joint)
        about["required V (N)"] = load * direction.shear
        about["required M (N m)"] = load * direction.torque * joint.a
        about |= verdict.told
    click.echo(text_of(rows, form, about))
    if form == "table":
        click.echo("\n".join(told))
    require_answer(rows)
    if not about.get("carried", True):
        sys.exit(1)


@main.command()
@joint_options
@_models
@format_option
@picture_option
def envelope(
    models: Sequence[str], form: str, picture: Path | None, push: str, **flags: Any
) -> None:
    """Compute the V-M curve from pure shear to pure torsion."""
    joint = joint_of(flags)
    asked = {name: MODELS[name] for name in models or ("safe", "law")}
    with told_late() as tell, status_line() as progress:
        rows, _ = capacity_rows(joint, VM_RATIOS, asked, Push(push), progress, tell=tell)
    if picture is not None:
        draw(curves(rows, f"{joint.locks} locks", note_of(joint)), picture)
    click.echo(text_of(rows, form))
    require_answer(rows)


@main.command()
@joint_options
@_ratio
@format_option
@picture_option
def weights(ratio: float, form: str, picture: Path | None, push: str, **flags: Any) -> None:
    """Compute the load of each lock / its strength (static model)."""
    joint = joint_of(flags)
    with refused_in_one_line():
        rows = weight_rows(joint, over_a(ratio, joint), Push(push))
    if picture is not None:
        draw(bars(rows, f"weights of {joint.locks} locks"), picture)
    click.echo(text_of(rows, form))


@main.command()
@joint_options
@_ratio
@format_alone
def sensitivity(ratio: float, form: str, push: str, **flags: Any) -> None:
    """Compute the effect of each size on the first failure.

    Each row has the change of V at the first failure of the static model, in %, for +1 % and -1 %
    of one parameter at constant e / a, and the derivative of V; in pure torsion those of M. Largest
    effects come first. A note says why a parameter has no derivative.
    """
    joint = joint_of(flags)
    with refused_in_one_line(), status_line() as progress:
        words, rows = effect_rows(joint, over_a(ratio, joint), Push(push), progress)
    if form == "table":
        click.echo(f"{words}\n")
        rows = [
            {key: row[key] for key in row if not key.startswith("first failure")} for row in rows
        ]
    click.echo(text_of(rows, form))


@main.command()
@joint_options
@format_option
def law(form: str, push: str, **flags: Any) -> None:
    """Compute the effective number of locks in pure shear."""
    joint = joint_of(flags)
    with refused_in_one_line():
        click.echo(text_of(law_rows(joint, Push(push)), form))


@main.command("joint")
@joint_options
@_shear
@_torque
@grouped(
    LOAD,
    "-e",
    "--eccentricity",
    "ratio",
    type=quantity(Number()),
    help="e / a of V, instead of -M.",
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
@format_option
@picture_option
@note_option
def inverse(
    shear: float,
    torque: float,
    ratio: float | None,
    vary: Sequence[str],
    price: Sequence[str],
    every: bool,
    variation: float | None,
    gamma_m: float | None,
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
        from sidmacib.rule.reliability import Reliability

        reliability = Reliability(variation or 0.0, gamma_m or 1.0)
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
            click.echo("\n".join(meaning(reliability, joint)))
        if note is not None and found is not None:
            from sidmacib.command.note import Case, write_note

            case = Case(found.joint, found.direction, Push(push), reliability, found.needed)
            write_note(case, note)
    if found is None:
        raise click.ClickException(answers.why_none(tried))


for command in (assembly, design, build):
    main.add_command(command)
