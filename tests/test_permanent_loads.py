"""Permanent loads of a structure's file, against statics by hand."""

import math
from typing import Any

import numpy as np
import pytest
from structures import dry, example

from sidmacib.answers.structure import static_answer
from sidmacib.answers.structure_limit import limit_state
from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import GRAVITY, Assembly
from sidmacib.mechanics.limit import limit_load
from sidmacib.structure.analysis.capacity_curve import capacity_curve
from sidmacib.structure.blocks import box, prism
from sidmacib.structure.files.loads import PermanentSection, permanent_on
from sidmacib.structure.files.structure_file import structure_of
from sidmacib.structure.loads import Permanent
from sidmacib.structure.structure import structure

FRICTION, DENSITY = 0.5, 2000.0
WEIGHT = DENSITY * GRAVITY  # of the cube of 1 m
CUBE: dict[str, Any] = {
    "blocks": {
        "ground": {"low": [-2, -2, -1], "high": [3, 3, 0], "fixed": True},
        "cube": {"low": [0, 0, 0], "high": [1, 1, 1], "density": DENSITY},
    },
    "interfaces": {"friction": FRICTION},
    "load": {"acceleration": [1, 0, 0]},
}


def sliding(*permanent: dict[str, Any]) -> float:
    """The push along x, in N, that the cube carries."""
    problem = structure_of({**CUBE, "permanent": list(permanent)})
    return limit_load(*problem, friction=True).load


def on(assembly: Assembly, *permanent: dict[str, Any]) -> Permanent:
    found = permanent_on(assembly, [PermanentSection.read(each) for each in permanent])
    assert found is not None
    return found


@pytest.mark.parametrize(
    ("permanent", "push"),
    [
        ({"surcharge": {"pascals": "5kPa"}}, FRICTION * (WEIGHT + 5000.0)),
        ({"surcharge": {"pascals": 5000, "x": [0.25, 0.75]}}, FRICTION * (WEIGHT + 2500.0)),
        ({"pressure": {"side": [-1, 0, 0], "pascals": "2kPa"}}, FRICTION * WEIGHT - 2000.0),
        ({"pressure": {"side": [-1, 0, 0], "pascals": -2000}}, FRICTION * WEIGHT + 2000.0),
        (
            {"water": {"side": [-1, 0, 0], "level": 0.8}},
            FRICTION * WEIGHT - 0.5 * 1000.0 * GRAVITY * 0.8**2,
        ),
        (
            {
                "earth": {
                    **{"side": [1, 0, 0], "level": 1, "density": 1800},
                    **{"coefficient": 0.3, "surcharge": "10kPa"},
                }
            },
            FRICTION * WEIGHT + 0.3 * (0.5 * 1800.0 * GRAVITY + 10_000.0),
        ),
        (
            {
                "force": {
                    **{"block": "cube", "at": [0.5, 0.5, 1]},
                    **{"direction": [0, 0, -2], "newtons": "3kN"},
                }
            },
            FRICTION * (WEIGHT + 3000.0),
        ),
    ],
)
def test_a_cube_slides_where_friction_and_permanent_loads_say(
    permanent: dict[str, Any], push: float
) -> None:
    assert sliding(permanent) == pytest.approx(push, rel=1e-6)


def test_earth_behind_a_wall_overturns_it_at_the_height_of_the_triangle() -> None:
    """A wall of 0.5 by 2 m: W b / 2 = K gamma h^3 / 6 + P h / 2 about its toe."""
    wall = {"low": [0, 0, 0], "high": [0.5, 1, 2], "density": DENSITY}
    earth = {"side": [-1, 0, 0], "level": 2, "coefficient": 0.1, "density": 1800}
    given = {
        **CUBE,
        "blocks": {**CUBE["blocks"], "cube": wall},
        "interfaces": {"friction": 2},
        "permanent": [{"earth": earth}],
    }
    weight, push = WEIGHT, 0.1 * 1800 * GRAVITY * 2**2 / 2
    expected = weight * 0.25 - push * 2 / 3
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


def test_the_point_of_a_permanent_force_moves_with_its_block() -> None:
    """A block that rocks about an edge under its weight and a force on the middle of its top."""
    force = {"block": "cube", "at": [0.5, 0.5, 1], "direction": [0, 0, -1], "newtons": WEIGHT}
    given = {**CUBE, "interfaces": {"friction": 2}, "permanent": [{"force": force}]}
    curve = capacity_curve(*structure_of(given))
    turns = [each.placed.turn[1] for each in curve.path.positions[:-1]]
    turn = np.array([math.atan2(each[0, 2], each[0, 0]) for each in turns])
    own = WEIGHT * (np.cos(turn) - np.sin(turn)) / 2
    top = WEIGHT * (np.cos(turn) / 2 - np.sin(turn))
    expected = (own + top) / ((np.cos(turn) + np.sin(turn)) / 2)
    assert len(turn) > 10
    assert curve.load[:-1] == pytest.approx(expected, abs=1e-6 * curve.load[0])


def test_a_structure_that_other_permanent_loads_fell_is_said_to_fall_by_them() -> None:
    pressed = {"pressure": {"side": [-1, 0, 0], "pascals": 2 * WEIGHT}}
    problem = structure_of({**CUBE, "permanent": [pressed]})
    for model in (static_answer, lambda each: limit_state(*each)):
        with pytest.raises(CapacityError, match="own weight and the other permanent loads"):
            model(problem)


@pytest.mark.parametrize(
    ("permanent", "message"),
    [
        ({"pressure": {"side": [0, 0, -1], "pascals": 1}}, "permanent.1.pressure: no side of a"),
        ({"pressure": {"side": [1, 0, 0], "pascals": "5kN"}}, "5kN is a force"),
        ({"earth": {"side": [1, 0, 1], "level": 1, "coefficient": 1}}, "it must be horizontal"),
        ({"surcharge": {"pascals": 1, "x": [1, 0]}}, "the first value must not exceed"),
        ({"surcharge": {"pascals": 1, "blocks": "kube"}}, "permanent.1.surcharge: no side of a"),
        (
            {"force": {"block": "ground", "at": [0, 0, 0], "direction": [1, 0, 0], "newtons": 1}},
            "permanent.1.force.block: 'ground' is not allowed",
        ),
        ({}, "permanent.1: must have one key, force, pressure, surcharge, earth, water"),
    ],
)
def test_a_fault_of_a_permanent_load_is_named(permanent: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        sliding(permanent)


def test_gravity_does_not_turn_beside_permanent_loads() -> None:
    given = {**CUBE, "permanent": [{"surcharge": {"pascals": 1}}]}
    with pytest.raises(ValueError, match=r"load.tilt: must not be given beside permanent"):
        structure_of({**given, "load": {"tilt": {"axis": [0, 1, 0]}}})
