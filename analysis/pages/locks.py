"""Numbers of the study of the law, `make locks`."""

from collections.abc import Callable
from pathlib import Path

from analysis.designs.errors import ALL
from analysis.looks import look_of
from analysis.pages.markdown import body, markdown, percent, size, table_in
from workflow.models import REFERENCE_MODEL
from workflow.results.tables import (
    ASSUMED_SIZES,
    BONDS,
    CAPACITY,
    CHARACTERISTIC,
    FREEDOMS,
    INTERACTION,
    LAW,
    POINTS,
    RULE_ERRORS,
    SENSITIVITY,
)

RIGID = "rigid"  # the design of rigid pieces and brittle bonds
DIRECTIONS = {"0.0": "e = 0", "0.1": "0.1 a", "0.3": "0.3 a", "1.0": "a", "inf": "torsion"}


def law_errors(results: Path) -> str:
    """Law over the static model's first failure, on rigid pieces."""
    table = table_in(results, LAW)
    own = table[
        table["quantity"].eq("law / first failure")
        & table["design"].eq(RIGID)
        & table["upper_body"].eq(ALL)
        & table["eccentricity_over_a"].isin(DIRECTIONS)
    ]
    rows = []
    for (held, dry), part in own.groupby(["held", "dry_faces"], sort=False):
        told = part.set_index("eccentricity_over_a").loc[list(DIRECTIONS)]
        name = f"{'plate' if held == 'plate' else 'pressure'}, {dry}"
        quantiles = zip(told["error_5_percent"], told["error_95_percent"], strict=True)
        extremes = zip(told["least_error"], told["largest_error"], strict=True)
        rows += [
            [f"{name}: mean size", *(size(value, 2) for value in told["mean_absolute_error"])],
            ["5 % and 95 % quantiles", *(f"{percent(a)}, {percent(b)}" for a, b in quantiles)],
            ["extremes", *(f"{percent(a, 0)}, {percent(b, 0)}" for a, b in extremes)],
        ]
    return markdown(["", *DIRECTIONS.values()], rows)


def safe_margins(results: Path) -> str:
    """The safe rule over the brittle peak."""
    table = table_in(results, LAW)
    own = table[table["quantity"].eq("safe / peak") & table["upper_body"].eq(ALL)]
    own = own[~own["eccentricity_over_a"].eq(ALL)]
    rows = []
    for (design, held), part in own.groupby(["design", "held"], sort=True):
        points = int(part["points"].sum())
        mean = float((part["mean_error"] * part["points"]).sum() / points)
        name = f"{design}, {'plate' if held == 'plate' else 'pressure'}"
        rows.append(
            [name, f"{points:,}", percent(mean), percent(float(part["largest_error"].max()))]
        )
    return markdown(["", "points", "mean", "nearest to the peak"], rows)


def counts(results: Path) -> str:
    """How many joints and points each design has, and how many have no answer."""
    points = table_in(results, POINTS)
    rows = []
    for design, part in points.groupby("design", sort=True):
        rows.append(
            [
                str(design),
                f"{part['number'].nunique():,}",
                f"{len(part):,}",
                f"{int(part['first_failure'].isna().sum()):,}",
                f"{int(part['law'].isna().sum()):,}",
                size(float(part["first_failure_mesh_error"].abs().quantile(0.95))),
                f"{int(part['limit'].notna().sum()):,}",
            ]
        )
    head = ["design", "joints", "points", "no static answer", "no law", "mesh error, 95 %"]
    return markdown([*head, "limit analyses"], rows)


def rules(results: Path) -> str:
    """Where the paper's rules with its Option 4 promise more than the brittle peak."""
    own = table_in(results, RULE_ERRORS)
    own = own[own["option"].eq("option4")]
    names = {
        "half": "(n − 1) / 2",
        "floor_of_sum": "sum of weights, rounded down",
        "lower_sum": "sum over lower locks",
        "none": "every lock",
    }
    groups = list(dict.fromkeys(own["locks"]))
    rows = []
    for rule, upper in ((rule, upper) for rule in names for upper in ("columns", "monolithic")):
        part = own[own["rule"].eq(rule) & own["upper_body"].eq(upper)].set_index("locks")
        cells = [
            f"{size(part.loc[g, 'unsafe_share'], 0)}, {percent(part.loc[g, 'mean_error'], 0)}"
            for g in groups
            if g in part.index
        ]
        rows.append([f"{names[rule]}, {body(upper)}", *cells])
    return markdown(["unsafe at; mean error", *(f"n = {group}" for group in groups)], rows)


def interaction(results: Path) -> str:
    """Curves through pure shear and pure torsion against what lies between."""
    table = table_in(results, INTERACTION)
    own = table[table["design"].eq(RIGID) & table["eccentricity_over_a"].eq(ALL)]
    rows = [
        [
            f"{row.exponent:g}",
            f"{row.dry_faces}, {body(row.upper_body)}",
            size(row.mean_absolute_error),
            f"{percent(row.least_error, 0)}, {percent(row.largest_error, 0)}",
        ]
        for row in own.itertuples()
    ]
    return markdown(["p", "", "mean size of error", "extremes"], rows)


def freedoms(results: Path) -> str:
    """Misfit of SiDMACIB's polygon by what may be chosen."""
    table = table_in(results, FREEDOMS)
    own = table[table["design"].eq(RIGID)]
    rows = []
    for freedom in dict.fromkeys(own["freedom"]):
        part = own[own["freedom"].eq(freedom)]
        cells = []
        for upper in ("columns", "monolithic"):
            chosen = part[part["upper_body"].eq(upper)]
            mean = (chosen["mean_misfit"] * chosen["joints"]).sum() / chosen["joints"].sum()
            cells += [size(float(mean), 0), size(float(chosen["misfit_95_percent"].max()), 0)]
        rows.append([freedom, *cells])
    head = ["chosen", "columns: mean", "95 %", "one piece: mean", "95 %"]
    return markdown(head, rows)


def bonds(results: Path) -> str:
    """Peaks of bonds that soften or yield, in pure shear."""
    table = table_in(results, BONDS)
    own = table[table["eccentricity_over_a"].eq(0.0)]
    rows = [
        [
            row.bonds,
            body(row.upper_body),
            f"{row.points}",
            f"{row.mean_peak_over_first_failure:.2f}",
            f"{row.largest_peak_over_first_failure:.2f}",
            f"{row.mean_peak_over_pairs:.2f}",
        ]
        for row in own.itertuples()
    ]
    head = ["bonds (fracture energy over stored)", "", "joints", "peak over first failure, mean"]
    return markdown([*head, "largest", "peak over P·T0, mean"], rows)


def sensitivity(results: Path) -> str:
    """Total Sobol indices of the law in pure shear, nine locks."""
    table = table_in(results, SENSITIVITY)
    own = table[table["locks"].eq(9) & table["eccentricity_over_a"].eq(0.0)]
    wide = own.pivot_table(index="parameter", columns="upper_body", values="total", sort=False)
    rows = [
        [str(name), f"{row['columns']:.2f}", f"{row['monolithic']:.2f}"]
        for name, row in wide.iterrows()
    ]
    return markdown(["parameter", "columns", "one piece"], rows)


def characteristic(results: Path) -> str:
    """The 5 % quantile of the first failure over the law's, in pure shear."""
    table = table_in(results, CHARACTERISTIC)
    own = table[table["eccentricity_over_a"].eq(0.0)]
    wide = own.pivot_table(
        index=["locks", "upper_body"], columns="variation", values="characteristic_over_law"
    )
    rows = [
        [f"{locks}, {body(upper)}", *(f"{v:.2f}" for v in row)]
        for (locks, upper), row in wide.iterrows()
    ]
    return markdown(["locks", *(f"scatter {100 * v:g} %" for v in wide.columns)], rows)


def assumed_sizes(results: Path) -> str:
    """Locks that work over all sizes that the paper leaves open."""
    rows = [
        [
            f"{row.locks}",
            f"{row.friction:g}",
            f"{row.half:g}",
            f"{row.working_at_assumed_sizes:.2f}",
            f"{row.least_working:.2f} – {row.most_working:.2f}",
            size(row.unsafe_share_of_half, 0),
        ]
        for row in table_in(results, ASSUMED_SIZES).itertuples()
    ]
    head = ["locks", "friction", "(n − 1) / 2", "sizes assumed here", "all sizes"]
    return markdown([*head, "(n − 1) / 2 unsafe at"], rows)


def engines(results: Path) -> str:
    """Peaks of the engines beside the static model's, on the designed samples."""
    capacity = table_in(results, CAPACITY)
    finest = capacity[capacity["mesh_m"].eq(capacity["mesh_m"].max())]
    loads = finest[finest["variant"].eq("reference")].pivot_table(
        index="case", columns="model", values="load_N"
    )
    rows = []
    for model in ("yade", "liggghts", "law", "safe"):
        if model not in loads or REFERENCE_MODEL not in loads:
            continue
        error = (loads[model] / loads[REFERENCE_MODEL] - 1.0).dropna()
        rows.append(
            [
                look_of(model).name,
                f"{len(error)}",
                size(float(error.abs().mean())),
                f"{percent(float(error.min()))}, {percent(float(error.max()))}",
            ]
        )
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
