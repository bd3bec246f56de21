"""What several tests need."""

import csv
import fcntl
import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

# Before numpy is imported: threads of linear algebra on small matrices only wait for each other.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
import pandas as pd
import pytest
from hypothesis import settings
from joints import sawn
from small import TWO_MESHES
from structures import WITH_STRUCTURES

from sidmacib import Assembly, FaceMaterial, Joint, Loading, Loads, NodeLayout
from sidmacib.engines import ENGINES, Numerics
from sidmacib.engines.render import assembly_data, engine_material
from sidmacib.engines.run import EngineError, engine_outcome
from sidmacib.engines.scripts.assembly import GivenAssembly, assembly_of
from sidmacib.engines.scripts.records import RESULT
from sidmacib.joint.pieces import lock_faces, shared_face
from sidmacib.mechanics.assembly import Cuboid, Kind
from sidmacib.mechanics.contact_nodes import contact_nodes
from sidmacib.mechanics.equilibrium import self_weight
from sidmacib.problem import Problem
from workflow import engine as engine_step
from workflow.case import Case, JointCase, JointSubject
from workflow.command import snakemake, snakemake_command
from workflow.configuration import read_study
from workflow.results import RECORD, read_records
from workflow.results.joint_part import JointRecord
from workflow.schema import Study

# Programs that tests start, and then ask to end, would inherit that nohup or a background job
# ignores these signals.
for number, usual in ((signal.SIGINT, signal.default_int_handler), (signal.SIGHUP, signal.SIG_DFL)):
    if signal.getsignal(number) is signal.SIG_IGN:
        signal.signal(number, usual)

# The same examples on every machine, and no limit on their time: that is for benchmarks.
settings.register_profile("repeatable", deadline=None, derandomize=True)
settings.load_profile("repeatable")

ROOT = Path(__file__).parents[1]
# `make` with this environment as it is: nothing is installed.
INSTALLED = ("make", "--old-file=.venv/study.ready", f"BIN={Path(sys.executable).parent}")
DISTINCT = tuple(name for name, engine in ENGINES.items() if not engine.elastic)  # rigid pieces


@pytest.fixture
def joint() -> Joint:
    return sawn(locks=3)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """Of the file of a structure."""
    return tmp_path / "structure.yaml"


@pytest.fixture(params=DISTINCT)
def engine(request: pytest.FixtureRequest) -> str:
    """Each engine of distinct elements."""
    return str(request.param)


def block_on_ground(joint: Joint, kind: Kind, mesh: float) -> Assembly:
    """One free block, a x b x h, on a fixed one, across a single face."""
    x = joint.a / 2
    mass = joint.density * joint.a * joint.b * joint.h
    pieces = (
        Cuboid("lower", (-x, 0.0, -joint.h), (x, joint.b, 0.0), mass, fixed=True),
        Cuboid("block", (-x, 0.0, 0.0), (x, joint.b, joint.h), mass),
    )
    material = joint.inner if kind is Kind.INNER else joint.dry
    faces = (shared_face("face", kind, material, pieces, (0, 1)),)
    return Assembly(pieces, faces, contact_nodes(faces, mesh, NodeLayout.CENTRES), joint.a)


def renumbered(assembly: Assembly) -> Assembly:
    """The same joint with its faces, and so its nodes, in reverse order."""
    order = np.arange(len(assembly.faces))[::-1]
    nodes = np.concatenate([np.flatnonzero(assembly.nodes.face == i) for i in order])
    return replace(
        assembly,
        faces=tuple(assembly.faces[i] for i in order),
        nodes=replace(
            assembly.nodes,
            face=np.argsort(order)[assembly.nodes.face[nodes]],
            position=assembly.nodes.position[nodes],
            area=assembly.nodes.area[nodes],
        ),
    )


def scaled(joint: Joint, length: float, stress: float) -> Joint:
    """The joint with lengths, and all that is a force or a stiffness per area, times these."""

    def of(face: FaceMaterial) -> FaceMaterial:
        factors = dict.fromkeys(("cohesion", "tensile_strength"), stress)
        factors |= dict.fromkeys(("normal_stiffness", "shear_stiffness"), stress / length)
        return replace(face, **{name: by * getattr(face, name) for name, by in factors.items()})

    sizes = {name: length * getattr(joint, name) for name in ("a", "b", "h", "H")}
    density = stress / length * joint.density
    return replace(joint, **sizes, density=density, inner=of(joint.inner), dry=of(joint.dry))


def as_read(assembly: Assembly, loads: Loads) -> GivenAssembly:
    """What a script of an engine reads of an assembly."""
    data = json.loads(json.dumps(assembly_data(assembly, loads)))
    names = [face["material"] for face in data["faces"]]
    laws = zip(names, assembly.faces, strict=True)
    return assembly_of(data, {name: engine_material(face.material) for name, face in laws})


def load_on_block(assembly: Assembly, force: tuple[float, float, float], moment_z: float) -> Loads:
    """Self-weight, and a force (N) and a moment (N m) on the free block; T0 as their scale."""
    variable = np.zeros((len(assembly.pieces), 6))
    variable[1] = [*force, 0.0, 0.0, moment_z]
    return Loads(self_weight(assembly.pieces), variable, sawn(3).T0)


def run_guided(
    name: str, problem: Problem, numerics: Numerics, folder: Path, time_limit: float
) -> None:
    """Run an engine as a study does, from the loads of the static model."""
    engine_outcome(ENGINES[name], problem, numerics, "what is tested", folder, time_limit)


@dataclass(frozen=True)
class CaseResult:
    """The results of an engine for a case: its record and its tables."""

    case: JointCase
    record: JointRecord
    nodes: pd.DataFrame
    history: pd.DataFrame

    peak_load = property(lambda self: self.record.load_N)
    shear = property(lambda self: self.record.part.shear_N)
    failed_load = property(lambda self: self.record.failed_load_N)
    first_failure_load = property(lambda self: self.record.first_failure_load_N)
    unbalanced_share = property(lambda self: self.record.unbalanced_share)

    @property
    def weights(self) -> pd.DataFrame:
        return pd.DataFrame([asdict(each) for each in self.record.part.weights])


def a_case(
    engine: str,
    joint: Joint,
    loading: Loading,
    mesh: float = 0.03,
    nodes: NodeLayout = NodeLayout.CENTRES,
    **numerics: float,
) -> JointCase:
    subject = JointSubject("n", joint, mesh, nodes, loading)
    return Case("case", engine, "reference", subject, Numerics(**numerics))


def with_subject(case: JointCase, **changes: Any) -> JointCase:
    """``case`` with ``changes`` of its subject."""
    return replace(case, subject=replace(case.subject, **changes))


@pytest.fixture(scope="session")
def made_once(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """What takes long, made by the first of all processes that test: a folder by its name.

    Nobody writes into it but ``make``; where that fails, the next one tries again.
    """
    place = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        place = place.parent  # which all of them share

    def made(name: str, make: Callable[[Path], object]) -> Path:
        folder, whole = place / name, place / f"{name}.whole"
        with (place / f"{name}.lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not whole.exists():
                shutil.rmtree(folder, ignore_errors=True)
                make(folder)
                whole.touch()
        return folder

    return made


@pytest.fixture
def run(made_once: Callable[..., Path]) -> Callable[[JointCase], CaseResult]:
    """Run a case, once in all tests: runs repeat to the byte."""

    def found(case: JointCase) -> CaseResult:
        name = hashlib.sha256(case.to_json().encode()).hexdigest()[:16]
        folder = made_once(f"case-{name}", partial(run_case, case))
        (record,) = read_records([folder / RECORD])
        nodes = pd.read_csv(folder / "nodes.csv")
        nodes["lock"] = nodes["face"].map(lock_faces(case.subject.joint)).fillna(0).astype(int)
        return CaseResult(case, record, nodes, pd.read_csv(folder / "history.csv"))

    return found


def run_case(case: JointCase, folder: Path) -> Path:
    """Run a case in ``folder``; returns it. Raises `EngineError` if there is no result."""
    folder.mkdir(parents=True, exist_ok=True)
    arguments = {"case": case.to_json(), "time_limit": 300.0, "last_try": 1}
    outputs = {"record": folder / RECORD, "result": folder / RESULT}
    fault = engine_step.run(arguments, {}, outputs)
    if fault is not None:
        raise EngineError(fault)
    return folder


@pytest.fixture(scope="module")
def served() -> Iterator[Any]:
    """The explorer, on a free port."""
    from explorer import explorer  # noqa: PLC0415 - few tests need it

    with explorer() as found:
        found.ask({})  # compiled
        found.post("/structure", {"page": "compiled", "number": 1, "values": {}})
        yield found


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """A real one, for pages."""
    from chromium import chromium  # noqa: PLC0415 - few tests need it

    with chromium() as opened:
        yield opened


def run_study(config: Mapping[str, Any], folder: Path, *targets: str) -> None:
    """Have Snakemake make ``targets`` of a study, whose results are in ``folder``."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "study.yaml"
    path.write_text(json.dumps(config))
    assert snakemake(path, str(folder), [f"{folder}/{name}" for name in targets])


def outputs_of(config: Mapping[str, Any], folder: Path) -> dict[str, list[str]]:
    """What a study makes, by rule, below its results; nothing is run. ``folder``: an empty one."""
    path = folder / "study.yaml"
    path.write_text(json.dumps(config))
    command = [*snakemake_command(path, str(folder)), "--summary"]
    found = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    outputs: dict[str, list[str]] = {}
    for row in csv.DictReader(found.splitlines(), delimiter="\t"):
        name = Path(row["output_file"]).relative_to(folder)
        outputs.setdefault(row["rule"], []).append(str(name))
    return outputs


@pytest.fixture(scope="session")
def solved_study(made_once: Callable[..., Path]) -> tuple[Study, Path]:
    """A study without engines, and its results but figures."""
    config = TWO_MESHES | {
        "samples": {"n3": {"locks": 3}, "n5": {"locks": 5}},
        "eccentricities": [0, 0.3, "torsion"],
        "models": ["static", "limit"],
        "sidmacib": {"reductions": ["none", "half", "lower_sum"]},
    }
    targets = "summary.txt", "report.html"
    return read_study(config), made_once("study", lambda to: run_study(config, to, *targets))


@pytest.fixture(scope="session")
def structures_study(made_once: Callable[..., Path]) -> Path:
    """Results of structures beside a joint, but figures."""
    vtk = "structures/vtk/trilith-load-static-blocks.vtu"  # made with all others
    targets = ".complete", "report.html", vtk
    return made_once("structures", lambda to: run_study(WITH_STRUCTURES, to, *targets))
