"""The command `multilock`."""

import importlib
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import click

from sidmacib.command.joints import EccentricityType, joint_of, joint_options
from sidmacib.command.output import FORMATS, draw, text_of
from sidmacib.loading import Push

DIRECTIONS = (0.0, 0.05, 0.1, 0.2, 0.35, 0.5, 1.0, 2.0, float("inf"))
MODELS = ("safe", "law", "static", "limit", "sidmacib")
CONTEXT = {"help_option_names": ["--help"], "max_content_width": 100}

_format = click.option(
    "--format", "form", type=click.Choice(FORMATS), default="table", show_default=True
)
_models = click.option(
    "-m", "--model", "models", multiple=True, type=click.Choice(MODELS), help="May be repeated."
)


# A line with \b alone has click leave the paragraph as it is.
HELP = """Tell how much torsion and shear an interlocking joint with several locks takes.

\b
  multilock capacity -n 9 -e 0.3         loads of a joint of nine locks at e = 0.3 a
  multilock envelope --picture vm.png    its V-M curve
  multilock weights -n 5                 what each lock carries at the peak
  multilock law -n 9 -H 0.06             how many locks work
  multilock cases config.yaml            a study's cases and their state

Lengths are in m, forces in N, stresses in Pa. What is not given is as in the published study. For
completion in bash: eval "$(_MULTILOCK_COMPLETE=bash_source multilock)".
"""


@click.group(context_settings=CONTEXT, help=HELP)
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
def capacity(
    ratios: Sequence[float], models: Sequence[str], form: str, push: str, **joint: Any
) -> None:
    """Shear and torque that a joint carries, after several models.

    safe is for design, law the best estimate of the first failure, static the peak of the joint's
    pieces, limit what bonds that yield reach, sidmacib the published rule. Without a choice they
    are safe, law and static; of pieces that bend, where static takes minutes, safe and law.
    """
    from sidmacib.command.answers import capacity_rows, usual_models

    own = joint_of(joint)
    rows = capacity_rows(own, ratios, models or usual_models(own), Push(push))
    _show(rows, form)


@contextmanager
def _refused_in_one_line() -> Iterator[None]:
    """What a model says of a joint that it does not take, as click tells errors."""
    from sidmacib.errors import CapacityError

    try:
        yield
    except (CapacityError, ValueError) as error:
        raise click.ClickException(str(error)) from None


def _show(rows: Sequence[dict[str, Any]], form: str) -> None:
    """Print loads; an exit code of 1 if no model gives any."""
    click.echo(text_of(rows, form))
    if all(row["V (N)"] is None for row in rows):
        sys.exit(1)


@main.command()
@joint_options
@_models
@_format
@click.option(
    "--picture",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Draw the curves into this file: .png, .svg or .pdf.",
)
def envelope(
    models: Sequence[str], form: str, picture: Path | None, push: str, **joint: Any
) -> None:
    """The V-M curve from pure shear to pure torsion."""
    from sidmacib.command.answers import capacity_rows

    own = joint_of(joint)
    rows = capacity_rows(own, DIRECTIONS, models or ("safe", "law"), Push(push))
    if picture is not None:
        draw(rows, picture, f"{own.locks} locks")
    _show(rows, form)


@main.command()
@joint_options
@click.option(
    "-e", "--eccentricity", "ratio", type=EccentricityType(), default=0.0, help="e / a, or torsion."
)
@_format
def weights(ratio: float, form: str, push: str, **joint: Any) -> None:
    """What each lock carries at the peak, over its strength (static model)."""
    from sidmacib.command.answers import weight_rows

    own = joint_of(joint)
    with _refused_in_one_line():
        click.echo(text_of(weight_rows(own, ratio, Push(push)), form))


@main.command()
@joint_options
@_format
def law(form: str, push: str, **joint: Any) -> None:
    """How many locks work in pure shear: closed form, law and safe rule."""
    from sidmacib.command.answers import law_rows

    own = joint_of(joint)
    with _refused_in_one_line():
        click.echo(text_of(law_rows(own, Push(push)), form))


@main.command()
@click.argument("config", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--results", help="Results folder, in place of the configuration's.")
@_format
def cases(config: Path, results: str | None, form: str) -> None:
    """A study's cases and their state; in the project's folder, where the workflow is."""
    if not Path("workflow", "state.py").is_file():
        raise click.ClickException("no workflow here; run this in the folder of the project")
    sys.path.insert(0, str(Path.cwd()))
    try:
        state = importlib.import_module("workflow.state")
    except ModuleNotFoundError as error:
        words = f"{error.name} is not installed; make .venv/study.ready has what a study needs"
        raise click.ClickException(words) from None
    with _refused_in_one_line():
        click.echo(text_of(state.case_rows(config, results), form))
