"""Solids of a joint or a structure, written into a folder: files, table and drawings."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path

import click
import numpy as np

from sidmacib.build import Clearance, Kind, Solid, laid, own_axes
from sidmacib.build.files import UNITS, file_name, obj_text, step, stl, threemf
from sidmacib.build.sheet import draw_sheet, spelled, write_sheet
from sidmacib.command.answers import Row
from sidmacib.command.output import text_of, writing
from sidmacib.structure.locks import Row as LockRow
from sidmacib.structure.structure import Pair

TOLD = 0.01  # of a lock's width: a clearance that is not told takes less
SHEETS = 40  # kinds that are drawn: of a heap of stones each is one


def table(made: Sequence[Solid], of: Sequence[Kind], unit: str) -> list[Row]:
    """Number, name, kind, size along its own axes, volume and mass of each solid."""
    named = {each.number: kind.name for kind in of for each in kind.solids}
    rows: list[Row] = []
    for each in made:
        size = np.round(UNITS[unit] * laid(each, own_axes(each)).places.max(axis=0), 6)
        rows.append(
            {
                "number": each.number,
                "block": each.name,
                "kind": named[each.number],
                **{f"{k} ({unit})": float(x) for k, x in zip("xyz", size, strict=True)},
                "volume (m3)": each.volume,
                "mass (kg)": each.mass,
            }
        )
    return rows


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
    locked: Mapping[Pair, LockRow],
    clearance: Clearance,
    folder: Path,
    unit: str,
    drawings: str,
    with_step: bool,
    progress: Callable[[str], object],
) -> None:
    """Write files, table and drawings into ``folder``; `click.UsageError` if that fails."""
    gaps = [f"{spelled(UNITS[unit] * gap)} {unit}" for gap in (clearance.sides, clearance.heads)]
    note = f"Clearance: {gaps[0]} at flanks and ends of locks, {gaps[1]} at their heads"
    note = note if locked else "No locks"
    with writing("--output", folder):
        for name in ("stl", "drawings"):
            (folder / name).mkdir(parents=True, exist_ok=True)
        (folder / "blocks.3mf").write_bytes(threemf(made, unit))
        (folder / "blocks.obj").write_text(obj_text(made, unit), encoding="utf-8")
        (folder / "blocks.csv").write_text(text_of(table(made, of, unit), "csv") + "\n", "utf-8")
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
