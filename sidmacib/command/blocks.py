"""The commands on blocks: what they carry, their locks, their solids."""

import json
import sys
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path
from typing import Any

import click

from sidmacib.command.options import (
    EXISTING,
    PAGE,
    PICTURE,
    Command,
    Written,
    flag_of,
    format_option,
    joint_of,
    joint_options,
    keep_inputs,
    note_option,
    partial_factor_options,
    quantity,
)
from sidmacib.command.output import (
    plain_row,
    refused_in_one_line,
    status_line,
    text_of,
    told_late,
    with_version,
)
from sidmacib.quantities import Number

GAP = Number(at_least=0, unit="m")
READING = {
    "fixed": "Blocks that cannot move, by names, numbers or patterns: 'left,base*'.",
    "fixed_below": "Fix every block that reaches below this height: 0.5m.",
    "unit": "Unit of lengths in a file of blocks: m, cm, mm, in, ft.",
    "up": "Axis of a file of blocks that points upwards: x, y, z.",
    "layers": "Layers of a 3dm file that have the blocks: 'Blocks,Supports'.",
    "tolerance": "Largest gap of faces that touch, over the size of a block: 0.006.",
}


def _gap(flag: str, words: str) -> Callable[..., Any]:
    return click.option(flag, type=quantity(GAP), default=0.0, help=words)


def _reading_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Options of commands that read a file of blocks, keys of `added_keys`."""
    for name, words in reversed(READING.items()):
        command = click.option(flag_of(name), help=words)(command)
    return command


@click.command(cls=Command)
@click.argument("file", type=EXISTING)
@click.option(
    "--interfaces",
    is_flag=True,
    help="Print the forces at each interface instead, at the load of the static model.",
)
@_reading_options
@click.option("--friction", help="Coefficient of friction of all interfaces.")
@click.option("--density", help="In kg/m3, of blocks whose material has none.")
@click.option("--case", help="Answer in full for one of the file's load cases.")
@click.option(
    "--reserve",
    "without_load",
    is_flag=True,
    help="Leave out the load: print what the structure has in reserve under permanent loads.",
)
@click.option("--from-file", is_flag=True, help="Take the interfaces that a file of COMPAS has.")
@click.option(
    "--compas",
    type=Written(),
    help="Write forces and mechanism of limit analysis as JSON, as Results of compas_dem.",
)
@click.option(
    "--capacity-curve",
    type=Written(),
    help="Follow the mechanism at finite displacements; write the load over the displacement, down "
    "to no load, into this CSV file. If a support moves: its reaction over its movement.",
)
@click.option(
    "--picture",
    type=PICTURE,
    help="Draw the structure with its forces into this file: .png, .svg or .pdf. With "
    "--capacity-curve, or if a support or a vehicle moves, draw the curve instead.",
)
@click.option(
    "--report",
    type=PAGE,
    help="Write a page with the answer, and the structure in three dimensions with loads, "
    "reactions, hinges, mechanism, into this file: .html. Needs multilock[report].",
)
@click.option(
    "--history",
    type=Written(),
    help="Where loads act in time: write where each block is, 100 times a second, into this CSV.",
)
@click.option(
    "--collapse",
    is_flag=True,
    help="Where the ground moves: find the factor on its motion at which the structure falls.",
)
@click.option(
    "--seismic",
    is_flag=True,
    help="Verify the mechanism for the spectrum in the file by displacements: Circolare 7/2019.",
)
@click.option(
    "-m",
    "--model",
    "engines",
    multiple=True,
    type=click.Choice(("yade",)),
    help="Where a support or the ground moves: ask YADE too.",
)
@partial_factor_options
@note_option
@format_option
def assembly(file: Path, **options: Any) -> None:
    """Compute the load capacity of a block structure.

    FILE describes the blocks, the interfaces and the load in YAML, or has the blocks: OBJ, GLB,
    glTF, STL, PLY, OFF, Rhino's 3dm, or JSON of COMPAS. Options, or a YAML file of the same name
    beside it, then add what it lacks: --fixed, --friction, locks, a load other than a push along x.

    limit: limit analysis with associated friction; may overestimate. static: raises the load on
    elastic interfaces with path-dependent friction, up to first failure and peak. For a tilt load,
    both report the largest angle in equilibrium. If a support moves: its reaction, and the movement
    at which the structure falls. If loads act in time: whether it stands, and how far blocks move.

    If the file says how many newtons are to be carried, the first line is the verdict, with
    factors; of several load cases, each has a line. Without a load: whether it stands, its
    geometrical safety factor, and the horizontal acceleration at which it falls. The exit status is
    1 if no model has a result, or if the verdict is no.
    """
    with refused_in_one_line(), told_late() as tell:
        tell(f"reading {file.name} ...")
        from sidmacib.command.assembly import Wanted, passes
        from sidmacib.command.structures import added_keys
        from sidmacib.scene.page import plotly_js
        from sidmacib.structure.files.structure_file import description_in, files_behind
        from sidmacib.structure.partial_factors import PartialFactors

        gammas = (options.pop(f"gamma_{symbol}") or 1.0 for symbol in "gqm")
        factors = PartialFactors(*gammas)
        own = {each.name: options.pop(each.name) for each in fields(Wanted) if each.name in options}
        if own["report"] is not None:  # what is missing is said before the answer is computed
            try:
                plotly_js()
            except ValueError as error:
                raise ValueError(f"--report: {error}") from None
        description = description_in(
            file,
            added_keys(**options),
            lambda name: click.echo(f"Note: {name} is not read, as it has blocks itself", err=True),
        )
        keep_inputs(files_behind(file, description))
        wanted = Wanted(file=file, description=description, factors=factors, tell=tell, **own)
        if not passes(wanted):
            sys.exit(1)


@click.command(cls=Command)
@click.argument("file", type=EXISTING)
@click.option(
    "--output",
    type=Written(),
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
        from sidmacib.design.file import case_files, read_task, write_designed
        from sidmacib.structure.files.structure_file import files_behind

        task = read_task(file)
        if output is not None:
            keep_inputs(files_behind(file, task.description), case_files(task, output))
        found = design_of(task, lambda line: None if quiet else click.echo(line, err=True))
        if output is not None:
            write_designed(task, found.choice, output)
    tables = design_tables(found)
    if form == "json":
        named = {name: [*map(plain_row, each)] for name, each in tables.items()}
        answer = {"verdict": "yes" if found.passes else "no", "answer": verdict(found)}
        about = {"file": file.name, "input": task.description}
        click.echo(json.dumps(with_version({**answer, **about, **named}), indent=1))
    else:
        click.echo(verdict(found))
        for name, rows in tables.items():
            if rows:
                click.echo(f"\n{name}\n{text_of(rows, form)}")
    if not found.passes:
        sys.exit(1)


@click.command(cls=Command)
@click.argument("source", metavar="[FILE]", required=False, type=EXISTING)
@joint_options
@click.option(
    "-o",
    "--output",
    type=click.Path(file_okay=False, path_type=Path),
    required=True,
    help="Folder for the files; those of the same names are replaced.",
)
@_gap("--clearance", "Gap at flanks and ends of locks, m, such as 0.5mm.  [default: 0]")
@_gap("--head-clearance", "Gap at the heads of locks, m.  [default: 0: the joint bears there]")
@_gap(
    "--radius",
    "Radius of the mill, m, which leaves corners of hollows round; edges of locks there are "
    "rounded.  [default: 0]",
)
@_gap("--alike", "How far corners of blocks of one kind may differ, m.  [default: rounding]")
@click.option(
    "--output-unit",
    type=click.Choice(("mm", "m")),
    default="mm",
    show_default=True,
    help="Unit of the files and drawings.",
)
@click.option(
    "--drawings",
    type=click.Choice(("svg", "pdf")),
    default="svg",
    show_default=True,
    help="Kind of the drawings.",
)
@click.option("--step", is_flag=True, help="Write STEP too; needs multilock[step].")
@_reading_options
@format_option
def build(
    source: Path | None,
    output: Path,
    clearance: float,
    head_clearance: float,
    radius: float,
    alike: float,
    output_unit: str,
    drawings: str,
    step: bool,
    form: str,
    push: str,
    **flags: Any,
) -> None:
    """Write the blocks with their locks as closed solids.

    As STL, 3MF and OBJ, on request as STEP, with drawings of each kind of block, and a table with
    the order in which blocks can be put in place. The exit status is 1 if some cannot.

    FILE is a structure as for assembly, with or without a load, or a joint's file. Without FILE
    the options describe a joint. Each lock is added to its own block and cut out of the other;
    clearance makes locks smaller. Ends with an error if a solid would not be closed, or would
    overlap another.
    """
    with refused_in_one_line(), told_late() as tell, status_line() as progress:
        from sidmacib.build import blocks_of_file, joint_blocks, kinds, solids
        from sidmacib.build.clearance import Clearance
        from sidmacib.build.placing import order_of
        from sidmacib.command.build import (
            clearance_note,
            overlap_note,
            radius_note,
            stuck_note,
            table,
            write_all,
        )
        from sidmacib.command.structures import added_keys
        from sidmacib.structure.files.structure_file import description_in, files_behind

        if source is not None:
            written = output / "blocks.obj", output / "blocks.csv", *output.glob("stl/*")
            keep_inputs(files_behind(source, description_in(source)), written)
        of_blocks = {name: value for name in READING if (value := flags.pop(name)) is not None}
        given = [name for name, value in flags.items() if value is not None]
        if source is None and of_blocks:
            raise click.UsageError(f"{flag_of(next(iter(of_blocks)))}: is for a file of blocks")
        tell("reading ...")
        found = None if source is None else blocks_of_file(source, added_keys(**of_blocks))
        if found is None:
            if source is not None and flags["file"] is not None:
                raise click.UsageError("--file: must not be given beside FILE, which is a joint's")
            joint = joint_of(flags if source is None else {**flags, "file": source})
            found = joint_blocks(joint)
        elif given:
            raise click.UsageError(f"{flag_of(given[0])}: is for a joint; {source} is a structure")
        gaps = Clearance(clearance, head_clearance, radius)
        blocks, rows, near = found
        tell(f"cutting {len(blocks):,} blocks ...")
        made = solids(blocks, rows, gaps, near)
        clear = clearance_note(rows.values(), clearance)
        for note in (clear, radius_note(made, radius), overlap_note(blocks)):
            if note:
                click.echo(f"Note: {note}", err=True)
        tell("order of placing, kinds and drawings ...")
        of, order = kinds(made, alike), order_of(blocks, rows, near)
        full = table(made, of, order, output_unit)
        write_all(made, of, full, rows, gaps, output, output_unit, drawings, step, progress)
    brief = table(made, of, order, output_unit, full=False)
    click.echo(text_of(brief if form == "table" else full, form))
    if order.stuck:
        raise click.ClickException(stuck_note(blocks, order))
