"""Compare measured shear and torque of dry contacts with the static model.

    make measured

`pushes.csv` has the loads, `contacts.yaml` the block, its feet, friction and the source. Nothing is
fitted. Writes ``tables/contacts.csv``, and the figure of measured over computed by eccentricity.
"""

import math
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from sidmacib.mechanics.assembly import GRAVITY
from sidmacib.mechanics.static import static_peak
from sidmacib.structure.files.structure_file import structure_of
from sidmacib.yaml_text import read_yaml
from studies.markdown import markdown, table_in
from studies.measured.walls import results_folder
from workflow.results.tables import Table, write_table

HERE = Path(__file__).parent
CONTACTS = Table(
    "contacts",
    (
        *("surface", "support", "push", "eccentricity_m", "measured_N", "static_N"),
        "measured_over_static",
    ),
    ("surface", "support", "push"),
)
FOOT, THICK = 0.002, 0.0172  # m, of which nothing depends on the second
CELL = 0.015  # m, of the whole face
CLASSES = (0.0, 0.005, 0.015, 0.03, 0.05, math.inf)  # of eccentricity, m


@cache
def given() -> dict[str, Any]:
    """The block and its supports, as in the file."""
    return dict(read_yaml(HERE / "contacts.yaml"))


def description(surface: str, support: str, force: tuple[float, float, float]) -> dict[str, Any]:
    """The structure for a ``force``: x, y (N) and torque about the centroid (N m)."""
    known = given()
    leg, (x, y, torque) = known["leg"], force
    size = math.hypot(x, y)
    arm = torque / size
    at = [leg / 3 + arm * y / size, leg / 3 - arm * x / size, 0.0]
    half = FOOT / 2
    blocks: dict[str, Any] = {
        f"foot{number}": {"low": [u - half, v - half, -0.01], "high": [u + half, v + half, 0.0]}
        for number, (u, v) in enumerate(known["supports"][support])
    }
    whole = {} if blocks else {"mesh": CELL}
    blocks = blocks or {"board": {"low": [-leg, -leg, -0.01], "high": [2 * leg, 2 * leg, 0.0]}}
    for each in blocks.values():
        each["fixed"] = True
    blocks["block"] = {
        "outline": [[0, 0, 0], [leg, 0, 0], [0, leg, 0]],
        "along": [0, 0, THICK],
        "density": known["mass"] / (0.5 * leg**2 * THICK),
    }
    friction = known["friction"][surface] / (known["mass"] * GRAVITY)
    load = {"force": {"block": "block", "at": at, "direction": [x / size, y / size, 0]}}
    return {"blocks": blocks, "interfaces": {"friction": friction}, "load": load, **whole}


def row(push: dict[str, Any]) -> dict[str, Any]:
    """What is found for a row of `pushes.csv`."""
    force = push["force_x_N"], push["force_y_N"], push["torque_Nm"]
    problem = structure_of(description(push["surface"], push["support"], force))
    size = math.hypot(*force[:2])
    static = static_peak(*problem).peak.load
    return {
        **{name: push[name] for name in ("surface", "support", "push")},
        "eccentricity_m": float(f"{abs(force[2]) / size:.4g}"),
        "measured_N": float(f"{size:.4g}"),
        "static_N": float(f"{static:.4g}"),
        "measured_over_static": float(f"{size / static:.4g}"),
    }


def pushes() -> list[dict[str, Any]]:
    """All rows of `pushes.csv`."""
    table = pd.read_csv(HERE / "pushes.csv")
    return [{str(k): v for k, v in each.items()} for each in table.to_dict("records")]


def by_eccentricity(table: pd.DataFrame) -> Iterator[tuple[float, float, pd.DataFrame]]:
    """Parts of a table between two eccentricities (m) of `CLASSES`."""
    for low, high in pairwise(CLASSES):
        e = table["eccentricity_m"]
        yield low, high, table[(e >= low) & (e < high)]


def compared(table: pd.DataFrame) -> Figure:
    """Measured over computed loads over the eccentricity, with medians."""
    figure = Figure(figsize=(7.5, 4.2), layout="constrained")
    axes = figure.add_subplot()
    face = table["support"].eq("whole face")
    for colour, (name, part) in enumerate((("on feet", table[~face]), ("whole face", table[face]))):
        look = {"ls": "none", "marker": ".", "ms": 4, "alpha": 0.5, "color": f"C{colour}"}
        axes.plot(1e3 * part["eccentricity_m"], part["measured_over_static"], **look)
        middles = [
            (1e3 * some["eccentricity_m"].median(), some["measured_over_static"].median())
            for _, _, some in by_eccentricity(part)
            if len(some)
        ]
        label = f"{name}: {len(part)} loads, medians"
        axes.plot(*np.array(middles).T, marker="o", color=f"C{colour}", label=label)
    axes.axhline(1.0, color="black", lw=0.8)
    axes.set(xlabel="eccentricity e = M / V (mm)", ylabel="measured / computed by the static model")
    axes.set_ylim(0.4, 2.5)
    axes.set_xlim(left=0)
    axes.legend()
    return figure


def in_short(results: Path) -> str:
    """Measured over static for a page: feet and whole faces by surface."""
    table, lines = table_in(results, CONTACTS), []
    table["kind"] = np.where(table["support"].eq("whole face"), "whole face", "three feet")
    for (surface, kind), part in table.groupby(["surface", "kind"]):
        ratio, load = part["measured_over_static"], part["measured_N"]
        lines.append(
            [
                str(surface),
                str(kind),
                str(len(part)),
                f"{load.min():.3g} to {load.max():.3g}",
                f"{ratio.median():.2f}",
                f"{ratio.mean():.2f} ± {ratio.std():.2f}",
            ]
        )
    head = ["board", "contact", "loads", "measured (N)", "measured / static, median"]
    return markdown([*head, "mean"], lines)


def in_classes(results: Path) -> str:
    """Medians of measured over static by eccentricity, for a page."""
    table = table_in(results, CONTACTS)
    face = table["support"].eq("whole face")
    lines = []
    both = zip(by_eccentricity(table[~face]), by_eccentricity(table[face]), strict=True)
    for (low, high, feet), (_, _, flat) in both:
        ends = f"over {1e3 * low:g}" if math.isinf(high) else f"{1e3 * low:g} to {1e3 * high:g}"
        cells = [[str(len(p)), f"{p['measured_over_static'].median():.2f}"] for p in (feet, flat)]
        lines.append([ends, *cells[0], *cells[1]])
    head = ["e (mm)", "loads on feet", "median", "loads on the face", "median"]
    return markdown(head, lines)


BLOCKS = {"contacts-short": in_short, "contacts-eccentricity": in_classes}


def main() -> None:
    """Command line: write the table and the figure, and print how they compare."""
    to = results_folder(__doc__)
    print(f"contacts: {given()['source']}", flush=True)
    with ProcessPoolExecutor() as processes:
        rows = [*processes.map(row, pushes(), chunksize=10)]
    table = pd.DataFrame(rows, columns=list(CONTACTS.columns))
    write_table(CONTACTS, table, to / "tables/contacts.csv")
    path = to / "figures/contacts.png"
    compared(table).savefig(path, dpi=150, metadata={"Software": None})
    print(in_short(to))


if __name__ == "__main__":
    main()
