"""The explorer's data for a structure: what its models say, and what is drawn of it."""

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from typing import Any

import pandas as pd

from analysis.drawing import label_of
from analysis.explore.comparison import Figure
from analysis.explore.examples import EXAMPLES, STRUCTURE_MODELS, Chosen, defaults
from analysis.report import json_value
from analysis.tables.structures import blocks_table, interfaces_table, structures_table
from sidmacib.answers.structure_words import answer_words
from sidmacib.errors import CapacityError, ResultError
from sidmacib.models import structure_limit, structure_static
from sidmacib.problem import FIRST_FAILURE, PEAK, Counts, Outcome, Problem
from sidmacib.scene.loads import arrows_of
from sidmacib.scene.sections import forces_of
from sidmacib.scene.solids import shape_of
from sidmacib.structure.files.structure_file import structure_of
from workflow.case import Case, StructureSubject
from workflow.results import record_of, record_without_result
from workflow.results.structure_part import StructureRecord

KEPT = 64  # structures that are not computed again
FAULTS = (CapacityError, ResultError, ValueError, ArithmeticError, MemoryError)
ASSUMES = "ductile bonds, dilatant sliding: may overestimate"


@lru_cache(maxsize=KEPT)
def limit(chosen: Chosen) -> StructureRecord:
    """Limit analysis on the cells of the file."""
    return _record("limit", chosen, structure_limit.solve)


@lru_cache(maxsize=KEPT)
def static(chosen: Chosen) -> StructureRecord:
    """The static model, as `multilock assembly` and a study have it."""
    return _record("static", chosen, structure_static.solve)


STAGES = (limit, static)  # what an answer needs, in this order


def structure_answer(chosen: Chosen) -> dict[str, Any]:
    """Content of the page: rows of models, and blocks and interfaces of the one that is drawn."""
    rows, drawn = _rows(chosen), {"limit": limit, "static": static}[chosen.model](same(chosen))
    problem = structure_of(chosen.description)
    return {
        "words": _words(chosen, rows),
        "unit": _unit(chosen),
        "lines": _lines(rows),
        "row": rows[chosen.model],
        "shape": _shape(chosen.example, dict(chosen.values).get("locks")),
        "loads": arrows_of(*problem),
        **forces_of(problem.assembly, drawn.part.interfaces),
        "blocks": _plain(blocks_table([drawn])),
        "interfaces": _plain(interfaces_table([drawn])),
        "yaml": chosen.text,
    }


def carried(chosen: Chosen) -> tuple[str, dict[str, Figure]]:
    """What a structure carries: in words, and by names."""
    rows = _rows(chosen)
    told: dict[str, Figure] = {}
    for name, load, share, *_ in _lines(rows):
        told[f"{name}: {_unit(chosen)}"] = load
        if share is not None:
            told[f"{name}: load / weight"] = share
    return _words(chosen, rows), {**told, "load that counts": rows["static"]["counts"]}


def _rows(chosen: Chosen) -> dict[str, dict[str, Any]]:
    """The row of each model."""
    table = structures_table([stage(same(chosen)) for stage in STAGES])
    return {row["model"]: row for row in _plain(table)}


def _unit(chosen: Chosen) -> str:
    return "tilt (°)" if EXAMPLES[chosen.example].tilts else "load (N)"


def same(chosen: Chosen) -> Chosen:
    """The structure whatever is drawn of it: what results are kept by."""
    return replace(chosen, model=STRUCTURE_MODELS[0])


def _lines(rows: dict[str, dict[str, Any]]) -> list[list[Any]]:
    """Lines: result, load or tilt, load over weight, mesh error (%), remark."""
    limit_row, static_row = rows["limit"], rows["static"]
    name = label_of("static").name
    if static_row["error"]:
        failures = [[name, None, None, None, _why(static_row)]]
    else:
        counts, bond = _counts(static_row), static_row["first_interface"]
        failures = [_line(name, static_row, "", f"{counts}; failure mode: {static_row['mode']}")]
        if static_row["counts"] == FIRST_FAILURE:
            failures.append(_line(f"{name}, peak", static_row, "peak_", "does not count"))
        elif bond:
            first = f"at {bond}"
            failures.append(_line(f"{name}, first failure", static_row, "first_failure_", first))
    remark = _why(limit_row) if limit_row["error"] else ASSUMES
    return [_line(label_of("limit").name, limit_row, "", remark), *failures]


def _counts(row: dict[str, Any]) -> Counts:
    return Counts(row["counts"] == PEAK, row["because"])


def _line(what: str, row: dict[str, Any], part: str, remark: str) -> list[Any]:
    """A line of the load, or of a ``part`` of the row's columns: another load of the model."""
    load = row["peak_N" if part == "peak_" else f"{part}load_N"]
    tilt, share = row[f"{part}tilt_degrees"], row["load_over_weight"]
    if part and share is not None and load is not None:
        share *= load / row["load_N"]
    error = row["first_failure_mesh_error"] if part == "first_failure_" else row["mesh_error"]
    percent = None if error is None or part == "peak_" else 100.0 * error
    return [what, load if tilt is None else tilt, json_value(share), json_value(percent), remark]


def _words(chosen: Chosen, rows: dict[str, dict[str, Any]]) -> str:
    """The answer in a line."""
    row = rows["static"]
    title = EXAMPLES[chosen.example].title
    title = title[0].upper() + title[1:]
    if row["error"]:
        return f"{title}: no answer from the {label_of('static').name}: {_why(row)}."
    load, weight = row["tilt_degrees"], None
    if load is None:
        load = row["load_N"]
        weight = load / row["load_over_weight"]
    return f"{title}: {answer_words(load, weight, _counts(row), row['mode'])}."


def _why(row: dict[str, Any]) -> str:
    return str(row["error"]).removeprefix(f"{row['model']}: ")


def _record(model: str, chosen: Chosen, solve: Callable[[Problem], Outcome]) -> StructureRecord:
    """The record of ``chosen`` by ``solve``; its error if there is one."""
    subject = StructureSubject(chosen.example, "load", dict(chosen.description))
    case = Case(chosen.example, model, "", subject, None)
    try:
        problem = subject.problem()
        return record_of(case, problem, solve(problem), {})
    except FAULTS as error:
        return record_without_result(case, error=f"{model}: {_reason(error)}")


def _reason(error: BaseException) -> str:
    return str(error) or type(error).__name__


@lru_cache(maxsize=KEPT)
def _shape(example: str, locks: float | None) -> dict[str, Any]:
    """Drawing of an example with so many locks: no other slider changes blocks."""
    values = defaults(example) | ({} if locks is None else {"locks": locks})
    return shape_of(structure_of(Chosen(example, tuple(values.items())).description).assembly)


def _plain(table: pd.DataFrame) -> list[dict[str, Any]]:
    """The rows of a table by column, for JSON."""
    return [
        {str(name): json_value(value) for name, value in row.items()}
        for row in table.to_dict("records")
    ]
