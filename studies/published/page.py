"""Numbers of the published study in pages, `make study`."""

from collections.abc import Callable, Iterable, Sequence
from itertools import combinations
from pathlib import Path

import pandas as pd

from analysis.calibration.candidates import PEAK_AIM, WEIGHT_AIM, read_as_degrees
from analysis.drawing import label_of
from analysis.published import (
    PublishedLine,
    PublishedSamples,
    comparisons,
    difference_text,
    quantity_label,
    read_published,
)
from analysis.summary.summary import leading_models
from sidmacib.models import REFERENCE_MODEL
from studies.markdown import direction, markdown, markdown_of, signed, size, span, table_in
from workflow.results.tables import CASES, FIT, VALIDATION, WEIGHTS

LOADS = ("sidmacib_pure_shear_option4", "dem_pure_shear")
HEAD = ("at e = 0", "locks", "mesh (m)", "published")
FITS = ("not as printed", "fitted")  # to the published numbers, by friction and geometry
NONE = "–"
RULE_WORDS = {"half": "(n − 1) / 2", "lower_sum": "sum over the lower locks"}


def _comparisons(results: Path) -> list[PublishedSamples]:
    leading = leading_models(table_in(results, FIT))
    return list(comparisons(table_in(results, VALIDATION), leading))


def _head(parts: Sequence[PublishedSamples]) -> list[str]:
    """Headings: the published number, then setting, model and difference of each sample."""
    head = [*HEAD]
    for setting, model in parts[0].samples.values():
        head += [f"{setting.replace(*FITS)}; {label_of(model).name}", "difference"]
    return head


def _lines(
    parts: Iterable[PublishedSamples], quantities: Sequence[str], mesh: str = ""
) -> list[list[str]]:
    """Published and computed numbers whose names begin with one of ``quantities``.

    ``mesh``: of the only lines that are shown; all if it is not given.
    """
    return [
        _cells(part, line)
        for quantity in quantities
        for part in parts
        for line in part.lines
        if line.quantity.startswith(quantity) and mesh in ("", line.mesh)
    ]


def _cells(part: PublishedSamples, line: PublishedLine) -> list[str]:
    cells = [quantity_label(line.quantity), f"{part.locks}", line.mesh, f"{line.published:g}"]
    for sample in part.samples:
        row = line.rows.get(sample)
        cells += (
            [NONE] * 2 if row is None else [f"{row.computed:.5g}", signed(difference_text(row))]
        )
    return cells


def _weights(part: PublishedSamples, mesh: str) -> list[str]:
    """The weights at a mesh, one after the other."""
    lines = [
        line
        for line in part.lines
        if line.quantity.startswith("weight_lock")
        and not line.quantity.endswith("_swapped")
        and line.mesh == mesh
    ]
    cells = [", ".join(f"{line.published:g}" for line in lines)]
    for sample in part.samples:
        cells += [", ".join(f"{line.rows[sample].computed:.2f}" for line in lines), "see below"]
    return [f"weights of locks 1 … {part.locks}", f"{part.locks}", mesh, *cells]


def _finest_mesh(parts: Iterable[PublishedSamples]) -> str:
    """The finest mesh of the published numbers."""
    return min({line.mesh for part in parts for line in part.lines if line.mesh}, key=float)


def beside_short(results: Path) -> str:
    """The published numbers that the README shows."""
    parts = _comparisons(results)
    mesh = _finest_mesh(parts)
    rows = [
        *_lines(parts, LOADS),
        *(_weights(part, mesh) for part in parts),
        *_lines(parts, ("weight_sum", "best_option"), mesh),
    ]
    return markdown(_head(parts), rows)


def headline(results: Path) -> str:
    """Three published numbers beside those computed with each friction, finest mesh."""
    parts = _comparisons(results)
    mesh, rows = _finest_mesh(parts), []
    for part in parts:
        lines = {line.quantity: line for line in part.lines if line.mesh == mesh}
        for quantity, words, unit in (
            ("dem_pure_shear_N", f"peak V, {part.locks} locks", " N"),
            ("weight_sum", f"sum of lock weights, {part.locks} locks", ""),
        ):
            numbers = [f"{lines[quantity].published:.5g}{unit}"]
            for sample in part.samples:
                row = lines[quantity].rows[sample]
                difference = signed(difference_text(row))
                numbers.append(f"{row.computed:.5g}{unit} ({difference})")
            rows.append([words, *numbers])
    head = [setting.replace(*FITS) for setting, _ in parts[0].samples.values()]
    return markdown(["", "published", *head], [rows[0], *rows[2:]])


def _static(results: Path) -> pd.DataFrame:
    """The static model's peaks at the finest mesh, by e / a, with a column for each sample."""
    table = table_in(results, CASES)
    table = table[table["model"].eq(REFERENCE_MODEL) & table["variant"].eq("reference")]
    return table.query("mesh_m == mesh_m.min()").pivot_table(
        index="eccentricity_over_a", columns="sample", values="load_N", sort=False
    )


def curves(results: Path) -> str:
    """Loads along the path of the static model in all directions, finest mesh."""
    loads = _static(results)
    rows = [
        [direction(float(ratio)), *(f"{load:.1f}" for load in row)]
        for ratio, row in loads.iterrows()
    ]
    return markdown(["e / a", *(f"{sample} (N)" for sample in loads.columns)], rows)


def agreement(results: Path) -> str:
    """Every two models of the pieces on the same nodes: largest differences."""
    cases = table_in(results, CASES).query("error.isna() and variant == 'reference'")
    loads = [
        cases.pivot_table(index="case", columns="model", values=column)
        for column in ("first_failure_load_N", "load_N")
    ]
    weights = (
        table_in(results, WEIGHTS)
        .query("variant == 'reference'")
        .pivot_table(index=["case", "lock"], columns="model", values="weight")
    )
    names = [name for name in cases["model"].unique() if name != "limit"]
    rows = []
    for one, other in combinations(names, 2):
        errors = [(table[one] / table[other] - 1.0).dropna() for table in loads]
        spans = [span(error.min(), error.max(), 2, " to ") for error in errors]
        apart = (weights[one] - weights[other]).abs().max()
        who = f"{label_of(one).name} over {label_of(other).name}"
        rows.append([who, f"{len(errors[1])}", *spans, f"{apart:.4f}"])
    head = ["", "cases", "first failure", "peak", "weights apart, at most"]
    return markdown(head, rows)


def options(results: Path) -> str:
    """The option of SiDMACIB that fits each model best, by the paper's rule and by the sum."""
    table = table_in(results, FIT)
    leading = table["model"].eq(table["sample"].map(leading_models(table)))
    table = table[leading & ~table["friction"].astype(bool) & table["reduction"].isin(RULE_WORDS)]
    keys = ["sample", "reduction", "mesh_m"]
    best = table.sort_values([*keys, "misfit"], kind="stable").drop_duplicates(keys)
    return markdown_of(
        best,
        {
            "sample": lambda row: f"{row.sample}: {row.locks} locks, {label_of(row.model).name}",
            "mesh (m)": lambda row: f"{row.mesh_m:g}",
            "rule": lambda row: RULE_WORDS[row.reduction],
            "best option": lambda row: row.option.removeprefix("option"),
            "misfit": lambda row: size(row.misfit),
            "unsafe by up to": lambda row: size(row.largest_unsafe_error),
            "safe by up to": lambda row: size(row.largest_safe_error),
        },
    )


def frictions(results: Path) -> str:
    """Results of `make calibrate` for each friction: the best geometry, and how many fit."""
    table, grid = (
        pd.read_csv(results / "calibration" / f"{name}.csv") for name in ("friction", "map")
    )
    count = len(grid[grid["candidate"].str.startswith("g") & grid["friction"].eq(0.0)])
    published = read_published()
    names = {
        published.numbers["sample"]["friction"]: "{}, as printed",
        round(read_as_degrees(published), 6): "{} = tan 0.3°",
    }
    return markdown_of(
        table,
        {
            "friction μ": lambda row: names.get(row.friction, "{}").format(f"{row.friction:g}"),
            "least misfit": lambda row: f"{row.misfit_swapped:.2f}",
            "its peaks, weights within": lambda row: (
                f"{size(row.largest_peak_difference, 2)}, {row.largest_weight_difference:.3f}"
            ),
            f"of {count} geometries fit all peaks to {size(PEAK_AIM)} and weights to "
            f"{WEIGHT_AIM:g}": lambda row: f"{row.geometries_that_fit or 'none'}",
            "peaks alone, any weights, within": lambda row: size(row.least_peak_difference, 2),
        },
    )


BLOCKS: dict[str, Callable[[Path], str]] = {
    "published-three": headline,
    "published-short": beside_short,
    "curves": curves,
    "agreement": agreement,
    "options": options,
    "frictions": frictions,
}
