"""The exact V-M envelope."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial import ConvexHull

from sidmacib.contact_points import OPTIONS
from sidmacib.joint import Direction, Joint
from sidmacib.polygon import envelope, polygon
from sidmacib.programme import InfeasibleError, Sidmacib, capacity


def support_of(points: np.ndarray):
    return lambda normal: points[np.argmax(points @ normal)]


@settings(max_examples=100)
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
    for eccentricity in (0.0, 0.005, 0.05, math.inf):
        point = capacity(model, Direction.at_eccentricity(eccentricity, joint.a))
        at = np.array([point.shear, point.torque]) / [joint.T0, joint.T0 * joint.a]
        distances = [
            np.cross(np.append((end - start) / s, 0), np.append(at - start / s, 0))[2]
            for start, end in edges
            for s in [np.array([joint.T0, joint.T0 * joint.a])]
        ]
        assert min(distances) == pytest.approx(0.0, abs=1e-6)


def test_an_empty_set_has_no_envelope(joint: Joint) -> None:
    with pytest.raises(InfeasibleError, match="outward normal"):
        envelope(Sidmacib(joint, OPTIONS["option1"], overload=-2000.0))
