"""Write the report: data, styles and scripts in one file, with the plotting library inside."""

import json
import platform
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from plotly.offline import get_plotlyjs

from analysis.report.content import content
from analysis.report.files import PARTS, SCRIPTS, SCRIPTS_OF_PARTS, STYLE
from workflow.results import tables as forms
from workflow.results.tables import read_table
from workflow.schema import Study
from workflow.structures.case import StructureCase

HERE = Path(__file__).parent
CHECKOUT = HERE.parents[1]
PACKAGES = ("numpy", "scipy", "cvxpy", "pandas", "plotly", "snakemake")
SUMMARIES = ("summary", "structure_summary")
SECTIONS = {  # of each part, as in its template
    "joints": (
        ("curves", "V\N{EN DASH}M curves"),
        ("weights", "Weights"),
        ("stresses", "Stresses"),
        ("joint", "Joint"),
        ("law", "Law"),
        ("models", "Models"),
    ),
    "structures": (("structures", "Structures"),),
}


def page(data: Mapping[str, Any], configuration: str, summary: str) -> str:
    """The page as HTML, with the parts that there are ``data`` for."""
    files = FileSystemLoader(HERE)
    environment = Environment(loader=files, undefined=StrictUndefined, autoescape=True)
    # Data may hold whatever a configuration does: nothing in it ends the script it is in.
    text = json.dumps(data, separators=(",", ":"), allow_nan=False).replace("</", "<\\/")
    parts = [part for part in PARTS if part in data]
    scripts = (*SCRIPTS, *(SCRIPTS_OF_PARTS[part] for part in parts))
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
        versions=[("Python", platform.python_version()), *((p, version(p)) for p in PACKAGES)],
        names=", ".join(data["names"]),
    )


def run(
    arguments: Mapping[str, Any], inputs: Mapping[str, Path], outputs: Mapping[str, Path]
) -> None:
    """Write the page from the tables that it has in full, and the summaries.

    ``arguments``: ``study`` as JSON, None without joints; ``structures``: the sections of that name
    as JSON, None without any; ``cases``: one of each structure, load and variant.
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
    configuration = {} if study is None else study.model_dump(mode="json")
    if arguments["structures"] is not None:
        configuration |= json.loads(arguments["structures"])
    summaries = [inputs[name].read_text() for name in SUMMARIES if name in inputs]
    outputs["page"].write_text(
        page(data, json.dumps(configuration, indent=1), "\n".join(summaries))
    )
