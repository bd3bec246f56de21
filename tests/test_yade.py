"""The distinct elements in YADE, against theory. All of these are real runs, small ones."""

import json
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import a_case, block_on_ground, run_case, run_guided
from joints import PUBLISHED

from sidmacib import Loading, limit_load, static_peak
from sidmacib.engines import ENGINES, Numerics
from sidmacib.engines.run import OUTPUTS
from sidmacib.joint import INNER, Direction, Joint
from sidmacib.mechanics.assembly import Failure, Kind, Loads, NodeLayout
from sidmacib.mechanics.equilibrium import self_weight
from sidmacib.problem import Problem

pytestmark = pytest.mark.engine
SHEAR = Loading(Direction(0.0))


# --- the joint -----------------------------------------------------------------------------------
@pytest.mark.parametrize(("locks", "published", "weights", "within"), PUBLISHED)
def test_published_samples_reach_their_peak_and_weights(
    run, locks: int, published: float, weights: list[float], within: float
) -> None:
    result = run(a_case("yade", Joint(locks), SHEAR, mesh=0.02))
    assert result.shear == pytest.approx(published, rel=within)
    assert result.weights["weight"].tolist() == pytest.approx(weights, abs=0.06)


def test_halving_the_loading_rate_hardly_moves_the_peak(run) -> None:
    fast, slow = (
        run(a_case("yade", Joint(3), SHEAR, mesh=0.02, ramp_periods=periods)).peak_load
        for periods in (40.0, 80.0)
    )
    assert slow == pytest.approx(fast, rel=0.005)


def test_a_joint_whose_column_snaps_to_another_equilibrium_has_not_collapsed(run) -> None:
    """Its first column breaks off, turns by five hundredths and rests against the next lock."""
    joint = Joint(3, inner=replace(INNER, cohesion=1e6))
    nodes = NodeLayout.VERTICES  # and more damping, or it swings so far that it breaks more bonds
    case = a_case("yade", joint, Loading(Direction(0.5)), 0.02, nodes, damping=0.7)
    found, expected = run(case), static_peak(*case.subject.problem())
    assert found.first_failure_load == pytest.approx(expected.first_failure_load, rel=0.01)
    # The static model, of small rotations, does not count on a column that has turned so far.
    assert found.peak_load > 1.5 * expected.peak.load


def test_a_ductile_bond_yields_in_tension_and_does_not_break(tmp_path: Path) -> None:
    """Pulled upwards beside its middle, it reaches the plastic limit, or more as it turns."""
    joint = Joint(3, inner=replace(INNER, cohesion=1e6))
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
    joint, loading = Joint(5, failure=Failure.DUCTILE), Loading(Direction(0.5))
    found = run(a_case("yade", joint, loading, 0.02, NodeLayout.VERTICES))
    problem = found.case.subject.problem()
    assert found.peak_load == pytest.approx(static_peak(*problem).peak.load, rel=0.02)
    assert found.peak_load > 1.05 * limit_load(*problem).load
    assert not found.history.filter(like="_broken_share").to_numpy().any()


# --- the engine ----------------------------------------------------------------------------------
def test_the_script_runs_by_hand_with_yades_own_launcher(tmp_path: Path) -> None:
    folder = run_case(a_case("yade", Joint(2), SHEAR), tmp_path / "case")
    expected = [(folder / name).read_bytes() for name in OUTPUTS]
    for name in OUTPUTS:
        (folder / name).unlink()
    script = ENGINES["yade"].script
    subprocess.run(
        ["yade", "-n", "-x", script], cwd=folder, check=True, capture_output=True, timeout=120
    )
    assert [(folder / name).read_bytes() for name in OUTPUTS] == expected
