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
from analysis.report.files import SCRIPTS, STYLE
from workflow.results import tables as forms
from workflow.results.tables import read_table
from workflow.schema import Study

HERE = Path(__file__).parent
CHECKOUT = HERE.parents[1]
PACKAGES = ("numpy", "scipy", "cvxpy", "pandas", "plotly", "snakemake")


def page(data: Mapping[str, Any], study: Study, summary: str) -> str:
    """The page as HTML."""
    files = FileSystemLoader(HERE)
    environment = Environment(loader=files, undefined=StrictUndefined, autoescape=True)
    # Data may hold whatever a configuration does: nothing in it ends the script it is in.
    text = json.dumps(data, separators=(",", ":"), allow_nan=False).replace("</", "<\\/")
    return environment.get_template("page.html.j2").render(
        data=text,
        plotly=get_plotlyjs(),
        style=(CHECKOUT / STYLE).read_text(),
        script="".join((CHECKOUT / script).read_text() for script in SCRIPTS),
        verdict=data["verdict"],
        tables=list(data["tables"]),
        summary=summary,
        configuration=study.model_dump_json(indent=1),
        versions=[("Python", platform.python_version()), *((p, version(p)) for p in PACKAGES)],
        samples=", ".join(study.samples),
    )


def run(
    arguments: Mapping[str, Any], inputs: Mapping[str, Path], outputs: Mapping[str, Path]
) -> None:
    """Write the page from the tables that it has in full, and the summary."""
    study = Study.model_validate_json(arguments["study"])
    tables = {
        name: read_table(getattr(forms, name.upper()), path)
        for name, path in inputs.items()
        if name != "summary"
    }
    data = content(study, tables, tuple(tables), outputs["page"].parent)
    outputs["page"].write_text(page(data, study, inputs["summary"].read_text()))
