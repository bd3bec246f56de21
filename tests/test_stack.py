"""An assembly that is no joint: a tilted stack of dry blocks, known by hand."""

import pytest
from stack import hinge, overturning, tilted_stack

from sidmacib.mechanics.assembly import Loads
from sidmacib.mechanics.limit import limit_load
from sidmacib.mechanics.static.model import static_peak


def weight(loads: Loads) -> float:
    return -float(loads.permanent[:, 2].sum())


@pytest.mark.parametrize("blocks", [1, 4])
@pytest.mark.parametrize("friction", [0.1, 0.35])
def test_a_squat_stack_slides_at_its_friction(blocks: int, friction: float) -> None:
    assembly, loads = tilted_stack(blocks, friction, width=0.4)
    assert overturning(assembly) > friction
    tilt = static_peak(assembly, loads).peak.load / weight(loads)
    assert tilt == pytest.approx(friction, rel=2e-5)


@pytest.mark.parametrize("blocks", [1, 4])
@pytest.mark.parametrize("mesh", [0.1, 0.05, 0.01])
def test_a_slender_stack_falls_about_its_outermost_nodes(blocks: int, mesh: float) -> None:
    assembly, loads = tilted_stack(blocks, friction=2.0, mesh=mesh)
    assert overturning(assembly) < 2.0
    tilt = static_peak(assembly, loads).peak.load / weight(loads)
    assert tilt == pytest.approx(overturning(assembly), rel=2e-5)


def test_with_finer_nodes_the_stack_falls_about_its_edge() -> None:
    assembly, loads = tilted_stack(3, friction=2.0, width=0.2, height=0.1, mesh=0.001, depth=0.001)
    assert hinge(assembly) == pytest.approx(0.1, abs=6e-4)
    tilt = static_peak(assembly, loads).peak.load / weight(loads)
    assert tilt == pytest.approx(0.2 / 0.3, rel=0.006)  # width over height


@pytest.mark.parametrize("friction", [0.2, 2.0])
def test_limit_analysis_finds_the_smaller_of_sliding_and_overturning(friction: float) -> None:
    # Every face carries the weight above it however it slides: dilation changes nothing here.
    assembly, loads = tilted_stack(3, friction)
    tilt = limit_load(assembly, loads, friction=True).load / weight(loads)
    assert tilt == pytest.approx(min(friction, overturning(assembly)), rel=1e-5)
