"""What distinct elements must find, in both engines and in each. Real runs, small ones."""

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from campaigns.faults import processes_in
from command_runner import answers
from conftest import ROOT, a_case, block_on_ground, load_on_block, run_case, run_guided
from joints import PUBLISHED, loaded, sawn
from stack import tilted_stack
from test_execute import becomes_true

from sidmacib import Loading, limit_load, static_peak
from sidmacib.engines import ENGINES, Numerics
from sidmacib.engines.render import write_script
from sidmacib.engines.run import OUTPUTS, EngineError, execute
from sidmacib.engines.scripts.records import RESULT
from sidmacib.joint import DRY, INNER, Direction, HoldDown, Joint, OwnLock, Side
from sidmacib.mechanics.assembly import FaceMaterial, Failure, Kind, NodeLayout
from sidmacib.mechanics.equilibrium import self_weight
from sidmacib.mechanics.loads import Loads
from sidmacib.models.static import solve as static_model
from sidmacib.problem import Problem
from sidmacib.structure.blocks import box
from sidmacib.structure.loads import force_at
from sidmacib.structure.structure import structure
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


def test_a_block_that_spins_about_its_last_bond_is_not_at_rest(engine: str, tmp_path: Path) -> None:
    """Friction and one bond resist its torque; forces alone balanced at 2066 N in LIGGGHTS."""
    block = box("block", (0, 0, 0), (0.4, 0.6, 1.0), 2500)
    bond = FaceMaterial(1e10, 1e10, 0.6, 2e4, 1e4)
    model = structure([box("ground", (-1, -1, -1), (1, 1, 0), 2e3, fixed=True), block], bond)
    loads = force_at(model, "block", (0.0, 0.6, 0.1), (1.0, 0.0, 0.0))
    result = found(engine, tmp_path, Problem(model, loads))
    assert result["peak_load_N"] == pytest.approx(static_peak(model, loads).peak.load, rel=0.03)


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
    top = max(piece.high[2] for piece in assembly.pieces)
    overturns = float(assembly.nodes.position[:, 0].max()) / (top / 2)  # lever of the weight
    expected = min(friction, overturns) * loads.scale
    result = found(engine, tmp_path, Problem(assembly, loads), Numerics())
    assert result["peak_load_N"] == pytest.approx(expected, rel=5e-3)
    assert result["mode"] == "mechanism"


# --- a right answer or a clear no ----------------------------------------------------------------
def test_pieces_that_nothing_holds_drift_off_and_have_no_peak(tmp_path: Path) -> None:
    # Without friction nothing holds the upper pieces along x, once a torque has turned them.
    joint = sawn(3, dry=replace(DRY, friction=0.0))
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
    joint = sawn(3, inner=replace(INNER, **soft), dry=replace(DRY, **soft))
    loading = Loading(Direction(eccentricity))
    case = a_case(engine, joint, loading, 0.02, NodeLayout.VERTICES)
    expected = static_peak(*case.subject.problem()).peak.load
    assert run(case).peak_load == pytest.approx(expected, rel=0.015)


def test_contacts_too_soft_for_distinct_elements_are_refused(engine: str, tmp_path: Path) -> None:
    soft = {"normal_stiffness": 1e6, "shear_stiffness": 1e6}
    joint = sawn(3, inner=replace(INNER, **soft), dry=replace(DRY, **soft))
    with pytest.raises(EngineError, match=f"{engine}: contacts are so soft that the load moves"):
        run_case(a_case(engine, joint, Loading(Direction(0.0)), mesh=0.02), tmp_path)


def test_joints_with_hardly_any_tensile_strength_have_a_peak(engine: str, run) -> None:
    # In the static model, the limit of ever smaller tensile strengths.
    joint, loading = sawn(3, inner=replace(INNER, tensile_strength=1e-3)), Loading(Direction(0.0))
    expected = static_peak(*loaded(joint))
    none = replace(joint, inner=replace(INNER, tensile_strength=0.0))
    result = run(a_case(engine, none, loading, mesh=0.03))
    assert result.peak_load == pytest.approx(expected.peak.load, rel=0.01)
    assert result.first_failure_load == pytest.approx(expected.first_failure_load, rel=0.01)


def test_a_computation_that_diverges_ends_with_a_reason(engine: str, tmp_path: Path) -> None:
    numerics = Numerics(time_step_ratio=20.0)  # over the largest stable one
    assembly = block_on_ground(sawn(3), Kind.INNER, mesh=0.03)
    loads = load_on_block(assembly, (0.0, 1.0, 0.0), 0.0)
    with pytest.raises(
        EngineError, match=r"diverged|try a smaller time_step_ratio|LIGGGHTS ended before its"
    ):
        found(engine, tmp_path, Problem(assembly, loads), numerics)
    assert not (tmp_path / RESULT).exists()


# --- the joint -----------------------------------------------------------------------------------


@pytest.mark.parametrize("eccentricity", [0.0, 0.5, float("inf")])
def test_stresses_balance_every_piece(engine: str, run, eccentricity: float) -> None:
    result = run(a_case(engine, sawn(3), Loading(Direction(eccentricity)), mesh=0.02))
    assert result.unbalanced_share < 0.0075


def test_friction_stays_within_its_cone_and_dry_faces_carry_no_tension(engine: str, run) -> None:
    result = run(a_case(engine, sawn(3), Loading(Direction(0.5)), mesh=0.02))
    dry = result.nodes[result.nodes["kind"] == "dry"]
    shear = np.linalg.norm(dry[["shear_x_Pa", "shear_y_Pa", "shear_z_Pa"]], axis=1)
    assert (dry["normal_Pa"] >= 0.0).all()
    # Stresses are in the axes of the joint at rest; sides turn by up to 1e-4 with their pieces.
    assert (shear <= 0.3 * dry["normal_Pa"] * (1 + 5e-4) + 1e-6).all()


def test_the_history_has_load_displacement_shear_and_breakage(engine: str, run) -> None:
    history = run(a_case(engine, sawn(3), Loading(Direction(0.0)))).history
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
        *((sawn(3), 0.0), (sawn(5), 0.2), (sawn(3), float("inf"))),
        (sawn(3, first=Side.LOWER), 0.2),
        (sawn(3, different={2: OwnLock(width=0.06, density=2000.0, inner=STRONG)}), 0.0),
        (sawn(3, hold_down=HoldDown.force(500.0)), 0.5),
        (sawn(3, hold_down=HoldDown.weight()), 0.0),
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


def test_stiff_rough_dry_faces_do_not_slip_as_the_load_is_raised(tmp_path: Path) -> None:
    """With the usual rate of loading YADE had 137.9 N; an own solver has 151.00 N."""
    stiff = replace(DRY, normal_stiffness=1e13, shear_stiffness=1e13)
    problem = loaded(sawn(5, dry=stiff), float("inf"), 0.02, NodeLayout.VERTICES)
    first = found("yade", tmp_path, problem, Numerics())["first_failure_load_N"]
    assert first == pytest.approx(151.00, rel=2e-3)
    assert first == pytest.approx(static_peak(*problem).first_failure_load, rel=2e-3)


@pytest.mark.parametrize("times", [1.0, 100.0])
def test_a_broken_column_stands_only_where_it_turns_little(engine: str, run, times: float) -> None:
    # With the usual stiffness it turns by 8 degrees in the static model's next equilibrium.
    inner, dry = (
        replace(law, normal_stiffness=times * 1e10, shear_stiffness=times * 1e10)
        for law in (INNER, DRY)
    )
    strong = sawn(3, inner=replace(inner, cohesion=1e6), dry=dry)
    loading = Loading(Direction(0.5))
    case = a_case(engine, strong, loading, mesh=0.02, nodes=NodeLayout.LOBATTO)
    result, (expected, _, _) = run(case), solved(case, static_model)
    assert expected.load_N == pytest.approx(542.1 if times == 1.0 else 1146.3, rel=1e-3)
    assert result.peak_load == pytest.approx(expected.load_N, rel=0.02)
    first = expected.first_failure_load_N
    assert result.first_failure_load == pytest.approx(first, rel=0.01)


def test_a_run_repeats_to_the_byte(engine: str, tmp_path: Path) -> None:
    case = a_case(engine, sawn(2), Loading(Direction(0.2)))
    one, other = (run_case(case, tmp_path / name) for name in ("one", "other"))
    for name in OUTPUTS:
        assert (one / name).read_bytes() == (other / name).read_bytes()


# --- the command ---------------------------------------------------------------------------------
def test_the_command_finds_what_an_engine_finds(engine: str) -> None:
    static, row = answers("capacity", "-n", "3", "-m", "static", "-m", engine)
    assert row["V_N"] == pytest.approx(static["V_N"], rel=0.005)
    assert row["note"].startswith("failure mode: bonds; ")


# --- YADE ----------------------------------------------------------------------------------------
SHEAR = Loading(Direction(0.0))


# --- the joint -----------------------------------------------------------------------------------
@pytest.mark.parametrize(("locks", "published", "weights", "within"), PUBLISHED)
def test_published_samples_reach_their_peak_and_weights(
    run, locks: int, published: float, weights: list[float], within: float
) -> None:
    result = run(a_case("yade", sawn(locks), SHEAR, mesh=0.02))
    assert result.shear == pytest.approx(published, rel=within)
    assert result.weights["weight"].tolist() == pytest.approx(weights, abs=0.06)


def test_halving_the_loading_rate_hardly_moves_the_peak(run) -> None:
    fast, slow = (
        run(a_case("yade", sawn(3), SHEAR, mesh=0.02, ramp_periods=periods)).peak_load
        for periods in (40.0, 80.0)
    )
    assert slow == pytest.approx(fast, rel=0.005)


def test_a_joint_whose_column_snaps_to_another_equilibrium_has_not_collapsed(run) -> None:
    """Its first column breaks off, turns by five hundredths and rests against the next lock."""
    joint = sawn(3, inner=replace(INNER, cohesion=1e6))
    nodes = NodeLayout.VERTICES  # and more damping, or it swings so far that it breaks more bonds
    case = a_case("yade", joint, Loading(Direction(0.5)), 0.02, nodes, damping=0.7)
    found, expected = run(case), static_peak(*case.subject.problem())
    assert found.first_failure_load == pytest.approx(expected.first_failure_load, rel=0.01)
    # The static model, of small rotations, does not count on a column that has turned so far.
    assert found.peak_load > 1.5 * expected.peak.load


def test_a_ductile_bond_yields_in_tension_and_does_not_break(tmp_path: Path) -> None:
    """Pulled upwards beside its middle, it reaches the plastic limit, or more as it turns."""
    joint = sawn(3, inner=replace(INNER, cohesion=1e6))
    block = replace(block_on_ground(joint, Kind.INNER, 0.01), failure=Failure.DUCTILE)
    variable = np.zeros((2, 6))
    variable[1, 2], variable[1, 3] = 1.0, 0.02  # N upwards, and N m for each of them
    loads = Loads(self_weight(block.pieces), variable, joint.T0)
    run_guided("yade", Problem(block, loads), Numerics(tolerance=5e-4), tmp_path, 120)
    result = json.loads((tmp_path / "result.json").read_text())
    assert 1.0 <= result["peak_load_N"] / limit_load(block, loads).load <= 1.1
    brittle = static_peak(replace(block, failure=Failure.BRITTLE), loads)
    assert result["peak_load_N"] > 1.3 * brittle.peak.load


def test_a_ductile_joint_under_torque_carries_what_the_static_model_does(run) -> None:
    """Both have friction, by which they carry more than limit analysis, which has none."""
    joint, loading = sawn(5, failure=Failure.DUCTILE), Loading(Direction(0.5))
    found = run(a_case("yade", joint, loading, 0.02, NodeLayout.VERTICES))
    problem = found.case.subject.problem()
    assert found.peak_load == pytest.approx(static_peak(*problem).peak.load, rel=0.02)
    assert found.peak_load > 1.05 * limit_load(*problem).load
    assert not found.history.filter(like="_broken_share").to_numpy().any()


# --- the engine ----------------------------------------------------------------------------------
def test_the_script_runs_by_hand_with_yades_own_launcher(tmp_path: Path) -> None:
    folder = run_case(a_case("yade", sawn(2), SHEAR), tmp_path / "case")
    expected = [(folder / name).read_bytes() for name in OUTPUTS]
    for name in OUTPUTS:
        (folder / name).unlink()
    script = ENGINES["yade"].script
    subprocess.run(
        ["yade", "-n", "-x", script], cwd=folder, check=True, capture_output=True, timeout=120
    )
    assert [(folder / name).read_bytes() for name in OUTPUTS] == expected


# --- LIGGGHTS ------------------------------------------------------------------------------------

LIGGGHTS = ENGINES["liggghts"]


def test_corners_that_fail_first_leave_a_joint_that_carries_more(run) -> None:
    joint, loading = sawn(3), Loading(Direction(2.0))
    found = run(a_case("liggghts", joint, loading, mesh=0.01))
    expected = static_peak(*found.case.subject.problem())
    assert found.first_failure_load == pytest.approx(expected.first_failure_load, rel=0.01)
    assert found.peak_load == pytest.approx(expected.peak.load, rel=0.01)


def test_two_ranks_find_what_one_finds(run) -> None:
    one, two = (
        run(a_case("liggghts", sawn(3), Loading(Direction(0.5)), mesh=0.02, ranks=n)).peak_load
        for n in (1, 2)
    )
    assert two == pytest.approx(one, rel=0.002)


def written(tmp_path: Path, locks: int = 2, mesh: float = 0.03, **numerics: int) -> Path:
    write_script(LIGGGHTS, *loaded(sawn(locks), 0.0, mesh), Numerics(**numerics), "case", tmp_path)
    return tmp_path


def test_a_broken_input_script_fails_with_liggghts_own_words(tmp_path: Path) -> None:
    right, wrong = "neighbor {SKIN", "neighbour {SKIN"
    deck = written(tmp_path) / "engines" / "liggghts" / "deck.py"
    text = deck.read_text()
    assert right in text
    deck.write_text(text.replace(right, wrong))
    words = r"(?s)ended with exit code 1.*(ERROR|LIGGGHTS ended before its commands were done)"
    with pytest.raises(EngineError, match=words):
        execute(LIGGGHTS, tmp_path, 60)
    assert not (tmp_path / "result.json").exists()


def shared_memory() -> set[Path]:
    """MPI's segments that are left in the system's shared memory."""
    return set(Path("/dev/shm").glob("vader*"))


def test_no_process_of_liggghts_is_left_after_the_time_limit(tmp_path: Path) -> None:
    written(tmp_path, locks=5, mesh=0.004, ranks=2)
    with pytest.raises(EngineError, match="out of time after 4 s"):
        execute(LIGGGHTS, tmp_path, 4)
    assert becomes_true(lambda: not processes_in(tmp_path))


def test_no_process_of_liggghts_outlives_a_runner_that_is_killed(tmp_path: Path) -> None:
    written(tmp_path, locks=5, mesh=0.004, ranks=2)
    before = shared_memory()
    call = (
        "from pathlib import Path; from sidmacib.engines import ENGINES;"
        "from sidmacib.engines.run import execute;"
        f"execute(ENGINES['liggghts'], Path({str(tmp_path)!r}), 300)"
    )
    runner = subprocess.Popen([sys.executable, "-c", call], cwd=ROOT)

    def ranks() -> int:
        return sum(each.startswith("liggghts") for each in processes_in(tmp_path))

    assert becomes_true(lambda: ranks() == 2)
    runner.kill()
    runner.wait()
    assert becomes_true(lambda: not processes_in(tmp_path))
    assert shared_memory() <= before
