"""Run times on this machine, as a table: `make bench`.

With ``--base``, another checkout runs its own `make bench` first, in its environment; the table has
both for what is called the same there. CPU times are of all processes. Run it on a quiet machine.
"""

import argparse
import json
import sys
import tempfile
import time
import timeit
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import pandas as pd
import yaml

from benchmarks.explorer import step_seconds
from benchmarks.peers import peer_times
from benchmarks.structures import armadillo_figures, wall_figures
from benchmarks.usage import Usage, used
from sidmacib.joint.joint import Direction, Joint
from sidmacib.joint.loading import Loading, lateral_load
from sidmacib.joint.pieces import assemble
from sidmacib.mechanics.static.lowest_peak import lowest_peak
from sidmacib.mechanics.static.model import static_peak
from sidmacib.problem import Problem
from workflow.engines import ENGINES as ALL_ENGINES
from workflow.engines.scripts.records import RESULT
from workflow.joints.sampling import Sampling, sampled_joints
from workflow.results.files import read_times
from workflow.run.closure import ROOT
from workflow.steps.sampling import solved_rows

REPEATS = 5
UNGUIDED = "unguided"  # the study's variant
MESHES = [round(0.02 + 0.0002 * n, 4) for n in range(50)]
RATIOS = [round(0.02 * n, 2) for n in range(50)]
SWEEP = {  # 10,000 cases of the static model
    "samples": {f"n{n}": {"locks": n} for n in (3, 5, 7, 9)},
    "meshes": MESHES,
    "eccentricities": RATIOS,
    "models": ["static"],
    "dem": {"engines": []},
}
CURVE = [0, 0.05, 0.1, 0.2, 0.35, 0.5, 1, 2, float("inf")]  # e / a
ENGINES = {  # 500 cases of an engine
    "samples": {"n3": {"locks": 3}, "n5": {"locks": 5}},
    "meshes": MESHES[:10],
    "eccentricities": RATIOS[:25],
    "models": [],
    "dem": {"engines": ["yade"]},
}
PLANS = {
    "10,000 static cases": SWEEP,
    "500 engine cases": ENGINES,
    "5,000 engine cases": {**ENGINES, "meshes": MESHES, "eccentricities": RATIOS},
}
ONE = {
    "samples": {"n3": {"locks": 3}},
    "meshes": [0.02],
    "eccentricities": [0],
    "models": ["static"],
}


@dataclass(frozen=True)
class Figure:
    """A line of the table: what was measured, its unit and its value."""

    what: str
    unit: str
    value: float


def least(command: Sequence[str], repeats: int) -> Usage:
    """The quickest of some runs of a command."""
    return min((used(command, ROOT) for _ in range(repeats)), key=lambda run: run.cpu)


def python(code: str) -> list[str]:
    """A command that runs ``code``."""
    return [sys.executable, "-c", code]


def snakemake(config: Path, *arguments: str) -> list[str]:
    """A command that runs Snakemake on a configuration."""
    return [
        *(str(Path(sys.executable).parent / "snakemake"), *arguments, "--quiet", "all"),
        *("--configfile", str(config), "--config", f"results={config.parent / 'results'}"),
    ]


def static_problem(number: int) -> Problem:
    """One of many joints of five locks, mesh 0.02 m."""
    joint = Joint(5, h=0.008 + 1e-5 * number)
    assembly = assemble(joint, 0.02)
    loading = Loading(Direction(0.02 * (number % 50)))
    return Problem(assembly, lateral_load(joint, assembly, loading))


def static_case(number: int) -> float:
    """The peak (N) of one of many joints."""
    return static_peak(*static_problem(number)).peak.load


def static_seconds(locks: int, mesh: float) -> float:
    """Time of the static model in pure shear, s: the least of three."""
    import sidmacib

    def solve() -> None:
        joint = sidmacib.Joint(locks)
        assembly = sidmacib.assemble(joint, mesh)
        loading = sidmacib.Loading(sidmacib.Direction(0.0))
        sidmacib.static_peak(assembly, sidmacib.lateral_load(joint, assembly, loading))

    return min(timeit.repeat(solve, repeat=3, number=1))


def capacity_seconds(cases: int) -> float:
    """CPU-s of a case of a study, with the search for its lowest peak: the mean."""
    start = time.process_time()
    for number in range(cases):
        lowest_peak(*static_problem(number))
    return (time.process_time() - start) / cases


def sampling_seconds(joints: int) -> float:
    """CPU-s a point of `make locks`: a joint in a direction, on two meshes; limit analysis apart.

    The mean of the ``joints`` after the first of its sampling, in seven directions.
    """
    ratios, sampling = (0.0, 0.05, 0.1, 0.3, 1.0, 3.0, float("inf")), Sampling(512, 2026)
    sampled = sampled_joints(sampling, Joint(5), 1, 1 + joints)
    start = time.process_time()
    points = list(solved_rows(sampled, ratios, cells=(1, 2), limited=joints + 1))
    return (time.process_time() - start) / len(points)


def library_figures() -> Iterator[Figure]:
    """The static model and SiDMACIB, in this process and in two."""
    import sidmacib

    static_case(0)
    yield Figure("static case with its lowest peak, 5 locks", "ms CPU", 1e3 * capacity_seconds(100))
    with ProcessPoolExecutor(2) as pool:
        list(pool.map(static_case, range(20)))
        start = time.perf_counter()
        list(pool.map(static_case, range(1000), chunksize=50))
        yield Figure("static cases, 5 locks", "1/s", 1000 / (time.perf_counter() - start))
    yield Figure("static model, a point of make locks", "ms CPU", 1e3 * sampling_seconds(40))
    yield Figure("static case, 63 locks", "s", static_seconds(63, 0.02))
    yield Figure("static case, 15 locks, mesh 0.005 m", "s", static_seconds(15, 0.005))
    for locks in (3, 5):
        for name, milliseconds in peer_times(sidmacib.Joint(locks)):
            yield Figure(f"{name}, {locks} locks", "ms CPU", milliseconds)
    model = sidmacib.Sidmacib(sidmacib.Joint(5), sidmacib.OPTIONS["option4"])
    sidmacib.envelope(model)
    start = time.perf_counter()
    for _ in range(10):
        sidmacib.envelope(model)
    yield Figure("SiDMACIB, envelope of 5 locks", "ms", 1e3 * (time.perf_counter() - start) / 10)
    yield Figure("fit of free contact points, 5 locks", "CPU-s", fit_seconds())
    for name, locks in (("law", 5), ("safe", 5), ("law", 31), ("safe", 31)):
        yield Figure(f"{name}, {locks} locks", "CPU-s", rule_seconds(name, locks))
    yield Figure("law, curve of 31 locks", "CPU-s", law_curve_seconds(31))
    seconds = step_seconds()
    if seconds is not None:
        yield Figure("explorer, a step of the slider", "CPU-s", seconds)


def fit_seconds() -> float:
    """CPU-s of a fit of the contact points' distance and strength to nine loads."""
    import sidmacib
    from analysis.tables.fit import best_pair

    loads = [400.0 / (1.0 + 3.0 * e) for e in CURVE[:-1]]
    curve = pd.DataFrame({"eccentricity_over_a": CURVE, "load_N": [*loads, 80.0]})
    start = time.process_time()
    best_pair(sidmacib.Joint(5), 1000.0, True, curve)
    return time.process_time() - start


def rule_seconds(name: str, locks: int) -> float:
    """CPU-s of the law or the safe rule in one direction, the mean of ten."""
    import sidmacib
    from sidmacib.rule.first_failure import first_failure
    from sidmacib.rule.law import RULES

    first_failure.cache_clear()
    joint = sidmacib.Joint(locks)
    start = time.process_time()
    for number in range(10):
        RULES[name](joint, sidmacib.Direction(0.01 + 0.05 * number))
    return (time.process_time() - start) / 10


def law_curve_seconds(locks: int) -> float:
    """CPU-s of the law in nine directions."""
    import sidmacib

    start = time.process_time()
    for e in CURVE:
        sidmacib.law(sidmacib.Joint(locks), sidmacib.Direction(e))
    return time.process_time() - start


def elastic_seconds(locks: int, mesh: float) -> float:
    """CPU-s of the static model for elastic pieces, one above all locks, in pure shear."""
    import sidmacib
    from sidmacib.joint.joint import UpperBody

    elastic = sidmacib.Elastic(1e10, 0.2)
    joint = sidmacib.Joint(locks, upper_body=UpperBody.MONOLITHIC, elastic=elastic)
    start = time.process_time()
    assembly = sidmacib.assemble(joint, mesh)
    loading = sidmacib.Loading(sidmacib.Direction(0.0))
    sidmacib.static_peak(assembly, sidmacib.lateral_load(joint, assembly, loading))
    return time.process_time() - start


def elastic_figures() -> Iterator[Figure]:
    """Pieces that bend: few and many locks, and a finer mesh."""
    elastic_seconds(2, 0.05)  # imports and compiles
    for locks, mesh in ((5, 0.02), (11, 0.02), (5, 0.01)):
        what = f"elastic pieces, {locks} locks, mesh {mesh:g} m"
        yield Figure(what, "CPU-s", elastic_seconds(locks, mesh))


def structure_figures() -> Iterator[Figure]:
    """A wall of 1,000 blocks, and the armadillo with compas_cra if it is installed."""
    list(wall_figures(10))  # compiles
    for what, unit, value in (*wall_figures(1000), *armadillo_figures()):
        yield Figure(what, unit, value)


def process_figures(folder: Path) -> Iterator[Figure]:
    """Imports and planning."""
    for what, code in (
        ("import numpy", "import numpy"),
        ("import sidmacib", "import sidmacib; sidmacib.Joint"),
    ):
        yield Figure(what, "CPU-s", least(python(code), REPEATS).cpu)
    for name, config in PLANS.items():
        path = folder / f"{name.replace(' ', '-')}.yaml"
        path.write_text(yaml.safe_dump(config))
        plan = used(snakemake(path, "-n"), ROOT)
        yield Figure(f"plan {name}", "s", plan.wall)
        yield Figure(f"plan {name}", "MB", plan.memory)


def workflow_figures(folder: Path) -> Iterator[Figure]:
    """Time that the workflow adds to the computations, and time of a run with nothing to do."""
    batch = {**SWEEP, "samples": {"n5": {"locks": 5}}, "meshes": MESHES[:10]}
    times = job_times(batch, folder / "batch", "static")
    start = time.process_time()
    for number in range(500):
        lowest_peak(*static_problem(number))
    alone = time.process_time() - start
    yield Figure("added to a static case", "ms CPU", 1e3 * (sum(times) - alone) / 500)
    for engine in ("yade", "liggghts"):
        times = job_times({**ONE, "dem": {"engines": [engine]}}, folder / engine, engine)
        yield Figure(f"a case of {engine}", "CPU-s", sum(times))
    path = folder / "one.yaml"
    path.write_text(yaml.safe_dump({**ONE, "dem": {"engines": []}}))
    target = str(folder / "one")
    command = [sys.executable, "-m", "workflow", "study", str(path), "--results", target]
    used(command, ROOT)
    yield Figure("make study with nothing to do", "s", used(command, ROOT).wall)
    command = [sys.executable, "-m", "analysis", "case", *command[4:], "--case", "n3-mesh0.02-e0a"]
    used(command, ROOT)
    yield Figure("make case of a finished case", "s", used(command, ROOT).wall)


def job_times(config: Mapping[str, object], folder: Path, kind: str) -> list[float]:
    """CPU-s of the jobs of a kind, with programs that they start, in a study run in ``folder``."""
    folder.mkdir()
    path = folder / "study.yaml"
    path.write_text(yaml.safe_dump(config))
    target = str(folder / "results/tables/cases.csv")
    used([*snakemake(path), "--", target], ROOT)
    return [cpu for found, _, cpu in read_times(folder / "results") if found == kind]


def study_figures(results: Path) -> Iterator[Figure]:
    """Times of a study's cases in their last run."""
    times = pd.DataFrame(read_times(results), columns=["kind", "wall", "cpu"])
    if len(times):
        yield Figure("study: all cases", "CPU-s", times["cpu"].sum())
        engines = times["kind"].isin(ALL_ENGINES)
        yield Figure("study: cases in engines", "CPU-s", times.loc[engines, "cpu"].sum())


def step_figures(results: Path) -> Iterator[Figure]:
    """Mean time steps of each engine, over the cases that were searched guided and unguided."""
    for engine in ("yade", "liggghts"):
        folder = results / "cases" / engine
        steps = {path.parent.name: time_steps(path) for path in sorted(folder.glob(f"*/{RESULT}"))}
        both = [name for name in steps if f"{name}-{UNGUIDED}" in steps]
        for what, names in (
            ("guided", both),
            ("unguided", [f"{name}-{UNGUIDED}" for name in both]),
        ):
            if names:
                mean = sum(steps[name] for name in names) / len(names)
                yield Figure(f"{engine}: a case, {what}", "time steps", mean)


def time_steps(result: Path) -> int:
    """Number of time steps that an engine took for its result."""
    return int(json.loads(result.read_text())["time_steps"])


def base_values(checkout: Path, folder: Path) -> pd.DataFrame:
    """What `make bench` of another checkout measures: columns what, unit, base."""
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
        figures = [
            *process_figures(folder),
            *library_figures(),
            *elastic_figures(),
            *structure_figures(),
            *workflow_figures(folder),
            *study_figures(arguments.results),
            *step_figures(arguments.results),
        ]
    table = pd.DataFrame(figures)
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
