"""Numbers of `make locks` in pages."""

from collections.abc import Callable
from pathlib import Path

from analysis.drawing import label_of
from sidmacib.models import REFERENCE_MODEL
from studies.locks.tables import BONDS, FREEDOMS, INTERACTION, LAW, POINTS, RULE_ERRORS
from studies.locks.variation import ASSUMED_SIZES, CHARACTERISTIC, SENSITIVITY
from studies.markdown import body, markdown, markdown_of, percent, size, span, table_in
from workflow.results.tables import CAPACITY

DIRECTIONS = {"0.0": "e = 0", "0.1": "0.1 a", "0.3": "0.3 a", "1.0": "a", "inf": "torsion"}
BRITTLE = ("bends", "rigid")  # samplings whose peaks the rule is made for
BODIES = ("columns", "monolithic")
HOLDS = {"plate": "plate", "pressed": "pressure"}
RULE_WORDS = {
    "half": "(n − 1) / 2",
    "floor_of_sum": "sum of weights, rounded down",
    "lower_sum": "sum over lower locks",
    "none": "every lock",
}


def law_errors(results: Path) -> str:
    """Law over the static model's first failure, on rigid pieces."""
    table = table_in(results, LAW).query(
        "quantity == 'law / first failure' and sampling == 'rigid' and upper_body == 'all'"
    )
    table = table[table["eccentricity_over_a"].isin(DIRECTIONS)]
    rows = []
    for (held, dry), part in table.groupby(["held", "dry_faces"], sort=False):
        errors = [*part.set_index("eccentricity_over_a").loc[list(DIRECTIONS)].itertuples()]
        rows += [
            [
                f"{HOLDS[str(held)]}, {dry}: mean size",
                *(size(each.mean_absolute_error, 2) for each in errors),
            ],
            [
                "5 % and 95 % quantiles",
                *(span(each.error_5_percent, each.error_95_percent) for each in errors),
            ],
            ["extremes", *(span(each.least_error, each.largest_error, 0) for each in errors)],
        ]
    return markdown(["", *DIRECTIONS.values()], rows)


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


def counts(results: Path) -> str:
    """Number of joints and points of each sampling, and number of points without an answer."""
    rows = [
        [
            str(sampling),
            f"{part['number'].nunique():,}",
            f"{len(part):,}",
            f"{part['first_failure'].isna().sum():,}",
            f"{part['law'].isna().sum():,}",
            size(part["first_failure_mesh_error"].abs().quantile(0.95)),
            f"{part['limit'].notna().sum():,}",
        ]
        for sampling, part in table_in(results, POINTS).groupby("sampling", sort=True)
    ]
    head = ["sampling", "joints", "points", "no static answer", "no law", "mesh error, 95 %"]
    return markdown([*head, "limit analyses"], rows)


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


def interaction(results: Path) -> str:
    """Curves through pure shear and pure torsion against the loads between them."""
    table = table_in(results, INTERACTION)
    return markdown_of(
        table.query("sampling == 'rigid' and eccentricity_over_a == 'all'"),
        {
            "p": lambda row: f"{row.exponent:g}",
            "": lambda row: f"{row.dry_faces}, {body(row.upper_body)}",
            "mean size of error": lambda row: size(row.mean_absolute_error),
            "extremes": lambda row: span(row.least_error, row.largest_error, 0),
        },
    )


def freedoms(results: Path) -> str:
    """Misfit of SiDMACIB's polygon by its free parameters."""
    table = table_in(results, FREEDOMS).query("sampling == 'rigid'")
    rows = []
    for freedom, part in table.groupby("freedom", sort=False):
        cells = []
        for upper in BODIES:
            chosen = part[part["upper_body"].eq(upper)]
            mean = (chosen["mean_misfit"] * chosen["joints"]).sum() / chosen["joints"].sum()
            cells += [size(mean, 0), size(chosen["misfit_95_percent"].max(), 0)]
        rows.append([str(freedom), *cells])
    return markdown(["chosen", "columns: mean", "95 %", "one piece: mean", "95 %"], rows)


def bonds(results: Path) -> str:
    """Peaks of bonds that soften or yield, in pure shear."""
    return markdown_of(
        table_in(results, BONDS).query("eccentricity_over_a == 0"),
        {
            "bonds (fracture energy over stored)": lambda row: row.bonds,
            "": lambda row: body(row.upper_body),
            "joints": lambda row: f"{row.points}",
            "peak over first failure, mean": lambda row: f"{row.mean_peak_over_first_failure:.2f}",
            "largest": lambda row: f"{row.largest_peak_over_first_failure:.2f}",
            "peak over P·T0, mean": lambda row: f"{row.mean_peak_over_pairs:.2f}",
        },
    )


def sensitivity(results: Path) -> str:
    """Total Sobol indices of the law in pure shear, nine locks."""
    table = table_in(results, SENSITIVITY).query("locks == 9 and eccentricity_over_a == 0")
    wide = table.pivot_table(index="parameter", columns="upper_body", values="total", sort=False)
    return markdown_of(
        wide,
        {
            "parameter": lambda row: row.Index,
            "columns": lambda row: f"{row.columns:.2f}",
            "one piece": lambda row: f"{row.monolithic:.2f}",
        },
    )


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
    "law-errors": law_errors,
    "safe-margins": safe_margins,
    "counts": counts,
    "rules": rules,
    "interaction": interaction,
    "freedoms": freedoms,
    "bonds": bonds,
    "sensitivity": sensitivity,
    "characteristic": characteristic,
    "assumed-sizes": assumed_sizes,
    "engines": engines,
}
