"""The distinct elements in YADE, against theory. All of these are real runs, small ones."""

import json
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from conftest import a_case, block_on_ground, run_case

from sidmacib.engines import ENGINES
from sidmacib.engines.run import OUTPUTS
from sidmacib.joint import INNER, Direction, Joint
from sidmacib.joint.loading import Loading, lateral_load
from sidmacib.joint.pieces import assemble
from sidmacib.mechanics.assembly import Failure, Kind, Loads, NodeLayout
from sidmacib.mechanics.equilibrium import self_weight
from sidmacib.mechanics.limit import limit_load
from sidmacib.mechanics.static import static_peak

pytestmark = pytest.mark.engine


# --- the joint -----------------------------------------------------------------------------------
def test_three_locks_reach_the_published_peak_within_3_and_a_half_percent(run) -> None:
    result = run(a_case("yade", Joint(3), Loading(Direction(0.0)), mesh=0.02))
    assert result.shear == pytest.approx(240.76, rel=0.035)
    published_first_two_swapped = [0.77, 0.99, 0.0]
    assert result.weights["weight"].tolist() == pytest.approx(published_first_two_swapped, abs=0.06)


def test_five_locks_reach_the_published_peak_within_2_percent(run) -> None:
    result = run(a_case("yade", Joint(5), Loading(Direction(0.0)), mesh=0.02))
    assert result.shear == pytest.approx(408.26, rel=0.02)
    published_first_two_swapped = [0.57, 0.99, 0.68, 0.68, 0.0]
    assert result.weights["weight"].tolist() == pytest.approx(published_first_two_swapped, abs=0.06)


@pytest.mark.parametrize(("locks", "eccentricity"), [(3, 0.0)])
def test_halving_the_loading_rate_hardly_moves_the_peak(
    run, locks: int, eccentricity: float
) -> None:
    peaks = [
        run(
            a_case(
                "yade",
                Joint(locks),
                Loading(Direction(eccentricity)),
                mesh=0.02,
                ramp_periods=periods,
            )
        ).peak_load
        for periods in (40.0, 80.0)
    ]
    assert peaks[1] == pytest.approx(peaks[0], rel=0.005)


def test_a_joint_whose_column_snaps_to_another_equilibrium_has_not_collapsed(run) -> None:
    """Its first column breaks off, turns by five hundredths and rests against the next lock."""
    joint = Joint(3, inner=replace(INNER, cohesion=1e6))
    nodes = NodeLayout.VERTICES  # and more damping, or it swings so far that it breaks more bonds
    case = a_case("yade", joint, Loading(Direction(0.5)), 0.02, nodes, damping=0.7)
    found, expected = run(case), static_peak(*case.subject.problem())
    assert found.first_failure_load == pytest.approx(expected.first_failure_load, rel=0.01)
    # The static model, of small rotations, does not count on a column that has turned so far.
    assert found.peak_load > 1.5 * expected.peak.load


def test_a_ductile_bond_yields_in_tension_and_does_not_break(run_block) -> None:
    """Pulled upwards beside its middle, it reaches the plastic limit, or more as it turns."""
    joint = Joint(3, inner=replace(INNER, cohesion=1e6))
    block = replace(block_on_ground(joint, Kind.INNER, 0.01), failure=Failure.DUCTILE)
    variable = np.zeros((2, 6))
    variable[1, 2], variable[1, 3] = 1.0, 0.02  # N upwards, and N m for each of them
    loads = Loads(self_weight(block.pieces), variable, joint.T0)
    result = json.loads((run_block("yade", block, loads) / "result.json").read_text())
    assert 1.0 <= result["peak_load_N"] / limit_load(block, loads).load <= 1.1
    assert (
        result["peak_load_N"]
        > 1.3 * static_peak(replace(block, failure=Failure.BRITTLE), loads).peak.load
    )


@pytest.mark.parametrize(("locks", "eccentricity"), [(5, 0.5)])
def test_a_ductile_joint_under_torque_carries_what_the_static_model_does(
    tmp_path: Path, locks: int, eccentricity: float
) -> None:
    """Both have friction, by which they carry more than limit analysis, which has none."""
    joint = Joint(locks, failure=Failure.DUCTILE)
    case = a_case("yade", joint, Loading(Direction(eccentricity)), 0.02, NodeLayout.VERTICES)
    folder = run_case(case, tmp_path)
    result = json.loads((folder / "result.json").read_text())
    assembly = assemble(joint, case.subject.mesh, case.subject.nodes)
    loads = lateral_load(joint, assembly, case.subject.loading)
    assert result["peak_load_N"] == pytest.approx(static_peak(assembly, loads).peak.load, rel=0.02)
    assert result["peak_load_N"] > 1.05 * limit_load(assembly, loads).load
    history = pd.read_csv(folder / "history.csv")
    assert not history.filter(like="_broken_share").to_numpy().any()


# --- the engine ----------------------------------------------------------------------------------
def test_the_script_runs_by_hand_with_yades_own_launcher(tmp_path: Path) -> None:
    case = a_case("yade", Joint(2), Loading(Direction(0.0)))
    folder = run_case(case, tmp_path / "case")
    expected = [(folder / name).read_bytes() for name in OUTPUTS]
    for name in OUTPUTS:
        (folder / name).unlink()
    script = ENGINES["yade"].script
    subprocess.run(
        ["yade", "-n", "-x", script], cwd=folder, check=True, capture_output=True, timeout=120
    )
    assert [(folder / name).read_bytes() for name in OUTPUTS] == expected
