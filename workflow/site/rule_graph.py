"""The rules of a study as a drawing: `.venv/bin/python -m workflow.site.rule_graph FILE.svg`.

The graph is Snakemake's, as `snakemake --rulegraph` prints it; arrows that others imply are left
out. The layout is made here, as the program that Snakemake counts on (`dot`) may not be there.
"""

import re
import subprocess
import sys
from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from statistics import fmean

CHECKOUT = Path(__file__).parents[2]
NODE = re.compile(r"^\s*(\d+)\[label = \"([^\"]+)\"", re.M)
EDGE = re.compile(r"^\s*(\d+) -> (\d+)$", re.M)
BOX, GAP = (132, 34), (24, 34)  # of a rule and between rules, in px: across, down
BLUE, GREY = "#0072b2", "#6b7280"

Graph = Mapping[str, frozenset[str]]  # for each rule the rules that it takes files from


def rules() -> Graph:
    """The rules of the study of `config.yaml` with all engines; nothing runs."""
    done = subprocess.run(
        [sys.executable, "-m", "snakemake", "--rulegraph", "--forceall"],
        cwd=CHECKOUT,
        capture_output=True,
        text=True,
        check=True,
    )
    return read(done.stdout)


def read(text: str) -> Graph:
    """The graph in what ``snakemake --rulegraph`` prints."""
    names = dict(NODE.findall(text))
    edges = [(names[one], names[other]) for one, other in EDGE.findall(text)]
    return {
        name: frozenset(one for one, other in edges if other == name)
        for name in sorted(names.values())
    }


def before(graph: Graph, name: str) -> frozenset[str]:
    """All rules that must have run before rule ``name``."""
    return frozenset().union(*({one} | before(graph, one) for one in graph[name]))


def reduced(graph: Graph) -> Graph:
    """``graph`` without the arrows that a longer way implies."""
    return {
        name: frozenset(
            one
            for one in sources
            if not any(one in before(graph, other) for other in sources - {one})
        )
        for name, sources in graph.items()
    }


def ways(graph: Graph) -> list[tuple[str, ...]]:
    """The places of each arrow, a layer after the other: its rules, and names of gaps between.

    A rule is in the layer behind the last of its sources.
    """
    return [
        (one, *(f"{one}>{name}@{level}" for level in range(depth(graph, one) + 1, last)), name)
        for name in graph
        for last in [depth(graph, name)]
        for one in sorted(graph[name])
    ]


def depth(graph: Graph, name: str) -> int:
    """The number of rules on the longest way to ``name``."""
    return max((depth(graph, one) + 1 for one in graph[name]), default=0)


def layout(graph: Graph) -> dict[str, tuple[float, float]]:
    """The middle of each rule, and of the gaps that `ways` leads through, in px."""
    found: dict[str, tuple[float, float]] = {}
    steps = [(one, next_) for way in ways(graph) for one, next_ in pairwise(way)]
    row, level = [name for name in graph if not graph[name]], 0
    while row:
        widths = [BOX[0] if name in graph else 0 for name in row]
        left = -(sum(widths) + GAP[0] * (len(row) - 1)) / 2
        for name, width in zip(row, widths, strict=True):
            found[name] = left + width / 2, (BOX[1] + GAP[1]) * (level + 0.5)
            left += width + GAP[0]
        level += 1
        sources: dict[str, list[float]] = {}
        for one, name in steps:
            if one in row:
                sources.setdefault(name, []).append(found[one][0])
        row = sorted(sources, key=lambda name: (fmean(sources[name]), name))
    return found


def svg(graph: Graph) -> str:
    """The drawing, from the first rules down to the last."""
    middles = layout(graph)
    left = min(x for x, _ in middles.values()) - (BOX[0] + GAP[0]) / 2
    width = max(x for x, _ in middles.values()) + (BOX[0] + GAP[0]) / 2 - left
    height = max(y for _, y in middles.values()) + (BOX[1] + GAP[1]) / 2
    size = f'viewBox="{left:g} 0 {width:g} {height:g}" width="{width:g}" height="{height:g}"'
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" {size} font-family="sans-serif">',
            f'<marker id="tip" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="8" '
            f'markerHeight="8" orient="auto"><path d="M0 0L8 4L0 8z" fill="{GREY}"/></marker>',
            f'<rect x="{left:g}" width="{width:g}" height="{height:g}" fill="white"/>',
            *(_arrow([middles[place] for place in way]) for way in ways(graph)),
            *(_box(name, *middles[name]) for name in graph),
            "</svg>\n",
        ]
    )


def _arrow(places: list[tuple[float, float]]) -> str:
    """From below one box to above another, through the gaps between other boxes."""
    x, y = places[0]
    path, y = [f"M{x:g} {y + BOX[1] / 2:g}"], y + BOX[1] / 2
    for u, v in places[1:]:
        top, bend = v - BOX[1] / 2, (v - BOX[1] / 2 - y) / 2
        path.append(f"C{x:g} {y + bend:g} {u:g} {top - bend:g} {u:g} {top:g}")
        if (u, v) != places[-1]:
            path.append(f"V{v + BOX[1] / 2:g}")
        x, y = u, v + BOX[1] / 2
    line = f'fill="none" stroke="{GREY}" marker-end="url(#tip)"'
    return f'<path d="{"".join(path)}" {line}/>'


def _box(name: str, x: float, y: float) -> str:
    place = f'x="{x - BOX[0] / 2:g}" y="{y - BOX[1] / 2:g}" width="{BOX[0]}" height="{BOX[1]}"'
    return (
        f'<rect {place} rx="6" fill="white" stroke="{BLUE}"/>'
        f'<text x="{x:g}" y="{y + 5:g}" font-size="14" text-anchor="middle">{name}</text>'
    )


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(svg(reduced(rules())))
