"""Contact nodes: what their areas integrate, and how fast failure loads converge with the mesh."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from joints import loaded

from sidmacib import Joint, NodeLayout, assemble
from sidmacib.mechanics.contact_nodes import cell_counts, side_rule
from sidmacib.mechanics.static import StaticSolution, static_peak

LAYOUTS = list(NodeLayout)
EXACT = {NodeLayout.CENTRES: 1, NodeLayout.VERTICES: 1, NodeLayout.LOBATTO: 3}  # degree
NODES = {NodeLayout.CENTRES: 4, NodeLayout.VERTICES: 5, NodeLayout.LOBATTO: 9}  # on four cells


def solved(joint: Joint, mesh: float, nodes: NodeLayout, eccentricity: float) -> StaticSolution:
    return static_peak(*loaded(joint, eccentricity, mesh, nodes))


@given(st.sampled_from(LAYOUTS), st.integers(1, 40))
def test_a_rule_is_symmetric_and_its_weights_are_shares(layout: NodeLayout, cells: int) -> None:
    places, weights = side_rule(layout, cells)
    assert weights.sum() == pytest.approx(1.0)
    assert np.all(weights > 0.0) and np.all(np.diff(places) > 0.0)
    assert places == pytest.approx(1.0 - places[::-1])
    assert weights == pytest.approx(weights[::-1])


@pytest.mark.parametrize("layout", LAYOUTS)
def test_a_rule_is_exact_up_to_its_degree_and_no_further(layout: NodeLayout) -> None:
    places, weights = side_rule(layout, 3)
    assert len(side_rule(layout, 4)[0]) == NODES[layout]
    error = [abs(weights @ places**k - 1.0 / (k + 1)) for k in range(6)]
    assert max(error[: EXACT[layout] + 1]) < 1e-14
    assert error[EXACT[layout] + 1] > 1e-5


@pytest.mark.parametrize(("more", "cells"), [(0.0, 3), (5e-8, 3), (-2e-9, 3), (1e-4, 4)])
def test_digits_of_a_size_that_nobody_means_make_no_more_cells(more: float, cells: int) -> None:
    model = assemble(Joint(3, a=0.06 + more), 0.02)
    assert cell_counts(model.faces, 0.02)[:, 0].max() == cells


def test_one_cell_of_lobatto_points_is_enough_and_a_million_too_many() -> None:
    model = assemble(Joint(3), 0.05)
    assert cell_counts(model.faces, 0.05)[:, 1].max() == 1
    with pytest.raises(ValueError, match=r"at most 0\.05 m, .* \(got 0\.051 m\)"):
        assemble(Joint(3), 0.051)
    words = r"^mesh: 1e-06 m is not allowed; .* at most 1000000 cells \(they would have 3.*e\+10\)$"
    with pytest.raises(ValueError, match=words):
        assemble(Joint(3), 1e-6)  # before they are made


@given(st.sampled_from(LAYOUTS), st.floats(0.004, 0.045))
def test_nodes_of_a_face_have_its_area_middle_and_corners(layout: NodeLayout, mesh: float) -> None:
    model = assemble(Joint(2), mesh, layout)
    for number, face in enumerate(model.faces):
        on_face = model.nodes.face == number
        assert model.nodes.area[on_face].sum() == pytest.approx(face.area)
        places, areas = model.nodes.position[on_face], model.nodes.area[on_face]
        middle = np.average(places, axis=0, weights=areas)
        assert middle == pytest.approx((np.array(face.low) + face.high) / 2)
        assert np.ptp(places, axis=0)[face.axis] == 0.0
        for corner in (face.low, face.high):
            apart = np.abs(places - corner).sum(axis=1).min()
            assert (apart < 1e-12) == (layout is not NodeLayout.CENTRES)


@pytest.mark.parametrize(
    ("layout", "order"), [(NodeLayout.CENTRES, 1.0), (NodeLayout.VERTICES, 2.0)]
)
def test_first_failures_converge_at_the_layouts_order(layout: NodeLayout, order: float) -> None:
    joint = Joint(3)
    limit = solved(joint, 0.0025, NodeLayout.LOBATTO, math.inf).first_failure_load
    meshes = (0.02, 0.01, 0.005)
    firsts = (solved(joint, mesh, layout, math.inf).first_failure_load for mesh in meshes)
    errors = [first / limit - 1.0 for first in firsts]
    found = -np.polyfit(np.log(1.0 / np.array(meshes)), np.log(errors), 1)[0]
    assert found == pytest.approx(order, abs=0.3)
    assert min(errors) > 0.0  # from above: unsafe
