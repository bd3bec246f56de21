"""Limit analysis of structures: how they move, and those that gave solvers trouble."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_runner import answers
from structures import dry, read_flat_vault, read_structure

from sidmacib import CapacityError, InfeasibleError, static_peak
from sidmacib.errors import SolverError
from sidmacib.mechanics import sliding
from sidmacib.mechanics.assembly import FaceMaterial
from sidmacib.mechanics.limit import limit_load, require_standing
from sidmacib.mechanics.sliding import sliding_limit
from sidmacib.structure.blocks import box, prism
from sidmacib.structure.files.structure_file import structure_of
from sidmacib.structure.loads import acceleration
from sidmacib.structure.structure import structure
from studies.structures.shapes import arch


def test_the_work_of_the_load_in_the_mechanism_of_an_arch_lifts_its_weight() -> None:
    model = structure(arch(12, 0.2), dry(3.0))
    loads = acceleration(model, (1.0, 0.0, 0.0))
    found = limit_load(model, loads, friction=True)
    assert float(np.sum(loads.variable * found.mechanism)) == pytest.approx(1.0)
    lifted = -float(np.sum(loads.permanent * found.mechanism))
    assert lifted == pytest.approx(found.load, rel=1e-6)
    turns = np.round(found.mechanism[2:, 4], 3)
    assert len(set(turns) - {0.0}) == 3  # three bodies between four hinges


def test_a_stepped_stack_carries_no_more_without_dilation_and_obeys_coulomb() -> None:
    blocks = [
        box("floor", (-1.0, 0.0, -0.2), (1.0, 0.3, 0.0), 2e3, fixed=True),
        box("low", (0.0, 0.0, 0.0), (0.3, 0.3, 0.2), 2e3),
        box("next", (0.3, 0.0, 0.0), (0.6, 0.3, 0.2), 2e3),
        box("high", (0.1, 0.0, 0.2), (0.6, 0.3, 0.4), 2e3),
    ]
    model = structure(blocks, dry(0.6))
    found = sliding_limit(model, acceleration(model, (1, 0, 0)))
    assert 0.0 < found.state.load <= found.associated.load * (1 + 1e-4)
    force = found.state.force
    beyond = np.hypot(force[:, 1], force[:, 2]) - 0.6 * force[:, 0]
    assert beyond.max() <= 0.02 * force[:, 0].max()


def test_sliding_in_bonds_does_not_dilate_either() -> None:
    """A block that is pushed along its notch, dry and with bonds that hold next to nothing."""
    left = [(-1.0, 0.0, -0.5), (0.0, 0.0, -0.5), (0.0, 0.0, 0.0), (-1.0, 0.0, 1.0)]
    right = [(-x, y, z) for x, y, z in left]
    key = [(0.0, 0.0, 0.0), (1.0, 0.0, 1.0), (-1.0, 0.0, 1.0)]
    along = (0.0, 0.5, 0.0)
    blocks = [
        prism("left", left, along, 2e3, fixed=True),
        prism("right", right, along, 2e3, fixed=True),
        prism("key", key, along, 2e3),
    ]
    weak = FaceMaterial(1e10, 1e10, 0.4, cohesion=1.0, tensile_strength=1.0)
    loads = []
    for law in (dry(0.4), weak):
        model = structure(blocks, law)
        found = sliding_limit(model, acceleration(model, (0, 1, 0)))
        assert found.state.load < 0.99 * found.associated.load
        loads.append(found.state.load)
    assert loads[1] == pytest.approx(loads[0], rel=5e-3)


CASES = Path(__file__).parent / "cases"
FALLS = "The structure does not stand under its own weight"


def block_on_locks(count: int, condensed: dict[str, Any] | None) -> dict[str, Any]:
    """A block of 0.2 by 0.7 m on a row of locks, pushed along the row just above them."""
    locks: dict[str, Any] = {"between": "all", "count": count, "height": 0.03, "row": [0, 1, 0]}
    locks |= {"first": "block", "inner": {"cohesion": 8e4, "tensile_strength": 3e5}}
    locks |= {"dry": {"friction": 0.3}}
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


@pytest.mark.long
def test_a_wedge_that_only_dilation_holds_up_is_told_that_it_falls() -> None:
    path = CASES / "wedge_unstable.yaml"
    problem = read_structure(path)
    require_standing(*problem, friction=True)  # associated friction holds it
    with pytest.raises(InfeasibleError, match=f"^{FALLS} where sliding does not dilate$"):
        sliding_limit(*problem)
    rows = {str(row["model"]): row for row in answers("assembly", str(path))}
    assert float(str(rows["limit"]["load_N"])) > 0.0
    assert str(rows["limit"]["note"]).endswith(f"; static model: {FALLS.replace('The', 'the')}")
    assert rows["static"]["note"] == FALLS
    assert all(float(str(row["load_N"] or 0.0)) >= 0.0 for row in rows.values())


@pytest.mark.long
def test_rounds_that_do_not_settle_are_no_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sliding, "SLIDING_ROUNDS", 12)
    with pytest.raises(
        SolverError, match=r"rounds do not settle; the last 10 go from \d+ to \d+ N"
    ):
        sliding_limit(*read_flat_vault(3))


def test_a_structure_too_large_for_rounds_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sliding, "MOST_NODES", 100)
    with pytest.raises(CapacityError, match=r"without dilation: 176 nodes; at most 100 are"):
        sliding_limit(*read_flat_vault(3))


@pytest.mark.long
@pytest.mark.parametrize("count", [5, 7, 9])
def test_condensed_locks_carry_no_more_than_locks_that_are_cut_out(count: int) -> None:
    cut_out = static_peak(*structure_of(block_on_locks(count, None))).first_failure_load
    assert 0.8 * cut_out < carried(count, {}) <= cut_out
    assert carried(count, {}) == carried(count, {"rule": "safe"})
    assert carried(count, {"working": "all"}) == pytest.approx(11_200, rel=1e-3)
    assert carried(count, {"working": count}) == pytest.approx(11_200, rel=1e-3)
