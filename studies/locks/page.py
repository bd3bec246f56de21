"""Numbers of `make locks` in pages."""

from collections.abc import Callable
from pathlib import Path

from analysis.drawing import label_of
from sidmacib.models import REFERENCE_MODEL
from studies.locks.tables import LAW, RULE_ERRORS
from studies.locks.variation import ASSUMED_SIZES, CHARACTERISTIC
from studies.markdown import body, markdown, markdown_of, percent, size, span, table_in
from workflow.results.tables import CAPACITY

BRITTLE = ("bends", "rigid")  # samplings whose peaks the rule is made for
BODIES = ("columns", "monolithic")
HOLDS = {"plate": "plate", "pressed": "pressure"}
RULE_WORDS = {
    "half": "(n − 1) / 2",
    "floor_of_sum": "sum of weights, rounded down",
    "lower_sum": "sum over lower locks",
    "none": "every lock",
}


def safe_margins(results: Path) -> str:
    """The safe rule over the brittle peak."""
    table = table_in(results, LAW).query(
        "quantity == 'safe / peak' and upper_body == 'all' and eccentricity_over_a != 'all'"
    )
    parts = [
        (f"{sampling}, {HOLDS[str(held)]}", part)
        for (sampling, held), part in table.groupby(["sampling", "held"], sort=True)
    ]
    parts.append(("brittle: bends and rigid", table[table["sampling"].isin(BRITTLE)]))
    rows = []
    for name, part in parts:
        points = int(part["points"].sum())
        mean = (part["mean_error"] * part["points"]).sum() / points
        rows.append([name, f"{points:,}", percent(mean), percent(part["largest_error"].max())])
    return markdown(["", "points", "mean", "nearest to the peak"], rows)


def rules(results: Path) -> str:
    """Share of points where the paper's rules with Option 4 exceed the brittle peak."""
    table = table_in(results, RULE_ERRORS).query("option == 'option4'")
    groups = table["locks"].unique()
    rows = []
    for rule, words in RULE_WORDS.items():
        for upper in BODIES:
            part = table[table["rule"].eq(rule) & table["upper_body"].eq(upper)]
            cells = [
                f"{size(row.unsafe_share, 0)}, {percent(row.mean_error, 0)}"
                for row in part.itertuples()
            ]
            rows.append([f"{words}, {body(upper)}", *cells])
    return markdown(["unsafe at; mean error", *(f"n = {group}" for group in groups)], rows)


def characteristic(results: Path) -> str:
    """The 5 % quantile of the first failure over the law's, in pure shear."""
    wide = (
        table_in(results, CHARACTERISTIC)
        .query("eccentricity_over_a == 0")
        .pivot_table(["characteristic_over_law"], ["locks", "upper_body"], "variation")
        .droplevel(0, axis=1)
    )
    rows = [
        [f"{locks}, {body(upper)}", *(f"{value:.2f}" for value in row)]
        for (locks, upper), row in wide.iterrows()
    ]
    return markdown(["locks", *(f"scatter {100 * each:g} %" for each in wide.columns)], rows)


def assumed_sizes(results: Path) -> str:
    """Locks that work over all sizes that the paper leaves open."""
    return markdown_of(
        table_in(results, ASSUMED_SIZES),
        {
            "locks": lambda row: f"{row.locks}",
            "friction": lambda row: f"{row.friction:g}",
            "(n − 1) / 2": lambda row: f"{row.half:g}",
            "sizes assumed here": lambda row: f"{row.working_at_assumed_sizes:.2f}",
            "all sizes": lambda row: f"{row.least_working:.2f} – {row.most_working:.2f}",
            "(n − 1) / 2 unsafe at": lambda row: size(row.unsafe_share_of_half, 0),
        },
    )


def engines(results: Path) -> str:
    """Peaks of engines and rules over those of the static model, on the study's samples."""
    table = table_in(results, CAPACITY).query("variant == 'reference' and mesh_m == mesh_m.max()")
    loads = table.pivot_table(index="case", columns="model", values="load_N")
    rows = []
    for model in ("yade", "liggghts", "law", "safe"):
        if model in loads and REFERENCE_MODEL in loads:
            error = (loads[model] / loads[REFERENCE_MODEL] - 1.0).dropna()
            cells = [f"{len(error)}", size(error.abs().mean()), span(error.min(), error.max())]
            rows.append([label_of(model).name, *cells])
    return markdown(["against the static peak", "cases", "mean size", "extremes"], rows)


BLOCKS: dict[str, Callable[[Path], str]] = {
    "safe-margins": safe_margins,
    "rules": rules,
    "characteristic": characteristic,
    "assumed-sizes": assumed_sizes,
    "engines": engines,
}
