"""The summary of a study in words: how results compare, where they are, and what is missing."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import pandas as pd

from analysis.drawing import label_of
from analysis.published import comparisons, difference_text, quantity_label
from analysis.summary import (
    DESIGN,
    MESH_LIMIT,
    PEAK_ACCURACY,
    answers,
    compared_with_static,
    direction_words,
    disagreements,
    of_cases,
    of_leading,
    percent,
    varied,
)
from analysis.summary.earthquakes import summary as earthquakes_summary
from analysis.summary.structures import summary as structures_summary
from analysis.tables import winner
from sidmacib.mechanics.assembly import NodeLayout
from sidmacib.models import LAWS, first_failure_only
from workflow.case import REFERENCE
from workflow.results.tables import read_tables
from workflow.step import Arguments, Files, step

AGREEMENT = 0.01  # of two models on the same nodes; larger differences are named
GEOMETRY = "a, b, h and H (the paper's text gives a * b only), "
ACROSS = 4  # samples in one block of the list of loads
MOST_SAMPLES = 12  # whose loads are listed


def summary(
    results: str,
    tables: dict[str, pd.DataFrame],
    meshes: Sequence[float],
    ductile: Sequence[str] = (),
) -> str:
    """The text: cases without a result, answers, then the findings, model by model.

    ``meshes``: the study's (m); loads and fits are those at the finest, the tables have all.
    ``ductile``: names of the variants with ductile bonds.
    """
    leading = leading_models(tables["fit"])
    mesh = min(meshes)
    return "\n".join(
        [
            *_failed(tables["cases"]),
            *(line for each in answers(tables, leading, mesh) for line in each.lines),
            "",
            *_validation(tables["validation"], leading),
            *_models(of_cases(tables), mesh),
            *_mesh_errors(tables["capacity"], set(tables["cases"]["nodes"].unique())),
            *spread_lines(tables["capacity"]),
            *_fits(tables["fit"], tables["best_fit"], leading, mesh),
            *_variants(tables["capacity"]),
            *_disagreements(tables["cases"]),
            *_without_friction(tables["cases"], ductile),
            "",
            "Largest unbalanced force on a piece (or moment / a) at any peak: "
            f"{100 * tables['capacity']['unbalanced_share'].max():.2g} % of the load",
            "",
            f"Report:  {results}/report.html",
            f"Tables:  {results}/tables",
            f"Figures: {results}/figures (side_by_side.png first)",
            # The geometry only if it represents the paper's.
            f"Assumed: {'' if tables['validation'].empty else GEOMETRY}contact-point positions.",
            "",
        ]
    )


def _failed(cases: pd.DataFrame) -> Iterator[str]:
    """Cases without a result come first: they are missing from the tables."""
    if failed := _failures(cases, "name"):
        yield f"WITHOUT A RESULT: {len(failed)} of {len(cases)} cases"
        yield from (f"  {line}" for line in failed)
        yield ""


def _failures(cases: pd.DataFrame, name: str) -> list[str]:
    """Name, which is in the column ``name``, model and reason of each case without a result."""
    rows = cases.loc[cases["error"].notna(), [name, "model", "error"]]
    return [f"{case} ({model}): {error}" for case, model, error in rows.itertuples(index=False)]


def _disagreements(cases: pd.DataFrame) -> Iterator[str]:
    """Engines against the static model on the same nodes."""
    compared = cases[compared_with_static(cases)]
    if compared.empty:
        return
    size = compared["difference_to_static"].abs()
    first = any(map(first_failure_only, compared["model"].unique()))
    what = "Peaks, or first failures of models that go no further," if first else "Peaks"
    yield ""
    yield (
        f"{what} against the static model on the same nodes: {len(compared)} cases, at most "
        f"{100 * size.max():.2f} %; {(size > AGREEMENT).sum()} of them differ by more than "
        f"{100 * AGREEMENT:g} %"
    )
    for row in compared[size > AGREEMENT].itertuples():
        yield f"  {row.name} ({row.model}): {100 * float(row.difference_to_static):+.2f} %"
    for name, model, words in disagreements(cases):
        yield f"  {name} ({model}) {words}"


def _without_friction(cases: pd.DataFrame, ductile: Sequence[str]) -> Iterator[str]:
    """Limit analysis, which has no friction, against the static model, both with ductile bonds."""
    selected = cases[cases["model"].eq("limit") & cases["variant"].isin(ductile)]
    far = selected[selected["difference_to_static"].abs() > AGREEMENT]
    if far.empty:
        return
    yield ""
    yield (
        f"Ductile bonds: limit analysis, which has no friction, differs from the static model by "
        f"more than {100 * AGREEMENT:g} % in {len(far)} of {len(selected)} cases"
    )
    for row in far.itertuples():
        yield f"  {row.name}: {100 * float(row.difference_to_static):+.2f} %"


def leading_models(fit: pd.DataFrame) -> dict[str, str]:
    """The detailed model that each sample's fits are shown for: the first one."""
    first = fit.drop_duplicates("sample")
    return dict(zip(first["sample"].astype(str), first["model"].astype(str), strict=True))


def _validation(table: pd.DataFrame, leading: Mapping[str, str]) -> Iterator[str]:
    if table.empty:
        yield "The paper has no numbers for the samples of this study."
        return
    yield "Published against computed (e = 0)"
    for part in comparisons(table, leading):
        for sample, words in part.samples.items():
            yield f"  {part.locks} locks, {sample}: {'; '.join(words)}"
        heads = "".join(f"{sample:>12}{'diff.':>9}" for sample in part.samples)
        yield f"  {'quantity':44}{'mesh m':>7}{'published':>11}{heads}"
        for line in part.lines:
            cells = "".join(
                f"{line.rows[s].computed:>12.5g}{difference_text(line.rows[s]):>9}"
                if s in line.rows
                else " " * 21
                for s in part.samples
            )
            name = quantity_label(line.quantity)
            yield f"  {name:44}{line.mesh:>7}{line.published:>11g}{cells}".rstrip()


def _models(capacity: pd.DataFrame, mesh: float) -> Iterator[str]:
    """V and M that each model gives at the finest mesh, direction by direction."""
    shown = capacity[capacity["failed_load_N"].notna() | capacity["model"].isin(LAWS)]
    shown = shown[(shown["variant"] == REFERENCE) & np.isclose(shown["mesh_m"], mesh)]
    samples = list(shown["sample"].unique())
    # What to design for comes first, then the other laws, then models of the pieces.
    order = [*dict.fromkeys((*DESIGN, *LAWS, *shown["model"]))]
    models = sorted(shown["model"].unique(), key=order.index)
    for model in models:
        rows = shown[shown["model"] == model]
        first = " (first failure)" * (first_failure_only(model) or model == "law")
        at = "" if model in LAWS else f", mesh {mesh:g} m"
        yield ""
        name = label_of(model).name
        yield f"{name[0].upper()}{name[1:]}{first}{at}: V (N) and M (N m)"
        for start in range(0, min(len(samples), MOST_SAMPLES), ACROSS):
            yield from _loads(rows, samples[start : start + ACROSS])
        yield from _refusals(rows)
    if len(samples) > MOST_SAMPLES:
        yield f"  ({MOST_SAMPLES} of {len(samples)} samples; tables/capacity.csv has all)"


def _loads(rows: pd.DataFrame, samples: Sequence[str]) -> Iterator[str]:
    """V and M of some samples, one line for each direction."""
    there = [sample for sample in samples if sample in set(rows["sample"])]
    if not there:
        return
    yield f"  {'e/a':<8}" + "".join(f"{sample:>22}" for sample in there)
    shown = rows[rows["sample"].isin(there)]
    for ratio, own in shown.groupby("eccentricity_over_a"):
        known = own.dropna(subset=["shear_N"]).itertuples()
        loads = {row.sample: f"{row.shear_N:>12.5g}{row.torque_Nm:>10.5g}" for row in known}
        cells = "".join(loads.get(sample, f"{'-':>12}{'-':>10}") for sample in there)
        yield f"  {'torsion' if ratio == np.inf else f'{ratio:g}':<8}{cells}".rstrip()


def _refusals(rows: pd.DataFrame) -> Iterator[str]:
    """Why a model gives nothing, sample by sample."""
    for (sample, reason), part in rows[rows["load_N"].isna()].groupby(
        ["sample", "error"], sort=False
    ):
        where = ", ".join(map(direction_words, part["eccentricity_over_a"]))
        everywhere = len(part) == (rows["sample"] == sample).sum()
        yield f"  - {sample}{'' if everywhere else f' at {where}'}: {reason}"


def _mesh_errors(capacity: pd.DataFrame, nodes: set[str]) -> Iterator[str]:
    """The largest mesh error of each model at each mesh, with advice where it is large.

    ``nodes``: the layouts that there are.
    """
    known = capacity[capacity["mesh_error"].notna()]
    if known.empty:
        return
    yield ""
    yield "Largest mesh error (estimate from two meshes; the true one is less in 95 % of joints)"
    for (model, mesh), rows in known.groupby(["model", "mesh_m"], sort=False):
        row = rows.loc[rows["mesh_error"].idxmax()]
        case = varied(row["case"], row["variant"])
        yield (
            f"  {model} mesh {mesh:g} m: {100 * row['mesh_error']:.2f} % ({case})"
            + (f", ABOVE {100 * MESH_LIMIT:g} %" if row["mesh_error"] > MESH_LIMIT else "")
        )
    high = known[known["mesh_error"] > MESH_LIMIT]
    if len(high):
        yield (
            f"  {len(high)} of {len(known)} capacities have a mesh error above "
            f"{100 * MESH_LIMIT:g} %; conclusions from these may be mesh artefacts. "
            "Use a finer mesh" + (" or nodes: lobatto." if nodes - {NodeLayout.LOBATTO} else ".")
        )


def spread_lines(capacity: pd.DataFrame) -> Iterator[str]:
    """How far the static model's peaks spread, and where more than `AGREEMENT`."""
    known = capacity[capacity["peak_spread"].notna()]
    if known.empty:
        return
    far = known[known["peak_spread"] > AGREEMENT]
    yield ""
    yield (
        "Spread of static peaks, the lowest of which counts: above "
        f"{100 * AGREEMENT:g} % in {len(far)} of {len(known)} cases"
    )
    for row in far.itertuples():
        case = varied(row.case, row.variant)
        yield f"  {case}: {100 * float(row.peak_spread):.1f} %"


def _fits(
    fit: pd.DataFrame, best: pd.DataFrame, leading: Mapping[str, str], mesh: float
) -> Iterator[str]:
    if not leading:  # no sample that SiDMACIB is a model of
        return
    yield ""
    yield (
        f"SiDMACIB against {' and '.join(dict.fromkeys(leading.values()))}, all directions, mesh "
        f"{mesh:g} m (others: tables/fit.csv)"
    )
    fit, best = (of_leading(rows, leading, mesh) for rows in (fit, best))
    for (model, sample), selected in fit.groupby(["model", "sample"], sort=False):
        safe = selected[selected["largest_unsafe_error"] <= PEAK_ACCURACY]
        choices = {"best": selected, "best safe": safe}
        if (selected["reduction"] == "half").any():
            choices["best by (n-1)/2"] = selected[selected["reduction"] == "half"]
        for words, rows in choices.items():
            if rows.empty:
                yield f"  {model} {sample}, {words + ':':17}none"
                continue
            row = winner(rows, sample, mesh)
            friction = "friction" if row["friction"] else "no friction"
            mesh_error = row["largest_mesh_error"]
            within = "" if pd.isna(mesh_error) else f" (mesh error up to {percent(mesh_error)})"
            yield (
                f"  {model} {sample}, {words + ':':17}{row['option']}, {friction}, "
                f"{row['reduction']}: misfit {percent(row['misfit'])}, unsafe by up to "
                f"{percent(row['largest_unsafe_error'])}, safe by up to "
                f"{percent(row['largest_safe_error'])}{within}"
            )
    for row in best[best["friction"].eq(False)].itertuples():
        yield (
            f"  {row.model} {row.sample}, free fit:        d = "
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
    for (model, mesh, variant), rows in both.groupby(["model", "mesh_m", "variant"], sort=False):
        changes = ", ".join(
            _change(sample, part) for sample, part in rows.groupby("sample", sort=False)
        )
        places = sorted(rows["eccentricity_over_a"].unique())
        where = ", ".join("torsion" if np.isinf(e) else f"{e:g}" for e in places)
        yield f"  {model} mesh {mesh:g} m, {variant}: {changes} (e/a = {where})"


def _change(sample: object, rows: pd.DataFrame) -> str:
    low, high = rows["change"].min(), rows["change"].max()
    return f"{sample} {low:+.1f}" + (" %" if len(rows) == 1 else f" to {high:+.1f} %")


def run(arguments: Arguments, inputs: Files, outputs: Files) -> None:
    """Write the summary of joints, then that of structures, if there are any."""
    tables = read_tables(inputs)
    results, texts = arguments["results"], []
    if "cases" in tables:
        texts.append(summary(results, tables, arguments["meshes"], arguments["ductile"]))
    if "structures" in tables:
        others = map(tables.get, ("supports", "verdicts", "measured_structures"))
        texts.append(structures_summary(results, tables["structures"], *others))
    if "fragility" in tables:
        texts.append(earthquakes_summary(tables["fragility"], tables["earthquakes"]))
    outputs["summary"].write_text("\n".join(texts))


def check_complete(arguments: Arguments, inputs: Files, outputs: Files) -> str | None:
    """Write how many cases there are; returns the names and reasons of those without a result."""
    tables, names = read_tables(inputs), {"cases": "name"}
    count = sum(map(len, tables.values()))
    failed = [
        line for kind, cases in tables.items() for line in _failures(cases, names.get(kind, "case"))
    ]
    if not failed:
        outputs["mark"].write_text(f"{count} cases\n")
        return None
    return "\n".join([f"{len(failed)} of {count} cases have no result:", *failed])


if __name__ == "__main__":
    step(run, complete=check_complete)
