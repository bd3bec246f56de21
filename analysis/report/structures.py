"""The report's data of structures: from their tables, and the shapes of their blocks."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields
from typing import Any

import pandas as pd

from analysis.drawing import label_of
from analysis.report import failed_cases, finding
from analysis.summary import AGREEMENT, varied
from analysis.summary.structures import measured_lines, structure_disagreement, verdict_lines
from sidmacib.mechanics.assembly import Assembly
from sidmacib.models import REFERENCE_MODEL
from sidmacib.problem import FIRST_FAILURE
from sidmacib.quantities import digits, four_digits
from sidmacib.scene.drawn import points_of, shape_of
from sidmacib.scene.forces import arrows_of, forces_of
from sidmacib.structure.analysis.forces import InterfaceRow
from workflow.case import StructureCase

LIMIT, LEAST = "limit", "limit, least"
MOST_ROWS = 20_000  # of interfaces and blocks: what the page has room for
MOST_POINTS = 60_000  # of all shapes, for the same reason
MOST_TOLD = 6  # loads and variants of a structure in the verdict


def structures_content(
    cases: Sequence[StructureCase], blocks: pd.DataFrame, interfaces: pd.DataFrame
) -> dict[str, Any]:
    """The shapes of structures, the one that each case has, its loads, reactions and thrust.

    ``cases``: one of each structure, load and variant; ``blocks``, ``interfaces``: the rows that
    the page has. A case has no shape if there is no room for it.
    """
    shapes: list[dict[str, Any]] = []
    assemblies: dict[str, Assembly] = {}
    found, room = [], MOST_POINTS
    for case in cases:
        problem = case.subject.problem()
        assemblies[case.name] = problem.assembly
        shape = shape_of(problem.assembly)
        if shape not in shapes and points_of(shape) <= room:
            room -= points_of(shape)
            shapes.append(shape)
        found.append(
            {
                "structure": case.subject.structure,
                "load": case.subject.load,
                "variant": case.variant,
                "shape": shapes.index(shape) if shape in shapes else None,
                "loads": arrows_of(*problem),
            }
        )
    told = blocks.drop_duplicates(["model", "case"])[["model", "case"]]
    return {
        "shapes": shapes,
        "cases": found,
        "forces": {
            f"{model}/{case}": forces_of(assemblies[case], _interface_rows(own))
            for (model, case), own in interfaces.groupby(["model", "case"], sort=False)
        },
        "told": [f"{row.model}/{row.case}" for row in told.itertuples()],
    }


def _interface_rows(table: pd.DataFrame) -> list[InterfaceRow]:
    names = [field.name for field in fields(InterfaceRow)]
    rows = table[names].astype(object).where(table[names].notna(), None)
    return [InterfaceRow(*row) for row in rows.itertuples(index=False)]


def with_room(tables: Mapping[str, pd.DataFrame]) -> dict[str, pd.DataFrame]:
    """The rows of interfaces and blocks of as many cases as the page has room for."""
    places = {
        name: pd.MultiIndex.from_frame(tables[name][["model", "case"]])
        for name in ("interfaces", "blocks")
    }
    counts = places["interfaces"].append(places["blocks"]).value_counts()
    chosen, room = [], MOST_ROWS
    for row in tables["structures"].itertuples():
        room -= int(counts.get((row.model, row.case), 0))
        if room >= 0:
            chosen.append((row.model, row.case))
    return {name: tables[name][index.isin(chosen)] for name, index in places.items()}


def structures_verdict(
    table: pd.DataFrame,
    verdicts: pd.DataFrame | None = None,
    measured: pd.DataFrame | None = None,
) -> list[dict[str, str]]:
    """Findings on the structures of a study; ``verdicts``: on the loads that are to be carried.

    ``measured``: loads beside computed ones.
    """
    told = [] if verdicts is None else verdict_lines(verdicts)
    required = [finding(name, f"{words}.", "good" if yes else "bad") for name, words, yes in told]
    tested = [] if measured is None else measured_lines(measured)
    required += [finding(name, f"{words}.") for name, words in tested]
    return [*required, *_carried(table), *_without(table), *_agreement(table), *_limit(table)]


def supports_verdict(table: pd.DataFrame) -> list[dict[str, str]]:
    """Findings on the supports that move: how far, what then happens, and the reactions."""
    found = []
    for (structure, load, variant), rows in table.groupby(
        ["structure", "load", "variant"], sort=False
    ):
        name, last = f"{structure}, {varied(load, variant)}", rows.iloc[-1].to_dict()
        if last["answer"] == "none":
            found.append(finding(name, f"No result: {last['note']}.", "bad"))
            continue
        turns = pd.notna(last["movement_degrees"])
        reaction, unit = ("reaction_Nm", "N m") if turns else ("reaction_N", "N")
        moved = f"{last['movement_degrees']:.4g}°" if turns else f"{last['movement_m']:.4g} m"
        least = rows.loc[rows["answer"].eq(LEAST), reaction].iloc[0]
        text = f"Reaction drops to {four_digits(least)} {unit}; after {moved}: {last['note']}."
        found.append(finding(name, text))
    return found


def _carried(table: pd.DataFrame) -> Iterator[dict[str, str]]:
    """Capacity of each structure in the static model, or in the first model that answers."""
    for structure, rows in table.groupby("structure", sort=False):
        lines = []
        for (load, variant), own in rows.groupby(["load", "variant"], sort=False):
            answered = own[[_answer(row) is not None for row in own.to_dict("records")]]
            if answered.empty:
                continue
            static = answered[answered["model"].eq(REFERENCE_MODEL)]
            row = (answered if static.empty else static).iloc[0].to_dict()
            lines.append(f"{varied(load, variant)}: {_of_model(row)}")
        more = f"; and {len(lines) - MOST_TOLD} more" if len(lines) > MOST_TOLD else ""
        text = "; ".join(lines[:MOST_TOLD]) + more if lines else "No model has a result"
        yield finding(str(structure), f"{text}.")


def _of_model(row: Mapping[str, Any]) -> str:
    """The load of a model that counts with its mesh error, and the other one that it found."""
    notes, error = [label_of(row["model"]).name], row["mesh_error"]
    first, peak = f"{digits(row['first_failure_load_N'], 5)} N", f"{digits(row['peak_N'], 5)} N"
    if pd.notna(row["tilt_degrees"]):
        first = f"{row['first_failure_tilt_degrees']:.5g} degrees"
        peak = f"{row['peak_tilt_degrees']:.5g} degrees"
    if pd.notna(error):
        notes.append(f"mesh error {round(100 * error, 1):g} %")
    if row["counts"] == FIRST_FAILURE:
        notes.append(f"first bond failure; the peak of {peak} is not reliable")
    elif pd.notna(row["first_interface"]):
        notes.append(f"first bond failure at {first}")
    return f"{_answer(row)} ({', '.join(notes)})"


def _answer(row: Mapping[str, Any]) -> str | None:
    """The load of a row, or its tilt; None if it has neither."""
    if pd.notna(row["tilt_degrees"]):
        return f"tilt {row['tilt_degrees']:.4g}°"
    if pd.isna(row["load_N"]):
        return None
    share = row["load_over_weight"]
    load = f"{four_digits(row['load_N'])} N"
    return load if pd.isna(share) else f"{load}, {share:.4g} of the weight"


def _without(table: pd.DataFrame) -> Iterator[dict[str, str]]:
    yield from failed_cases(table, "Structures without a result", " cases")
    if refused := int(table["refused"].notna().sum()):
        text = f"{refused} of {len(table)} cases (reasons next to the 3D view)."
        yield finding("No answer", text)


def _agreement(table: pd.DataFrame) -> Iterator[dict[str, str]]:
    compared = table[table["difference_to_static"].notna() & table["model"].ne(LIMIT)]
    if compared.empty:
        return
    worst = compared.loc[compared["difference_to_static"].abs().idxmax()]
    apart = float(worst["difference_to_static"])
    words = structure_disagreement(worst.to_dict())
    yield finding(
        "Engines against the static model, structures",
        f"{len(compared)} cases with the same contact nodes: at most {100 * abs(apart):.2f} % "
        f"apart ({worst['case']}, {label_of(worst['model']).name}{words and f': {words}'}).",
        "good" if abs(apart) < AGREEMENT else "bad",
    )


def _limit(table: pd.DataFrame) -> Iterator[dict[str, str]]:
    apart = table.loc[table["model"].eq(LIMIT), "difference_to_static"].dropna()
    if apart.empty:
        return
    yield finding(
        "Limit analysis against the static model",
        f"From {100 * apart.min():+.2f} % to {100 * apart.max():+.2f} %. Limit analysis "
        "assumes ductile bonds and dilatant sliding.",
    )
