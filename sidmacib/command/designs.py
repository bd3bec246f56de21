"""Output of the command for a design."""

import math
from collections.abc import Iterator

import numpy as np

from sidmacib.command.answers import Row
from sidmacib.design.designed import Design
from sidmacib.quantities import four_digits


def verdict(design: Design) -> str:
    """PASS or FAIL with the reasons, in a line."""
    locks = sum(row.working for row in design.choice if row)
    rows = sum(row is not None for row in design.choice)
    what = f"{locks} load-bearing locks in {rows} of {len(design.choice)} interfaces"
    if design.passes:
        least = min(check.factor for check in design.checks if check.decides and check.factor)
        return f"PASS: {what}; smallest load factor {_short(least)} (all cases, all checks)."
    reasons = []
    for check in design.failing:
        found = "no answer" if check.factor is None else _short(check.factor)
        reasons.append(f"{check.model}, {check.case}: {found}")
    if design.task.asked.buildable and design.order.stuck:
        stuck = _names(design, design.order.stuck)
        reasons.append(f"{', '.join(stuck[:5])} cannot be placed")
    asked = f"required load factor {design.task.asked.factor:g}"
    if not design.cost:
        what = "the design model needs no locks, but a check does"
    else:
        what = f"the best design found, of {what}, fails a check"
    return f"FAIL: {what}; {asked}; {'; '.join(reasons)}."


def design_tables(design: Design) -> dict[str, list[Row]]:
    """The tables of a design by name: cost, locks, checks, order."""
    mixed, whole = design.mixed, design.whole
    searches = (
        ("mixed rows, one direction for each interface", mixed.cost, mixed.bound),
        ("whole rows", whole.cost, whole.bound),
        ("design, against the bound at full lock strength", design.cost, design.bound),
    )
    return {
        "cost": [
            {"search": what, "cost": cost, "bound": bound, "gap": cost and 1.0 - bound / cost}
            for what, cost, bound in searches
        ],
        "locks": lock_rows(design),
        "checks": [
            {
                "case": check.case,
                "model": check.model,
                "factor": check.factor if check.factor is None else float(check.factor),
                "decides": "yes" if check.decides else "no",
                "note": check.note,
            }
            for check in design.checks
        ],
        "order of placing": [*order_rows(design)],
    }


def lock_rows(design: Design) -> list[Row]:
    """The locks of each interface that gets any."""
    structure = design.task.structure
    found: list[Row] = []
    for number, layout in enumerate(design.choice):
        if layout is None:
            continue
        use = np.abs(design.needed[:, number]) / layout.strength
        gained = float(design.by_strength[:, number].max())
        found.append(
            {
                "interface": structure.assembly.faces[structure.sites[number].face].name,
                "locks": len(layout.widths),
                "working": layout.working,
                "width (m)": layout.width,
                "run": " ".join(f"{each:.3g}" for each in layout.run),
                "strength (N)": layout.strength,
                "utilisation": float(use.max()),
                "case": structure.cases[int(use.argmax())].name,
                "load factor gained by +1 % strength": gained * layout.strength / 100.0,
            }
        )
    return found


def order_rows(design: Design) -> Iterator[Row]:
    """The blocks in the order of placing, and how each comes; then those that are stuck."""
    pieces = design.task.structure.assembly.pieces
    for number, (block, way) in enumerate(design.order.steps.items(), start=1):
        along = " ".join(f"{each:.3g}" for each in way)
        yield {"step": number, "block": pieces[block].name, "moves along": along}
    for name in _names(design, design.order.stuck):
        yield {"step": None, "block": name, "moves along": "cannot be placed"}


def _names(design: Design, blocks: tuple[int, ...]) -> list[str]:
    return [design.task.structure.assembly.pieces[block].name for block in blocks]


def _short(factor: float) -> str:
    return "unlimited" if math.isinf(factor) else four_digits(factor)
