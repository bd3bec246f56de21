"""Output of the command where a structure's file says what is to be carried."""

from collections.abc import Sequence
from typing import Any

from sidmacib.answers.structure import StaticAnswer
from sidmacib.answers.verdict import Verdict, governing, lower_first, on_all, verdict
from sidmacib.command.answers import Row
from sidmacib.command.structures import Tell, limit_of, static_of, structure_rows, telling
from sidmacib.errors import CapacityError, InfeasibleError
from sidmacib.mechanics.assembly import Kind
from sidmacib.mechanics.crushing import crushed_faces
from sidmacib.mechanics.limit import LimitState
from sidmacib.problem import Problem
from sidmacib.structure.analysis.reserve import Push, Reserve, reserve
from sidmacib.structure.analysis.tilt import moves_most
from sidmacib.structure.files.structure_file import Demand
from sidmacib.validation import refused


def demanded_rows(
    demand: Demand,
    limit: LimitState | CapacityError | None,
    static: StaticAnswer | CapacityError,
    tell: Tell = str,
) -> tuple[list[Row], Verdict | None]:
    """`structure_rows`, and the verdict where a load is to be carried."""
    rows = structure_rows(demand, limit, static, tell)
    if demand.newtons is None or limit is None:
        return rows, None
    return rows, verdict(demand.newtons, static, limit)


def case_rows(demands: Sequence[Demand]) -> tuple[list[Row], str, bool]:
    """One row for each load case, the verdict on all of them, and whether all are carried."""
    found = []
    for demand in demands:
        assert demand.newtons is not None, "a load case says what is to be carried"
        limit = limit_of(demand.problem)
        assert limit is not None, "no load case tilts a structure"
        found.append(verdict(demand.newtons, static_of(demand.problem, limit), limit))
    first = governing(found)
    rows: list[Row] = [
        {
            "case": demand.case,
            "required (N)": each.newtons,
            "carried": "yes" if each.passes else "no",
            "factor": each.factor,
            "to first failure": each.first,
            "to peak": each.peak,
            "to limit": each.limit,
            "governs": "yes" if number == first else "",
            "note": each.note or each.words,
        }
        for number, (demand, each) in enumerate(zip(demands, found, strict=True))
    ]
    words = on_all([str(demand.case) for demand in demands], found)
    return rows, words, all(each.passes for each in found)


def reserve_rows(demands: Sequence[Demand]) -> tuple[list[Row], str, bool]:
    """What a structure has in reserve without a load, the verdict, and whether it stands."""
    (problem,) = (demand.problem for demand in demands)
    try:
        found = reserve(problem, telling(problem))
    except CapacityError as error:
        words, falls = str(error), isinstance(error, InfeasibleError)
        said = f"{'No' if falls else 'No answer'}: {lower_first(words)}"
        return [_reserve_row("limit", "stands", None, words)], said, False
    rows = [
        _reserve_row(
            "limit", "geometrical safety factor", found.factor, _factor_note(problem, found.factor)
        )
    ]
    if crushed_faces(problem.assembly):
        note = "strength of the blocks over the strength needed"
        note = note if found.strength else "no limit: more than 100"
        rows.append(_reserve_row("limit", "factor of compressive strengths", found.strength, note))
    least = [] if found.least is None else [("least", found.least)]
    axes = [("", push) for push in found.tried if 1.0 in map(abs, push.direction)]
    for name, push in (*least, *axes):
        tilt = "" if push.tilt is None else f"a tilt of {push.tilt:.4g} degrees; "
        note = f"{tilt}largest displacement: {moves_most(problem.assembly, push.mechanism)}"
        what = f"{name} horizontal acceleration (g), towards {_way(push)}".lstrip()
        rows.append(_reserve_row("limit", what, push.acceleration, note))
    rows.append(_reserve_row("static", "stands", None, found.static or "in equilibrium"))
    if found.falls:
        return rows, f"No: {lower_first(found.static)} in the static model", False
    return rows, f"Yes: {_stands(found)}", True


def _reserve_row(model: str, what: str, value: float | None, note: str) -> Row:
    return {"model": model, "reserve": what, "value": value, "note": note}


def _factor_note(problem: Problem, factor: float | None) -> str:
    if factor is not None:
        return "thickness of the interfaces over the least with which it stands"
    if all(face.kind is Kind.DRY for face in problem.assembly.faces):
        return "no limit: more than 100"
    return "for dry interfaces only"


def _stands(found: Reserve) -> str:
    words = "it stands"
    if found.factor is not None:
        words += f", with a geometrical safety factor of {found.factor:.3g}"
    push = found.least
    if push is None:
        words += (
            "; no horizontal acceleration fells it in limit analysis, which wedges blocks that "
        )
        words += "slide; for the static model's answer, give an acceleration as the load"
    else:
        tilt = "" if push.tilt is None else f", a tilt of {push.tilt:.3g} degrees"
        words += f"; it falls at {push.acceleration:.3g} g towards {_way(push)}{tilt}"
    return f"{words}; the static model: {found.static}" if found.static else words


def _way(push: Push) -> str:
    return f"({', '.join(f'{each:.3g}' for each in push.direction[:2])})"


def chosen_case(demands: Sequence[Demand], name: str) -> Demand:
    """The load case called ``name``; ValueError if there is none."""
    names = [str(demand.case) for demand in demands if demand.case is not None]
    if not names:
        raise ValueError(f"--case {name}: the file has no load_cases")
    if name not in names:
        raise refused("--case", name, " or ".join(names))
    return demands[names.index(name)]


def without_loads(description: Any) -> Any:
    """A ``description`` in plain values without what is raised."""
    if not isinstance(description, dict):
        return description
    return {key: value for key, value in description.items() if key not in ("load", "load_cases")}
