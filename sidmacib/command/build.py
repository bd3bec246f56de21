"""Solids of a joint or a structure, written into a folder: files, table and drawings."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path

import click
import numpy as np

from sidmacib.build import Kind, Solid, own_axes
from sidmacib.build.clearance import Clearance
from sidmacib.build.files import UNITS, file_name, obj_text, step, stl, threemf
from sidmacib.build.sheet import draw_sheet, spelled, write_sheet
from sidmacib.command.answers import Row
from sidmacib.command.output import text_of, writing
from sidmacib.quantities import some_of
from sidmacib.structure.blocks import Block
from sidmacib.structure.locks import Row as LockRow
from sidmacib.structure.overlaps import deepest_overlap
from sidmacib.structure.placing import Order
from sidmacib.structure.structure import Pair

FITS = 1e-5  # m: a deeper overlap of solids is told
TOLD = 0.01  # of a lock's width: a clearance that is not told takes less
SHEETS = 40  # kinds that are drawn: of a heap of stones each is one


def table(
    made: Sequence[Solid], of: Sequence[Kind], order: Order, unit: str, *, full: bool = True
) -> list[Row]:
    """Number, name, kind, size along its own axes, volume, mass and step of each solid.

    Those of step 0 are there first. ``full``: also the direction in which it goes in, its centre of
    mass, and its pose: the rows of the matrix, (4, 4), that takes its STL file to its place.
    """
    named = {each.number: kind.name for kind in of for each in kind.solids}
    steps = dict.fromkeys(range(len(made)), 0) | dict.fromkeys(order.stuck)
    steps |= {block: step for step, block in enumerate(order.steps, 1)}
    rows: list[Row] = []
    for block, each in enumerate(made):
        axes, size = own_axes(each), UNITS[unit]
        along = size * each.places @ axes.T
        row: Row = {
            "number": each.number,
            "block": each.name,
            "kind": named[each.number],
            **_of_axes("", np.ptp(along, axis=0), f" ({unit})"),
            "volume (m3)": each.volume,
            "mass (kg)": each.mass,
            "step": steps[block],
        }
        if full:
            pose = np.eye(4)
            pose[:3] = np.column_stack([axes.T, along.min(axis=0) @ axes])
            row |= _of_axes("insertion ", order.steps.get(block, (None,) * 3))
            row |= _of_axes("centre ", size * each.centre, f" ({unit})")
            row["pose"] = " ".join(f"{x:.9g}" for x in np.round(pose, 9).ravel() + 0.0)
        rows.append(row)
    return rows


def _of_axes(before: str, values: Iterable[float | None], after: str = "") -> Row:
    named = zip("xyz", values, strict=True)
    return {f"{before}{k}{after}": None if x is None else round(float(x), 6) for k, x in named}


def stuck_note(blocks: Sequence[Block], order: Order) -> str:
    """Which blocks cannot be put where they are."""
    names = some_of([blocks[block].name for block in order.stuck], 5)
    return (
        f"{names} cannot be put in by any translation: the blocks beside hold every direction; use "
        "fewer locks, or locks that run another way"
    )


def overlap_note(blocks: Sequence[Block]) -> str:
    """How far blocks overlap that the tolerance takes as touching, or nothing."""
    _, words = deepest_overlap(blocks, FITS)
    return f"{words}; the files keep that" if words else ""


def radius_note(made: Iterable[Solid], radius: float) -> str:
    """That the ``radius`` (m) of a mill changes no lock, or nothing."""
    if not radius or any(each.rounded for each in made):
        return ""
    return "--radius changes nothing: no edge of a lock lies in a corner of a hollow"


def clearance_note(rows: Iterable[LockRow], sides: float) -> str:
    """What a clearance at the ``sides`` (m) of locks takes of them, or nothing."""
    widths = [float(np.diff(row.edges).min()) for row in rows if row.locks.count > 1]
    share = sides / min(widths, default=math.inf)
    if share < TOLD:
        return ""
    return (
        f"the clearance takes {100.0 * share:.2g} % of the width of the narrowest lock; "
        "analyses leave it out: reduce their cohesion and tensile strength by as much"
    )


def write_all(
    made: Sequence[Solid],
    of: Sequence[Kind],
    rows: Sequence[Row],
    locked: Mapping[Pair, LockRow],
    clearance: Clearance,
    folder: Path,
    unit: str,
    drawings: str,
    with_step: bool,
    progress: Callable[[str], object],
) -> None:
    """Write files, drawings and ``rows`` into ``folder``; `click.UsageError` if that fails."""
    gaps = [f"{spelled(UNITS[unit] * gap)} {unit}" for gap in (clearance.sides, clearance.heads)]
    note = f"Clearance: {gaps[0]} at flanks and ends of locks, {gaps[1]} at their heads"
    if any(each.rounded for each in made):
        note += f"; radius {spelled(UNITS[unit] * clearance.radius)} {unit}"
    note = note if locked else "No locks"
    with writing("--output", folder):
        for name in ("stl", "drawings"):
            (folder / name).mkdir(parents=True, exist_ok=True)
        (folder / "blocks.3mf").write_bytes(threemf(made, unit))
        (folder / "blocks.obj").write_text(obj_text(made, unit), encoding="utf-8")
        (folder / "blocks.csv").write_text(text_of(rows, "csv") + "\n", "utf-8")
        for each in made:
            (folder / "stl" / f"{file_name(each, len(made))}.stl").write_bytes(stl(each, unit))
        for kind in of[:SHEETS]:
            progress(f"drawing {kind.name} of {of[min(len(of), SHEETS) - 1].name}")
            sheet = draw_sheet(kind, locked, len(made), unit, note)
            write_sheet(sheet, folder / "drawings" / f"{kind.name}.{drawings}")
        if len(of) > SHEETS:
            click.echo(f"Note: of {len(of)} kinds the first {SHEETS} are drawn", err=True)
        if with_step:
            try:
                (folder / "blocks.step").write_bytes(step(made, unit))
            except ValueError as error:
                raise ValueError(f"--step: {error}") from None
