"""Run times on this machine, as a table: `make bench`.

With ``--base``, another checkout runs its own `make bench` first, in its environment; the table has
both for what is called the same there. CPU times are of all processes. Run it on a quiet machine.
"""

import argparse
import json
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import pandas as pd
import yaml

import sidmacib
from analysis.explore.pictures import answers, pictures
from analysis.explore.state import Settings
from analysis.tables.comparisons import best_pair
from benchmarks import seconds, used
from benchmarks.in_time import step_figures
from benchmarks.peers import armadillo_figures, peer_times
from benchmarks.scaling import wall_figures
from sidmacib.engines import ENGINES
from sidmacib.engines.scripts.records import RESULT
from sidmacib.joint import Direction, Joint, UpperBody
from sidmacib.joint.loading import Loading, posed
from sidmacib.mechanics.static import static_peak
from sidmacib.mechanics.static.peaks import lowest_peak
from sidmacib.problem import Problem
from sidmacib.rule import RULES, first_failure
from workflow.results import read_times
from workflow.sampling import sampled_joints, solved_rows
from workflow.schema.sections import SamplingSection
from workflow.step import ROOT

MESHES = [round(0.02 + 0.0002 * n, 4) for n in range(50)]
RATIOS = [round(0.02 * n, 2) for n in range(50)]
CURVE = [0, 0.05, 0.1, 0.2, 0.35, 0.5, 1, 2, float("inf")]  # e / a
DISTINCT = [name for name, engine in ENGINES.items() if not engine.elastic]
STATIC = {"models": ["static"], "dem": {"engines": []}}
ENGINE = {"models": [], "dem": {"engines": ["yade"]}}
TWO, FOUR = ({f"n{n}": {"locks": n} for n in some} for some in ((3, 5), (3, 5, 7, 9)))
PLANS = {
    "10,000 static cases": {**STATIC, "samples": FOUR, "meshes": MESHES, "eccentricities": RATIOS},
    "500 engine cases": {
        **ENGINE,
        **{"samples": TWO, "meshes": MESHES[:10], "eccentricities": RATIOS[:25]},
    },
    "5,000 engine cases": {**ENGINE, "samples": TWO, "meshes": MESHES, "eccentricities": RATIOS},
}
ONE = {"samples": {"n3": {"locks": 3}}, "meshes": [0.02], "eccentricities": [0]}


Lines = Iterator[tuple[str, str, float]]  # what was measured, its unit and its value


def columns(locks: int, **given: Any) -> Joint:
    """A joint as in the paper: its upper block is cut into columns."""
    return Joint(locks, upper_body=UpperBody.COLUMNS, **given)


def problem(joint: Joint, mesh: float = 0.02, ratio: float = 0.0) -> Problem:
    """A joint under V at ``ratio`` (e / a)."""
    return posed(joint, Loading(Direction(ratio)), mesh)


def numbered(number: int) -> Problem:
    """One of many joints of five locks."""
    return problem(columns(5, h=0.008 + 1e-5 * number), ratio=0.02 * (number % 50))


def static_load(number: int) -> float:
    """The peak (N) of one of many joints."""
    return static_peak(*numbered(number)).peak.load


def capacities(count: int) -> None:
    """Find the lowest peaks of many joints by the static model."""
    for number in range(count):
        lowest_peak(*numbered(number))


def library_figures() -> Lines:
    """The static model, SiDMACIB, law and safe rule."""
    static_load(0)  # compiles
    each = 1e3 * seconds(lambda: capacities(100)) / 100
    yield "static case with its lowest peak, 5 locks", "ms CPU", each
    with ProcessPoolExecutor(2) as pool:
        list(pool.map(static_load, range(20)))
        cases = partial(pool.map, static_load, range(1000), chunksize=50)
        spent = seconds(lambda: list(cases()), clock=time.perf_counter)
        yield "static cases, 5 locks", "1/s", 1000 / spent
    sampled = list(sampled_joints(SamplingSection(joints=512, seed=2026), columns(5), 1, 41))
    ratios = (0.0, 0.05, 0.1, 0.3, 1.0, 3.0, float("inf"))
    points = partial(solved_rows, sampled, ratios, cells=(1, 2), limited=41)
    spent = seconds(lambda: list(points())) / (len(sampled) * len(ratios))
    yield "static model, a point of make locks", "ms CPU", 1e3 * spent
    for locks, mesh, name in ((63, 0.02, "63 locks"), (15, 0.005, "15 locks, mesh 0.005 m")):
        solve = partial(
            lambda joint, mesh: static_peak(*problem(joint, mesh)), columns(locks), mesh
        )
        least = min(seconds(solve, clock=time.perf_counter) for _ in range(3))
        yield f"static case, {name}", "s", least
    elastic = sidmacib.Elastic(1e10, 0.2)
    for locks, mesh in ((2, 0.05), (5, 0.02), (11, 0.02), (5, 0.01)):  # the first compiles
        joint = Joint(locks, upper_body=UpperBody.MONOLITHIC, elastic=elastic)
        spent = seconds(lambda: static_peak(*problem(joint, mesh)))  # noqa: B023
        yield f"elastic pieces, {locks} locks, mesh {mesh:g} m", "CPU-s", spent
    for locks in (3, 5):
        for name, milliseconds in peer_times(columns(locks)):
            yield f"{name}, {locks} locks", "ms CPU", milliseconds
    envelope = partial(
        sidmacib.envelope, sidmacib.Sidmacib(columns(5), sidmacib.OPTIONS["option4"])
    )
    envelope()
    spent = seconds(envelope, 10, time.perf_counter)
    yield "SiDMACIB, envelope of 5 locks", "ms", 1e3 * spent
    loads = [*(400.0 / (1.0 + 3.0 * e) for e in CURVE[:-1]), 80.0]
    curve = pd.DataFrame({"eccentricity_over_a": CURVE, "load_N": loads})
    spent = seconds(lambda: best_pair(columns(5), 1000.0, True, curve))
    yield "fit of free contact points, 5 locks", "CPU-s", spent
    for name, locks in (("law", 5), ("safe", 5), ("law", 31), ("safe", 31)):
        first_failure.cache_clear()
        ways = iter([Direction(0.01 + 0.05 * number) for number in range(10)])
        spent = seconds(lambda: RULES[name](columns(locks), next(ways)), 10)  # noqa: B023
        yield f"{name}, {locks} locks", "CPU-s", spent
    first_failure.cache_clear()
    spent = seconds(lambda: [RULES["law"](columns(31), Direction(e)) for e in CURVE])
    yield "law, curve of 31 locks", "CPU-s", spent
    sliders = iter([Settings(locks=locks) for locks in range(2, 16)])
    spent = seconds(lambda: pictures(each := next(sliders), answers(each)), 14)
    yield "explorer, answer to a step of the slider", "CPU-s", spent


def written(config: Mapping[str, object], path: Path) -> Path:
    """The file of a configuration."""
    path.write_text(yaml.safe_dump(dict(config)))
    return path


def study(config: Mapping[str, object], folder: Path, name: str) -> list[str]:
    """The command that runs a study into a folder of its own."""
    path = written(config, folder / f"{name}.yaml")
    results = str(folder / name)
    return [sys.executable, "-m", "workflow", "study", str(path), "--results", results]


def process_figures(folder: Path) -> Lines:
    """Imports, planning, and studies: what the workflow adds, and a run with nothing to do."""
    for code in ("import numpy", "import sidmacib; sidmacib.Joint"):
        least = min(used([sys.executable, "-c", code], ROOT).cpu for _ in range(5))
        yield code.partition(";")[0], "CPU-s", least
    for name, config in PLANS.items():
        path = written(config, folder / f"{name.replace(' ', '-')}.yaml")
        command = [sys.executable, "-m", "snakemake", "-n", "--quiet", "all"]
        more = ["--configfile", str(path), "--config", f"results={folder / 'planned'}"]
        plan = used([*command, *more], ROOT)
        yield f"plan {name}", "s", plan.wall
        yield f"plan {name}", "MB", plan.memory
    one = study({**STATIC, **ONE}, folder, "one")
    used(one, ROOT)
    yield "make study with nothing to do", "s", used(one, ROOT).wall
    many = {**STATIC, "samples": {"n5": {"locks": 5}}, "meshes": MESHES[:10]}
    batch = study({**many, "eccentricities": RATIOS}, folder, "batch")
    used(batch, ROOT)
    alone = seconds(lambda: capacities(500))
    added = (job_seconds(folder / "batch", "static") - alone) / 500
    yield "added to a static case", "ms CPU", 1e3 * added
    for engine in DISTINCT:
        used(study({**ENGINE, **ONE, "dem": {"engines": [engine]}}, folder, engine), ROOT)
        yield f"a case of {engine}", "CPU-s", job_seconds(folder / engine, engine)
    case = [sys.executable, "-m", "analysis", "case", *one[4:], "--case", "n3-mesh0.02-e0a"]
    used(case, ROOT)
    yield "make case of a finished case", "s", used(case, ROOT).wall


def job_seconds(results: Path, kind: str) -> float:
    """CPU-s of a study's jobs of a kind, with the programs that they start."""
    return sum(cpu for found, _, cpu in read_times(results) if found == kind)


def study_figures(results: Path) -> Lines:
    """Times of a study's cases in their last run; time steps of guided and unguided searches."""
    times = pd.DataFrame(read_times(results), columns=["kind", "wall", "cpu"])
    if len(times):
        yield "study: all cases", "CPU-s", times["cpu"].sum()
        engines = times["kind"].isin(ENGINES)
        yield "study: cases in engines", "CPU-s", times.loc[engines, "cpu"].sum()
    for engine in DISTINCT:
        found = sorted((results / "cases" / engine).glob(f"*/{RESULT}"))
        steps = {path.parent.name: json.loads(path.read_text())["time_steps"] for path in found}
        both = [name for name in steps if f"{name}-unguided" in steps]
        for what, end in (("guided", ""), ("unguided", "-unguided")):
            if both:
                mean = sum(steps[name + end] for name in both) / len(both)
                yield f"{engine}: a case, {what}", "time steps", mean


def base_values(checkout: Path, folder: Path) -> pd.DataFrame:
    """The table of `make bench` of another checkout: columns what, unit, base."""
    # `make bench` here, with its variables, is no part of it.
    apart = [*("env", "-u", "MAKEFLAGS", "-u", "MAKELEVEL"), "BASE="]
    used([*apart, "make", "bench", f"RESULTS={folder}"], checkout)
    table = pd.read_csv(folder / "tables/bench.csv")
    return table[["what", "unit", "value"]].rename(columns={"value": "base"})


def main() -> None:
    """Command line: perhaps another checkout, and the results of a study that was run."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--base", type=Path, help="another checkout, which has a .venv")
    parser.add_argument("--results", type=Path, default=ROOT / "results")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        base = base_values(arguments.base, folder / "base") if arguments.base else None
        list(wall_figures(10))  # compiles
        blocks = (*wall_figures(1000), *step_figures(), *armadillo_figures())
        figures = [
            *process_figures(folder),
            *library_figures(),
            *blocks,
            *study_figures(arguments.results),
        ]
    table = pd.DataFrame(figures, columns=["what", "unit", "value"])
    if base is not None:
        table = table.merge(base, on=["what", "unit"], how="left")
        table["ratio"] = table["value"] / table["base"]
    path = arguments.results / "tables/bench.csv"
    path.parent.mkdir(parents=True, exist_ok=True)
    table.to_csv(path, index=False, float_format="%.4g")
    print(table.to_string(index=False, float_format=lambda value: f"{value:.4g}", na_rep=""))
    print(f"Table: {path}")


if __name__ == "__main__":
    main()
