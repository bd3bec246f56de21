"""Output of the command where a structure's file says what is to be carried."""

from collections.abc import Sequence

import click

from sidmacib.answers.verdict import Verdict, governing, verdict
from sidmacib.command.answers import Row
from sidmacib.command.structures import limit_of, static_of, structure_rows
from sidmacib.errors import CapacityError
from sidmacib.mechanics.limit import LimitState
from sidmacib.structure.files.structure_file import Demand
from sidmacib.validation import refused


def demanded_rows(
    demand: Demand, limit: LimitState | CapacityError | None
) -> tuple[list[Row], Verdict | None]:
    """`structure_rows` with factors, and the verdict, where a load is to be carried."""
    problem, static = demand.problem, static_of(demand.problem)
    rows = structure_rows(problem, limit, static)
    if demand.newtons is None or limit is None:
        return rows, None
    for row in rows:
        load = row["load (N)"]
        row["factor"] = None if load is None else load / demand.newtons
    head = [key for key in rows[0] if key != "factor"]
    head.insert(head.index("load (N)") + 1, "factor")
    ordered = [{key: row[key] for key in head} for row in rows]
    return ordered, verdict(demand.newtons, static, limit)


def case_rows(demands: Sequence[Demand]) -> tuple[list[Row], str, bool]:
    """One row for each load case, the verdict on all of them, and whether all are carried."""
    found = []
    for demand in demands:
        assert demand.newtons is not None, "a load case says what is to be carried"
        limit = limit_of(demand.problem)
        assert limit is not None, "no load case tilts a structure"
        found.append(verdict(demand.newtons, static_of(demand.problem), limit))
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
    passes = all(each.passes for each in found)
    carried = f"all {len(found)} cases" if passes else _named(demands, found)
    words = f"{demands[first].case} governs: {found[first].reasons}"
    return rows, f"{'Yes' if passes else 'No'}: {carried}; {words}", passes


def chosen_case(demands: Sequence[Demand], name: str) -> Demand:
    """The load case called ``name``; ValueError if there is none."""
    names = [str(demand.case) for demand in demands if demand.case is not None]
    if not names:
        raise ValueError(f"--case {name}: the file has no load_cases")
    if name not in names:
        raise refused("--case", name, " or ".join(names))
    return demands[names.index(name)]


def _named(demands: Sequence[Demand], found: Sequence[Verdict]) -> str:
    names = [str(d.case) for d, each in zip(demands, found, strict=True) if not each.passes]
    return f"{', '.join(names)} {'is' if len(names) == 1 else 'are'} not carried"


def require_case(**options: object) -> None:
    """`click.UsageError` for an option that is given and has one answer for one load case."""
    for name, value in options.items():
        if value:
            flag = f"--{name.replace('_', '-')}"
            raise click.UsageError(f"{flag}: needs --case, as the file has load_cases")
