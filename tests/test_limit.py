"""Limit analysis of the whole joint."""

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import block_on_ground, load_on_block, renumbered, scaled
from hypothesis import given, settings
from hypothesis import strategies as st
from joints import loaded, sawn

from sidmacib import UnboundedError
from sidmacib.joint import HoldDown, Joint, UpperBody
from sidmacib.joint.parameters import with_parameters
from sidmacib.mechanics.assembly import Assembly, Floats, Kind, NodeLayout
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.equilibrium import equilibrium_matrix, free_rows
from sidmacib.mechanics.limit import LimitState, limit_load
from sidmacib.mechanics.loads import Loads


@pytest.mark.parametrize("e_over_a", [0.0, -5.0, math.inf])
def test_one_lock_carries_nothing_and_not_minus_nothing(e_over_a: float) -> None:
    found = limit_load(*loaded(sawn(1, hold_down=HoldDown.weight()), e_over_a)).load
    assert (found, math.copysign(1.0, found)) == (0.0, 1.0)


def test_an_inner_face_in_torsion_carries_its_plastic_torque(joint: Joint) -> None:
    model = block_on_ground(joint, Kind.INNER, 0.005)
    arm = np.linalg.norm(model.nodes.position[:, :2] - model.pieces[1].centre[:2], axis=1)
    found = limit_load(model, load_on_block(model, (0.0, 0.0, 0.0), 1.0)).load
    assert found == pytest.approx(joint.inner.cohesion * float(model.nodes.area @ arm), rel=1e-6)


def test_a_block_pressed_without_end_has_no_limit(joint: Joint) -> None:
    model = block_on_ground(joint, Kind.INNER, 0.02)
    with pytest.raises(UnboundedError, match=r"^limit analysis: the load can grow without limit"):
        limit_load(model, load_on_block(model, (0.0, 0.0, -1.0), 0.0))


def test_associated_friction_under_a_fixed_plate_is_refused(joint: Joint) -> None:
    with pytest.raises(ValueError, match=r"^friction: must be false under a fixed plate"):
        limit_load(*loaded(joint), friction=True)


def test_friction_under_an_overload_adds_to_what_the_locks_carry(joint: Joint) -> None:
    model, loads = loaded(replace(joint, hold_down=HoldDown.force(1000.0)))
    smooth, rough = (limit_load(model, loads, friction=friction).load for friction in (False, True))
    assert smooth == pytest.approx(joint.T0, rel=1e-7)
    # What presses the two upper locks adds; what presses the lower one loads its root.
    pressure = -loads.permanent[:, 2].sum()
    assert 2 / 3 * 0.3 * 1000.0 < rough - smooth < 0.3 * pressure


@settings(max_examples=8)
@given(
    st.floats(-6, 6).map(lambda power: 10**power),
    st.floats(-6, 6).map(lambda power: 10**power),
    st.one_of(st.floats(0.0, 3.0), st.just(math.inf)),
    st.integers(2, 5),
)
def test_the_limit_scales_with_lengths_and_stresses_over_twelve_orders_of_magnitude(
    length: float, stress: float, eccentricity: float, locks: int
) -> None:
    joint, factor = sawn(locks), stress * length**2
    one, other = (
        limit_load(*loaded(each, eccentricity, 0.03 * size)).load
        for each, size in ((joint, 1.0), (scaled(joint, length, stress), length))
    )
    # To the nine digits that are reported, of which the last may be rounded either way.
    assert other / factor == pytest.approx(one, rel=3e-8, abs=1e-8 * joint.T0)


def masonry(count: int) -> list[tuple[Joint, float]]:
    """Joints of the sizes and strengths of masonry, and eccentricities over a."""
    random = np.random.default_rng(8)
    found = []
    for _ in range(count):
        b, cohesion = random.uniform(0.05, 0.3), 10 ** random.uniform(4.7, 6.6)
        given = {
            **{"locks": int(random.integers(2, 8)), "a": random.uniform(0.05, 0.5), "b": b},
            **{"h": b * random.uniform(0.06, 0.6), "H": b * random.uniform(0.3, 1.5)},
            **{"density": random.uniform(1400, 2700), "cohesion": cohesion},
            "tensile_strength": cohesion * random.uniform(0.3, 5),
            "friction": random.uniform(0.0, 0.8),
        }
        joint = with_parameters(sawn(3), given)
        found.append((joint, float(random.choice([0.0, 0.1, 0.5, math.inf]))))
    return found


def solved(joint: Joint, eccentricity: float, mesh: float) -> tuple[Assembly, Loads, LimitState]:
    model, loads = loaded(joint, eccentricity, mesh)
    return model, loads, limit_load(model, loads)


def imbalance(model: Assembly, loads: Loads, found: LimitState) -> Floats:
    target = (loads.permanent + found.load * loads.variable).ravel()
    return (equilibrium_matrix(model) @ found.force.ravel() - target)[free_rows(model)]


def test_joints_of_masonry_have_a_limit_that_admissible_forces_carry() -> None:
    for joint, eccentricity in masonry(16):
        model, loads, found = solved(joint, eccentricity, min(joint.a, joint.b) / 2.5)
        contact_law, allowed = ContactLaw.of(model), 1e-7 * joint.T0
        inner = contact_law.cohesive
        size = np.hypot(found.force[:, 1], found.force[:, 2])
        assert np.abs(imbalance(model, loads, found)).max() <= 1e-8 * joint.T0
        assert (size[inner] <= contact_law.shear_strength[inner] * (1 + 1e-8) + allowed).all()
        bound = -contact_law.tensile_strength[inner] * (1 + 1e-8)
        assert (found.force[inner, 0] >= bound - allowed).all()
        assert (size[~inner] <= allowed).all()
        assert (found.force[~inner, 0] >= -allowed).all()


def test_the_order_of_faces_and_nodes_does_not_matter(joint: Joint) -> None:
    model, loads = loaded(joint, 0.3)
    one, other = limit_load(model, loads), limit_load(renumbered(model), loads)
    assert other.load == pytest.approx(one.load, rel=2e-8)
    faces = renumbered(model).nodes.face
    back = np.concatenate([np.flatnonzero(faces == face) for face in range(faces.max(), -1, -1)])
    # Among the many states that carry the load, the same one.
    assert other.force[back] == pytest.approx(one.force, abs=1e-4 * joint.T0)


def test_the_forces_are_the_least_that_carry_the_load(joint: Joint) -> None:
    """Any other states of equilibrium within the strengths have a larger sum of s^2 / A."""
    model, _, found = solved(joint, 0.0, 0.03)
    matrix = equilibrium_matrix(model)[free_rows(model)].toarray()
    weight = 1.0 / np.repeat(model.nodes.area, 3)
    kernel = np.linalg.svd(matrix)[2][np.linalg.matrix_rank(matrix) :]
    contact_law, force = ContactLaw.of(model), found.force
    size = np.hypot(force[:, 1], force[:, 2])
    free = np.repeat(contact_law.cohesive & (size < 0.99 * contact_law.shear_strength), 3)
    free |= np.tile([True, False, False], len(size)) & np.repeat(force[:, 0] > 1e-3, 3)
    # Self-equilibrated changes of forces that no strength hinders.
    hindered = kernel.T[~free]
    basis = kernel.T @ np.linalg.svd(hindered)[2][np.linalg.matrix_rank(hindered, 1e-9) :].T
    assert basis.shape[1] > 0
    slope = basis.T @ (weight * force.ravel())
    assert np.abs(slope).max() <= 1e-3 * np.abs(weight * force.ravel()).max()


def test_the_published_samples_need_no_rounding(joint: Joint) -> None:
    assert solved(joint, 0.0, 0.02)[2].load == 240.0


@pytest.mark.parametrize("body", [UpperBody.COLUMNS, UpperBody.MONOLITHIC])
def test_a_limit_is_found_where_forces_concentrate_on_few_nodes(body: UpperBody) -> None:
    joint = sawn(5, upper_body=body)
    near = [loaded(joint, e_over_a, 0.02, NodeLayout.LOBATTO) for e_over_a in (0.49, 0.5, 0.51)]
    found = [limit_load(*problem).load for problem in near]
    assert found == sorted(found, reverse=True)
    assert found[1] == pytest.approx((found[0] + found[2]) / 2, rel=1e-3)


@pytest.mark.parametrize("locks", [4, 8])
@pytest.mark.parametrize("ratio", [0.5, math.inf])
def test_an_even_number_of_locks_has_a_limit_load_and_forces(locks: int, ratio: float) -> None:
    """One lock is idle there, which leaves solvers fewer digits."""
    model, loads = loaded(sawn(locks), ratio, 0.02, NodeLayout.LOBATTO)
    found = limit_load(model, loads)
    more = limit_load(*loaded(sawn(locks + 1), ratio, 0.02, NodeLayout.LOBATTO)).load
    assert 0.0 < found.load <= more * (1 + 1e-6)
    assert np.abs(imbalance(model, loads, found)).max() < 1e-6 * loads.scale
