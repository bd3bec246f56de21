"""The distinct elements in LIGGGHTS: what is special to this engine. Real runs, small ones."""

import subprocess
import sys
from pathlib import Path

import pytest
from campaigns.faults import processes_in
from conftest import ROOT, a_case
from joints import loaded
from test_execute import becomes_true

from sidmacib import Direction, Joint, Loading, static_peak
from sidmacib.engines import ENGINES, Numerics
from sidmacib.engines.render import write_script
from sidmacib.engines.run import EngineError, execute

pytestmark = pytest.mark.engine

LIGGGHTS = ENGINES["liggghts"]


def test_corners_that_fail_first_leave_a_joint_that_carries_more(run) -> None:
    joint, loading = Joint(3), Loading(Direction(2.0))
    found = run(a_case("liggghts", joint, loading, mesh=0.01))
    expected = static_peak(*found.case.subject.problem())
    assert found.first_failure_load == pytest.approx(expected.first_failure_load, rel=0.01)
    assert found.peak_load == pytest.approx(expected.peak.load, rel=0.01)


def test_two_ranks_find_what_one_finds(run) -> None:
    one, two = (
        run(a_case("liggghts", Joint(3), Loading(Direction(0.5)), mesh=0.02, ranks=n)).peak_load
        for n in (1, 2)
    )
    assert two == pytest.approx(one, rel=0.002)


def written(tmp_path: Path, locks: int = 2, mesh: float = 0.03, **numerics: int) -> Path:
    write_script(LIGGGHTS, *loaded(Joint(locks), 0.0, mesh), Numerics(**numerics), "case", tmp_path)
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
