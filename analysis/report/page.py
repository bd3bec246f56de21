"""Write the report: data, styles and scripts in one file, with the plotting library inside."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from plotly.offline import get_plotlyjs

from analysis.report.content import content
from analysis.report.files import ADDRESS, PARTS, SCRIPTS, SCRIPTS_OF_PARTS, SHARED, STYLE
from analysis.report.provenance import as_yaml
from workflow.case import StructureCase
from workflow.results import tables as forms
from workflow.results.tables import read_table
from workflow.schema import Study
from workflow.step import Arguments, Files, step

HERE = Path(__file__).parent
CHECKOUT = HERE.parents[1]
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
    files = FileSystemLoader([HERE, CHECKOUT / SHARED])
    environment = Environment(loader=files, undefined=StrictUndefined, autoescape=True)
    # Data may hold whatever a configuration does: nothing in it ends the script it is in.
    text = json.dumps(data, separators=(",", ":"), allow_nan=False).replace("</", "<\\/")
    parts = [part for part in PARTS if part in data]
    own = (script for part in parts for script in SCRIPTS_OF_PARTS[part])
    scripts = (*SCRIPTS, *own, ADDRESS)
    return environment.get_template("page.html.j2").render(
        data=text,
        plotly=get_plotlyjs(),
        style=(CHECKOUT / STYLE).read_text(),
        script="".join((CHECKOUT / script).read_text() for script in scripts),
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


if __name__ == "__main__":
    step(run)
