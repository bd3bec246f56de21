"""How structures move at their limit load, and limit analysis without dilation."""

import numpy as np
import pytest
from structures import dry

from sidmacib.mechanics.assembly import Assembly
from sidmacib.mechanics.limit import limit_load
from sidmacib.mechanics.sliding import sliding_limit
from sidmacib.structure.blocks import box
from sidmacib.structure.loads import acceleration
from sidmacib.structure.structure import structure
from studies.structures.shapes import arch

GROUND = box("ground", (-2.0, -2.0, -1.0), (2.0, 2.0, 0.0), 2e3, fixed=True)


def block(friction: float) -> Assembly:
    return structure([GROUND, box("block", (0, 0, 0), (0.4, 0.6, 1.0), 2e3)], dry(friction))


def test_a_block_that_slides_dilates_by_its_friction_and_one_that_rocks_turns() -> None:
    slides, rocks = (
        limit_load(block(friction), acceleration(block(friction), (1, 0, 0)), friction=True)
        for friction in (0.2, 0.84)
    )
    assert slides.mechanism[1] == pytest.approx([1.0, 0.0, 0.2, 0.0, 0.0, 0.0], abs=1e-6)
    # About the foot at x = 0.4 m: 1 m at the centroid, 0.5 m up, is 2 rad.
    assert rocks.mechanism[1] == pytest.approx([1.0, 0.0, 0.4, 0.0, 2.0, 0.0], abs=1e-6)


def test_the_work_of_the_load_in_the_mechanism_of_an_arch_lifts_its_weight() -> None:
    model = structure(arch(12, 0.2), dry(3.0))
    loads = acceleration(model, (1.0, 0.0, 0.0))
    found = limit_load(model, loads, friction=True)
    assert float(np.sum(loads.variable * found.mechanism)) == pytest.approx(1.0)
    lifted = -float(np.sum(loads.permanent * found.mechanism))
    assert lifted == pytest.approx(found.load, rel=1e-6)
    turns = np.round(found.mechanism[2:, 4], 3)
    assert len(set(turns) - {0.0}) == 3  # three bodies between four hinges


@pytest.mark.parametrize(("friction", "expected"), [(0.2, 0.2), (0.84, 0.4)])
def test_a_block_carries_the_same_without_dilation(friction: float, expected: float) -> None:
    model = block(friction)
    found = sliding_limit(model, acceleration(model, (1, 0, 0)))
    assert found.state.load == pytest.approx(expected * model.pieces[1].weight, rel=1e-4)
    assert found.associated.load == pytest.approx(found.state.load, rel=1e-4)


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
