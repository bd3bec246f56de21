"""Limit analysis of the whole joint."""

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import block_on_ground, load_on_block, renumbered
from hypothesis import given, settings
from hypothesis import strategies as st

from sidmacib.joint import Joint
from sidmacib.loading import Loading, Push, lateral_load
from sidmacib.mechanics.assembly import Kind
from sidmacib.mechanics.equilibrium import equilibrium_matrix, free_rows, permanent_and_reference
from sidmacib.mechanics.limit import limit_load
from sidmacib.mechanics.static import static_peak


def limit_of(joint: Joint, loading: Loading, mesh: float = 0.03) -> float:
    model = assemble(joint, mesh)
    return limit_load(model, lateral_load(joint, model, loading)).load


@pytest.mark.parametrize("locks", [3, 5, 7])
@pytest.mark.parametrize("push", Push)
def test_half_the_locks_of_an_odd_number_count_with_no_rule_put_in(locks: int, push: Push) -> None:
    joint = Joint(locks)
    expected = (locks - 1) / 2 * joint.T0
    assert limit_of(joint, Loading(Direction(0.0), push=push)) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("locks", [2, 4, 6])
def test_an_even_number_of_locks_carries_one_more_in_the_push_that_closes_all_pairs(
    locks: int,
) -> None:
    joint = Joint(locks)
    pairs = {Push.PLUS_Y: locks / 2, Push.MINUS_Y: locks / 2 - 1}
    for push, count in pairs.items():
        found = limit_of(joint, Loading(Direction(0.0), push=push))
        assert found == pytest.approx(count * joint.T0, abs=1e-5 * joint.T0)


def test_an_inner_face_alone_carries_T0(joint: Joint) -> None:
    model = block_on_ground(joint, Kind.INNER, 0.02)
    assert limit_load(model, load_on_block(model, (0.0, 1.0, 0.0), 0.0)).load == pytest.approx(
        joint.T0
    )


def test_an_inner_face_in_torsion_carries_its_plastic_torque(joint: Joint) -> None:
    model = block_on_ground(joint, Kind.INNER, 0.005)
    arm = np.linalg.norm(model.nodes.position[:, :2] - model.pieces[1].centre[:2], axis=1)
    found = limit_load(model, load_on_block(model, (0.0, 0.0, 0.0), 1.0)).load
    assert found == pytest.approx(joint.inner.cohesion * float(model.nodes.area @ arm), rel=1e-6)


def test_a_dry_block_under_an_overload_slides_at_friction_times_what_presses(joint: Joint) -> None:
    model = block_on_ground(joint, Kind.DRY, 0.02)
    loads = load_on_block(model, (0.0, 1.0, 0.0), 0.0)
    found = limit_load(model, loads, friction=True, overload=100.0).load
    assert found == pytest.approx(0.3 * (100.0 + model.pieces[1].weight), rel=1e-6)


def test_associated_friction_under_a_fixed_plate_is_refused(joint: Joint) -> None:
    model = assemble(joint, 0.03)
    with pytest.raises(ValueError, match=r"overload: got None, allowed with friction is a force"):
        limit_load(model, lateral_load(joint, model, Loading(Direction(0.0))), friction=True)


@settings(max_examples=10)
@given(st.floats(1.0, 3.0), st.floats(0.0, 0.2))
def test_more_strength_never_carries_less(factor: float, eccentricity: float) -> None:
    joint = Joint(3)
    stronger = replace(joint, inner=replace(joint.inner, cohesion=factor * joint.inner.cohesion))
    loading = Loading(Direction(eccentricity))
    assert limit_of(stronger, loading) >= limit_of(joint, loading) * (1 - 1e-6)


@pytest.mark.parametrize("push", Push)
def test_mirrored_torque_and_push_give_the_same_limit_for_odd_locks(
    joint: Joint, push: Push
) -> None:
    expected = limit_of(joint, Loading(Direction(0.02)))
    for eccentricity in (0.02, -0.02):
        found = limit_of(joint, Loading(eccentricity, push=push))
        assert found == pytest.approx(expected, rel=1e-6)


@settings(max_examples=10)
@given(st.floats(0.2, 5.0))
def test_scaling_all_lengths_and_loads_scales_the_limit(factor: float) -> None:
    joint = Joint(3)
    sizes = {name: factor * getattr(joint, name) for name in ("a", "b", "h", "H")}
    scaled = replace(joint, **sizes, density=joint.density / factor)
    expected = factor**2 * limit_of(joint, Loading(Direction(0.02)))
    found = limit_of(scaled, Loading(0.02 * factor), 0.03 * factor)
    assert found == pytest.approx(expected, rel=1e-6)


def test_the_order_of_faces_and_nodes_does_not_matter(joint: Joint) -> None:
    model = assemble(joint, 0.03)
    loads = lateral_load(joint, model, Loading(Direction(0.02)))
    other = limit_load(renumbered(model), loads).load
    assert other == pytest.approx(limit_load(model, loads).load, rel=1e-6)


def test_the_forces_balance_every_piece(joint: Joint) -> None:
    model = assemble(joint, 0.03)
    loads = lateral_load(joint, model, Loading(Direction(0.02)))
    found = limit_load(model, loads)
    permanent, reference = permanent_and_reference(model, loads)
    target = permanent + found.load * reference
    residual = (equilibrium_matrix(model) @ found.force.ravel() - target)[free_rows(model)]
    assert np.abs(residual).max() <= 1e-7 * found.load


def test_strength_and_load_scale_together(joint: Joint) -> None:
    doubled = replace(
        joint,
        density=2 * joint.density,
        inner=replace(joint.inner, cohesion=1.6e5, tensile_strength=7.4e5),
    )
    loading = Loading(Direction(0.02))
    assert limit_of(doubled, loading) == pytest.approx(2 * limit_of(joint, loading), rel=1e-5)


@pytest.mark.parametrize("eccentricity", [0.0, 0.03, math.inf])
def test_the_frictionless_limit_is_above_the_frictionless_brittle_peak(
    joint: Joint, eccentricity: float
) -> None:
    smooth = replace(joint, dry=replace(joint.dry, friction=0.0))
    model = assemble(smooth, 0.02)
    loads = lateral_load(joint, model, Loading(Direction(eccentricity)))
    assert limit_load(model, loads).load >= static_peak(model, loads).peak.load * (1 - 1e-5)
