"""Find geometry and friction that fit the published numbers: ``make calibrate``.

The static model solves a grid of joints, then engines confirm the best of them. Each step is a
separate study in the results folder, whose configuration is written here.
"""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd
import yaml

from analysis.calibration.candidates import (
    Trial,
    best_rows,
    candidate_of,
    candidate_study,
    candidates,
    check,
    curve_study,
    curve_table,
    describe,
    engine_study,
    friction_table,
    misfit_table,
    study_candidates,
)
from analysis.calibration.figure import calibration
from analysis.figures import style
from analysis.published import read_published
from workflow.configuration import read_study_file
from workflow.results.tables import CASES, WEIGHTS, read_table
from workflow.schema import Study

Snakemake = Callable[[Path, str, Sequence[str]], bool]


def calibrate(config: Path, results: str | None, snakemake: Snakemake) -> str | None:
    """Write map, curves, figures and best joints; returns what failed, None if nothing did."""
    study = read_study_file(config, results)
    published = read_published()
    locks = check(study, published)
    place = Path(study.results, "calibration")
    of_study = {f"own{n}": each for n, each in enumerate(study_candidates(study, published))}

    def done(name: str, content: Mapping[str, Any]) -> Tables | None:
        return run_study(place / f"{name}.yaml", content, snakemake)

    every = {f"g{n:05}": each for n, each in enumerate(candidates(study, published))} | of_study
    tables = done("map", candidate_study(study, locks, every, str(place / "map")))
    if tables is None:
        return "the map of joints is incomplete, see above"
    table = misfit_table(*tables, published)
    write(table, place / "map.csv")
    grid = table[~table["candidate"].isin(of_study)]
    frictions = friction_table(grid)
    write(frictions, place / "friction.csv")

    best = [candidate_of(row) for _, row in best_rows(grid).iterrows()]
    chosen = of_study | ranked(best)
    tables = done("curves", curve_study(study, locks, chosen, str(place / "curves")))
    if tables is None:
        return "the curves are incomplete, see above"
    curves = curve_table(tables[0], tables[1])
    write(curves, place / "curves.csv")
    own = table[table["candidate"].isin(of_study)]
    for name, figure in calibration(grid, own, curves, published).items():
        paths = [Path(study.results, f"figures/{name}.{kind}") for kind in ("png", "pdf")]
        style.save(figure, paths)

    chosen = of_study | ranked(best[: study.calibration.confirmed])
    content = engine_study(study, locks, chosen, str(place / "best"))
    tables = done("best", content)
    if tables is None:
        return "the confirmation is incomplete, see above"
    confirmed = misfit_table(*tables, published)
    write(confirmed, Path(study.results, "tables/calibration.csv"))
    print(describe(confirmed, frictions, published), end="")
    return None


Tables = tuple[Study, pd.DataFrame, pd.DataFrame]


def ranked(best: Sequence[Trial]) -> dict[str, Trial]:
    """Candidates by rank."""
    return {f"rank{rank}": each for rank, each in enumerate(best, start=1)}


def run_study(path: Path, content: Mapping[str, Any], snakemake: Snakemake) -> Tables | None:
    """Write a configuration, run its cases, and return the study with its cases and weights."""
    path.parent.mkdir(parents=True, exist_ok=True)
    text = yaml.safe_dump(dict(content), sort_keys=False)
    if not path.is_file() or path.read_text() != text:
        path.write_text(text)
    study = read_study_file(path)
    tables = [Path(study.results, f"tables/{name}.csv") for name in ("cases", "weights")]
    if not snakemake(path, study.results, [str(table) for table in tables]):
        return None
    return study, read_table(CASES, tables[0]), read_table(WEIGHTS, tables[1])


def write(rows: pd.DataFrame, path: Path) -> None:
    """Write a table of the calibration."""
    path.parent.mkdir(parents=True, exist_ok=True)
    rows.to_csv(path, index=False, float_format="%.10g")
