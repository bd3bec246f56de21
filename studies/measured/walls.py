"""Compare loads that walls carried in laboratories with the static model.

    make measured

`walls.yaml` has the loads, with their sources. Nothing is fitted: sizes, forces and moduli are
those of the sources. Writes tables of loads and of cracks, and three figures: measured over
computed, forces over displacements beside curves that were measured, and cracks.
"""

import argparse
from collections.abc import Iterable, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Self

import pandas as pd
from matplotlib.figure import Figure
from pydantic import Field, model_validator

from sidmacib.answers.ask import limit_of
from sidmacib.answers.structure import static_answer
from sidmacib.mechanics.limit import LimitState
from sidmacib.quantities import Number
from sidmacib.reading import Section, Text
from sidmacib.structure.files.structure_file import structure_of
from sidmacib.yaml_text import read_yaml
from studies.markdown import markdown, markdown_of, table_in
from studies.measured.cracks import CRACKS, Cracked, cracks_figure
from workflow.results.tables import Table, write_table
from workflow.schema import with_changes

HERE = Path(__file__).parent
WALLS = Table(
    "walls",
    (
        *("campaign", "specimen", "kind", "direction", "failure", "measured_N", "static_N"),
        *("mesh_error_over_load", "limit_N", "measured_over_static"),
    ),
    ("campaign", "specimen", "direction"),
)
PUSHED, PULLED = "+", "-"
Load = Annotated[float, Number(above=0, unit="N")]


class Specimen(Section):
    """A wall that was tested."""

    kind: Text
    """the changes of the file that it needs"""
    loads: Annotated[tuple[Load, ...], Field(min_length=1, max_length=2)]
    """the largest load in each direction in which it was pushed"""
    failure: Text
    """as reported"""
    crack: tuple[Annotated[float, Number(at_least=0, unit="m")], ...] = ()
    """how far from the toe, course by course from the lowest"""


class Campaign(Section):
    """Tests of one campaign on walls alike."""

    file: Text
    """the structure, beside this file"""
    source: Text
    """who tested, and where it was published"""
    read_in: Text
    """where the values were read"""
    assumed: Text
    """what the sources do not say"""
    kinds: dict[Text, dict[Text, Any]]
    """changes of the file by name"""
    specimens: dict[Text, Specimen]
    """by their names in the source"""

    @model_validator(mode="after")
    def _known(self) -> Self:
        for name, specimen in self.specimens.items():
            if specimen.kind not in self.kinds:
                allowed = f"one of {', '.join(self.kinds)}"
                raise ValueError(f"specimens.{name}.kind: {specimen.kind}; it must be {allowed}")
        return self


@dataclass(frozen=True)
class Computed:
    """What limit analysis and the static model find for a kind of wall.

    ``limit``, ``static``: in N; ``error``: mesh error of the second, over it. ``path``: of the
    static model, displacements (m) and loads (N).
    """

    limit: float
    static: float
    error: float | None
    path: tuple[tuple[float, float], ...]

    @classmethod
    def of(cls, description: Mapping[str, Any]) -> "Computed":
        """For the structure of a file."""
        problem = structure_of(description)
        limit = limit_of(problem)
        assert isinstance(limit, LimitState)  # they stand, and slide or rock under some load
        found = static_answer(problem, limit)
        path = tuple((point.displacement, point.load) for point in found.path)
        digits = float(f"{limit.load:.6g}"), float(f"{found.load:.6g}")
        return cls(*digits, found.mesh_error, path)


def campaigns(path: Path = HERE / "walls.yaml") -> dict[str, Campaign]:
    """The campaigns of a file; ValueError, in a line, for what is at fault."""
    return {name: Campaign.read(value, name) for name, value in read_yaml(path).items()}


def computed(campaign: Campaign, folder: Path = HERE) -> dict[str, Computed]:
    """What is found for each kind of wall."""
    file = read_yaml(folder / campaign.file)
    descriptions = [with_changes(file, changes) for changes in campaign.kinds.values()]
    with ProcessPoolExecutor() as processes:
        return dict(zip(campaign.kinds, processes.map(Computed.of, descriptions), strict=True))


def cracked(campaign: Campaign, folder: Path = HERE) -> list[Cracked]:
    """The walls whose crack is known."""
    file = read_yaml(folder / campaign.file)
    return [
        Cracked.of(name, with_changes(file, campaign.kinds[tested.kind]), tested.crack)
        for name, tested in campaign.specimens.items()
        if tested.crack
    ]


def rows(name: str, campaign: Campaign, found: Mapping[str, Computed]) -> Iterable[dict[str, Any]]:
    """A row of `WALLS` for each load that was measured."""
    for specimen, tested in campaign.specimens.items():
        answer = found[tested.kind]
        for direction, load in zip((PUSHED, PULLED), tested.loads, strict=False):
            yield {
                "campaign": name,
                "specimen": specimen,
                "kind": tested.kind,
                "direction": direction,
                "failure": tested.failure,
                "measured_N": load,
                "static_N": answer.static,
                "mesh_error_over_load": answer.error,
                "limit_N": answer.limit,
                "measured_over_static": float(f"{load / answer.static:.4g}"),
            }


# --- figures -------------------------------------------------------------------------------------
def compared(table: pd.DataFrame) -> Figure:
    """Measured over computed loads of each specimen, with the mesh error of what is computed."""
    figure = Figure(figsize=(7.5, 5.2), layout="constrained")
    axes = figure.add_subplot()
    names = list(dict.fromkeys(table["specimen"]))
    for colour, (campaign, part) in enumerate(table.groupby("campaign", sort=False)):
        for direction, marker in ((PUSHED, "o"), (PULLED, "s")):
            some = part[part["direction"].eq(direction)]
            if some.empty:
                continue
            ratio = some["measured_over_static"]
            axes.errorbar(
                ratio,
                [names.index(each) for each in some["specimen"]],
                xerr=ratio * some["mesh_error_over_load"],
                fmt=marker,
                color=f"C{colour}",
                markerfacecolor=f"C{colour}" if direction == PUSHED else "none",
                label=campaign if direction == PUSHED else f"{campaign}, pulled back",
            )
    axes.axvline(1.0, color="black", lw=0.8)
    axes.set_yticks(range(len(names)), names)
    axes.invert_yaxis()
    axes.set_xlabel("measured / computed by the static model; right of 1 the computed load is safe")
    axes.legend(loc="center right")
    return figure


def followed(curves: pd.DataFrame, every: Mapping[str, tuple[Campaign, Any]]) -> Figure:
    """Forces over displacements: measured, and the path of the static model to its peak."""
    shown = [name for name, (campaign, _) in every.items() if _kinds(campaign, curves)]
    figure = Figure(figsize=(10.5, 4.3), layout="constrained")
    for number, name in enumerate(shown, start=1):
        axes = figure.add_subplot(1, len(shown), number)
        campaign, found = every[name]
        for colour, (kind, specimens) in enumerate(_kinds(campaign, curves).items()):
            for specimen in specimens:
                curve = curves[curves["specimen"].eq(specimen)]
                axes.plot(curve["displacement_mm"], curve["force_kN"], color=f"C{colour}", lw=0.7)
            moved, carried = zip(*found[kind].path, strict=True)
            look = {"color": f"C{colour}", "lw": 2.2, "ls": "--", "label": f"{kind} on top"}
            axes.plot([1e3 * each for each in moved], [each / 1e3 for each in carried], **look)
        axes.set(title=f"{name}: measured, computed (dashed)", xlim=(0, 25))
        axes.set(xlabel="displacement (mm)", ylabel="force (kN)")
        axes.set_ylim(0, None)
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=4, fontsize=8)
    return figure


def _kinds(campaign: Campaign, curves: pd.DataFrame) -> dict[str, list[str]]:
    """Specimens with a curve, by their kind."""
    found: dict[str, list[str]] = {}
    known = set(curves["specimen"])
    for name, specimen in campaign.specimens.items():
        if name in known:
            found.setdefault(specimen.kind, []).append(name)
    return found


# --- pages ---------------------------------------------------------------------------------------
def in_markdown(results: Path) -> str:
    """The table for a page: a row for each kind of wall."""
    table, lines = table_in(results, WALLS), []
    for (campaign, kind), part in table.groupby(["campaign", "kind"], sort=False):
        ratio = part["measured_over_static"]
        values = ", ".join(f"{value / 1e3:.4g}" for value in part["measured_N"])
        first = part.iloc[0]
        spread = f"{ratio.min():.2f}" + (f" to {ratio.max():.2f}" if len(ratio) > 1 else "")
        computed = f"{first['static_N'] / 1e3:.3g}", f"{first['limit_N'] / 1e3:.3g}"
        lines.append([str(campaign), str(kind), *computed, values, spread])
    head = ["wall", "on top", "static (kN)", "limit analysis (kN)", "measured (kN)"]
    return markdown([*head, "measured / static"], lines)


def in_short(results: Path) -> str:
    """Measured over static for a page: a row for each campaign."""
    lines = []
    for campaign, part in table_in(results, WALLS).groupby("campaign", sort=False):
        ratio = part["measured_over_static"]
        counts = str(part["specimen"].nunique()), str(len(ratio))
        spread = f" ± {ratio.std():.2f}" if len(ratio) > 1 else ""
        mean = f"{ratio.mean():.2f}{spread}"
        lines.append([str(campaign), *counts, mean, f"{ratio.min():.2f} to {ratio.max():.2f}"])
    head = ["walls", "tested", "measured loads", "measured / static, mean", "least to largest"]
    return markdown(head, lines)


def sources(_: Path) -> str:
    """The sources for a page."""
    table = pd.DataFrame(
        [{"campaign": name, **each.model_dump()} for name, each in campaigns().items()]
    )
    return markdown_of(
        table,
        {
            "walls": lambda row: row.campaign,
            "source": lambda row: row.source,
            "read in": lambda row: row.read_in,
            "assumed": lambda row: row.assumed,
        },
    )


def in_cracks(results: Path) -> str:
    """The cracks for a page: a row for each wall, measured and computed."""
    lines = []
    for specimen, part in table_in(results, CRACKS).groupby("specimen", sort=False):
        for what, column in (("crack", "crack_m"), ("computed", "computed_m")):
            lines.append([str(specimen), what, *(f"{value:.2f}" for value in part[column])])
    most = max(len(line) for line in lines) - 2
    return markdown(["wall", "m from the toe", *(f"course {k + 1}" for k in range(most))], lines)


BLOCKS = {
    "walls-cracks": in_cracks,
    "walls-measured": in_markdown,
    "walls-short": in_short,
    "walls-sources": sources,
}


def results_folder(words: str | None) -> Path:
    """The folder that the command line names, with folders for tables and figures.

    ``words``: what the command does.
    """
    parser = argparse.ArgumentParser(description=words)
    parser.add_argument("--results", type=Path, default=Path("results-measured"))
    to: Path = parser.parse_args().results
    for folder in ("tables", "figures"):
        (to / folder).mkdir(parents=True, exist_ok=True)
    return to


def main() -> None:
    """Command line: write the table and the figures, and print how they compare."""
    to = results_folder(__doc__)
    every = {}
    for name, campaign in campaigns().items():
        print(f"{name}: {campaign.source}", flush=True)
        every[name] = campaign, computed(campaign)
    lines = [
        row for name, (campaign, found) in every.items() for row in rows(name, campaign, found)
    ]
    table = pd.DataFrame(lines, columns=list(WALLS.columns))
    write_table(WALLS, table, to / "tables/walls.csv")
    compared(table).savefig(to / "figures/measured.png", dpi=150, metadata={"Software": None})
    curves = pd.read_csv(HERE / "curves.csv")
    followed(curves, every).savefig(to / "figures/curves.png", dpi=150, metadata={"Software": None})
    walls = [wall for campaign, _ in every.values() for wall in cracked(campaign)]
    table = pd.DataFrame([row for wall in walls for row in wall.rows])
    write_table(CRACKS, table, to / "tables/cracks.csv")
    cracks_figure(walls).savefig(to / "figures/cracks.png", dpi=150, metadata={"Software": None})
    print(in_short(to))
    print(f"Tables: {to}/tables; figures: {to}/figures")


if __name__ == "__main__":
    main()
