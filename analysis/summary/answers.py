"""The first lines of a study's summary: common questions, each with an answer in one line."""

import math
from collections.abc import Iterable, Iterator, Mapping

import numpy as np
import pandas as pd

from analysis.drawing.labels import label_of, option_name
from analysis.tables.misfit import winner
from workflow.case import REFERENCE
from workflow.engines import ENGINES

# Smaller errors count as none: the distinct elements' peaks are not known more accurately.
PEAK_ACCURACY = 0.0025
MESH_LIMIT = 0.02  # of a mesh error; larger ones are named
DESIGN = "safe"  # the model whose loads are for design
SHOWN = 6  # samples in one answer


def answers(
    tables: Mapping[str, pd.DataFrame], leading: Mapping[str, str], mesh: float
) -> Iterator[str]:
    """One line for each answer, at the finest ``mesh`` (m); ``leading``: see the summary."""
    yield from _half(tables, leading, mesh)
    yield from _locks(tables["best_fit"], leading, mesh)
    yield from _design(tables["capacity"], ratios(tables["cases"]))
    yield from _option(tables["fit"], leading, mesh)
    yield from _published(tables["validation"], leading, mesh)
    yield from _engines(tables["cases"])
    yield from _mesh(tables["capacity"], mesh)


def ratios(cases: pd.DataFrame) -> dict[str, float]:
    """The ratio e / a of each direction of loading, by case; infinite for torsion."""
    selected = cases.drop_duplicates("case")
    return dict(zip(selected["case"], selected["eccentricity_over_a"], strict=True))


def direction_words(ratio: float) -> str:
    """A direction in words."""
    return "torsion" if math.isinf(ratio) else f"e/a = {ratio:g}"


def percent(share: float) -> str:
    """A share as a percentage."""
    return f"{100 * share:.1f} %"


def listed(words: Iterable[str]) -> str:
    """The first of some clauses, and how many more there are."""
    every = list(words)
    more = f"; {len(every) - SHOWN} more below" if len(every) > SHOWN else ""
    return "; ".join(every[:SHOWN]) + more


def _half(
    tables: Mapping[str, pd.DataFrame], leading: Mapping[str, str], mesh: float
) -> Iterator[str]:
    """Whether (n - 1) / 2 locks may be counted, with any option, and where not."""
    fit = tables["fit"]
    half = fit[(fit["reduction"] == "half") & np.isclose(fit["mesh_m"], mesh)]
    half = half[half["model"] == half["sample"].map(leading)]
    safest = [_safest(half[half["sample"] == sample]) for sample in half["sample"].unique()]
    if not safest:
        return
    worst = max(safest, key=lambda row: row["largest_unsafe_error"])
    asked, error = "May I count (n - 1) / 2 locks?", worst["largest_unsafe_error"]
    if error <= PEAK_ACCURACY:
        yield f"{asked} Yes, for these joints:"
    else:
        where = direction_words(_least_safe(tables, worst))
        yield f"{asked} No: unsafe by {percent(error)} ({worst['sample']}, {where})"
    yield "  " + listed(map(_verdict, safest))


def _safest(half: pd.DataFrame) -> pd.Series:
    """The best safe row of a sample by (n - 1) / 2, otherwise the least unsafe one."""
    safe = half[half["largest_unsafe_error"] <= PEAK_ACCURACY]
    by = "largest_unsafe_error" if safe.empty else "misfit"
    return (half if safe.empty else safe).sort_values(by, kind="stable").iloc[0]


def _verdict(row: pd.Series) -> str:
    error, option = row["largest_unsafe_error"], option_name(row["option"])
    verdict = "safe" if error <= PEAK_ACCURACY else f"unsafe by {percent(error)}"
    return f"{row['sample']} {verdict} ({option})"


def _least_safe(tables: Mapping[str, pd.DataFrame], row: pd.Series) -> float:
    """The direction, e / a, in which SiDMACIB overestimates the capacity most."""
    capacity = tables["capacity"]
    same = capacity[(capacity["sample"] == row["sample"])]
    same = same[np.isclose(same["mesh_m"], row["mesh_m"])]
    carried = same[(same["model"] == row["model"]) & (same["variant"] == REFERENCE)]
    promised = same[(same["weights_from"] == row["model"]) & (same["reduction"] == "half")]
    promised = promised[
        (promised["option"] == row["option"]) & (promised["friction"] == row["friction"])
    ]
    loads = carried.set_index("case")["load_N"]
    error = promised.set_index("case")["load_N"] / loads
    return ratios(tables["cases"])[str(error.idxmax())]


def _locks(best: pd.DataFrame, leading: Mapping[str, str], mesh: float) -> Iterator[str]:
    """The number of locks that fits best, which need not be whole."""
    selected = best[(best["friction"] == False) & np.isclose(best["mesh_m"], mesh)]  # noqa: E712
    selected = selected[selected["model"] == selected["sample"].map(leading)]
    if len(selected):
        parts = listed(f"{row.sample} {row.locks_that_count:.2f}" for row in selected.itertuples())
        yield f"How many locks fit best? {parts}"


def _design(capacity: pd.DataFrame, ratio: Mapping[str, float]) -> Iterator[str]:
    """Design loads in the first and the last direction of each sample."""
    safe = capacity[(capacity["model"] == DESIGN) & capacity["case"].isin(ratio)]
    if safe.empty:
        return
    parts = []
    safe = safe.assign(ratio=safe["case"].map(ratio)).sort_values("ratio", kind="stable")
    safe = safe.drop_duplicates(["sample", "ratio"])  # it is the same at all meshes
    for sample in capacity["sample"].unique():
        rows = safe[safe["sample"] == sample]
        if rows.empty:
            continue
        ends = rows.iloc[[0, -1] if len(rows) > 1 else [0]]
        if ends["load_N"].isna().all():
            parts.append(f"{sample} no answer, see below")
            continue
        parts.append(f"{sample} {', '.join(map(_at, ends.itertuples()))}")
    yield "What may I design for? The safe rule's V (N) or M (N m), others below:"
    yield f"  {listed(parts)}"


def _at(row: object) -> str:
    """V of a row in pure shear, M in torsion, both in between; with the direction."""
    ratio, shear, torque = (float(getattr(row, key)) for key in ("ratio", "shear_N", "torque_Nm"))
    if math.isnan(shear):
        loads = "no answer"
    elif math.isinf(ratio):
        loads = f"M {torque:.4g}"
    else:
        loads = f"V {shear:.4g}" + (f" M {torque:.4g}" if ratio else "")
    return f"{loads} at {direction_words(ratio)}" if ratio and math.isfinite(ratio) else loads


def _option(fit: pd.DataFrame, leading: Mapping[str, str], mesh: float) -> Iterator[str]:
    """The option of SiDMACIB that fits best, with its rule."""
    selected = fit[(fit["model"] == fit["sample"].map(leading)) & np.isclose(fit["mesh_m"], mesh)]
    rows = [winner(selected, sample, mesh) for sample in selected["sample"].unique()]
    if rows:
        parts = listed(
            f"{row['sample']} {option_name(row['option'])}, {row['reduction']} "
            f"({percent(row['misfit'])})"
            for row in rows
        )
        yield f"Which option and rule of SiDMACIB fit best? {parts}"


def _published(table: pd.DataFrame, leading: Mapping[str, str], mesh: float) -> Iterator[str]:
    """Differences of the peaks in pure shear from the published ones."""
    selected = table[(table["quantity"] == "dem_pure_shear_N") & np.isclose(table["mesh_m"], mesh)]
    selected = selected[selected["model"] == selected["sample"].map(leading)]
    if len(selected):
        parts = listed(
            f"{row.sample} {100 * float(row.relative_difference):+.2f} %"
            for row in selected.itertuples()
        )
        yield f"Are published peaks met? {parts}"


def _engines(cases: pd.DataFrame) -> Iterator[str]:
    """Differences of the engines from the static model."""
    engines = cases[cases["model"].isin(list(ENGINES))]
    size = engines["difference_to_static"].abs().dropna()
    if len(size):
        names = ", ".join(label_of(model).name for model in engines["model"].unique())
        yield (
            f"Do models of the same pieces agree? {names} and the static model within "
            f"{100 * size.max():.2g} % in {len(size)} cases"
        )


def _mesh(capacity: pd.DataFrame, mesh: float) -> Iterator[str]:
    """Whether the finest mesh is fine enough."""
    selected = capacity[capacity["mesh_error"].notna() & np.isclose(capacity["mesh_m"], mesh)]
    if selected.empty:
        return
    row = selected.sort_values("mesh_error", kind="stable").iloc[-1]
    verdict = "No" if row["mesh_error"] > MESH_LIMIT else "Yes"
    yield (
        f"Is a mesh of {mesh:g} m fine enough? {verdict}: mesh error up to "
        f"{percent(row['mesh_error'])} ({row['model']}, {row['case']})"
    )
