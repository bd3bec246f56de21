"""What several tests need."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings

from analysis.reading import CaseResult, read_case
from sidmacib.discretisation import (
    Block,
    Discretisation,
    Face,
    Kind,
    Piece,
    contact_nodes,
)
from sidmacib.joint import Direction, Joint
from sidmacib.loading import Loading, PieceLoad
from workflow.cases import Case
from workflow.engines import ENGINES
from workflow.execute import execute
from workflow.render import DATA_FILE, joint_data, script, write_case
from workflow.study import Numerics

# The same examples on every machine, and no limit on their time: that is for benchmarks.
settings.register_profile("repeatable", deadline=None, derandomize=True)
settings.load_profile("repeatable")

ROOT = Path(__file__).parents[1]


@pytest.fixture
def joint() -> Joint:
    return Joint(locks=3)


def block_on_ground(joint: Joint, kind: Kind, mesh: float) -> Discretisation:
    """One free block, a x b x h, on a fixed one, across a single face."""
    x = joint.a / 2
    mass = joint.density * joint.a * joint.b * joint.h
    low, high = (-x, 0.0, 0.0), (x, joint.b, joint.h)
    pieces = (
        Piece("lower", Block.LOWER, (-x, 0.0, -joint.h), (x, joint.b, 0.0), mass, fixed=True),
        Piece("block", Block.UPPER, low, high, mass),
    )
    faces = (Face("face", kind, 0, 1, 2, low, (x, joint.b, 0.0), lock=1),)
    return Discretisation(joint, mesh, pieces, faces, contact_nodes(faces, mesh))


def renumbered(model: Discretisation) -> Discretisation:
    """The same joint with its faces, and so its nodes, in reverse order."""
    order = np.arange(len(model.faces))[::-1]
    nodes = np.concatenate([np.flatnonzero(model.nodes.face == i) for i in order])
    return replace(
        model,
        faces=tuple(model.faces[i] for i in order),
        nodes=replace(
            model.nodes,
            face=np.argsort(order)[model.nodes.face[nodes]],
            position=model.nodes.position[nodes],
            area=model.nodes.area[nodes],
        ),
    )


def load_on_block(force: tuple[float, float, float], moment_z: float) -> tuple[PieceLoad, ...]:
    return (PieceLoad(1, np.array(force), np.array([0.0, 0.0, moment_z])),)


@pytest.fixture
def run_block(tmp_path: Path) -> Callable[..., Path]:
    """Search the peak of a block on the ground; returns the folder of the results."""

    def run(
        name: str, model: Discretisation, loads: tuple[PieceLoad, ...], direction: Direction
    ) -> Path:
        engine, folder = ENGINES[name], tmp_path / "block"
        folder.mkdir()
        text = script(engine, "block", model, loads, Numerics(tolerance=5e-4))
        (folder / engine.script).write_text(text)
        (folder / DATA_FILE).write_text(json.dumps(joint_data(model, loads, direction)))
        execute(engine, folder, 120)
        return folder

    return run


def a_case(
    engine: str, joint: Joint, loading: Loading, mesh: float = 0.03, **numerics: float
) -> Case:
    return Case(
        name="case",
        model=engine,
        variant="reference",
        sample="n",
        joint=joint,
        mesh=mesh,
        loading=loading,
        numerics=Numerics(**numerics),
    )


@pytest.fixture
def run(tmp_path: Path) -> Callable[[Case], CaseResult]:
    folders = iter(range(100))
    return lambda case: read_case(run_case(case, tmp_path / str(next(folders))))


def run_case(case: Case, folder: Path) -> Path:
    """Run a case in ``folder``; returns it."""
    write_case(case, folder)
    execute(ENGINES[case.model], folder, 300)
    return folder
