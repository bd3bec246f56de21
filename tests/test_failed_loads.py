"""Loads that are known not to be carried: just above the largest that is, whichever model asks."""

import math
from typing import Any

import pytest

from sidmacib.joint import Direction, Joint
from sidmacib.joint.loading import Loading, posed
from sidmacib.models import limit, static, structure_limit, structure_static
from sidmacib.structure.analysis.tilt import PRECISION, tilt_of_load
from sidmacib.structure.files.structure_file import structure_of

FRICTION = 0.2
SLIDING: dict[str, Any] = {
    "blocks": {
        "ground": {"low": [-1, -1, -1], "high": [2, 2, 0], "fixed": True},
        "block": {"low": [0, 0, 0], "high": [0.6, 0.6, 0.3]},
    },
    "interfaces": {"friction": FRICTION},
}
BONDED = SLIDING | {"interfaces": {"friction": FRICTION, "cohesion": 2e3, "tensile_strength": 2e3}}
PUSH, TILT = {"acceleration": [1, 0, 0]}, {"tilt": {"axis": [0, 1, 0]}}
STRUCTURES = {"static": structure_static.solve, "limit": structure_limit.solve}


@pytest.mark.parametrize("model", [static, limit], ids=["static", "limit"])
@pytest.mark.parametrize("ratio", [0.0, 0.3, math.inf])
def test_of_a_joint(model: Any, ratio: float) -> None:
    outcome = model.solve(posed(Joint(3), Loading(Direction(ratio)), 0.05))
    above = outcome.failed_load / outcome.path[-1].load - 1.0
    assert 0.0 <= above <= (1.1e-5 if model is static else 0.0)


@pytest.mark.parametrize("model", STRUCTURES)
@pytest.mark.parametrize("description", [SLIDING, BONDED], ids=["dry", "bonded"])
@pytest.mark.parametrize(("load", "most"), [(PUSH, 1.1e-5), (TILT, 1.01 * PRECISION)])
def test_of_a_structure_that_is_pushed_or_tilted(
    model: str, description: dict[str, Any], load: dict[str, Any], most: float
) -> None:
    found = STRUCTURES[model](structure_of({**description, "load": load}))
    above = found.failed_load / found.path[-1].load - 1.0
    assert 0.0 <= above <= (most if model == "static" else 0.0)


def test_a_block_on_a_slope_slides_between_the_last_angle_and_the_failed_one() -> None:
    problem = structure_of({**SLIDING, "load": TILT})
    found = structure_static.solve(problem)
    weight = 0.6 * 0.6 * 0.3 * 2000.0 * 9.81
    loads = (found.path[-1].load, found.failed_load)
    carried, failed = (tilt_of_load(load, weight) for load in loads)
    critical = math.degrees(math.atan(FRICTION))
    assert carried == pytest.approx(critical, rel=2e-3)
    assert failed == pytest.approx(critical, rel=2e-3)
    assert carried < failed


@pytest.mark.parametrize("load", [PUSH, TILT], ids=["push", "tilt"])
def test_first_failures_and_broken_bonds_are_at_carried_loads(load: dict[str, Any]) -> None:
    found = structure_static.solve(structure_of({**BONDED, "load": load}))
    peak, first = found.path[-1].load, found.first_failure_load
    assert 0.0 < first <= peak
    assert all(broken == pytest.approx(first, rel=1e-4) for broken in found.broken_at.values())
    assert found.broken_at or load is TILT  # where the peak is the first failure, it has none
