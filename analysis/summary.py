"""The summary of a study in words: how the results compare, and where they are."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from analysis.fit import winner
from workflow.case import REFERENCE
from workflow.models import MODELS, first_failure_only
from workflow.results.tables import (
    BEST_FIT,
    CAPACITY,
    CASES,
    FIT,
    VALIDATION,
    Table,
    read_table,
)

# Smaller errors count as none: the distinct elements' peaks are not known more accurately.
PEAK_ACCURACY = 0.0025
AGREEMENT = 0.01  # of two models on the same nodes; larger differences are named


def summary(results: str, tables: dict[str, pd.DataFrame]) -> str:
    """The text, one finding per line."""
    fitted = tables["fit"]["model"]
    leading = str(fitted.iloc[0]) if len(fitted) else ""
    return "\n".join(
        [
            *_failed(tables["cases"]),
            *_validation(tables["validation"], leading),
            *_models(tables["capacity"]),
            *_fits(tables["fit"], tables["best_fit"], leading),
            *_variants(tables["capacity"]),
            *_disagreements(tables["cases"]),
            "",
            "Largest unbalanced force on a piece (or moment over a), at any peak: "
            f"{100 * tables['capacity']['unbalanced_share'].max():.2g} % of the load",
            "",
            f"Tables:  {results}/tables",
            f"Figures: {results}/figures (side_by_side.png first)",
            _assumed(published=not tables["validation"].empty),
            "",
        ]
    )


def _assumed(published: bool) -> str:
    """What rests on an assumption; the geometry only if it stands for the paper's."""
    geometry = "a, b, h and H (the paper's text gives a * b only), " if published else ""
    return f"Assumed: {geometry}contact-point positions."


def _failed(cases: pd.DataFrame) -> Iterator[str]:
    """Cases without a result come first: they are missing from the tables."""
    failed = cases[cases["error"].notna()]
    if failed.empty:
        return
    yield f"WITHOUT A RESULT: {len(failed)} of {len(cases)} cases"
    for row in failed.itertuples():
        yield f"  {row.name} ({row.model}): {row.error}"
    yield ""


def _disagreements(cases: pd.DataFrame) -> Iterator[str]:
    """Engines against the static model on the same nodes."""
    held = cases[cases["difference_to_static"].notna() & (cases["model"] != "limit")]
    if held.empty:
        return
    size = held["difference_to_static"].abs()
    first = any(map(first_failure_only, held["model"].unique()))
    what = "Peaks, or first failures of models that go no further," if first else "Peaks"
    yield ""
    yield (
        f"{what} against the static model on the same nodes: {len(held)} cases, at most "
        f"{100 * size.max():.2f} %; {(size > AGREEMENT).sum()} of them differ by more than "
        f"{100 * AGREEMENT:g} %"
    )
    for row in held[size > AGREEMENT].itertuples():
        yield f"  {row.name} ({row.model}): {100 * float(row.difference_to_static):+.2f} %"


def _validation(table: pd.DataFrame, leading: str) -> Iterator[str]:
    if table.empty:
        yield "The paper has no numbers for the samples of this study."
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
    """Largest loads of all models of the joint's pieces, direction by direction."""
    own = capacity[capacity["failed_load_N"].notna() & (capacity["variant"] == REFERENCE)]
    models = list(own["model"].unique())
    yield ""
    told = (f"{m} (first failure)" if m in MODELS and first_failure_only(m) else m for m in models)
    yield f"Largest load along each direction (N): {', '.join(told)}"
    keys = ["sample", "mesh_m", "eccentricity_m"]
    for _, rows in own.groupby("case", sort=False):
        sample, mesh, eccentricity = rows[keys].iloc[0]
        loads = rows.set_index("model")["load_N"]
        cells = "".join(f"{loads[m]:>10.2f}" if m in loads else " " * 10 for m in models)
        yield f"  {sample} mesh {mesh:g} m, e = {eccentricity:>6g} m{cells}"


def _fits(fit: pd.DataFrame, best: pd.DataFrame, leading: str) -> Iterator[str]:
    if not leading:  # no sample that SiDMACIB is a model of
        return
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
    keys = ["model", "case"]
    reference = engines.loc[engines["variant"] == REFERENCE, [*keys, "load_N"]]
    others = engines[engines["variant"] != REFERENCE]
    both = others.merge(reference, on=keys, suffixes=("", "_reference"))
    if both.empty:
        return
    both["change"] = 100 * (both["load_N"] / both["load_N_reference"] - 1)
    yield ""
    yield "Variants against the reference variant, load along the direction"
    groups = both.groupby(["model", "sample", "mesh_m", "variant"], sort=False)
    for (model, sample, mesh, variant), rows in groups:
        low, high = rows["change"].min(), rows["change"].max()
        change = f"{low:+.1f} %" if len(rows) == 1 else f"{low:+.1f} to {high:+.1f} %"
        where = ", ".join(f"{e:g}" for e in rows["eccentricity_m"])
        yield f"  {model} {sample} mesh {mesh:g} m, {variant}: {change} at e = {where} m"


def run(arguments: Mapping[str, Any], inputs: Sequence[Path], outputs: Sequence[Path]) -> None:
    """Write the summary."""
    kinds: tuple[Table, ...] = (VALIDATION, FIT, BEST_FIT, CAPACITY, CASES)
    tables = {k.name: read_table(k, path) for k, path in zip(kinds, inputs, strict=True)}
    outputs[0].write_text(summary(arguments["results"], tables))
