"""The distinct elements in LIGGGHTS: what is special to this engine. Real runs, small ones."""

import math
from pathlib import Path

import pytest
from conftest import a_case

from analysis.weights import lock_weights
from sidmacib.joint import Joint
from sidmacib.loading import Loading, lateral_load
from sidmacib.mechanics.static import static_peak
from workflow.engines import ENGINES
from workflow.execute import EngineError, execute
from workflow.render import write_case

pytestmark = pytest.mark.engine


@pytest.mark.parametrize(
    ("locks", "eccentricity"), [(3, 0.0), (3, math.inf), (5, 0.006), (5, 0.03)]
)
def test_both_engines_find_the_same_first_failure_and_weights(
    run, locks: int, eccentricity: float
) -> None:
    one, other = (
        run(a_case(engine, Joint(locks), Loading(Direction(eccentricity)), mesh=0.02))
        for engine in ENGINES
    )
    assert other.first_failure_load == pytest.approx(one.first_failure_load, rel=0.01)
    assert other.peak_load == pytest.approx(one.peak_load, rel=0.01)
    weights = (lock_weights(result)["weight"].to_numpy() for result in (one, other))
    assert next(weights) == pytest.approx(next(weights), abs=0.01)


def test_corners_that_fail_first_leave_a_joint_that_carries_more(run) -> None:
    joint, loading = Joint(3), Loading(0.12)
    found = run(a_case("liggghts", joint, loading, mesh=0.01))
    model = assemble(joint, 0.01)
    expected = static_peak(model, lateral_load(joint, model, loading))
    assert found.first_failure_load == pytest.approx(expected.first_failure_load, rel=0.01)
    assert found.peak_load == pytest.approx(expected.peak.load, rel=0.01)


def test_more_than_fifteen_locks_work(run) -> None:
    joint = Joint(17)
    found = run(a_case("liggghts", joint, Loading(Direction(0.0))))
    model = assemble(joint, 0.03)
    peak = static_peak(model, lateral_load(joint, model, Loading(Direction(0.0)))).peak
    assert found.peak_load == pytest.approx(peak.load, rel=0.01)


def test_two_ranks_find_what_one_finds(run) -> None:
    one, two = (
        run(a_case("liggghts", Joint(3), Loading(Direction(0.03)), mesh=0.02, ranks=n)).peak_load
        for n in (1, 2)
    )
    assert two == pytest.approx(one, rel=0.002)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("neighbor {SKIN:g} bin", "ERROR"),  # an input script that LIGGGHTS refuses
        ('"variable load equal 0.0"', "ERROR|LIGGGHTS has ended"),
    ],
)
def test_a_broken_input_script_fails_with_liggghts_own_words(
    tmp_path: Path, change: str, message: str
) -> None:
    write_case(a_case("liggghts", Joint(2), Loading(Direction(0.0))), tmp_path)
    script = tmp_path / ENGINES["liggghts"].script
    broken = script.read_text().replace(change, change.replace("neighbor", "neighbour", 1))
    broken = broken.replace('"variable load equal 0.0"', '"variable load equal v_nothing"')
    script.write_text(broken)
    with pytest.raises(EngineError, match=f"(?s)ended with exit code 1.*({message})"):
        execute(ENGINES["liggghts"], tmp_path, 60)
    assert not (tmp_path / "result.json").exists()


def test_no_process_of_liggghts_is_left_after_the_time_limit(tmp_path: Path) -> None:
    write_case(a_case("liggghts", Joint(5), Loading(Direction(0.0)), mesh=0.004, ranks=2), tmp_path)
    with pytest.raises(EngineError, match="out of time after 3 s"):
        execute(ENGINES["liggghts"], tmp_path, 3)
    left = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            if (
                "liggghts" in (process / "comm").read_text()
                and "Z" not in (process / "stat").read_text().split(")")[1]
            ):
                left.append(str((process / "cwd").readlink()))
        except OSError:
            continue
    assert not [folder for folder in left if str(tmp_path) in folder]
