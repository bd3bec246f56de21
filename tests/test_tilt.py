"""Gravity that turns, against theory and under changes that mean nothing."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from structures import BLOCK, GROUND, degrees, dry, moved, notch, on_ground

from sidmacib.errors import UnboundedError
from sidmacib.mechanics.assembly import FaceMaterial, Vector
from sidmacib.structure.analysis.limit import limit_tilt
from sidmacib.structure.analysis.tilt import (
    Motion,
    load_of_tilt,
    moves_most,
    static_tilt,
    tilt_of_load,
    tilting,
    turned,
)
from sidmacib.structure.blocks import Block, box
from sidmacib.structure.locks import ALL, Condensed, Locks
from sidmacib.structure.structure import Pair, structure
from studies.structures.shapes import arch

STRONG = FaceMaterial(1e10, 1e10, 0.0, 1e9, 1e9)
Y = (0.0, 1.0, 0.0)


@pytest.mark.parametrize(
    ("friction", "axis", "slope", "motion"),
    [
        (0.2, (1.0, 0.0, 0.0), 0.2, Motion.SLIDING),
        (0.2, (0.0, -2.0, 0.0), 0.2, Motion.SLIDING),
        (0.2, (math.sqrt(3), 1.0, 0.0), 0.2, Motion.SLIDING),
        (0.84, (0.0, 1.0, 0.0), 0.4, Motion.ROCKING),
        (0.84, (1.0, 0.0, 0.0), 0.6, Motion.ROCKING),
    ],
)
def test_a_block_on_a_slope_slides_at_its_friction_angle_or_overturns_at_b_over_h(
    friction: float, axis: Vector, slope: float, motion: Motion
) -> None:
    model = on_ground(friction)
    loads = tilting(model, axis)
    found, limit = static_tilt(model, loads), limit_tilt(model, loads)
    assert found.angle == found.first_failure == pytest.approx(degrees(slope), abs=0.01)
    assert limit.angle == pytest.approx(degrees(slope), rel=1e-6)
    assert found.motion is motion
    assert limit.mechanism is not None
    assert moves_most(model, limit.mechanism) == "block"


@pytest.mark.parametrize(
    ("fails", "friction", "falls", "motion"),
    [(30.0, 0.0, 30.0, Motion.BONDS), (10.0, 0.5, degrees(0.5), Motion.SLIDING)],
)
def test_a_bond_fails_where_the_weight_along_it_is_its_cohesion_and_friction_holds_on(
    fails: float, friction: float, falls: float, motion: Motion
) -> None:
    slab = box("slab", (0.0, 0.0, 0.0), (0.4, 0.6, 0.01), 2e3)
    cohesion = math.sin(math.radians(fails)) * slab.weight / (0.4 * 0.6)
    model = structure([GROUND, slab], FaceMaterial(1e10, 1e10, friction, cohesion, 1e6))
    found = static_tilt(model, tilting(model, Y))
    assert found.first_failure == pytest.approx(fails, abs=0.01)
    assert found.angle == pytest.approx(falls, abs=0.01)
    assert found.motion is motion
    if motion is Motion.BONDS:
        assert found.mechanism is None
        assert limit_tilt(model, tilting(model, Y)).angle == pytest.approx(falls, abs=1e-3)


def test_a_block_that_is_glued_on_hangs_upside_down() -> None:
    model = structure([GROUND, BLOCK], STRONG)
    assert limit_tilt(model, tilting(model, Y)).angle == 180.0
    with pytest.raises(UnboundedError, match="up to 180 degrees"):
        static_tilt(model, tilting(model, Y))


def test_gravity_turns_by_the_right_hand_rule_and_keeps_its_size() -> None:
    model = on_ground(0.7)
    about_y = tilting(model, Y)
    for angle, way in ((90.0, [-1.0, 0.0, 0.0]), (180.0, [0.0, 0.0, 1.0])):
        gravity = turned(about_y, angle).permanent[1, :3] / BLOCK.weight
        assert gravity == pytest.approx(way)
    weight = turned(tilting(model, (1.0, 2.0, 0.5)), 70.0).permanent
    assert np.linalg.norm(weight[1]) == pytest.approx(BLOCK.weight)
    assert not weight[0].any()


@pytest.mark.parametrize("axis", [(0.0, 1.0, 0.0), (1.0, 2.0, 0.5)])
def test_gravity_that_turns_is_a_load_of_the_weight_times_the_angle(axis: Vector) -> None:
    loads = tilting(on_ground(0.7), axis)
    for angle in (0.0, 30.0, 130.0):
        load = load_of_tilt(angle, loads)
        assert tilt_of_load(load, BLOCK.weight) == pytest.approx(angle)
        assert loads.at(load) == pytest.approx(turned(loads, angle).permanent)
    assert loads.at(1e-3) == pytest.approx(loads.permanent + 1e-3 * loads.variable)


STONE, STEP = box("block", (0.0, 0.0, 0.0), (0.5, 0.4, 0.3), 2e3), np.array([0.05, 0.03, 0.3])
STACK = [  # each a little further along x and y than the one below
    replace(moved(STONE, Rotation.identity(), k * STEP), name=f"block{k}") for k in range(3)
]
SHAPES = {"stack": [GROUND, *STACK], "arch": arch(9, 0.25), "wedge": notch(1.0, 2.3)}
MATERIAL = dry(0.4)


def both(
    blocks: list[Block], axis: Vector, special: dict[Pair, FaceMaterial] | None = None
) -> tuple[float, float]:
    model = structure(blocks, MATERIAL, special)
    tilt = tilting(model, axis)
    return static_tilt(model, tilt).angle, limit_tilt(model, tilt).angle


@pytest.mark.parametrize("shape", SHAPES)
@settings(max_examples=2, deadline=None)
@given(
    about=st.floats(-3.0, 3.0),
    shift=st.lists(st.floats(-9.0, 9.0), min_size=3, max_size=3),
)
def test_turned_and_shifted_axes_mean_nothing(shape: str, about: float, shift: list[float]) -> None:
    """Turned about the vertical, as gravity begins along -z."""
    axis = np.array([0.3, 1.0, 0.0])
    here = both(SHAPES[shape], (0.3, 1.0, 0.0))
    turn = Rotation.from_rotvec([0.0, 0.0, about])
    x, y, z = turn.apply(axis).tolist()
    there = both([moved(block, turn, shift) for block in SHAPES[shape]], (x, y, z))
    assert there == pytest.approx(here, rel=5e-4)


def test_condensed_locks_hold_what_slides_along_their_row_up_to_their_strength() -> None:
    block = box("block", (0.0, 0.0, 0.0), (0.6, 0.6, 0.2), 2e3)
    area, strength = 0.36, 0.5 * block.weight
    inner = FaceMaterial(1e10, 1e10, 0.0, cohesion=strength / area, tensile_strength=1e9)
    locks = Locks(3, 0.01, row=(1.0, 0.0, 0.0), inner=inner, condensed=Condensed(ALL))
    pair = frozenset(("ground", "block"))
    model = structure([GROUND, block], dry(0.0), locked={pair: locks})
    expected = math.degrees(math.asin(0.5))  # the tangent would tell 26.6 degrees
    assert limit_tilt(model, tilting(model, Y)).angle == pytest.approx(expected, abs=1e-2)
