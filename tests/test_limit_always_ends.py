"""Limit analysis of structures that solvers, rounds or their own weight gave trouble to."""

from pathlib import Path
from typing import Any

import pytest
from command_runner import answers

from sidmacib.errors import CapacityError, InfeasibleError
from sidmacib.mechanics import sliding
from sidmacib.mechanics.limit import limit_load, require_standing
from sidmacib.mechanics.sliding import sliding_limit
from sidmacib.mechanics.static import static_peak
from sidmacib.structure.files.structure_file import read_structure, structure_of
from studies.flat_vault.geometry import FILES

CASES = Path(__file__).parent / "cases"
FALLS = "The structure does not stand under its own weight"


def block_on_locks(count: int, condensed: dict[str, Any] | None) -> dict[str, Any]:
    """A block of 0.2 by 0.7 m on a row of locks, pushed along the row just above them."""
    locks: dict[str, Any] = {
        "between": ["base", "block"],
        "count": count,
        "height": 0.03,
        "row": [0, 1, 0],
        "first": "block",
        "inner": {"cohesion": 8e4, "tensile_strength": 3e5},
        "dry": {"friction": 0.3},
    }
    if condensed is not None:
        locks["condensed"] = condensed
    return {
        "blocks": {
            "base": {"low": [0, 0, -0.4], "high": [0.2, 0.7, 0], "fixed": True},
            "block": {"low": [0, 0, 0], "high": [0.2, 0.7, 0.2]},
        },
        "interfaces": {"friction": 0.5},
        "locks": [locks],
        "load": {"force": {"block": "block", "at": [0.1, 0, 0.001], "direction": [0, 1, 0]}},
    }


def carried(count: int, condensed: dict[str, Any]) -> float:
    return limit_load(*structure_of(block_on_locks(count, condensed)), friction=True).load


def test_locks_that_no_solver_gave_a_verdict_for_have_a_limit_load() -> None:
    problem = read_structure(CASES / "limit_without_verdict.yaml")
    assert limit_load(*problem, friction=True).load == pytest.approx(1647.7, abs=0.1)


def test_a_wedge_that_only_dilation_holds_up_is_told_that_it_falls() -> None:
    path = CASES / "wedge_unstable.yaml"
    require_standing(*read_structure(path), friction=True)  # associated friction holds it
    with pytest.raises(InfeasibleError, match=f"^{FALLS} where sliding does not dilate$"):
        sliding_limit(*read_structure(path))
    rows = {str(row["model"]): row for row in answers("assembly", str(path))}
    assert float(str(rows["limit"]["load (N)"])) > 0.0
    assert rows["static"]["note"] == FALLS
    assert all(float(str(row["load (N)"] or 0.0)) >= 0.0 for row in rows.values())


def test_a_structure_that_falls_is_told_so_before_a_load_is_looked_for() -> None:
    leaning = {
        "blocks": {
            "ground": {"low": [-2, -2, -1], "high": [2, 2, 0], "fixed": True},
            "leaning": {
                "outline": [[0, 0, 0], [0.4, 0, 0], [1.4, 0, 1], [1.0, 0, 1]],
                "along": [0, 0.6, 0],
            },
        },
        "load": {"acceleration": [1, 0, 0]},
    }
    with pytest.raises(InfeasibleError, match=f"^{FALLS}$"):
        require_standing(*structure_of(leaning), friction=True)


def test_rounds_that_do_not_settle_end_with_the_lowest_load_and_say_so(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(sliding, "SLIDING_ROUNDS", 12)
    found = sliding_limit(*read_structure(FILES[3]))
    assert found.rounds == 12
    assert found.highest is not None
    assert 0.0 < found.state.load <= found.highest <= found.associated.load
    assert f"go up to {found.highest:.4g} N" in found.note


def test_a_structure_too_large_for_rounds_is_refused_at_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(sliding, "MOST_NODES", 100)
    with pytest.raises(CapacityError, match=r"without dilation: 176 nodes; at most 100 are"):
        sliding_limit(*read_structure(FILES[3]))


@pytest.mark.parametrize("count", [5, 7, 9])
def test_condensed_locks_carry_no_more_than_locks_that_are_cut_out(count: int) -> None:
    cut_out = static_peak(*structure_of(block_on_locks(count, None))).first_failure_load
    assert 0.8 * cut_out < carried(count, {}) <= cut_out
    assert carried(count, {"working": "all"}) == pytest.approx(11_200, rel=1e-3)


def test_condensed_locks_work_by_the_safe_rule_unless_another_number_is_given() -> None:
    assert carried(7, {}) == carried(7, {"rule": "safe"})
    assert carried(7, {"working": "all"}) == pytest.approx(carried(7, {"working": 7}))


def test_a_number_of_working_locks_is_a_number_or_all() -> None:
    with pytest.raises(
        ValueError, match=r"locks\.1\.condensed\.working: 'most' is not allowed; .* or all"
    ):
        structure_of(block_on_locks(7, {"working": "most"}))
