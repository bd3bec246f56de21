"""Find the geometry that fits the published numbers, by studies of many geometries.

The static model tries all geometries, then engines confirm the best. Each step is a study of its
own in the results folder; its configuration is written here.
"""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd
import yaml

from analysis.calibration import (
    best_rows,
    check,
    curve_study,
    curve_table,
    describe,
    engine_study,
    geometries,
    geometry_of,
    geometry_study,
    misfit_table,
)
from analysis.figures import style
from analysis.figures.calibration import calibration
from analysis.published import read_published
from workflow.configuration import installed_engines, read_study_file
from workflow.results.tables import CASES, WEIGHTS, read_table
from workflow.schema import Study
from workflow.schema.geometry import GeometrySection

Snakemake = Callable[[Path, str, Sequence[str], Sequence[str]], bool]


def calibrate(config: Path, results: str | None, snakemake: Snakemake) -> str | None:
    """Write map, curves, figure and best geometries; returns what failed, None if nothing did."""
    study = read_study_file(config, results)
    published = read_published()
    samples = check(study, published)
    place = Path(study.results, "calibration")

    def done(name: str, content: Mapping[str, Any], engines: Sequence[str]) -> Tables | None:
        return run_study(place / f"{name}.yaml", content, engines, snakemake)

    every = {f"g{n:04}": g for n, g in enumerate(geometries(study, published))}
    folder = str(place / "map")
    found = done("map", geometry_study(study, samples, every, folder), ())
    if found is None:
        return "the map of geometries is incomplete, see above"
    table = misfit_table(*found, published)
    write(table, place / "map.csv")

    best = [geometry_of(row) for _, row in best_rows(table.iloc[:-1]).iterrows()]
    ranked = named([study.geometry, *best])
    found = done("curves", curve_study(study, samples, ranked, str(place / "curves")), ())
    if found is None:
        return "the curves are incomplete, see above"
    curves = curve_table(found[0], found[1])
    write(curves, place / "curves.csv")
    figures = [Path(study.results, f"figures/calibration.{kind}") for kind in ("png", "pdf")]
    style.save(calibration(table, curves), figures)

    ranked = named([study.geometry, *best[: study.calibration.confirmed]])
    content = engine_study(study, samples, ranked, str(place / "best"))
    able = [name for name in installed_engines(study) if name in content["dem"]["engines"]]
    found = done("best", content, able)
    if found is None:
        return "the confirmation is incomplete, see above"
    confirmed = misfit_table(*found, published)
    write(confirmed, Path(study.results, "tables/calibration.csv"))
    print(describe(confirmed), end="")
    return None


Tables = tuple[Study, pd.DataFrame, pd.DataFrame]


def named(chosen: Sequence[GeometrySection]) -> dict[str, GeometrySection]:
    """Geometries by rank."""
    return {f"rank{rank}": geometry for rank, geometry in enumerate(chosen)}


def run_study(
    path: Path, content: Mapping[str, Any], engines: Sequence[str], snakemake: Snakemake
) -> Tables | None:
    """Write a configuration, run its cases, and return the study with its cases and weights."""
    path.parent.mkdir(parents=True, exist_ok=True)
    text = yaml.safe_dump(dict(content), sort_keys=False)
    if not path.is_file() or path.read_text() != text:
        path.write_text(text)
    study = read_study_file(path)
    tables = [Path(study.results, f"tables/{name}.csv") for name in ("cases", "weights")]
    if not snakemake(path, study.results, [str(table) for table in tables], engines):
        return None
    return study, read_table(CASES, tables[0]), read_table(WEIGHTS, tables[1])


def write(rows: pd.DataFrame, path: Path) -> None:
    """Write a table of the calibration."""
    path.parent.mkdir(parents=True, exist_ok=True)
    rows.to_csv(path, index=False, float_format="%.10g")
