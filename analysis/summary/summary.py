"""The summary of a study: what is missing, answers, loads by each model, published numbers."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import pandas as pd

from analysis.drawing import label_of
from analysis.published import comparisons, difference_text, quantity_label
from analysis.summary import (
    DESIGN,
    answers,
    direction_words,
    of_cases,
)
from analysis.summary.earthquakes import summary as earthquakes_summary
from analysis.summary.structures import summary as structures_summary
from sidmacib.models import LAWS, first_failure_only
from sidmacib.quantities import digits
from workflow.case import REFERENCE
from workflow.results.tables import read_tables
from workflow.step import Arguments, Files, step

GEOMETRY = "a, b, h and H (the paper's text gives a * b only), "
ACROSS = 4  # samples in one block of the list of loads
MOST_SAMPLES = 12  # whose loads are listed


def summary(results: str, tables: dict[str, pd.DataFrame], meshes: Sequence[float]) -> str:
    """The text: cases without a result, answers, loads of each model, and published numbers.

    ``meshes``: the study's (m); loads are those at the finest, the report and the tables have all.
    """
    leading, mesh = leading_models(tables["fit"]), min(meshes)
    return "\n".join(
        [
            *_failed(tables["cases"]),
            *(line for each in answers(tables, leading, mesh) for line in each.lines),
            *_models(of_cases(tables), mesh),
            "",
            *_validation(tables["validation"], leading),
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
                f"{digits(line.rows[s].computed, 5):>12}{difference_text(line.rows[s]):>9}"
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
        loads = {
            row.sample: f"{digits(row.shear_N, 5):>12}{digits(row.torque_Nm, 5):>10}"
            for row in known
        }
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


def run(arguments: Arguments, inputs: Files, outputs: Files) -> None:
    """Write the summary of joints, then that of structures, if there are any."""
    tables = read_tables(inputs)
    results, texts = arguments["results"], []
    if "cases" in tables:
        texts.append(summary(results, tables, arguments["meshes"]))
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
