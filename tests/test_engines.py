"""What distinct elements must find, against theory and the static model. Real runs, small ones."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from command_runner import answers
from conftest import a_case, block_on_ground, load_on_block, run_case, run_guided
from joints import loaded
from stack import overturning, tilted_stack

from sidmacib import Loading, static_peak
from sidmacib.engines import ENGINES, Numerics
from sidmacib.engines.run import OUTPUTS, EngineError
from sidmacib.engines.scripts.records import RESULT
from sidmacib.joint import DRY, INNER, Direction, HoldDown, Joint, OwnLock, Side
from sidmacib.mechanics.assembly import Kind, NodeLayout
from sidmacib.models.static import solve as static_model
from sidmacib.problem import Problem
from workflow.solve import solved

pytestmark = pytest.mark.engine


def found(
    engine: str, folder: Path, problem: Problem, numerics: Numerics | None = None
) -> dict[str, Any]:
    run_guided(engine, problem, numerics or Numerics(tolerance=5e-4), folder, 300)
    return dict(json.loads((folder / RESULT).read_text()))


# --- a single face -------------------------------------------------------------------------------
def test_an_inner_face_fails_at_T0_in_pure_shear(engine: str, joint: Joint, tmp_path: Path) -> None:
    model = block_on_ground(joint, Kind.INNER, mesh=0.02)
    loads = load_on_block(model, (0.0, 1.0, 0.0), 0.0)
    result = found(engine, tmp_path, Problem(model, loads))
    assert result["peak_load_N"] == pytest.approx(joint.T0, rel=1e-3)
    assert result["peak_load_N"] <= joint.T0 <= result["failed_load_N"]
    assert result["mode"] == "bonds"
    assert (result["engine"], result["engine_version"]) == (engine, ENGINES[engine].version())


def test_a_face_fails_at_its_elastic_torque(engine: str, joint: Joint, tmp_path: Path) -> None:
    # 3 x 3 nodes: when the corners fail, what is left carries less, so first failure is the peak.
    model = block_on_ground(joint, Kind.INNER, mesh=0.02)
    arm = np.linalg.norm(model.nodes.position[:, :2] - model.pieces[1].centre[:2], axis=1)
    elastic = joint.inner.cohesion * float(model.nodes.area @ arm**2) / arm.max()
    loads = load_on_block(model, (0.0, 0.0, 0.0), joint.a)
    result = found(engine, tmp_path, Problem(model, loads))
    assert result["peak_load_N"] * joint.a == pytest.approx(elastic, rel=1e-3)
    shear = pd.read_csv(tmp_path / "nodes.csv")[["shear_x_Pa", "shear_y_Pa"]].to_numpy()
    magnitude = np.linalg.norm(shear, axis=1)
    assert magnitude / magnitude.max() == pytest.approx(arm / arm.max(), abs=2e-3)


def test_a_block_slides_at_friction_times_weight(engine: str, joint: Joint, tmp_path: Path) -> None:
    model = block_on_ground(replace(joint, density=1e6), Kind.DRY, mesh=0.02)
    limit = joint.dry.friction * model.pieces[1].weight
    loads = load_on_block(model, (0.0, 1.0, 0.0), 0.0)
    result = found(engine, tmp_path, Problem(model, loads))
    assert result["peak_load_N"] == pytest.approx(limit, rel=1e-3)
    assert (result["mode"], result["first_failure_load_N"]) == ("mechanism", None)


# --- an assembly that is no joint ----------------------------------------------------------------
@pytest.mark.parametrize(("friction", "width"), [(0.35, 0.4), (2.0, 0.2)])
def test_a_tilted_stack_slides_or_falls_where_the_hand_says(
    engine: str, tmp_path: Path, friction: float, width: float
) -> None:
    assembly, loads = tilted_stack(3, friction, width=width, mesh=0.1)
    expected = min(friction, overturning(assembly)) * loads.scale
    result = found(engine, tmp_path, Problem(assembly, loads), Numerics())
    assert result["peak_load_N"] == pytest.approx(expected, rel=5e-3)
    assert result["mode"] == "mechanism"


# --- a right answer or a clear no ----------------------------------------------------------------
def test_pieces_that_nothing_holds_drift_off_and_have_no_peak(tmp_path: Path) -> None:
    # Without friction nothing holds the upper pieces along x, once a torque has turned them.
    joint = Joint(3, dry=replace(DRY, friction=0.0))
    with pytest.raises(EngineError, match=r"no peak: at .* drift off where the load does no work"):
        run_case(a_case("yade", joint, Loading(Direction(np.inf)), mesh=0.02), tmp_path)


@pytest.mark.parametrize(
    ("engine", "stiffness", "eccentricity"),
    [("yade", 1e9, 0.5), ("liggghts", 1e9, 0.5), ("yade", 1e8, 0.0)],
)
def test_soft_faces_fail_where_the_static_model_says(
    run, engine: str, stiffness: float, eccentricity: float
) -> None:
    soft = {"normal_stiffness": stiffness, "shear_stiffness": stiffness}
    joint = Joint(3, inner=replace(INNER, **soft), dry=replace(DRY, **soft))
    loading = Loading(Direction(eccentricity))
    case = a_case(engine, joint, loading, 0.02, NodeLayout.VERTICES)
    expected = static_peak(*case.subject.problem()).peak.load
    assert run(case).peak_load == pytest.approx(expected, rel=0.015)


def test_contacts_too_soft_for_distinct_elements_are_refused(engine: str, tmp_path: Path) -> None:
    soft = {"normal_stiffness": 1e6, "shear_stiffness": 1e6}
    joint = Joint(3, inner=replace(INNER, **soft), dry=replace(DRY, **soft))
    with pytest.raises(EngineError, match=f"{engine}: contacts are so soft that the load moves"):
        run_case(a_case(engine, joint, Loading(Direction(0.0)), mesh=0.02), tmp_path)


def test_joints_with_hardly_any_tensile_strength_have_a_peak(engine: str, run) -> None:
    # In the static model, the limit of ever smaller tensile strengths.
    joint, loading = Joint(3, inner=replace(INNER, tensile_strength=1e-3)), Loading(Direction(0.0))
    expected = static_peak(*loaded(joint))
    none = replace(joint, inner=replace(INNER, tensile_strength=0.0))
    result = run(a_case(engine, none, loading, mesh=0.03))
    assert result.peak_load == pytest.approx(expected.peak.load, rel=0.01)
    assert result.first_failure_load == pytest.approx(expected.first_failure_load, rel=0.01)


def test_a_computation_that_diverges_ends_with_a_reason(engine: str, tmp_path: Path) -> None:
    numerics = Numerics(time_step_ratio=20.0)  # over the largest stable one
    assembly = block_on_ground(Joint(3), Kind.INNER, mesh=0.03)
    loads = load_on_block(assembly, (0.0, 1.0, 0.0), 0.0)
    with pytest.raises(
        EngineError, match=r"diverged|try a smaller time_step_ratio|LIGGGHTS ended before its"
    ):
        found(engine, tmp_path, Problem(assembly, loads), numerics)
    assert not (tmp_path / RESULT).exists()


# --- the joint -----------------------------------------------------------------------------------


@pytest.mark.parametrize("eccentricity", [0.0, 0.5, float("inf")])
def test_stresses_balance_every_piece(engine: str, run, eccentricity: float) -> None:
    result = run(a_case(engine, Joint(3), Loading(Direction(eccentricity)), mesh=0.02))
    assert result.unbalanced_share < 0.0075


def test_friction_stays_within_its_cone_and_dry_faces_carry_no_tension(engine: str, run) -> None:
    result = run(a_case(engine, Joint(3), Loading(Direction(0.5)), mesh=0.02))
    dry = result.nodes[result.nodes["kind"] == "dry"]
    shear = np.linalg.norm(dry[["shear_x_Pa", "shear_y_Pa", "shear_z_Pa"]], axis=1)
    assert (dry["normal_Pa"] >= 0.0).all()
    # Stresses are in the axes of the joint at rest; sides turn by up to 1e-4 with their pieces.
    assert (shear <= 0.3 * dry["normal_Pa"] * (1 + 5e-4) + 1e-6).all()


def test_the_history_has_load_displacement_shear_and_breakage(engine: str, run) -> None:
    history = run(a_case(engine, Joint(3), Loading(Direction(0.0)))).history
    assert set(history["stage"]) >= {"equilibrium", "collapse"}
    still = history[history["stage"] == "equilibrium"]
    assert still["load_N"].is_monotonic_increasing
    assert still["displacement_m"].is_monotonic_increasing
    assert still["inner-lower-lock2_broken_share"].max() == 0.0
    assert history["inner-lower-lock2_broken_share"].max() == 1.0
    assert history.iloc[-1]["stage"] != "equilibrium"
    assert history["time_step"].is_monotonic_increasing
    assert history["attempt"].is_monotonic_increasing
    assert {"load_N", "inner-lower-lock2_shear_y_N"} <= set(history.columns)


STRONG = replace(INNER, cohesion=1e5, normal_stiffness=2e10, shear_stiffness=2e10)


@pytest.mark.parametrize(
    ("joint", "eccentricity"),
    [
        *((Joint(3), 0.0), (Joint(5), 0.2), (Joint(3), float("inf"))),
        (Joint(3, first=Side.LOWER), 0.2),
        (Joint(3, different={2: OwnLock(width=0.06, density=2000.0, inner=STRONG)}), 0.0),
        (Joint(3, hold_down=HoldDown.force(500.0)), 0.5),
        (Joint(3, hold_down=HoldDown.weight()), 0.0),
    ],
)
def test_joints_have_the_static_models_peak_and_weights(
    engine: str, run, joint: Joint, eccentricity: float
) -> None:
    case = a_case(engine, joint, Loading(Direction(eccentricity)), mesh=0.02)
    result = run(case)
    expected, _, _ = solved(case, static_model)
    assert result.peak_load == pytest.approx(expected.load_N, rel=0.01)
    assert result.record.mode == expected.mode == "bonds"
    weights = [each.weight for each in expected.part.weights]
    assert result.weights["weight"].tolist() == pytest.approx(weights, abs=0.01)


@pytest.mark.parametrize("times", [1.0, 100.0])
def test_a_broken_column_stands_only_where_it_turns_little(engine: str, run, times: float) -> None:
    # With the usual stiffness it turns by 8 degrees in the static model's next equilibrium.
    inner, dry = (
        replace(law, normal_stiffness=times * 1e10, shear_stiffness=times * 1e10)
        for law in (INNER, DRY)
    )
    strong = Joint(3, inner=replace(inner, cohesion=1e6), dry=dry)
    loading = Loading(Direction(0.5))
    case = a_case(engine, strong, loading, mesh=0.02, nodes=NodeLayout.LOBATTO)
    result, (expected, _, _) = run(case), solved(case, static_model)
    assert expected.load_N == pytest.approx(550.2 if times == 1.0 else 1148.2, rel=1e-3)
    assert result.peak_load == pytest.approx(expected.load_N, rel=0.02)
    first = expected.first_failure_load_N
    assert result.first_failure_load == pytest.approx(first, rel=0.01)


def test_a_run_repeats_to_the_byte(engine: str, tmp_path: Path) -> None:
    case = a_case(engine, Joint(2), Loading(Direction(0.2)))
    one, other = (run_case(case, tmp_path / name) for name in ("one", "other"))
    for name in OUTPUTS:
        assert (one / name).read_bytes() == (other / name).read_bytes()


# --- the command ---------------------------------------------------------------------------------
def test_the_command_finds_what_an_engine_finds(engine: str) -> None:
    static, row = answers("capacity", "-n", "3", "-m", "static", "-m", engine)
    assert row["V (N)"] == pytest.approx(static["V (N)"], rel=0.005)
    assert row["note"].startswith("failure mode: bonds; ")
