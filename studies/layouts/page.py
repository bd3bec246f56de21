"""Tables of the layouts of nodes: three studies, in the folders of their names in the results."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd

from sidmacib.mechanics.assembly import NodeLayout
from studies.markdown import markdown, size, table_in
from workflow.results.tables import CASES, FIT, Table

SAMPLES = {
    "n3": "3 locks as printed",
    "n3_fits": "3 locks fitted",
    "n5": "5 locks as printed",
    "n5_fits": "5 locks fitted",
}
TORSION = ("n3", "n5")  # as printed
RULE_WORDS = {"half": ", (n − 1) / 2", "lower_sum": ", lower locks"}
HEAD = [layout.replace("lobatto", "Lobatto") for layout in NodeLayout]


def _by_layout(results: Path, table: Table) -> pd.DataFrame:
    """A table of all three studies, with the layout."""
    return pd.concat(
        [table_in(results / layout, table).assign(layout=str(layout)) for layout in NodeLayout]
    )


def torsion(results: Path) -> str:
    """Loads in pure torsion on each layout and mesh, and the largest of their mesh errors."""
    cases = _by_layout(results, CASES).query("model == 'static'")
    cases = cases[np.isinf(cases["eccentricity_over_a"]) & cases["sample"].isin(TORSION)]
    keys = ["sample", "mesh_m"]
    loads = cases.pivot_table(index=keys, columns="layout", values="load_N")
    rows = [
        [
            SAMPLES[sample],
            f"{mesh:g}",
            *(f"{loads.loc[(sample, mesh), each]:.2f}" for each in NodeLayout),
        ]
        for sample in TORSION
        for mesh in sorted(cases["mesh_m"].unique(), reverse=True)
    ]
    errors = cases.pivot_table(index="mesh_m", columns="layout", values="mesh_error", aggfunc="max")
    for mesh, row in errors.sort_index(ascending=False).iterrows():
        cells = [size(row[each], 0) for each in NodeLayout]
        rows.append(["largest mesh-error estimate", f"{mesh:g}", *cells])
    return markdown(["pure torsion, M / a (N)", "mesh (m)", *HEAD], rows)


def options(results: Path) -> str:
    """The option of SiDMACIB that fits best on each layout and mesh, by the rule that counts."""
    table = _by_layout(results, FIT).query("model == 'static' and not friction")
    best = table.sort_values("misfit", kind="stable").drop_duplicates(
        ["layout", "sample", "mesh_m", "reduction"]
    )
    best = best.set_index(["sample", "reduction", "mesh_m", "layout"])
    rows = []
    for sample, words in SAMPLES.items():
        three = sample.startswith("n3")  # both rules count one lock
        for rule, of_rule in RULE_WORDS.items():
            if three and rule != "half":
                continue
            for mesh in sorted(table["mesh_m"].unique(), reverse=True):
                cells = [_cell(best.loc[(sample, rule, mesh, each)]) for each in NodeLayout]
                rows.append([words + ("" if three else of_rule), f"{mesh:g}", *cells])
    return markdown(["best option (misfit; unsafe by up to)", "mesh (m)", *HEAD], rows)


def _cell(row: pd.Series) -> str:
    """The option, with its misfit and its largest unsafe error."""
    unsafe = size(max(row["largest_unsafe_error"], 0.0))
    return f"{row['option'].removeprefix('option')} ({size(row['misfit'])}; {unsafe})"


BLOCKS: dict[str, Callable[[Path], str]] = {
    "layouts-torsion": torsion,
    "layouts-options": options,
}
