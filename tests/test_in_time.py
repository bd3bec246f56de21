"""The model in time against closed forms: Newmark's block, Housner's block, flight, collapse."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial import ConvexHull

from sidmacib.answers.in_time import TimeAnswer
from sidmacib.dynamics.motion import History
from sidmacib.dynamics.shapes import convex_parts
from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import GRAVITY
from sidmacib.structure.files.structure_file import assembly_of, demands_of

GROUND = {"low": [-3, -3, -0.5], "high": [3, 3, 0], "fixed": True}
FLAT = {"low": [0, 0, 0], "high": [0.6, 0.3, 0.2]}
SLENDER = {"low": [0, 0, 0], "high": [0.1, 0.2, 1.0]}


def described(blocks: dict[str, Any], load: dict[str, Any], friction: float) -> dict[str, Any]:
    return {"blocks": blocks, "interfaces": {"friction": friction}, "load": load}


def moved(blocks: dict[str, Any], load: dict[str, Any], friction: float) -> TimeAnswer:
    return TimeAnswer.of(demands_of(described(blocks, load, friction), in_time=True)[0].problem)


def pulse(acceleration: float, duration: float, **more: Any) -> dict[str, Any]:
    shape = {"acceleration": acceleration, "duration": duration, **more}
    return {"pulse": shape, "direction": [-1, 0, 0]}


def free(found: History) -> np.ndarray[Any, Any]:
    """Shifts of the second piece, the only one that is free."""
    return found.shift[:, 1]


@pytest.mark.parametrize("level", [0.35, 0.5, 1.0])
def test_a_block_slips_as_far_as_newmark_says_and_does_not_lift(level: float) -> None:
    """Newmark (1965): v^2 / (2 mu g) after the pulse, and what it has slipped in it."""
    mu, time = 0.3, 0.2
    load = {"ground": pulse(level * GRAVITY, time), "duration": 1.5}
    answer = moved({"ground": GROUND, "block": FLAT}, load, mu)
    faster = (level - mu) * GRAVITY
    slip = faster * time**2 / 2 + (faster * time) ** 2 / (2 * mu * GRAVITY)
    assert free(answer.history)[-1, 0] == pytest.approx(slip, rel=5e-3)
    assert np.abs(free(answer.history)[:, 1:]).max() < 1e-8
    assert answer.history.stands


def test_a_block_slips_down_a_slope_as_far_as_newmark_says() -> None:
    """It slips under what of the pulse is above its critical acceleration, and then decelerates."""
    mu, slope, level, time = 0.5, math.radians(20.0), 0.4, 0.3
    x, z = math.cos(slope), math.sin(slope)
    wedge = {"outline": [[-1, 0, -1], [2, 0, -1], [2 * x, 0, -2 * z], [-x, 0, z]]}
    wedge |= {"along": [0, 0.5, 0], "fixed": True}
    corners = [[0, 0], [0.5, 0], [0.5, 0.2], [0, 0.2]]
    outline = [[x * u + z * w, 0, -z * u + x * w] for u, w in corners]
    block = {"outline": outline, "along": [0, 0.3, 0]}
    motion = {"pulse": {"acceleration": level * GRAVITY, "duration": time}}
    motion["direction"] = [-x, 0, z]
    answer = moved({"ground": wedge, "block": block}, {"ground": motion, "duration": 3}, mu)
    holds = GRAVITY * (mu * x - z)
    faster = level * GRAVITY - holds
    slip = faster * time**2 / 2 + (faster * time) ** 2 / (2 * holds)
    assert np.linalg.norm(free(answer.history)[-1]) == pytest.approx(slip, rel=5e-3)


def rocked(step: float, alpha: float) -> tuple[float, float]:
    """Largest angles over ``alpha`` of a block that a pulse makes rock: before and after an impact.

    The pulse ends before the impact, when the block has turned by about a quarter of alpha.
    """
    width = 0.2
    radius = 0.5 * width / math.sin(alpha)
    time = math.sqrt(4.0 * radius / (3.0 * GRAVITY))
    block = {"low": [0, 0, 0], "high": [width, 0.2, width / math.tan(alpha)]}
    motion = pulse(1.5 * GRAVITY * math.tan(alpha), time)
    load = {"ground": motion, "duration": 8 * time, "step": step}
    turn = moved({"ground": GROUND, "block": block}, load, 3.0).history.turn[:, 1, 1] / alpha
    turn = turn * math.copysign(1.0, turn[np.argmax(np.abs(turn))])
    return float(turn.max()), float(-turn[int(turn.argmax()) :].min())


@pytest.mark.parametrize("alpha", [0.15, 0.25])
def test_a_rocking_block_loses_housners_energy_at_an_impact(alpha: float) -> None:
    """Housner (1963): the velocity after is r = 1 - 1.5 sin^2(alpha) of that before.

    The error is of the order of the step.
    """

    def height(angle: float) -> float:  # of the centroid over where it rests, over its radius
        return math.cos(alpha - angle * alpha) - math.cos(alpha)

    wanted = 1.0 - 1.5 * math.sin(alpha) ** 2
    errors = []
    for step in (2e-3, 5e-4):
        before, after = rocked(step, alpha)
        assert before > 0.5
        errors.append(math.sqrt(height(after) / height(before)) / wanted - 1.0)
    assert abs(errors[1]) < 0.01
    assert abs(errors[1]) < 0.5 * abs(errors[0])


def overturns(level: float, time: float) -> bool:
    load = {"ground": pulse(level * 0.1 * GRAVITY, time), "duration": 4.0}
    return not moved({"ground": GROUND, "block": SLENDER}, load, 3.0).history.stands


def exact_overturns(level: float, time: float) -> bool:
    """By the equation of motion of a block that rocks about one edge."""
    alpha, radius = math.atan(0.1), 0.5 * math.hypot(0.1, 1.0)

    def rate(t: float, y: Any) -> tuple[float, float]:
        push = level * 0.1 if t < time else 0.0
        turn = push * math.cos(alpha - y[0]) - math.sin(alpha - y[0])
        return y[1], 0.75 * GRAVITY / radius * turn

    found = solve_ivp(rate, (0.0, 4.0), (0.0, 0.0), max_step=2e-3, rtol=1e-9, atol=1e-12)
    back = int(np.argmax(found.y[0] < -1e-9)) or len(found.t)
    return bool(found.y[0, :back].max() > 2.0 * alpha)


@pytest.mark.long
@pytest.mark.parametrize("level", [1.5, 3.0])
def test_the_shortest_pulse_that_overturns_a_block(level: float) -> None:
    """Within 2 % of the equation of motion, which is Housner's (1963) for slender blocks."""
    low, high = 0.05, 0.4
    while high - low > 1e-4:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if exact_overturns(level, middle) else (middle, high)
    assert overturns(level, 1.02 * high)
    assert not overturns(level, 0.98 * high)


def test_a_block_that_is_thrown_flies_on_a_parabola_and_lands() -> None:
    load = {"blow": {"block": "block", "velocity": [0.5, 0, 3.0]}, "duration": 1.5}
    answer = moved({"ground": GROUND, "block": FLAT}, load, 0.8)
    path, time = free(answer.history), answer.history.time
    up = time < 2 * 3.0 / GRAVITY - 0.01
    assert path[up, 2] == pytest.approx(3.0 * time[up] - GRAVITY * time[up] ** 2 / 2, abs=1e-6)
    assert path[up, 0] == pytest.approx(0.5 * time[up], abs=1e-9)
    assert abs(path[-1, 2]) < 2e-3
    assert (np.diff(answer.history.energy) < 1e-6).all()


@pytest.mark.parametrize("restitution", [0.0, 0.6])
def test_momentum_is_kept_when_blocks_collide_off_centre(restitution: float) -> None:
    """On smooth ground, which takes none along it: linear, and angular about the vertical."""
    blocks = {
        "ground": GROUND,
        "one": {"low": [-0.8, 0.0, 0], "high": [-0.4, 0.4, 0.2]},
        "two": {"low": [0.2, 0.25, 0], "high": [0.6, 0.85, 0.2]},
    }
    blow = {"block": "one", "velocity": [2.0, 0, 0]}
    load = {"blow": blow, "duration": 0.6, "restitution": restitution}
    answer = moved(blocks, load, 0.0)
    assembly, found = answer.problem.assembly, answer.history
    time, shift, turn = found.time, found.shift, found.turn[:, :, 2]
    mass, angular, linear = [each.mass for each in assembly.pieces], 0.0, 0.0
    speed = (shift[-1] - shift[-20]) / (time[-1] - time[-20])
    spin = (turn[-1] - turn[-20]) / (time[-1] - time[-20])
    for k, gyration in ((1, (0.4**2 + 0.4**2) / 12.0), (2, (0.4**2 + 0.6**2) / 12.0)):
        x, y, _ = assembly.pieces[k].centre + shift[-1, k]
        linear += mass[k] * speed[k]
        angular += mass[k] * (x * speed[k, 1] - y * speed[k, 0] + gyration * spin[k])
    assert linear == pytest.approx([mass[1] * 2.0, 0.0, 0.0], abs=1e-6 * mass[1])
    assert angular == pytest.approx(-mass[1] * 2.0 * 0.2, rel=1e-3)
    assert abs(spin[2]) > 0.1


def test_energy_never_rises_while_a_stack_comes_to_rest() -> None:
    blocks = {"ground": GROUND, "a": FLAT, "b": {"low": [0, 0, 0.2], "high": [0.2, 0.3, 0.9]}}
    load = {"blow": {"block": "b", "velocity": [0.6, 0.1, 0]}, "duration": 2}
    answer = moved(blocks, load, 0.5)
    size = abs(answer.history.energy).max()
    assert size > 1.0
    assert np.diff(answer.history.energy).max() < 1e-5 * size  # of the midpoint rule, in flight
    assert answer.history.pressed < 1e-3


def test_a_coefficient_of_restitution_of_one_half_makes_a_block_bounce() -> None:
    """Straight on: with half of its velocity, so to a quarter of its height."""
    load = {"blow": {"block": "block", "velocity": [0, 0, 3.0]}, "duration": 1.2}
    found = moved({"ground": GROUND, "block": FLAT}, {**load, "restitution": 0.5}, 0.5).history
    flight, path = found.time < 2 * 3.0 / GRAVITY, free(found)[:, 2]
    assert path[~flight][5:].max() == pytest.approx(path[flight].max() / 4, rel=0.02)


TRILITH = {
    "ground": GROUND,
    "left": {"low": [0, 0, 0], "high": [0.3, 0.3, 1], "fixed": True},
    "right": {"low": [1.2, 0, 0], "high": [1.5, 0.3, 1]},
    "lintel": {"low": [0, 0, 1], "high": [1.5, 0.3, 1.2]},
}


def test_a_lintel_falls_where_its_support_is_lost_and_stands_else() -> None:
    assert moved(TRILITH, {"duration": 1}, 0.6).history.stands
    answer = moved(TRILITH, {"duration": 1.5, "lost": "left"}, 0.6)
    assert answer.words.startswith("No: ")
    first = answer.history.first_fallen
    assert first is not None and answer.problem.assembly.pieces[first].name == "lintel"


def test_blocks_meet_that_did_not_touch() -> None:
    far = {"low": [0.7, 0, 0], "high": [1.0, 0.3, 0.2]}
    load = {"blow": {"block": "block", "velocity": [2, 0, 0]}, "duration": 2}
    answer = moved({"ground": GROUND, "block": FLAT, "far": far}, load, 0.2)
    gap = 0.1 + answer.history.shift[:, 2, 0] - answer.history.shift[:, 1, 0]
    assert gap.min() > -1e-4
    assert answer.history.shift[-1, 2, 0] > 0.1


def test_a_block_that_is_not_convex_holds_another_in_its_notch() -> None:
    """It does not slide out sideways, as it would from a flat top."""
    notch = [[0, 0], [0.6, 0], [0.6, 0.4], [0.4, 0.4], [0.4, 0.2], [0.2, 0.2], [0.2, 0.4], [0, 0.4]]
    channel = {"outline": [[x, 0, z] for x, z in notch], "along": [0, 0.3, 0], "fixed": True}
    key = {"low": [0.2, 0, 0.2], "high": [0.4, 0.3, 0.35]}
    load = {"ground": pulse(0.5 * GRAVITY, 0.2), "duration": 1}
    answer = moved({"channel": channel, "key": key}, load, 0.0)
    assert np.abs(free(answer.history)).max() < 1e-6


def drum(sides: int) -> dict[str, Any]:
    """A prism of so many sides about an axis, 1 m wide and 1 m high."""
    angles = 2 * np.pi * np.arange(sides) / sides
    base = [[0.5 * math.cos(each), 0.5 * math.sin(each), 0.0] for each in angles]
    return {"outline": base, "along": [0, 0, 1]}


def outlined(places: list[list[float]]) -> dict[str, Any]:
    return {"outline": [[x, 0, z] for x, z in places], "along": [0, 0.3, 0]}


T = [[0, 0], [0.2, 0], [0.2, 0.4], [0.4, 0.4], [0.4, 0.6], [-0.2, 0.6], [-0.2, 0.4], [0, 0.4]]
PLUS = [[0, 0.2], [0.2, 0.2], [0.2, 0], [0.4, 0], [0.4, 0.2], [0.6, 0.2], [0.6, 0.4], [0.4, 0.4]]
PLUS += [[0.4, 0.6], [0.2, 0.6], [0.2, 0.4], [0, 0.4]]
DOVETAIL = [
    [0, 0],
    [0.6, 0],
    [0.4, 0.3],
    [0.8, 0.3],
    [0.8, 0.6],
    [-0.2, 0.6],
    [-0.2, 0.3],
    [0.2, 0.3],
]


@pytest.mark.parametrize("places", [T, PLUS, DOVETAIL], ids=["T", "plus", "dovetail"])
@pytest.mark.parametrize("angle", [0.0, 0.35, 1.2])
def test_convex_parts_of_a_block_add_up_to_it(places: list[list[float]], angle: float) -> None:
    """Cuts leave flaps without thickness, which are no edges to cut along again."""
    c, s = math.cos(angle), math.sin(angle)
    turned = [[c * x - s * z, s * x + c * z + 2] for x, z in places]
    below = {"low": [-1, 0, 0], "high": [1, 0.3, 1], "fixed": True}
    problem = {"blocks": {"ground": below, "other": {"low": [0, 0, 1], "high": [1, 0.3, 2]}}}
    (block,) = [
        each
        for each in assembly_of(
            {"blocks": {**problem["blocks"], "b": {**outlined(turned), "fixed": True}}}
        ).pieces
        if each.name == "b"
    ]
    parts = [*convex_parts(block)]
    assert len(parts) > 1
    hulls = [ConvexHull(each.places).volume for each in parts]
    assert sum(hulls) == pytest.approx(block.volume, rel=1e-6)


def test_sides_given_as_triangles_bear_as_a_whole() -> None:
    corners = [[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    triangles = [[0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4]]
    triangles += [[2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5]]
    blocks = {
        "ground": GROUND,
        "cube": {"vertices": corners, "faces": triangles},
        "one": {"low": [0.1, 0.6, 1], "high": [0.3, 0.8, 1.2]},
        "other": {"low": [0.7, 0.1, 1], "high": [0.9, 0.3, 1.2]},
    }
    answer = moved(blocks, {"duration": 0.5}, 0.7)
    assert answer.largest_shift.size < 1e-6


def test_small_blocks_rest_on_a_large_one_that_is_free() -> None:
    """Impulses of blocks that weigh a millionth of others are as exact."""
    blocks: dict[str, Any] = {"ground": GROUND, "large": {"low": [0, 0, 0], "high": [1, 1, 1]}}
    for number in range(5):
        x, z = 0.5 + 0.0015 * (number % 2), 1 + 0.005 * number
        blocks[f"p{number}"] = {"low": [x, 0.5, z], "high": [x + 0.005, 0.505, z + 0.005]}
    assert moved(blocks, {"duration": 1}, 0.7).largest_shift.size < 1e-6


def test_no_vertex_passes_the_ground_below_steep_sides() -> None:
    """A pyramid that is thrown onto its tip, beside which other sides look more downwards."""
    tip = {
        "vertices": [[0, 0, 0.4], [0.5, -0.2, 1], [0.5, 0.2, 1], [-0.5, 0.2, 1], [-0.5, -0.2, 1]]
    }
    tip["faces"] = [[0, 2, 1], [0, 3, 2], [0, 4, 3], [0, 1, 4], [1, 2, 3, 4]]
    held = {"low": [-0.6, -0.3, 1], "high": [0.6, 0.3, 1.2], "fixed": True}
    answer = moved({"ground": GROUND, "tip": tip, "held": held}, {"duration": 1.5}, 0.7)
    assert answer.history.pressed < 5e-3


@pytest.mark.long
@pytest.mark.parametrize("sides", [12, 24, 40])
def test_a_drum_rests_and_tips_about_its_edge_where_statics_says(sides: int) -> None:
    """A force at its top tips it at W r / h, with the distance r of the edge in its direction."""
    blocks = {"ground": GROUND, "drum": drum(sides)}
    weight = 2000 * GRAVITY * sides / 8 * math.sin(2 * math.pi / sides)
    assert moved(blocks, {"duration": 0.5}, 0.8).largest_turn.size < 1e-6
    for angle in (0.0, 0.4, 1.9, 3.6):
        direction = [math.cos(angle), math.sin(angle), 0]
        reach = max(0.5 * math.cos(angle - 2 * math.pi * k / sides) for k in range(sides))
        acts = {"block": "drum", "at": [0, 0, 1], "direction": direction}
        load = {"force": acts, "duration": 0.5}
        held = moved(blocks, {**load, "newtons": 0.9 * weight * 0.5 * math.cos(0.27)}, 5.0)
        assert held.largest_turn.size < 1e-4
        tipped = moved(blocks, {**load, "newtons": 1.1 * weight * reach}, 5.0)
        assert tipped.largest_turn.size > 0.02


def test_a_side_of_too_many_corners_is_refused() -> None:
    with pytest.raises(CapacityError, match="drum has a side of more than 64 corners"):
        moved({"ground": GROUND, "drum": drum(80)}, {"duration": 0.5}, 0.5)
