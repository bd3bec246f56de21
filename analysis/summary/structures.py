"""Summary of the structures of a study: the capacity of each, by each model."""

import math
from collections.abc import Iterator, Mapping
from typing import Any

import pandas as pd

from analysis.drawing import label_of
from analysis.summary import varied
from sidmacib.answers.verdict import Verdict, on_all
from sidmacib.engines.results import disagreement
from sidmacib.problem import FIRST_FAILURE, Failures
from sidmacib.quantities import digits

LOAD, TILT = ("load (N)", "load/weight"), ("tilt (degrees)", "")


def summary(
    results: str,
    structures: pd.DataFrame,
    supports: pd.DataFrame | None = None,
    verdicts: pd.DataFrame | None = None,
    measured: pd.DataFrame | None = None,
) -> str:
    """Verdicts, measured loads, lines for each structure, load and variant; supports that move."""
    lines = ["Structures: load capacity and its ratio to the weight, or the tilt angle"]
    if verdicts is not None:
        lines += [f"{name}: {words}" for name, words, _ in verdict_lines(verdicts)]
    if measured is not None:
        lines += [f"{name}: {words}" for name, words in measured_lines(measured)]
    for (structure, load, variant), rows in structures.groupby(
        ["structure", "load", "variant"], sort=False
    ):
        value, share = TILT if rows["tilt_degrees"].notna().any() else LOAD
        head = f"  {'model':10}{value:>14}{share:>13}{'to static':>11}  note"
        lines += ["", f"{structure}, load: {varied(load, variant)}"]
        lines += [f"  Note: {note}" for note in rows["input_notes"].dropna().unique()]
        lines.append(head)
        lines += map(_line, rows.to_dict("records"))
    if supports is not None:
        lines += _of_supports(supports)
    tables = f"{results}/tables/structures.csv, interfaces.csv, blocks.csv"
    lines += ["", f"Tables: {tables}; for ParaView: {results}/structures/vtk", ""]
    return "\n".join(lines)


def verdict_lines(verdicts: pd.DataFrame) -> Iterator[tuple[str, str, bool]]:
    """Structure and variant, the verdict on all its loads in words, and whether it is a yes."""
    for (structure, variant), rows in verdicts.groupby(["structure", "variant"], sort=False):
        names = [*rows["load"]]
        found = [
            Verdict(
                row["required_N"],
                bool(row["carried"]),
                row["verdict"],
                open=bool(row["open"]),
                factor=None if pd.isna(row["factor"]) else row["factor"],
            )
            for row in rows.to_dict("records")
        ]
        whole = found[0] if len(found) == 1 else on_all(names, found)
        yield varied(structure, variant), str(whole), whole.passes


def measured_lines(measured: pd.DataFrame) -> Iterator[tuple[str, str]]:
    """Each measured load: what it is of, and what it is over the loads of models, in words."""
    for (structure, _), rows in measured.groupby(["structure", "number"], sort=False):
        first, known = rows.iloc[0], rows.dropna(subset=["measured_over_load"])
        name = f"{structure}, {varied(first['load'], first['variant'])}"
        scatter = "" if pd.isna(first["scatter"]) else f" (scatter {100 * first['scatter']:.3g} %)"
        ratios = [
            f"{row['measured_over_load']:.3g} of {label_of(row['model']).name}"
            for row in known.to_dict("records")
        ]
        yield (
            name if pd.isna(first["specimen"]) else f"{name}, {first['specimen']}",
            f"measured {digits(first['measured_load_N'], 5)} N{scatter}, "
            f"{', '.join(ratios) or 'no model has a load'}; {first['source']}",
        )


def _of_supports(table: pd.DataFrame) -> Iterator[str]:
    for (structure, load, variant), rows in table.groupby(
        ["structure", "load", "variant"], sort=False
    ):
        columns, heads = ("reaction_N", "movement_m"), ("reaction (N)", "moved (m)")
        if rows["movement_degrees"].notna().any():
            columns, heads = ("reaction_Nm", "movement_degrees"), ("reaction (N m)", "degrees")
        yield from ("", f"{structure}, support that moves: {varied(load, variant)}")
        yield f"  {'answer':16}{heads[0]:>16}{heads[1]:>16}  note"
        for row in rows.to_dict("records"):
            numbers = ["-" if pd.isna(row[k]) else digits(row[k], 5) for k in columns]
            yield f"  {row['answer']:16}{numbers[0]:>16}{numbers[1]:>16}  {row['note']}"


def _line(row: Mapping[str, Any]) -> str:
    tilts = pd.notna(row["tilt_degrees"])
    if pd.isna(row["load_N"]) and not tilts:
        refused = pd.notna(row["refused"])
        why = f"no answer: {row['refused']}" if refused else f"no result: {row['error']}"
        return f"  {row['model']:10}{'-':>14}{'-':>13}{'-':>11}  {why}"
    value, share = row["load_N"], f"{row['load_over_weight']:.4f}"
    if tilts:
        value, share = row["tilt_degrees"], ""
    apart = row["difference_to_static"]
    return (
        f"  {row['model']:10}{digits(value, 5):>14}{share:>13}"
        f"{'' if pd.isna(apart) else f'{100 * apart:+.2f} %':>11}  {'; '.join(_notes(row))}"
    )


def structure_disagreement(row: Mapping[str, Any]) -> str:
    """Whether the load that counts is another than the static model's, in words."""
    if row["model"] == "limit" or pd.isna(row["difference_to_static"]):
        return ""
    share = 1.0 + float(row["difference_to_static"])
    if row["counts"] == FIRST_FAILURE:
        return disagreement(None, share, Failures(1.0, math.nan))
    return disagreement(share, None, Failures(math.nan, 1.0))


def _notes(row: Mapping[str, Any]) -> Iterator[str]:
    """What must be said with a load; the report has first failures, mesh errors and utilisation."""
    if words := structure_disagreement(row):
        yield words
    if pd.notna(row["note"]):
        yield row["note"]
    elif pd.notna(row["counts"]):
        yield f"the {row['counts']} counts: {row['because']}"
        yield f"failure mode: {row['mode']}"
