"""Write the report: data, styles and scripts in one file, with the plotting library inside.

The data are those of joints, of structures, and what both have in common.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pandas as pd
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from plotly.offline import get_plotlyjs

from analysis.drawing.labels import SERIES, label_of
from analysis.report.joints import answer_content, joints_content, joints_verdict
from analysis.report.json_values import headings, json_table, words
from analysis.report.provenance import as_yaml, provenance
from analysis.report.structures import (
    structures_content,
    structures_verdict,
    supports_verdict,
    with_room,
)
from sidmacib.engines import ENGINES
from sidmacib.models import MODELS
from workflow.case import StructureCase
from workflow.results import tables as forms
from workflow.results.record import read_times
from workflow.results.tables import read_table
from workflow.schema import Study
from workflow.step import Arguments, Files, step

HERE = Path(__file__).parent
DRAWING = HERE.parents[1] / "sidmacib/scene"  # shared with the explorer and the command
SCRIPTS = (DRAWING / "chart.js", DRAWING / "parts.js", HERE / "report.js")
SCRIPTS_OF_PARTS = {  # each part has a template, too
    "joints": (HERE / "joints.js", HERE / "paths.js"),
    "structures": (DRAWING / "structure.js", HERE / "structures.js"),
}
ADDRESS = HERE / "address.js"  # the last one
SUMMARIES = ("summary", "structure_summary")
SECTIONS = {  # of each part, as in its template
    "joints": (
        ("stresses", "Load\N{EN DASH}displacement"),
        ("joint", "Joint in 3D"),
        ("convergence", "Convergence"),
        ("weights", "Weights"),
        ("curves", "All V\N{EN DASH}M curves"),
        ("law", "Effective locks"),
        ("models", "Engines"),
    ),
    "structures": (("structures", "Structures"),),
}


def page(data: Mapping[str, Any], configuration: str, summary: str) -> str:
    """The page as HTML, with the parts that there are ``data`` for.

    ``configuration``: as YAML. ``summary``: as text.
    """
    files = FileSystemLoader([HERE, DRAWING])
    environment = Environment(loader=files, undefined=StrictUndefined, autoescape=True)
    # Data may hold whatever a configuration does: nothing in it ends the script it is in.
    text = json.dumps(data, separators=(",", ":"), allow_nan=False).replace("</", "<\\/")
    parts = [part for part in SCRIPTS_OF_PARTS if part in data]
    own = (script for part in parts for script in SCRIPTS_OF_PARTS[part])
    scripts = (*SCRIPTS, *own, ADDRESS)
    return environment.get_template("page.html.j2").render(
        data=text,
        plotly=get_plotlyjs(),
        style=(DRAWING / "report.css").read_text(),
        script="".join(script.read_text() for script in scripts),
        parts=parts,
        sections=[section for part in parts for section in SECTIONS[part]],
        verdict=data["verdict"],
        tables=list(data["tables"]),
        summary=summary,
        configuration=configuration,
        answer=data.get("answer"),
        **data["provenance"],
        names=", ".join(data["names"]),
    )


def run(arguments: Arguments, inputs: Files, outputs: Files) -> None:
    """Write the page from the tables that it has in full, and the summaries.

    ``arguments``: ``study`` as JSON, None without joints; ``structures``: the sections of that name
    as JSON, None without any; ``cases``: one of each structure, load and variant;
    ``configuration``: the whole of it as JSON.
    """
    study = None
    if arguments["study"] is not None:
        study = Study.model_validate_json(arguments["study"])
    tables = {
        name: read_table(getattr(forms, name.upper()), path)
        for name, path in inputs.items()
        if name not in SUMMARIES
    }
    cases = [StructureCase.from_json(text) for text in arguments["cases"]]
    data = content(study, tables, cases, outputs["page"].parent)
    configuration = as_yaml(json.loads(arguments["configuration"]))
    summaries = [inputs[name].read_text() for name in SUMMARIES if name in inputs]
    outputs["page"].write_text(page(data, configuration, "\n".join(summaries)))


def content(
    study: Study | None,
    tables: Mapping[str, pd.DataFrame],
    structures: Sequence[StructureCase],
    results: Path,
) -> dict[str, Any]:
    """All data of the page.

    ``study``: None if it has no joints. ``structures``: a case of each structure, load and variant.
    """
    data: dict[str, Any] = {"labels": labels(), "series": SERIES, "times": times_of(results)}
    names, verdict, shown = [], [], dict(tables)
    if study is not None:
        names += list(study.samples)
        verdict += joints_verdict(tables, study)
        data["joints"] = joints_content(study, tables)
        data["answer"] = answer_content(study, tables)
    if structures:
        names += dict.fromkeys(case.subject.structure for case in structures)
        verdict += structures_verdict(tables["structures"], tables.get("verdicts"))
        if "supports" in tables:
            verdict += supports_verdict(tables["supports"])
        shown |= with_room(tables)
        data["structures"] = structures_content(structures, shown["blocks"], shown["interfaces"])
    failed = [
        tables[name]
        .loc[tables[name]["error"].notna(), ["model", column, "error"]]
        .set_axis(["model", "name", "error"], axis=1)
        for name, column in (("cases", "name"), ("structures", "case"))
        if name in tables
    ]
    return {
        **data,
        "provenance": provenance(study, tables),
        "names": names,
        "verdict": verdict,
        "tables": {name: json_table(table) for name, table in shown.items()},
        "headings": headings(shown),
        "words": words(shown),
        "failed": json_table(pd.concat(failed)),
    }


def labels() -> dict[str, dict[str, Any]]:
    """Name and colour of each model, and whether it is an engine, drawn with marks only."""
    return {name: {**asdict(label_of(name)), "engine": name in ENGINES} for name in MODELS}


def times_of(results: Path) -> list[list[Any]]:
    """Seconds of each kind of job: on the clock, of processors; how many there were."""
    times = pd.DataFrame(read_times(results), columns=["kind", "wall", "cpu"])
    return [
        [str(kind), len(rows), *(round(float(rows[each].sum()), 1) for each in ("wall", "cpu"))]
        for kind, rows in times.groupby("kind", sort=False)
    ]


if __name__ == "__main__":
    step(run)
