"""The models that need no engine, run as the workflow runs them."""

from pathlib import Path

import pytest

from analysis.balance import unbalanced_share
from analysis.reading import read_case
from analysis.weights import lock_weights
from workflow.case import Case
from workflow.cases import cases_of
from workflow.configuration import read_study
from workflow.models import Obtained, obtained_by
from workflow.results import NODE_COLUMNS
from workflow.solve import solve_case, write_outcome


def case_of(model: str, direction: str, locks: int = 3) -> Case:
    config = {
        "samples": {"n": {"locks": locks}},
        "meshes": [0.03],
        "eccentricities": [0, 0.5, "torsion"],
        "sidmacib": {"reductions": ["none"]},
    }
    return cases_of(read_study(config))[model, f"n-mesh0.03-{direction}"]


def solved(case: Case, folder: Path) -> Path:
    write_outcome(case, *solve_case(case), folder)
    return folder


@pytest.mark.parametrize("model", obtained_by(Obtained.SOLVED))
@pytest.mark.parametrize("direction", ["e0a", "e0.5a", "torsion"])
def test_results_read_like_an_engines_and_balance_every_piece(
    model: str, direction: str, tmp_path: Path
) -> None:
    result = read_case(solved(case_of(model, direction), tmp_path))
    assert result.nodes.columns.tolist() == list(NODE_COLUMNS)
    assert unbalanced_share(result) < 1e-6
    assert result.history["load_N"].iloc[-1] == pytest.approx(result.peak_load)


def test_lower_locks_of_the_limit_model_are_used_up_whatever_their_number(tmp_path: Path) -> None:
    weights = lock_weights(read_case(solved(case_of("limit", "e0a", locks=5), tmp_path)))
    assert weights.loc[weights["block"] == "lower", "weight"].tolist() == pytest.approx([1.0, 1.0])


def test_shear_on_the_locks_grows_with_the_load_to_that_of_the_peak(tmp_path: Path) -> None:
    result = read_case(solved(case_of("static", "e0a"), tmp_path))
    weights = lock_weights(result).set_index("lock")
    last = result.history.iloc[-1]
    for lock in (1, 2, 3):
        assert last[f"lock{lock}_shear_y_N"] == pytest.approx(weights.loc[lock, "shear_y_N"])
    assert result.history["displacement_m"].is_monotonic_increasing


def test_what_is_written_is_the_same_again(tmp_path: Path) -> None:
    case = case_of("static", "torsion")
    one, other = solved(case, tmp_path / "one"), solved(case, tmp_path / "other")
    for path in one.iterdir():
        assert path.read_bytes() == (other / path.name).read_bytes()


def test_the_first_failure_is_told_where_a_model_knows_failure(tmp_path: Path) -> None:
    static = read_case(solved(case_of("static", "e0a"), tmp_path / "static"))
    limit = read_case(solved(case_of("limit", "e0a"), tmp_path / "limit"))
    assert 0 < static.first_failure_load <= static.peak_load < static.failed_load
    assert limit.first_failure_load is None
