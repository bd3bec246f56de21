"""The summary of a study in words: how the results compare, and where they are."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from analysis.beside import beside, difference, name_of
from analysis.fit import winner
from analysis.looks import look_of
from sidmacib.mechanics.path import SPREAD_LIMIT
from workflow.case import REFERENCE
from workflow.models import Obtained, first_failure_only, obtained_by
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
MESH_LIMIT = 0.02  # of a mesh error; larger ones are named
AGREEMENT = 0.01  # of two models on the same nodes; larger differences are named


def summary(results: str, tables: dict[str, pd.DataFrame], meshes: Sequence[float]) -> str:
    """The text, one finding per line; ``meshes``: the study's (m)."""
    leading = leading_models(tables["fit"])
    return "\n".join(
        [
            *_failed(tables["cases"]),
            *_validation(tables["validation"], leading),
            *_models(tables["capacity"], meshes),
            *_mesh_errors(tables["capacity"]),
            *spread_lines(tables["capacity"]),
            *_fits(tables["fit"], tables["best_fit"], leading),
            *_variants(tables["capacity"]),
            *_disagreements(tables["cases"]),
            "",
            "Largest unbalanced force on a piece (or moment over a), at any peak: "
            f"{100 * tables['capacity']['unbalanced_share'].max():.2g} % of the load",
            "",
            f"Report:  {results}/report.html",
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


def leading_models(fit: pd.DataFrame) -> dict[str, str]:
    """The detailed model that each sample's fits are told of: the first one."""
    first = fit.drop_duplicates("sample")
    return dict(zip(first["sample"].astype(str), first["model"].astype(str), strict=True))


def _validation(table: pd.DataFrame, leading: Mapping[str, str]) -> Iterator[str]:
    if table.empty:
        yield "The paper has no numbers for the samples of this study."
        return
    yield "Published against computed (e = 0)"
    for own in beside(table, leading):
        for sample, words in own.samples.items():
            yield f"  {own.locks} locks, {sample}: {words}"
        heads = "".join(f"{sample:>12}{'diff.':>9}" for sample in own.samples)
        yield f"  {'quantity':44}{'mesh m':>7}{'published':>11}{heads}"
        for line in own.lines:
            cells = "".join(
                f"{line.rows[s].computed:>12.5g}{difference(line.rows[s]):>9}"
                if s in line.rows
                else " " * 21
                for s in own.samples
            )
            name = name_of(line.quantity)
            yield f"  {name:44}{line.mesh:>7}{line.published:>11g}{cells}".rstrip()


def _models(capacity: pd.DataFrame, meshes: Sequence[float]) -> Iterator[str]:
    """Largest loads of all models of the joint's pieces, direction by direction."""
    asked = capacity["model"].isin(obtained_by(Obtained.LAW)) & capacity["load_N"].notna()
    found = capacity["failed_load_N"].notna() | asked
    own = capacity[found & (capacity["variant"] == REFERENCE)]
    # Not those for the mesh error only.
    own = own[np.isclose(own["mesh_m"].to_numpy()[:, None], meshes).any(axis=1)]
    models = list(own["model"].unique())
    yield ""
    names = [look_of(m).name + (" (first failure)" * first_failure_only(m)) for m in models]
    yield f"Largest load along each direction (N): {', '.join(names)}; largest mesh error"
    keys = ["sample", "mesh_m", "eccentricity_m"]
    for _, rows in own.groupby("case", sort=False):
        sample, mesh, eccentricity = rows[keys].iloc[0]
        loads = rows.set_index("model")["load_N"]
        cells = "".join(f"{loads[m]:>10.2f}" if m in loads else " " * 10 for m in models)
        error = rows["mesh_error"].max()
        told = "" if pd.isna(error) else f"{100 * error:>8.2f} %"
        where = "torsion" if np.isinf(eccentricity) else f"e = {eccentricity:g} m"
        place = f"{sample} mesh {mesh:g} m, {where}"
        spread = rows["peak_spread"].max()
        note = f"  (static: first failure, {_too_far(spread)})" if spread > SPREAD_LIMIT else ""
        yield f"  {place:<34}{cells}{told}{note}"


def _mesh_errors(capacity: pd.DataFrame) -> Iterator[str]:
    """The largest mesh error of each model at each mesh, and what to do where it is large."""
    own = capacity[capacity["mesh_error"].notna()]
    if own.empty:
        return
    yield ""
    yield "Largest mesh error (estimate from two meshes; the true one is less in 95 % of joints)"
    for (model, mesh), rows in own.groupby(["model", "mesh_m"], sort=False):
        row = rows.loc[rows["mesh_error"].idxmax()]
        variant = "" if row["variant"] == REFERENCE else f", {row['variant']}"
        yield (
            f"  {model} mesh {mesh:g} m: {100 * row['mesh_error']:.2f} % ({row['case']}{variant})"
            + (f", ABOVE {100 * MESH_LIMIT:g} %" if row["mesh_error"] > MESH_LIMIT else "")
        )
    high = own[own["mesh_error"] > MESH_LIMIT]
    if len(high):
        yield (
            f"  {len(high)} of {len(own)} capacities have a mesh error above {100 * MESH_LIMIT:g} "
            "%: what rests on them may be the mesh's doing. A finer mesh lowers it, or nodes: "
            "lobatto."
        )


def spread_lines(capacity: pd.DataFrame) -> Iterator[str]:
    """How far peaks move under tiny changes, and which capacities are first failures for it."""
    own = capacity[capacity["peak_spread"].notna()]
    if own.empty:
        return
    far = own[own["peak_spread"] > SPREAD_LIMIT]
    trusted = own["peak_spread"][own["peak_spread"] <= SPREAD_LIMIT].max()
    yield ""
    yield (
        f"Spread of static peaks under changes of 1e-9: {len(far)} of {len(own)} above "
        f"{100 * SPREAD_LIMIT:g} %"
        + ("" if pd.isna(trusted) else f", the others at most {100 * trusted:.2f} %")
    )
    for row in far.itertuples():
        variant = "" if row.variant == REFERENCE else f", {row.variant}"
        words = _too_far(float(row.peak_spread))
        yield f"  {row.case}{variant}: {words}; the first failure is told instead"


def _too_far(spread: float) -> str:
    return f"peaks spread by {100 * spread:.1f} % or more"


def _fits(fit: pd.DataFrame, best: pd.DataFrame, leading: Mapping[str, str]) -> Iterator[str]:
    if not leading:  # no sample that SiDMACIB is a model of
        return
    yield ""
    yield f"SiDMACIB against {' and '.join(dict.fromkeys(leading.values()))}, all directions"
    fit, best = (rows[rows["model"] == rows["sample"].map(leading)] for rows in (fit, best))
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
                f"{100 * row['largest_safe_error']:.1f} %{_within(row['largest_mesh_error'])}"
            )
    for row in best[best["friction"] == False].itertuples():  # noqa: E712
        yield (
            f"  {row.model} {row.sample} mesh {row.mesh_m:g} m, free fit:        d = "
            f"{row.distance_over_a:.3f} a, {row.locks_that_count:.2f} locks count: misfit "
            f"{100 * float(row.misfit):.1f} %"
        )


def _within(mesh_error: float) -> str:
    return "" if pd.isna(mesh_error) else f" (mesh error up to {100 * mesh_error:.1f} %)"


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
    outputs[0].write_text(summary(arguments["results"], tables, arguments["meshes"]))
