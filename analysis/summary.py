"""The end of a study in words: where the results are, and how they compare."""

import argparse
from collections.abc import Iterator
from pathlib import Path

import pandas as pd

from analysis.fit import winner
from workflow.case import REFERENCE

# Errors up to this count as none: peaks of the distinct elements are not known better.
PEAK_ACCURACY = 0.0025


def summary(results: str, tables: dict[str, pd.DataFrame]) -> str:
    """The text, one finding per line."""
    leading = str(tables["fit"]["model"].iloc[0])
    return "\n".join(
        [
            *_validation(tables["validation"], leading),
            *_models(tables["capacity"]),
            *_fits(tables["fit"], tables["best_fit"], leading),
            *_variants(tables["capacity"]),
            "",
            "Largest unbalanced force on a piece at any peak (or moment, over a): "
            f"{100 * tables['capacity']['unbalanced_share'].max():.2g} % of the load",
            "",
            f"Tables:  {results}/tables",
            f"Figures: {results}/figures (side_by_side.png first)",
            _assumed(published=not tables["validation"].empty),
            "",
        ]
    )


def _assumed(published: bool) -> str:
    """What rests on an assumption; the geometry only where it stands for the paper's."""
    geometry = "a, b, h and H (the paper's text gives a * b only), " if published else ""
    return f"Assumed: {geometry}contact-point positions."


def _validation(table: pd.DataFrame, leading: str) -> Iterator[str]:
    if table.empty:
        yield "No published number belongs to a sample of this study."
        return
    yield "Published against computed (e = 0)"
    yield f"  {'quantity':44}{'locks':>6}{'mesh m':>8}{'published':>11}{'computed':>10}{'diff.':>9}"
    shown = table[table["model"].isin([leading, "sidmacib"])]
    shown = shown[~shown["quantity"].str.contains("_friction_N")]
    for row in shown.itertuples():
        if pd.isna(row.absolute_difference):
            difference = "same" if row.computed == row.published else "other"
        elif pd.isna(row.relative_difference):
            difference = f"{row.absolute_difference:+.3f}"
        else:
            difference = f"{100 * row.relative_difference:+.1f} %"
        mesh = "" if pd.isna(row.mesh_m) else f"{row.mesh_m:g}"
        yield (
            f"  {row.quantity:44}{row.locks:>6}{mesh:>8}{row.published:>11g}"
            f"{row.computed:>10.4g}{difference:>9}"
        )


def _models(capacity: pd.DataFrame) -> Iterator[str]:
    """Loads of all models of the joint's pieces, over the directions."""
    own = capacity[capacity["failed_load_N"].notna() & (capacity["variant"] == REFERENCE)]
    models = list(own["model"].unique())
    yield ""
    yield f"Largest load along each direction (N): {', '.join(models)}"
    keys = ["sample", "mesh_m", "eccentricity_m"]
    for (sample, mesh, eccentricity), rows in own.groupby(keys, sort=False):
        loads = rows.set_index("model")["load_N"]
        cells = "".join(f"{loads[m]:>10.2f}" if m in loads else " " * 10 for m in models)
        yield f"  {sample} mesh {mesh:g} m, e = {eccentricity:>6g} m{cells}"


def _fits(fit: pd.DataFrame, best: pd.DataFrame, leading: str) -> Iterator[str]:
    yield ""
    yield f"SiDMACIB against {leading}, all directions"
    fit, best = fit[fit["model"] == leading], best[best["model"] == leading]
    for (model, sample, mesh), own in fit.groupby(["model", "sample", "mesh_m"], sort=False):
        safe = own[own["largest_unsafe_error"] <= PEAK_ACCURACY]
        choices = {"best": own, "best safe": safe}
        if (own["reduction"] == "half").any():
            choices["best by (n-1)/2"] = own[own["reduction"] == "half"]
        for words, rows in choices.items():
            if rows.empty:
                yield f"  {model} {sample} mesh {mesh:g} m, {words + ':':17}none"
                continue
            row = winner(rows, sample, mesh)
            friction = "friction" if row["friction"] else "no friction"
            yield (
                f"  {model} {sample} mesh {mesh:g} m, {words + ':':17}{row['option']}, {friction}, "
                f"{row['reduction']}: misfit {100 * row['misfit']:.1f} %, unsafe by up to "
                f"{100 * row['largest_unsafe_error']:.1f} %, safe by up to "
                f"{100 * row['largest_safe_error']:.1f} %"
            )
    for row in best[best["friction"] == False].itertuples():  # noqa: E712
        yield (
            f"  {row.model} {row.sample} mesh {row.mesh_m:g} m, free fit:        d = "
            f"{row.distance_over_a:.3f} a, {row.locks_that_count:.2f} locks count: misfit "
            f"{100 * float(row.misfit):.1f} %"
        )


def _variants(capacity: pd.DataFrame) -> Iterator[str]:
    engines = capacity[capacity["failed_load_N"].notna()]
    keys = ["model", "sample", "mesh_m", "eccentricity_m"]
    reference = engines.loc[engines["variant"] == REFERENCE, [*keys, "load_N"]]
    others = engines[engines["variant"] != REFERENCE]
    both = others.merge(reference, on=keys, suffixes=("", "_reference"))
    if both.empty:
        return
    both["change"] = 100 * (both["load_N"] / both["load_N_reference"] - 1)
    yield ""
    yield "Variants against the reference, load along the direction"
    groups = both.groupby(["model", "sample", "mesh_m", "variant"], sort=False)
    for (model, sample, mesh, variant), rows in groups:
        low, high = rows["change"].min(), rows["change"].max()
        change = f"{low:+.1f} %" if len(rows) == 1 else f"{low:+.1f} to {high:+.1f} %"
        where = ", ".join(f"{e:g}" for e in rows["eccentricity_m"])
        yield f"  {model} {sample} mesh {mesh:g} m, {variant}: {change} at e = {where} m"


def main() -> None:
    """Command line: the file to write, the results' folder, and the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("summary", type=Path)
    parser.add_argument("results")
    parser.add_argument("tables", type=Path, nargs="+")
    arguments = parser.parse_args()
    tables = {path.stem: pd.read_csv(path) for path in arguments.tables}
    arguments.summary.write_text(summary(arguments.results, tables))


if __name__ == "__main__":
    main()
