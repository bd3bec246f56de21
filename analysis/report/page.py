"""Write the report: data, styles and scripts in one file, with the plotting library inside.

The data are those of joints, of structures, and what both have in common.
"""

import json
import platform
import subprocess
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pandas as pd
import yaml

from analysis.drawing import SERIES, label_of
from analysis.published import read_published
from analysis.report import finding, headings, json_table, words
from analysis.report.joints import answer_content, joints_content, joints_verdict, size_table
from analysis.report.structures import (
    structures_content,
    structures_verdict,
    supports_verdict,
    with_room,
)
from analysis.summary.earthquakes import lines
from sidmacib.engines import ENGINES
from sidmacib.models import MODELS
from sidmacib.scene.page import HERE as SCENE  # shared with the explorer and the command
from sidmacib.scene.page import plotly_js, rendered
from workflow.case import StructureCase
from workflow.results import read_times
from workflow.results.tables import read_tables
from workflow.schema import Study
from workflow.step import Arguments, Files, step

CHECKOUT = Path(__file__).parents[2]
PACKAGES = ("numpy", "scipy", "cvxpy", "pandas", "plotly", "snakemake")
HERE = Path(__file__).parent
SCRIPTS = (SCENE / "chart.js", SCENE / "parts.js", HERE / "report.js")
SCRIPTS_OF_PARTS = {  # each part has a template, too
    "joints": (HERE / "joints.js", HERE / "paths.js"),
    "structures": (SCENE / "structure.js", HERE / "structures.js"),
}
ADDRESS = SCENE / "address.js"  # the last one
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
    # Data may hold whatever a configuration does: nothing in it ends the script it is in.
    text = json.dumps(data, separators=(",", ":"), allow_nan=False).replace("</", "<\\/")
    parts = [part for part in SCRIPTS_OF_PARTS if part in data]
    own = (script for part in parts for script in SCRIPTS_OF_PARTS[part])
    scripts = (*SCRIPTS, *own, ADDRESS)
    return rendered(
        HERE / "page.html.j2",
        data=text,
        plotly=plotly_js(),
        style=(SCENE / "report.css").read_text(),
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
    """Write the page from the tables that it has in full, and the summary.

    ``arguments``: ``study`` as JSON, None without joints; ``cases``: one of each structure, load
    and variant; ``configuration``: the whole of it as JSON.
    """
    study = None
    if arguments["study"] is not None:
        study = Study.model_validate_json(arguments["study"])
    tables = read_tables(inputs)
    cases = [StructureCase.from_json(text) for text in arguments["cases"]]
    data = content(study, tables, cases, outputs["page"].parent)
    configuration = as_yaml(json.loads(arguments["configuration"]))
    outputs["page"].write_text(page(data, configuration, inputs["summary"].read_text()))


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
        told = tables.get("verdicts"), tables.get("measured_structures")
        verdict += structures_verdict(tables["structures"], *told)
        if "supports" in tables:
            verdict += supports_verdict(tables["supports"])
        shown |= with_room(tables)
        data["structures"] = structures_content(structures, shown["blocks"], shown["interfaces"])
    if "fragility" in tables:
        names += dict.fromkeys(tables["fragility"]["structure"])
        verdict += [finding(name, f"{words}.") for name, words in lines(tables["fragility"])]
    failed = [
        tables[name]
        .loc[tables[name]["error"].notna(), ["model", column, "error"]]
        .set_axis(["model", "name", "error"], axis=1)
        for name, column in (("cases", "name"), ("structures", "case"), ("earthquakes", "case"))
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


def versions_of(tables: Mapping[str, pd.DataFrame]) -> list[tuple[str, str]]:
    """Versions of the program, of engines by the records of cases, of Python and its packages."""
    project = tomllib.loads((CHECKOUT / "pyproject.toml").read_text())["project"]
    return [
        (project["name"], f"{project['version']}{commit()}"),
        *_engines(tables),
        ("Python", platform.python_version()),
        *((package, version(package)) for package in PACKAGES),
    ]


def commit() -> str:
    """The commit of this checkout, and whether files differ from it; empty without Git."""
    if not (CHECKOUT / ".git").exists():  # a folder above may be another project's
        return ""
    command = ("git", "-C", str(CHECKOUT), "describe", "--always", "--dirty=, changed since")
    try:
        found = subprocess.run(command, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return ""
    return f", commit {found.stdout.strip()}"


def _engines(tables: Mapping[str, pd.DataFrame]) -> Iterator[tuple[str, str]]:
    """Names and versions of the engines that cases of these tables were run with."""
    told = [tables[name]["versions"].dropna() for name in ("cases", "structures") if name in tables]
    for text in sorted({part.strip() for each in told for of in each for part in of.split(",")}):
        name, _, number = text.partition(" ")
        if name in ENGINES:
            yield ENGINES[name].label, number


def provenance(study: Study | None, tables: Mapping[str, pd.DataFrame]) -> dict[str, Any]:
    """Sizes, versions, and the paper with its DOI, each None if there are none; for the page."""
    published = read_published()
    paper, doi = None, None
    if study is not None and published.samples(study):
        paper, _, doi = str(published.numbers["source"]).partition(", doi:")
    return {
        "sizes": None if study is None else size_table(study),
        "versions": versions_of(tables),
        "date": f"{datetime.now(UTC):%Y-%m-%d}",
        "source": paper,
        "doi": doi,
    }


def as_yaml(configuration: Mapping[str, Any]) -> str:
    """The ``configuration`` as YAML that a study can be started with, without what has no value."""
    whole = _known(configuration)
    whole["samples"] = {
        name: {key: value for key, value in sample.items() if value != {}}
        for name, sample in whole.get("samples", {}).items()
    }
    for name, structure in whole.get("structures", {}).items():  # where null takes a key away
        structure["variants"] = configuration["structures"][name]["variants"]
    text = yaml.safe_dump(whole, sort_keys=False, allow_unicode=True, width=100)
    return "# A study of multilock, with all defaults.\n" + text


def _known(value: Any) -> Any:
    """Nested values without those that are None."""
    if isinstance(value, Mapping):
        return {key: _known(each) for key, each in value.items() if each is not None}
    return value


if __name__ == "__main__":
    step(run)
