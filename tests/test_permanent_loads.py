"""Permanent loads of a structure's file, and gravity that turns, against statics by hand."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from structures import (
    BLOCK,
    CUBE,
    DOWN,
    GROUND,
    PUSH,
    WEIGHT,
    degrees,
    dry,
    example,
    moved,
    notch,
    on_ground,
)

from sidmacib import CapacityError, capacity_curve, limit_load
from sidmacib.answers.structure import static_answer
from sidmacib.engines import ENGINES
from sidmacib.engines.run import refusal
from sidmacib.errors import UnboundedError
from sidmacib.mechanics.assembly import GRAVITY, Assembly, FaceMaterial, Vector
from sidmacib.models import structure_limit, structure_static
from sidmacib.scene.forces import arrows_of, load_of
from sidmacib.structure.analysis.limit import limit_tilt
from sidmacib.structure.analysis.tilt import (
    Motion,
    moves_most,
    static_tilt,
    tilting,
    turned,
)
from sidmacib.structure.blocks import Block, box, prism
from sidmacib.structure.files.loads import PermanentSection, permanent_on
from sidmacib.structure.files.structure_file import structure_of
from sidmacib.structure.loads import Permanent
from sidmacib.structure.locks import ALL, Condensed, Locks
from sidmacib.structure.structure import structure
from studies.structures.shapes import arch
from workflow.schema import with_changes

FRICTION, DENSITY = 0.5, 2000.0
PUSHED: dict[str, Any] = {**CUBE, "load": PUSH}


SOIL = {"side": [1, 0, 0], "level": 1, "density": 1800, "coefficient": 0.3, "surcharge": "10kPa"}


def sliding(*permanent: dict[str, Any]) -> float:
    """The push along x, in N, that the cube carries."""
    problem = structure_of({**PUSHED, "permanent": list(permanent)})
    return limit_load(*problem, friction=True).load


def on(assembly: Assembly, *permanent: dict[str, Any]) -> Permanent:
    found = permanent_on(assembly, [PermanentSection.read(each) for each in permanent])
    assert found is not None
    return found


@pytest.mark.parametrize(
    ("permanent", "more"),  # N, that the cube carries
    [
        ({"surcharge": {"pascals": "5kPa"}}, FRICTION * 5000.0),
        ({"surcharge": {"pascals": 5000, "x": [0.25, 0.75]}}, FRICTION * 2500.0),
        ({"pressure": {"side": [-1, 0, 0], "pascals": "2kPa"}}, -2000.0),
        ({"pressure": {"side": [-1, 0, 0], "pascals": -2000}}, 2000.0),
        ({"water": {"side": [-1, 0, 0], "level": 0.8}}, -0.5 * 1000.0 * GRAVITY * 0.8**2),
        ({"earth": SOIL}, 0.3 * (0.5 * 1800.0 * GRAVITY + 10_000.0)),
        ({"force": {**DOWN["force"], "direction": [0, 0, -2], "newtons": "3kN"}}, FRICTION * 3e3),
    ],
)
def test_a_cube_slides_where_permanent_loads_say(permanent: dict[str, Any], more: float) -> None:
    assert sliding(permanent) == pytest.approx(FRICTION * WEIGHT + more, rel=1e-6)


def test_earth_behind_a_wall_overturns_it_at_the_height_of_the_triangle() -> None:
    """A wall of 0.5 by 2 m: W b / 2 = K gamma h^3 / 6 + P h / 2 about its toe."""
    earth = {"side": [-1, 0, 0], "level": 2, "coefficient": 0.1, "density": 1800}
    wall = {"blocks": {"cube": {"high": [0.5, 1, 2]}}, "interfaces": {"friction": 2}}
    given = with_changes(PUSHED, wall) | {"permanent": [{"earth": earth}]}
    expected = WEIGHT * 0.25 - 0.1 * 1800 * GRAVITY * 2**2 / 2 * 2 / 3
    assert limit_load(*structure_of(given), friction=True).load == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("seed", range(3))
def test_water_all_around_lifts_by_what_the_block_displaces(seed: int) -> None:
    """Archimedes: but for the area on which the block stands, which is dry."""
    random = np.random.default_rng(seed)
    angles = np.sort(random.uniform(0, 2 * math.pi, 7))
    outline = [(math.cos(a), math.sin(a), 0.0) for a in angles.tolist()]
    lean = (0.3, -0.2, 1.2)
    ground = box("ground", (-0.05, -0.05, -0.5), (0.05, 0.05, 0.0), DENSITY, fixed=True)
    block = prism("block", outline, lean, DENSITY)
    assembly = structure([ground, block], dry(FRICTION))
    (face,) = assembly.faces
    level = 2.0
    found = Permanent.none(2)
    for normal in block.normals:
        side = {"side": normal.tolist(), "within": 0.1, "level": level}
        found += on(assembly, {"water": side})
    force, moment = found.wrenches[1, :3], found.wrenches[1, 3:]
    dry_base = 1000.0 * GRAVITY * level * face.area
    lift = 1000.0 * GRAVITY * block.volume
    assert force == pytest.approx([0.0, 0.0, lift - dry_base], abs=1e-6 * lift)
    arm = np.array(face.middle) - block.centre
    assert moment == pytest.approx(np.cross(arm, [0, 0, -dry_base]), abs=1e-6 * lift)


def test_pressure_on_blocks_with_locks_is_that_on_their_sides() -> None:
    """The ends of the locks carry their part; the inside of blocks that were cut carries none."""
    given = example("keyed")
    given["blocks"]["base"]["fixed"] = False
    given["blocks"]["ground"] = {"low": [0, 0, -0.6], "high": [0.4, 0.6, -0.3], "fixed": True}
    assembly = structure_of(given).assembly
    found = on(assembly, {"pressure": {"side": [1, 0, 0], "pascals": 1000}})
    assert found.wrenches[:, 0].sum() == pytest.approx(-1000.0 * 0.6 * 0.6, rel=1e-9)
    assert (np.abs(found.wrenches[:, 0]) > 0.0).sum() == 5  # two blocks and three locks


@pytest.mark.long
def test_the_point_of_a_permanent_force_moves_with_its_block() -> None:
    """A block that rocks about an edge under its weight and a force on the middle of its top."""
    force = DOWN["force"] | {"newtons": WEIGHT}
    given = {**PUSHED, "interfaces": {"friction": 2}, "permanent": [{"force": force}]}
    curve = capacity_curve(*structure_of(given))
    turns = [each.placed.turn[1] for each in curve.path.positions[:-1]]
    turn = np.array([math.atan2(each[0, 2], each[0, 0]) for each in turns])
    own = WEIGHT * (np.cos(turn) - np.sin(turn)) / 2
    top = WEIGHT * (np.cos(turn) / 2 - np.sin(turn))
    expected = (own + top) / ((np.cos(turn) + np.sin(turn)) / 2)
    assert len(turn) > 10
    assert curve.load[:-1] == pytest.approx(expected, abs=1e-6 * curve.load[0])


SLOPE = {"tilt": {"axis": [0, 1, 0]}}
PRESSED = [
    {"surcharge": {"pascals": 0.4 * WEIGHT}},
    {"force": DOWN["force"] | {"newtons": 0.4 * WEIGHT}},
]


def slides_at(share: float) -> float:
    """W sin t = mu (W cos t + P), P being a ``share`` of W; degrees."""
    angle = math.atan(FRICTION)
    return math.degrees(angle + math.asin(share * math.sin(angle)))


@pytest.mark.parametrize("permanent", PRESSED)
def test_a_block_on_a_slope_slides_later_if_it_is_pressed(permanent: dict[str, Any]) -> None:
    problem = structure_of({**CUBE, "permanent": [permanent], "load": SLOPE})
    limit = limit_tilt(*problem).angle
    assert limit == pytest.approx(slides_at(0.4), abs=1e-3)
    answer = static_answer(problem)
    assert answer.load == pytest.approx(slides_at(0.4), rel=1e-3)
    assert answer.mode == "sliding"


@pytest.mark.long
def test_a_force_on_top_of_a_tilted_block_holds_it_by_its_lever() -> None:
    """W (h sin t - b cos t) / 2 = P x + Q h about the lower edge, x = 0; Q pulls it uphill."""
    force = {**PRESSED[1]["force"], "at": [0.2, 0.5, 1], "newtons": 0.1 * WEIGHT}
    up = {**force, "direction": [1, 0, 0], "at": [0.5, 0.5, 1], "newtons": 0.05 * WEIGHT}
    stiff = {"friction": 3, "normal_stiffness": 1e14, "shear_stiffness": 1e14}
    given = {**CUBE, "interfaces": stiff, "load": SLOPE}
    for forces, moment in (((force,), 0.1 * 0.2), ((force, up), 0.1 * 0.2 + 0.05 * 1.0)):
        problem = structure_of({**given, "permanent": [{"force": each} for each in forces]})
        exact = 45.0 + math.degrees(math.asin(2.0 * moment / math.sqrt(2.0)))
        found = limit_tilt(*problem).angle
        assert found == pytest.approx(exact, abs=1e-3)
        assert static_answer(problem).load == pytest.approx(exact, rel=2e-3)


def test_arrows_and_words_tell_what_does_not_turn() -> None:
    problem = structure_of({**CUBE, "permanent": PRESSED[1:], "load": SLOPE})
    found = arrows_of(*problem, load=problem.loads.scale * math.pi / 2)
    assert found["variable"][0]["force"] == pytest.approx([-WEIGHT, 0, 0], abs=1e-6)
    assert found["permanent"][0]["force"] == pytest.approx([0, 0, -0.4 * WEIGHT])
    assert load_of(problem).endswith("permanent loads beside weight, together (0, 0, -7848) N")


@pytest.mark.parametrize("load", [PUSH, SLOPE])
def test_what_falls_is_said_to_fall_by_all_permanent_loads(load: dict[str, Any]) -> None:
    pressed = {"pressure": {"side": [-1, 0, 0], "pascals": 2 * WEIGHT}}
    problem = structure_of({**CUBE, "permanent": [pressed], "load": load})
    for model in (structure_static, structure_limit):
        with pytest.raises(CapacityError, match="own weight and the other permanent loads"):
            model.solve(problem)


def test_engines_refuse_permanent_loads_beside_gravity_that_turns() -> None:
    problem = structure_of({**CUBE, "permanent": PRESSED[:1], "load": SLOPE})
    for name in ("yade", "liggghts"):
        assert (refusal(ENGINES[name], *problem) or "").startswith("gravity turns beside other")
        assert refusal(ENGINES[name], *structure_of({**CUBE, "load": SLOPE})) is None


# --- gravity that turns, against theory and under changes that mean nothing ----------------------
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
    model = structure(
        [GROUND, slab], FaceMaterial(1e10, 1e10, friction, cohesion, 1e6, bond_friction=0.0)
    )
    found = static_tilt(model, tilting(model, Y))
    assert found.first_failure == pytest.approx(fails, abs=0.01)
    assert found.angle == pytest.approx(falls, abs=0.01)
    assert found.motion is motion
    if motion is Motion.BONDS:
        assert found.mechanism is None
        assert limit_tilt(model, tilting(model, Y)).angle == pytest.approx(falls, abs=1e-3)


@pytest.mark.long
def test_a_block_that_is_glued_on_hangs_upside_down() -> None:
    model = structure([GROUND, BLOCK], FaceMaterial(1e10, 1e10, 0.0, 1e9, 1e9))
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
        load = loads.raised.newtons(angle)
        assert load == pytest.approx(math.radians(angle) * BLOCK.weight)
        assert loads.raised.value(load) == pytest.approx(angle)
        assert loads.at(load) == pytest.approx(turned(loads, angle).permanent)
    assert loads.at(1e-3) == pytest.approx(loads.permanent + 1e-3 * loads.variable)


STONE, STEP = box("block", (0.0, 0.0, 0.0), (0.5, 0.4, 0.3), 2e3), np.array([0.05, 0.03, 0.3])
STACK = [  # each a little further along x and y than the one below
    replace(moved(STONE, Rotation.identity(), k * STEP), name=f"block{k}") for k in range(3)
]
SHAPES = {"stack": [GROUND, *STACK], "arch": arch(9, 0.25), "wedge": notch(1.0, 2.3)}


def both(blocks: list[Block], axis: Vector) -> tuple[float, float]:
    model = structure(blocks, dry(0.4))
    tilt = tilting(model, axis)
    return static_tilt(model, tilt).angle, limit_tilt(model, tilt).angle


@pytest.mark.long
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
