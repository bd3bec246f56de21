"""The exact V-M envelope, SiDMACIB in closed form, and reductions of locks."""

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import scaled
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from joints import sawn
from scipy.spatial import ConvexHull

import sidmacib.contact_points.programme as programme_module
from sidmacib import InfeasibleError, SolverError
from sidmacib.contact_points import (
    OPTIONS,
    READY_OPTIONS,
    REDUCTIONS,
    ContactOption,
    active,
    contact_points,
    half_rule,
)
from sidmacib.contact_points.envelope import envelope, polygon
from sidmacib.contact_points.programme import Sidmacib, capacities, capacity, pair_loads, programme
from sidmacib.joint import DRY, INNER, Direction, HoldDown, Joint, OwnLock, Side
from sidmacib.mechanics.assembly import GRAVITY


def support_of(points: np.ndarray):
    return lambda normal: points[np.argmax(points @ normal)]


@settings(max_examples=50)
@given(arrays(float, (9, 2), elements=st.floats(-1, 1).map(lambda v: round(v, 2))))
def test_vertices_are_found_with_as_few_questions_as_vertices_and_edges(points: np.ndarray) -> None:
    assume(np.linalg.matrix_rank(points - points[0], tol=1e-3) == 2)
    hull = ConvexHull(points)
    assume(hull.volume > 1e-3)
    corners = {tuple(v) for v in points[hull.vertices]}
    found = polygon(support_of(points))
    assert {tuple(v) for v in found.vertices} == corners
    assert found.programmes <= 2 * len(corners)


@given(st.floats(0, 2 * math.pi))
def test_points_inside_an_edge_are_no_vertices(angle: float) -> None:
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [0, -1], [1, 0.3], [-0.5, 1]])
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])

    def mean_support(normal: np.ndarray) -> np.ndarray:
        """Any furthest point will do: here the mean of all of them."""
        reach = square @ turn.T @ normal
        return (square @ turn.T)[reach > reach.max() - 1e-9].mean(axis=0)

    assert len(polygon(mean_support).vertices) == 4


SLENDER = [  # leaning triangles, whose one corner is furthest in many directions
    [(0.0, 0.0), (across, up), (0.5 * across, 0.0)] for across in (1, -1) for up in (5, -5)
]
STRAIGHT = [[(-5, -2), (-5, 3)], [(5, 2), (5, 3)], [(0, -1), (2, 1)]]


@pytest.mark.parametrize("corners", [*SLENDER, *STRAIGHT, [(0.2, 0.3)]])
def test_a_slender_triangle_a_line_and_a_point_have_their_ends_for_vertices(corners) -> None:
    found = polygon(support_of(np.array(corners, float))).vertices
    assert sorted(map(tuple, found)) == sorted(corners)


@pytest.mark.parametrize("locks", [3, 5, 6])
def test_every_capacity_lies_on_the_envelope(locks: int) -> None:
    joint = sawn(locks)
    model = Sidmacib(joint, OPTIONS["option2"])
    found = envelope(model)
    edges = list(zip(found.vertices, np.roll(found.vertices, -1, axis=0), strict=True))
    assert found.programmes <= len(found.vertices) + len(edges)
    s = np.array([joint.T0, joint.T0 * joint.a])
    for eccentricity in (0.0, 0.1, 0.8, math.inf):
        point = capacity(model, Direction(eccentricity))
        at = np.array([point.shear, point.torque]) / s
        distances = [np.linalg.det([(end - start) / s, at - start / s]) for start, end in edges]
        assert min(distances) == pytest.approx(0.0, abs=1e-6)


def zonogon(sides: np.ndarray) -> np.ndarray:
    """Vertices, from the lowest on the left, of all sums of ``sides`` (K, 2) times -1 to 1."""
    sides = sides * np.where(sides[:, :1] < 0, -1.0, 1.0)
    around = sides[np.argsort(sides[:, 1] / sides[:, 0])]
    turns = np.vstack([np.zeros(2), around, -around[:-1]])
    return -sides.sum(axis=0) + 2 * np.cumsum(turns, axis=0)


@pytest.mark.long
@settings(max_examples=20)
@given(st.lists(st.integers(1, 50), min_size=1, max_size=6, unique=True), st.integers(2, 5))
def test_without_friction_a_contact_point_adds_two_edges(distances: list[int], locks: int) -> None:
    """V is the sum of the forces across, M of the forces times x: a zonogon, known by hand."""
    joint, positions = sawn(locks), [sign * x for x in distances for sign in (-1, 1)]
    count = len(positions)
    option = ContactOption(tuple(x / 100 for x in positions), (1 / count,) * count)
    strength = locks * joint.T0 / count
    expected = zonogon(strength * np.array([(1.0, x / 100 * joint.a) for x in positions]))
    found = envelope(Sidmacib(joint, option, friction=False)).vertices
    assert found.shape == expected.shape
    scale = [joint.T0, joint.T0 * joint.a]
    assert found / scale == pytest.approx(expected / scale, abs=1e-6)


def around_a_circle(noise: float):
    random, turns = np.random.default_rng(1), np.linspace(0, 2 * math.pi, 51)
    exact = support_of(np.column_stack([np.cos(turns), np.sin(turns)]))
    return lambda normal: exact(normal) + noise * random.uniform(-1, 1, 2)


def test_answers_may_be_a_little_off_but_not_contradict_each_other() -> None:
    assert len(polygon(around_a_circle(1e-9)).vertices) == 50
    with pytest.raises(SolverError, match="incomplete after 1000 programmes"):
        polygon(around_a_circle(1e-3))


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_the_tolerance_is_relative_to_the_polygons_size(size: float) -> None:
    corners = size * np.array([(-1, 0), (0, -1), (1, 0), (1e-5, 1), (-1e-5, 1)])
    assert len(polygon(support_of(corners)).vertices) == 5
    assert len(polygon(support_of(corners), tolerance=1e-3).vertices) == 4


def test_points_on_one_side_of_the_weight_have_no_envelope(joint: Joint) -> None:
    model = Sidmacib(joint, ContactOption((0.1, 0.4), (0.5, 0.5)))
    with pytest.raises(InfeasibleError, match=r"^outward normal \(V, M\) = .*: no forces balance"):
        envelope(model)


WEIGHTS = (0.6, 1.0, 0.67, 0.68, 0.01)


@pytest.mark.parametrize(
    ("reduction", "strength"),
    [
        ("none", (1, 1, 1, 1, 1)),
        ("floor_of_sum", (0, 1, 0, 1, 0)),  # 2.96, rounded down
        ("half", (0, 1, 0, 1, 0)),
        ("lower_sum", (0, 1.0, 0, 0.68, 0)),
        ("per_lock", WEIGHTS),
    ],
)
def test_reductions_of_five_locks(reduction: str, strength: tuple[float, ...]) -> None:
    assert REDUCTIONS[reduction](sawn(5), WEIGHTS) == pytest.approx(strength)


def test_lower_locks_count_before_upper_ones() -> None:
    assert active(sawn(5), 3) == (1, 1, 0, 1, 0)
    joint = sawn(3, first=Side.LOWER)
    assert half_rule(joint, ()) == (1.0, 0.0, 0.0)
    assert REDUCTIONS["lower_sum"](joint, (0.1, 1.0, 0.9)) == (0.1, 0.0, 0.9)


def test_half_of_an_even_number_is_refused() -> None:
    with pytest.raises(ValueError, match=r"^locks: 4 is not allowed .*; it must be odd$"):
        half_rule(sawn(4), ())


@pytest.mark.parametrize("rule", ["half", "floor_of_sum"])
def test_rules_that_count_locks_refuse_locks_that_differ_in_strength(rule: str) -> None:
    wide = sawn(3, different={2: OwnLock(width=0.06)})
    message = r"^different: a strength from 240 to 288 N is not allowed with .* the same for all$"
    with pytest.raises(ValueError, match=message):
        REDUCTIONS[rule](wide, (1.0, 1.0, 1.0))
    heavy = sawn(3, different={2: OwnLock(density=2000.0)})
    assert sum(REDUCTIONS[rule](heavy, (0.5, 0.5, 0.0))) == 1.0


PAIR = ContactOption.pair(0.25)
DIRECTIONS = [Direction(e) for e in (0.0, 0.2, -0.2, 1.0, -5.0, math.inf, -math.inf)]
DIFFERENT = {1: OwnLock(width=0.09, inner=replace(INNER, cohesion=2e5)), 2: OwnLock(density=9e3)}


@settings(max_examples=25)
@given(
    st.integers(2, 6),
    st.floats(0.0, 0.5),
    st.floats(0.0, 1.0),
    st.floats(0.0, 2.0),
    st.floats(0.01, 0.3),
    st.sampled_from([HoldDown.plate(), HoldDown.weight(), HoldDown.force(700.0)]),
    st.sampled_from([{}, DIFFERENT]),
    st.sampled_from(Side),
)
def test_loads_are_those_of_the_linear_programme(
    locks: int,
    distance: float,
    factor: float,
    friction: float,
    height: float,
    hold_down: HoldDown,
    different: dict[int, OwnLock],
    first: Side,
) -> None:
    dry = replace(DRY, friction=friction)
    joint = sawn(locks, H=height, dry=dry, hold_down=hold_down, different=different, first=first)
    strength = tuple(np.linspace(factor, 1.0, locks))
    model = Sidmacib(joint, ContactOption.pair(distance), strength)
    expected = [point.load for point in capacities(model, DIRECTIONS)]
    found = pair_loads(model, DIRECTIONS)
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-9 * joint.T0)


def test_without_friction_torsion_and_without_pressure_no_shear_is_carried(joint: Joint) -> None:
    torsion = pair_loads(Sidmacib(joint, PAIR, friction=False), [Direction(math.inf)])
    assert torsion == pytest.approx(0.25 * joint.locks * joint.T0)
    model = Sidmacib(replace(joint, density=0.0), PAIR, overload=0.0)
    assert pair_loads(model, [Direction(0.0)]) == 0.0


def test_other_contact_points_are_refused(joint: Joint) -> None:
    with pytest.raises(ValueError, match="must be a pair of contact points"):
        pair_loads(Sidmacib(joint, READY_OPTIONS["bilinear"]), DIRECTIONS)


# --- SiDMACIB as a linear programme --------------------------------------------------------------
PURE_SHEAR, TORSION = Direction(0.0), Direction(math.inf)


@pytest.mark.parametrize(("locks", "published"), [(3, 720.0), (5, 1200.0)])
@pytest.mark.parametrize("option", OPTIONS)
@pytest.mark.parametrize("friction", [False, True])
def test_pure_shear_is_published(locks: int, published: float, option: str, friction: bool) -> None:
    model = Sidmacib(sawn(locks), OPTIONS[option], friction=friction)
    assert capacity(model, PURE_SHEAR).shear == pytest.approx(published, rel=1e-9)


def test_forces_at_the_peak_balance_the_upper_block_and_keep_their_bounds(joint: Joint) -> None:
    model = Sidmacib(joint, OPTIONS["option2"])
    point = capacity(model, Direction(1 / 3))
    along, across, normal = point.forces.T
    positions = contact_points(joint, model.option)
    assert across.sum() == pytest.approx(-point.shear)
    assert along.sum() == pytest.approx(0.0, abs=1e-6)
    torque = positions[:, 0] @ across - positions[:, 1] @ along
    assert torque == pytest.approx(-point.torque)
    volume = joint.a * joint.b * (joint.locks * joint.H + (joint.locks + 1) // 2 * joint.h)
    assert normal.sum() == pytest.approx(1000.0 + joint.density * GRAVITY * volume)
    assert (np.abs(along) <= joint.dry.friction * normal + 1e-6).all()
    assert (np.abs(across) <= joint.T0 / 2 + 1e-6).all()


def test_a_programme_is_made_once_for_a_joint(
    joint: Joint, monkeypatch: pytest.MonkeyPatch
) -> None:
    model, made = Sidmacib(joint, ContactOption.pair(0.123), overload=777.0), []
    counted = lambda asked: made.append(asked) or programme(asked)  # noqa: E731
    monkeypatch.setattr(programme_module, "programme", counted)
    for eccentricity in (0.0, 0.3, -2.0):
        capacity(model, Direction(eccentricity))
    assert made == [model]


@pytest.mark.parametrize("power", [-6, -1, 1, 6])
@pytest.mark.parametrize("friction", [False, True])
def test_strength_far_from_what_presses_gives_the_load_by_hand(power: int, friction: bool) -> None:
    """Rocking about the last lock, or the locks' strength, decides pure shear."""
    joint = sawn(3, inner=replace(INNER, cohesion=10.0**power * 8e4))
    model = Sidmacib(joint, OPTIONS["option4"], friction=friction)
    upper_locks, body = 2 * joint.h, 3 * joint.H  # volumes over a b
    centre = (upper_locks * joint.h / 2 + body * (joint.h + joint.H / 2)) / (upper_locks + body)
    weight = joint.density * GRAVITY * joint.a * joint.b * (upper_locks + body)
    rocking = (1000.0 + weight) * joint.b / (centre - joint.h / 2)
    expected = min(3 * joint.T0, rocking)
    assert capacity(model, PURE_SHEAR).load == pytest.approx(expected, rel=1e-8)
    if not friction:
        torque = 3 * joint.T0 * joint.a / 4
        assert capacity(model, TORSION).torque == pytest.approx(torque, rel=1e-8)


@settings(max_examples=15)
@given(
    st.floats(-6, 6).map(lambda power: 10**power),
    st.floats(-6, 6).map(lambda power: 10**power),
    st.one_of(st.floats(0.0, 5.0), st.just(math.inf)),
    st.integers(2, 7),
)
def test_the_load_scales_with_lengths_and_stresses_over_twelve_orders_of_magnitude(
    length: float, stress: float, eccentricity: float, locks: int
) -> None:
    joint, direction, factor = sawn(locks), Direction(eccentricity), stress * length**2
    one = capacity(Sidmacib(joint, OPTIONS["option3"]), direction)
    larger, overload = scaled(joint, length, stress), factor * Sidmacib.overload
    model = Sidmacib(larger, OPTIONS["option3"], overload=overload)
    other = capacity(model, direction)
    assert other.load == pytest.approx(factor * one.load, rel=1e-9)
    assert other.torque == pytest.approx(factor * length * one.torque, rel=1e-9)


def test_three_points_give_a_curve_of_two_straight_parts(joint: Joint) -> None:
    model = Sidmacib(joint, READY_OPTIONS["bilinear"], friction=False)
    strength, most = 3 * joint.T0, 3 * joint.T0 * joint.a / 4
    for share in (0.0, 0.25, 0.5, 0.75, 0.9):
        torque = most * min(1.0, 2.0 * (1.0 - share))
        direction = Direction(torque / (share * strength * joint.a) if share else math.inf)
        point = capacity(model, direction)
        assert point.shear == pytest.approx(share * strength, abs=1e-6)
        assert point.torque == pytest.approx(torque, rel=1e-7)
