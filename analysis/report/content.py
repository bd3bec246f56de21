"""The report's data: those of joints, of structures, and what both have in common."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pandas as pd
from workflow.results.files import read_times

from analysis.drawing.labels import SERIES, label_of
from analysis.report.answer import answer_content
from analysis.report.headings import headings, words
from analysis.report.joints import joints_content, joints_verdict
from analysis.report.json_values import json_table
from analysis.report.provenance import provenance
from analysis.report.structures import (
    structures_content,
    structures_verdict,
    supports_verdict,
    with_room,
)
from sidmacib.engines import ENGINES
from sidmacib.models import MODELS
from workflow.case import StructureCase
from workflow.schema import Study


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
        verdict += structures_verdict(tables["structures"])
        if "supports" in tables:
            verdict += supports_verdict(tables["supports"])
        if "supports" in tables:
            verdict += supports_verdict(tables["supports"])
        shown |= with_room(tables)
        data["structures"] = structures_content(structures, shown["blocks"])
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
    totals: dict[str, list[float]] = {}
    for kind, wall, cpu in read_times(results):
        total = totals.setdefault(kind, [0.0, 0.0, 0.0])
        for position, value in enumerate((1.0, wall, cpu)):
            total[position] += value
    return [
        [kind, int(n), round(wall, 1), round(cpu, 1)] for kind, (n, wall, cpu) in totals.items()
    ]
