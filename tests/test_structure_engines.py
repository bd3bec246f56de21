"""What distinct elements must find for structures of blocks. Real runs, small ones."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import DISTINCT, run_guided
from scipy.spatial.transform import Rotation
from structures import dry, moved

from sidmacib.engines import ENGINES
from sidmacib.engines.execute import EngineNoAnswerError
from sidmacib.engines.numerics import Numerics
from sidmacib.engines.render import DATA_FILE, write_script
from sidmacib.mechanics.assembly import Assembly, FaceMaterial, Loads, NodeLayout
from sidmacib.mechanics.equilibrium import unbalanced_share
from sidmacib.mechanics.static.model import static_peak
from sidmacib.outcome import Outcome
from sidmacib.problem import Problem
from sidmacib.structure.analysis.tilt import Tilt, static_tilt, tilt_of_load, tilting
from sidmacib.structure.blocks import box
from sidmacib.structure.loads import acceleration
from sidmacib.structure.locks import ALL, Condensed, Locks
from sidmacib.structure.structure import structure
from studies.structures.shapes import arch
from workflow.results.files import read_outcome

MORTAR = FaceMaterial(1e10, 1e10, 0.4, cohesion=2e4, tensile_strength=1e4)


@pytest.fixture(params=DISTINCT)
def engine(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def leaning(law: FaceMaterial, angle: float) -> Assembly:
    """Two blocks on a fixed one, turned by an angle in degrees about an axis that is oblique."""
    axis = np.array([0.3, 1.0, 0.2])
    turn = Rotation.from_rotvec(math.radians(angle) * axis / np.linalg.norm(axis))
    blocks = [
        box("ground", (-0.3, -0.3, -0.2), (0.3, 0.3, 0.0), 2e3, fixed=True),
        box("one", (-0.2, -0.15, 0.0), (0.2, 0.15, 0.3), 2e3),
        box("two", (-0.2, -0.15, 0.3), (0.2, 0.15, 0.5), 2e3),
    ]
    return structure(
        [moved(each, turn, (0.1, 0.2, 0.3)) for each in blocks], law, nodes=NodeLayout.VERTICES
    )


def pushed(assembly: Assembly) -> Problem:
    return Problem(assembly, acceleration(assembly, (1.0, 0.3, 0.0)))


def found(engine: str, problem: Problem, folder: Path) -> Outcome:
    run_guided(engine, problem, Numerics(), folder, 300)
    return read_outcome(folder, problem.assembly)


@pytest.mark.engine
def test_mortar_in_a_leaning_stack_fails_where_the_static_model_says(
    engine: str, tmp_path: Path
) -> None:
    problem = pushed(leaning(MORTAR, 25.0))
    expected, outcome = static_peak(*problem), found(engine, problem, tmp_path)
    assert outcome.path[-1].load == pytest.approx(expected.peak.load, rel=2e-3)
    assert outcome.first_failure_load == pytest.approx(expected.first_failure_load, rel=2e-3)
    assert outcome.mode == "bonds"


@pytest.mark.engine
def test_a_stack_tilts_as_far_as_the_static_model_says(engine: str, tmp_path: Path) -> None:
    model, tilt = leaning(MORTAR, 0.0), Tilt((0.2, 1.0, 0.3))
    expected = static_tilt(model, tilt)
    problem = Problem(model, tilting(model, tilt))
    outcome, weight = found(engine, problem, tmp_path), problem.loads.scale
    assert tilt_of_load(outcome.path[-1].load, weight) == pytest.approx(expected.angle, rel=2e-3)
    if outcome.first_failure_load is not None:
        first = tilt_of_load(outcome.first_failure_load, weight)
        assert first == pytest.approx(expected.first_failure, rel=2e-3)
    peak = outcome.path[-1]
    assert peak.force is not None
    assert unbalanced_share(*problem, peak.load, peak.force) < 2e-3


@pytest.mark.engine
def test_what_never_falls_has_no_critical_tilt(engine: str, tmp_path: Path) -> None:
    glued = FaceMaterial(1e10, 1e10, 0.4, cohesion=1e9, tensile_strength=1e9)
    model = leaning(glued, 0.0)
    with pytest.raises(EngineNoAnswerError, match="in equilibrium up to a tilt of 180 degrees"):
        found(engine, Problem(model, tilting(model, Tilt((0.0, 1.0, 0.0)))), tmp_path)


@pytest.mark.engine
def test_compression_does_not_strengthen_the_bond_of_a_rough_face(
    engine: str, tmp_path: Path
) -> None:
    blocks = [
        box("ground", (0.0, 0.0, -0.2), (0.4, 0.4, 0.0), 2e3, fixed=True),
        box("block", (0.0, 0.0, 0.0), (0.4, 0.4, 0.1), 1e5),
    ]
    rough = replace(MORTAR, friction=1.0, tensile_strength=1e6)
    assembly = structure(blocks, rough)
    weight = assembly.pieces[1].weight
    variable = np.zeros((2, 6))
    variable[1, 0] = 1.0
    variable[1, 4] = -0.05  # at the face's height
    permanent = np.zeros((2, 6))
    permanent[1, 2] = -0.1 * weight
    problem = Problem(assembly, Loads(permanent, variable, weight))
    outcome = found(engine, problem, tmp_path)
    cohesion = rough.cohesion * 0.4 * 0.4
    assert 0.1 * weight > 0.4 * cohesion  # friction would be seen
    assert outcome.first_failure_load == pytest.approx(cohesion, rel=2e-3)


@pytest.mark.engine
@pytest.mark.parametrize(
    ("law", "close"),
    [(dry(0.7), 5e-3), (replace(MORTAR, cohesion=5e4, tensile_strength=2e4), 0.01)],
)
def test_an_arch_carries_what_the_static_model_says(
    tmp_path: Path, law: FaceMaterial, close: float
) -> None:
    problem = pushed(structure(arch(5, 0.25), law))
    expected, outcome = static_peak(*problem), found("yade", problem, tmp_path)
    assert outcome.path[-1].load == pytest.approx(expected.peak.load, rel=close)


# --- what is written for the engines ------------------------------------------------------------
def test_faces_in_any_direction_have_their_normal_and_tangents(tmp_path: Path) -> None:
    problem = pushed(leaning(MORTAR, 25.0))
    write_script(ENGINES["yade"], *problem, Numerics(), "stack", tmp_path)
    data = json.loads((tmp_path / DATA_FILE).read_text())
    for face, written in zip(problem.assembly.faces, data["faces"], strict=True):
        axes = np.array([written["normal"], *written["tangents"]])
        assert axes == pytest.approx(face.axes)
        assert written["size_m"][0] == 0.0
        assert max(written["size_m"]) >= 0.4 - 1e-9
    assert all("low_m" not in piece for piece in data["pieces"])


def test_what_an_engine_cannot_do_is_refused_by_name(engine: str, tmp_path: Path) -> None:
    pair = frozenset(("one", "two"))
    blocks = [
        box("one", (0.0, 0.0, 0.0), (0.4, 0.4, 0.2), 2e3, fixed=True),
        box("two", (0.0, 0.0, 0.2), (0.4, 0.4, 0.4), 2e3),
    ]
    locks = Locks(3, 0.02, row=(0.0, 1.0, 0.0), condensed=Condensed(ALL))
    condensed = structure(blocks, dry(0.5), locked={pair: locks})
    with pytest.raises(EngineNoAnswerError, match=f"^{engine}: one-two has condensed locks"):
        found(engine, pushed(condensed), tmp_path)
    rough = structure(blocks, replace(MORTAR, bond_friction=0.5))
    with pytest.raises(EngineNoAnswerError, match=f"^{engine}: one-two has a bond_friction of 0.5"):
        found(engine, pushed(rough), tmp_path)
