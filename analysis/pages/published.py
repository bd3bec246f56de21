"""Numbers of the published study, `make study`."""

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from analysis.beside import Beside, beside, difference, name_of
from analysis.looks import look_of
from analysis.pages.markdown import direction, markdown, percent, signed, size, table_in
from analysis.summary import leading_models
from sidmacib.joint import Direction
from workflow.models import REFERENCE_MODEL
from workflow.results.tables import CASES, FIT, MODELS, VALIDATION, VARIANTS, WEIGHTS

SHOWN = (0.0, 0.1, 0.5, np.inf)  # directions of the models beside each other, e / a
LOADS = ("sidmacib_pure_shear_option4", "dem_pure_shear")
HEAD = ("at e = 0", "locks", "mesh (m)", "published")
FITS = "as it fits"  # the published numbers, with another friction and geometry
NONE = "–"


def _beside(results: Path) -> list[Beside]:
    leading = leading_models(table_in(results, FIT))
    return list(beside(table_in(results, VALIDATION), leading))


def _heads(part: Beside) -> list[str]:
    """Of the samples' columns: a setting's words, and the difference."""
    names = []
    for words in part.samples.values():
        setting, model = words.rsplit("; ", 1)
        setting = setting.replace("not as printed", FITS)
        names += [f"{setting}; {look_of(model).name}", "difference"]
    return names


def _lines(parts: Iterable[Beside], quantities: Sequence[str]) -> list[list[str]]:
    """Published numbers whose names begin as ``quantities`` do, beside the computed ones."""
    rows = []
    for quantity in quantities:
        for part in parts:
            for line in [line for line in part.lines if line.quantity.startswith(quantity)]:
                row = [name_of(line.quantity), f"{part.locks}", line.mesh, f"{line.published:g}"]
                for sample in part.samples:
                    own = line.rows.get(sample)
                    row += (
                        [NONE] * 2
                        if own is None
                        else [f"{own.computed:.5g}", signed(difference(own))]
                    )
                rows.append(row)
    return rows


def _weights(part: Beside) -> list[str]:
    """The weights at the finest mesh, one after the other."""
    mesh = _mesh([part])
    own = [line for line in part.lines if _is_weight(line.quantity) and line.mesh == mesh]
    cells = [", ".join(f"{line.published:g}" for line in own)]
    for sample in part.samples:
        cells += [", ".join(f"{line.rows[sample].computed:.2f}" for line in own), "see below"]
    return [f"weights of locks 1 … {part.locks}", f"{part.locks}", mesh, *cells]


def _is_weight(quantity: str) -> bool:
    return quantity.startswith("weight_lock") and not quantity.endswith("_swapped")


def beside_short(results: Path) -> str:
    """The published numbers that the README shows."""
    parts = _beside(results)
    finest = [row for row in _lines(parts, ("weight_sum", "best_option")) if row[2] == _mesh(parts)]
    rows = [*_lines(parts, LOADS), *map(_weights, parts), *finest]
    return markdown([*HEAD, *_heads(parts[0])], rows)


def weights(results: Path) -> str:
    """Published and computed weights at the finest mesh, also with the first two swapped."""
    parts = _beside(results)
    mesh = _mesh(parts)
    rows = [row for row in _lines(parts, ("weight_",)) if row[2] == mesh]
    return markdown([*HEAD, *_heads(parts[0])], rows)


def _mesh(parts: Iterable[Beside]) -> str:
    """The finest mesh of the published numbers."""
    return min({line.mesh for part in parts for line in part.lines if line.mesh}, key=float)


def peaks(results: Path) -> str:
    """The peak of every model in pure shear, with its mesh error."""
    table = table_in(results, VALIDATION)
    own = table[table["quantity"].eq("dem_pure_shear_N") & table["model"].ne("limit")]
    rows = [
        [
            f"{row.locks}",
            row.setting.replace("not as printed", FITS),
            f"{row.mesh_m:g}",
            f"{row.published:g}",
            look_of(row.model).name,
            f"{row.computed:.2f}",
            percent(row.relative_difference, 2),
            size(row.mesh_error, 2) if row.mesh_error == row.mesh_error else NONE,
        ]
        for row in own.sort_values(["locks", "setting", "mesh_m"], kind="stable").itertuples()
    ]
    head = ["locks", "setting", "mesh (m)", "3DEC, published (N)", "model", "V (N)"]
    return markdown([*head, "difference", "mesh error"], rows)


def _static(results: Path) -> pd.DataFrame:
    """The static model's peaks at the finest mesh, by e / a, with a column for each sample."""
    cases = table_in(results, CASES)
    own = cases[cases["model"].eq(REFERENCE_MODEL) & cases["variant"].eq("reference")]
    finest = own[own["mesh_m"].eq(own["mesh_m"].min())]
    return finest.pivot_table(
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


def slopes(results: Path) -> str:
    """-dM/dV over a between the directions, from pure torsion to pure shear."""
    loads = _static(results).sort_index(ascending=False)
    directions = [Direction(float(ratio)) for ratio in loads.index]
    parts = np.array([(each.shear, each.torque) for each in directions])
    rows = []
    for sample in loads.columns:
        shear, torque = parts.T * loads[sample].to_numpy()
        found = -np.diff(torque) / np.diff(shear)
        rows.append([sample, ", ".join(f"{value:.2f}" for value in found)])
    return markdown(["sample, static model", "−dM/dV over a"], rows)


def models(results: Path) -> str:
    """First failure and peak of engines and static model on the same nodes, finest mesh."""
    table = table_in(results, MODELS)
    cases = table_in(results, CASES)
    ratio = cases.drop_duplicates("case").set_index("case")["eccentricity_over_a"]
    table = table.assign(ratio=table["case"].map(ratio))
    engines = [name for name in table["model"].unique() if name not in (REFERENCE_MODEL, "limit")]
    samples = table.loc[table["model"].isin(engines), "sample"].unique()
    finest = table[table["mesh_m"].eq(table["mesh_m"].min()) & table["sample"].isin(samples)]
    shown = [*engines, REFERENCE_MODEL]
    rows = []
    parts = finest[finest["ratio"].isin(SHOWN)].groupby(["locks", "sample", "ratio"])
    for (_, sample, e), part in parts:
        own = part.set_index("model")
        cells = [
            f"{own.loc[name, 'first_failure_load_N']:.2f}, {own.loc[name, 'load_N']:.2f}"
            if name in own.index
            else NONE
            for name in shown
        ]
        rows.append([str(sample), direction(float(e)), *cells])
    mesh = f"{table['mesh_m'].min():g}"
    names = [f"{look_of(name).name} (N)" for name in shown]
    return markdown([f"sample, mesh {mesh} m", "e / a", *names], rows)


def agreement(results: Path) -> str:
    """Every two models of the pieces on the same nodes: largest differences."""
    cases = table_in(results, CASES)
    own = cases[cases["error"].isna() & cases["variant"].eq("reference")]
    weights = table_in(results, WEIGHTS)
    weights = weights[weights["variant"].eq("reference")].pivot_table(
        index=["case", "lock"], columns="model", values="weight"
    )
    loads = {
        what: own.pivot_table(index="case", columns="model", values=column)
        for what, column in (("first", "first_failure_load_N"), ("peak", "load_N"))
    }
    names = [name for name in own["model"].unique() if name != "limit"]
    rows = []
    for number, one in enumerate(names):
        for other in names[number + 1 :]:
            parts = [(table[one] / table[other] - 1.0).dropna() for table in loads.values()]
            apart = (weights[one] - weights[other]).abs().dropna()
            spans = [f"{percent(p.min(), 2)} to {percent(p.max(), 2)}" for p in parts]
            who = f"{look_of(one).name} over {look_of(other).name}"
            rows.append([who, f"{len(parts[1])}", *spans, f"{apart.max():.4f}"])
    head = ["", "cases", "first failure", "peak", "weights apart, at most"]
    return markdown(head, rows)


def options(results: Path) -> str:
    """The option of SiDMACIB that fits each model best, by the paper's rule and by the sum."""
    table = table_in(results, FIT)
    leading = leading_models(table)
    own = table[table["model"].eq(table["sample"].map(leading)) & ~table["friction"].astype(bool)]
    names = {"half": "(n − 1) / 2", "lower_sum": "sum over the lower locks"}
    rows = []
    for (sample, rule, mesh), part in own[own["reduction"].isin(names)].groupby(
        ["sample", "reduction", "mesh_m"], sort=True
    ):
        best = part.sort_values("misfit", kind="stable").iloc[0]
        rows.append(
            [
                f"{sample}: {best['locks']} locks, {look_of(best['model']).name}",
                f"{mesh:g}",
                names[rule],
                str(best["option"]).removeprefix("option"),
                size(float(best["misfit"])),
                size(float(best["largest_unsafe_error"])),
                size(float(best["largest_safe_error"])),
            ]
        )
    head = ["sample", "mesh (m)", "rule", "best option", "misfit", "unsafe by up to"]
    return markdown([*head, "safe by up to"], rows)


def variants(results: Path) -> str:
    """What each variant does to the peak, where reference and variant were both run."""
    table = table_in(results, VARIANTS)
    table = table[table["model"].ne("limit")]
    loads = table.pivot_table(index=["model", "sample", "case"], columns="variant", values="load_N")
    rows = []
    for variant in [name for name in loads.columns if name != "reference"]:
        change = (loads[variant] / loads["reference"] - 1.0).dropna()
        for (model, sample), part in change.groupby(level=["model", "sample"]):
            spans = f"{percent(part.min())} to {percent(part.max())}"
            told = percent(part.iloc[0]) if len(part) == 1 else spans
            rows.append([variant, look_of(model).name, sample, f"{len(part)}", told])
    return markdown(["variant", "model", "sample", "cases", "peak over the reference's"], rows)


BLOCKS: dict[str, Callable[[Path], str]] = {
    "published-short": beside_short,
    "weights": weights,
    "curves": curves,
    "slopes": slopes,
    "peaks": peaks,
    "models": models,
    "agreement": agreement,
    "options": options,
    "variants": variants,
}
