"""Contact nodes: where they are, and when they hold, slide, open and fail."""

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import block_on_ground
from hypothesis import assume, given
from hypothesis import strategies as st
from joints import loaded, sawn

from sidmacib import NodeLayout, assemble
from sidmacib.engines.render import engine_material
from sidmacib.engines.scripts.assembly import GivenMaterial
from sidmacib.engines.scripts.assembly import utilisation as of_script
from sidmacib.joint import INNER, Joint
from sidmacib.mechanics.assembly import Kind
from sidmacib.mechanics.contact_law import ContactLaw, NodeState
from sidmacib.mechanics.contact_law.kernels import (
    node_force,
    node_tangent,
    utilisation,
)
from sidmacib.mechanics.contact_nodes import cell_counts, side_rule
from sidmacib.mechanics.static import StaticSolution, static_peak

NORMAL, SHEAR, FRICTION = 2e6, 1e6, 0.3  # N/m, N/m
moves = st.floats(-1e-5, 1e-5)


def dry(n: float, x: float, y: float) -> np.ndarray:
    return np.array(node_force(NORMAL, SHEAR, FRICTION, 0.0, False, n, x, y))


@given(moves, moves, moves)
def test_a_dry_node_never_pulls_and_stays_in_its_cone(n: float, x: float, y: float) -> None:
    force = dry(n, x, y)
    assert force[0] == pytest.approx(max(NORMAL * n, 0.0))
    assert math.hypot(force[1], force[2]) <= FRICTION * force[0] * (1 + 1e-12) + 1e-150


@given(moves, moves, moves)
def test_friction_acts_along_the_displacement(n: float, x: float, y: float) -> None:
    force = dry(n, x, y)
    assert force[1] * y == pytest.approx(force[2] * x, rel=1e-9)
    assert force[1] * x + force[2] * y >= 0.0


@given(moves, moves, moves, st.floats(0.001, 1.0))
def test_a_faded_bond_is_softer_unless_pressed(n: float, x: float, y: float, whole: float) -> None:
    force = node_force(NORMAL, SHEAR, FRICTION, 0.0, whole, n, x, y)
    normal = NORMAL * n if n > 0.0 else whole * NORMAL * n
    assert force == pytest.approx((normal, whole * SHEAR * x, whole * SHEAR * y))


# Friction coefficient, given friction (N) and what is left of the bond.
TANGENTS = [(FRICTION, 0.0, 0.0), (FRICTION, 0.0, 0.3), (FRICTION, 0.0, 1.0), (0.0, 2.0, 0.0)]


@given(moves, moves, moves, st.sampled_from(TANGENTS))
def test_the_tangent_is_the_derivative_of_the_force(
    n: float, x: float, y: float, node: tuple[float, float, float]
) -> None:
    constants, slip, step = (NORMAL, SHEAR, *node), math.hypot(x, y), 1e-11
    cone = node[0] * NORMAL * n + node[1]
    # Away from where the derivative jumps: opening, the edge of the cone and its tip.
    assume(abs(n) > 1e-8 and slip > 1e-7 and abs(SHEAR * slip - cone) > 1e-2)
    t00, t10, t20, t11, t12, t22 = node_tangent(*constants, n, x, y)
    expected = np.array([[t00, 0.0, 0.0], [t10, t11, t12], [t20, t12, t22]])
    for axis, move in enumerate(np.eye(3) * step):
        places = (np.array([n, x, y]) + each for each in (move, -move))
        after, before = (np.array(node_force(*constants, *place)) for place in places)
        derivative = (after - before) / (2 * step)
        assert derivative == pytest.approx(expected[:, axis], rel=1e-3, abs=1e-3 * NORMAL)


def bonds(joint: Joint) -> tuple[ContactLaw, NodeState]:
    contact_law = ContactLaw.of(block_on_ground(joint, Kind.INNER, 0.02))
    return contact_law, NodeState.initial(contact_law.cohesive)


@given(st.floats(0.0, 3.0), st.floats(-3.0, 3.0), st.floats(0, 2 * math.pi))
def test_shear_or_tension_decides_utilisation(shear: float, tension: float, angle: float) -> None:
    contact_law, state = bonds(sawn(3))
    x, y = shear * math.cos(angle), shear * math.sin(angle)
    strength = contact_law.shear_strength
    force = np.column_stack([-tension * contact_law.tensile_strength, x * strength, y * strength])
    assert utilisation(contact_law, state, force) == pytest.approx(max(shear, tension))


@given(st.floats(0.0, 2.0), st.floats(-0.5, 10.0), st.floats(0, 2 * math.pi))
def test_a_bond_on_its_cone_is_used_up(friction: float, pressure: float, angle: float) -> None:
    contact_law, state = bonds(sawn(3, inner=replace(INNER, bond_friction=friction)))
    cone, normal = contact_law.cone(), pressure * contact_law.shear_strength
    shear = cone.shear(normal)
    force = np.column_stack([normal, math.cos(angle) * shear, math.sin(angle) * shear])
    assert utilisation(contact_law, state, force) == pytest.approx(1.0)
    torn = np.column_stack([-cone.torn, 0.0 * shear, 0.0 * shear])
    assert (utilisation(contact_law, state, torn) >= 1.0 - 1e-12).all()


def test_scripts_of_engines_know_the_same_strengths() -> None:
    contact_law, state = bonds(sawn(3))
    count = len(contact_law.friction)
    force = np.random.default_rng(1).normal(scale=contact_law.shear_strength[0], size=(count, 3))
    used = utilisation(contact_law, state, force)
    area = contact_law.shear_strength / INNER.cohesion
    material = GivenMaterial(**engine_material(INNER))
    for n in range(count):
        assert of_script(force[n], (1.0, 0.0, 0.0), material, area[n]) == pytest.approx(used[n])


@pytest.mark.parametrize("name", ["cohesion", "tensile_strength"])
def test_without_a_strength_any_force_against_it_is_too_much(name: str) -> None:
    contact_law, state = bonds(sawn(3, inner=replace(INNER, **{name: 0.0})))
    none = np.zeros((len(contact_law.friction), 3))
    pulled, pressed = none.copy(), none.copy()
    pulled[:] = (-1e-9, 0, 0) if name == "tensile_strength" else (0, 1e-9, 0)
    pressed[:] = (1.0, 0, 0)
    assert (utilisation(contact_law, state, none) == 0.0).all()
    assert np.isinf(utilisation(contact_law, state, pulled)).all()
    assert (utilisation(contact_law, state, pressed) == 0.0).all()


# --- nodes: what their areas integrate, and how fast failure loads converge ----------------------
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
    model = assemble(sawn(3, a=0.06 + more), 0.02)
    assert cell_counts(model.faces, 0.02)[:, 0].max() == cells


def test_one_cell_of_lobatto_points_is_enough_and_a_million_too_many() -> None:
    model = assemble(sawn(3), 0.05)
    assert cell_counts(model.faces, 0.05)[:, 1].max() == 1
    with pytest.raises(ValueError, match=r"at most 0\.05 m, .* \(got 0\.051 m\)"):
        assemble(sawn(3), 0.051)
    words = r"^mesh: 1e-06 m is not allowed; .* at most 1000000 cells \(they would have 3.*e\+10\)$"
    with pytest.raises(ValueError, match=words):
        assemble(sawn(3), 1e-6)  # before they are made


@given(st.sampled_from(LAYOUTS), st.floats(0.004, 0.045))
def test_nodes_of_a_face_have_its_area_middle_and_corners(layout: NodeLayout, mesh: float) -> None:
    model = assemble(sawn(2), mesh, layout)
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
    joint = sawn(3)
    limit = solved(joint, 0.0025, NodeLayout.LOBATTO, math.inf).first_failure_load
    meshes = (0.02, 0.01, 0.005)
    firsts = (solved(joint, mesh, layout, math.inf).first_failure_load for mesh in meshes)
    errors = [first / limit - 1.0 for first in firsts]
    found = -np.polyfit(np.log(1.0 / np.array(meshes)), np.log(errors), 1)[0]
    assert found == pytest.approx(order, abs=0.3)
    assert min(errors) > 0.0  # from above: unsafe
