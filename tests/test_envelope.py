"""The exact V-M envelope."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial import ConvexHull

from sidmacib.contact_points import OPTIONS, ContactOption
from sidmacib.contact_points.envelope import envelope, polygon
from sidmacib.contact_points.programme import Sidmacib, capacity
from sidmacib.errors import InfeasibleError, SolverError
from sidmacib.joint import Direction, Joint


def support_of(points: np.ndarray):
    return lambda normal: points[np.argmax(points @ normal)]


@settings(max_examples=50)
@given(arrays(float, (9, 2), elements=st.floats(-1, 1).map(lambda v: round(v, 2))))
def test_all_vertices_are_found_with_as_few_questions_as_vertices_and_edges(
    points: np.ndarray,
) -> None:
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


@pytest.mark.parametrize("lean", [(1, 5), (1, -5), (-1, 5), (-1, -5)])
def test_a_slender_triangle_that_leans_has_three_vertices(lean: tuple[int, int]) -> None:
    """One corner is furthest in many directions."""
    corners = np.array([[0.0, 0.0], lean, [0.5 * lean[0], 0.0]])
    found = polygon(support_of(corners)).vertices
    assert {tuple(v) for v in found} == {tuple(v) for v in corners}


@pytest.mark.parametrize("ends", [[(-5, -2), (-5, 3)], [(5, 2), (5, 3)], [(0, -1), (2, 1)]])
def test_a_straight_line_has_its_ends_for_vertices(ends: list[tuple[int, int]]) -> None:
    found = polygon(support_of(np.array(ends, float))).vertices
    assert {tuple(v) for v in found} == set(ends)


def test_a_single_point_has_one_vertex() -> None:
    assert polygon(lambda normal: np.array([0.2, 0.3])).vertices.tolist() == [[0.2, 0.3]]


def test_vertices_go_round_counter_clockwise_from_the_smallest_shear(joint: Joint) -> None:
    vertices = envelope(Sidmacib(joint, OPTIONS["option4"])).vertices
    assert vertices[0, 0] == pytest.approx(vertices[:, 0].min())
    following = np.roll(vertices, -1, axis=0)
    assert np.sum(np.linalg.det(np.stack([vertices, following], axis=1))) > 0


def test_without_friction_the_envelope_is_a_rhombus(joint: Joint) -> None:
    found = envelope(Sidmacib(joint, OPTIONS["option1"], friction=False))
    expected = [(-720.0, 0.0), (0.0, -21.6), (720.0, 0.0), (0.0, 21.6)]
    assert found.vertices == pytest.approx(np.array(expected), abs=1e-6)
    assert found.programmes <= 8


@pytest.mark.parametrize("locks", [3, 5, 6])
def test_every_capacity_lies_on_the_envelope(locks: int) -> None:
    joint = Joint(locks)
    model = Sidmacib(joint, OPTIONS["option2"])
    found = envelope(model)
    edges = list(zip(found.vertices, np.roll(found.vertices, -1, axis=0), strict=True))
    assert found.programmes <= len(found.vertices) + len(edges)
    for eccentricity in (0.0, 0.1, 0.8, math.inf):
        point = capacity(model, Direction(eccentricity))
        at = np.array([point.shear, point.torque]) / [joint.T0, joint.T0 * joint.a]
        distances = [
            np.cross(np.append((end - start) / s, 0), np.append(at - start / s, 0))[2]
            for start, end in edges
            for s in [np.array([joint.T0, joint.T0 * joint.a])]
        ]
        assert min(distances) == pytest.approx(0.0, abs=1e-6)


def zonogon(sides: np.ndarray) -> np.ndarray:
    """Vertices, from the lowest on the left, of all sums of ``sides`` (K, 2) times -1 to 1."""
    sides = sides * np.where(sides[:, :1] < 0, -1.0, 1.0)
    around = sides[np.argsort(sides[:, 1] / sides[:, 0])]
    return -sides.sum(axis=0) + 2 * np.cumsum(
        np.vstack([np.zeros(2), around, -around[:-1]]), axis=0
    )


@settings(max_examples=20)
@given(
    st.lists(st.integers(1, 50), min_size=2, max_size=6, unique=True),
    st.integers(2, 5),
)
def test_without_friction_every_contact_point_adds_two_edges(
    distances: list[int], locks: int
) -> None:
    """V is the sum of the forces across, M of the forces times x: a zonogon, known by hand."""
    joint, positions = Joint(locks), [sign * x for x in distances for sign in (-1, 1)]
    count = len(positions)
    option = ContactOption(tuple(x / 100 for x in positions), (1 / count,) * count)
    strength = locks * joint.T0 / count
    expected = zonogon(strength * np.array([(1.0, x / 100 * joint.a) for x in positions]))
    found = envelope(Sidmacib(joint, option, friction=False)).vertices
    assert found.shape == expected.shape
    scale = [joint.T0, joint.T0 * joint.a]
    assert found / scale == pytest.approx(expected / scale, abs=1e-6)


def around_a_circle(noise: float):
    random = np.random.default_rng(1)
    exact = support_of(
        np.array([(math.cos(t), math.sin(t)) for t in np.linspace(0, 2 * math.pi, 51)])
    )
    return lambda normal: exact(normal) + noise * random.uniform(-1, 1, 2)


def test_answers_that_are_a_little_off_give_the_same_vertices() -> None:
    assert len(polygon(around_a_circle(1e-9)).vertices) == 50


def test_answers_that_contradict_each_other_are_an_error() -> None:
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
