"""The static brittle model: against theory, its convex twin and published values."""

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import block_on_ground, load_on_block, renumbered
from hypothesis import given, settings
from hypothesis import strategies as st

from sidmacib.joint import DRY, INNER, Joint
from sidmacib.loading import Loading, Push, lateral_load
from sidmacib.mechanics.assembly import Assembly, Kind
from sidmacib.mechanics.complementary import FrictionRule, first_failure_load, least_energy_forces
from sidmacib.mechanics.contact_law import NodeLaw, NodeState, respond, tangent, utilisation
from sidmacib.mechanics.equilibrium import equilibrium_matrix, free_rows, permanent_and_reference
from sidmacib.mechanics.static import NoEquilibriumError, Solver, StaticSolution, static_peak


def solved(
    joint: Joint, eccentricity: float, mesh: float = 0.03
) -> tuple[Assembly, StaticSolution]:
    model = assemble(joint, mesh)
    return model, static_peak(model, lateral_load(joint, model, Loading(Direction(eccentricity))))


def lock_shear(model: Assembly, solution: StaticSolution) -> list[float]:
    """Resultant shear on each inner face over T0."""
    faces = sorted((face.lock, i) for i, face in enumerate(model.faces) if face.lock)
    shear = solution.peak.force[:, 1:]
    return [
        float(np.linalg.norm(shear[model.nodes.face == i].sum(axis=0))) / model.joint.T0
        for _, i in faces
    ]


# --- the law of a node ---------------------------------------------------------------------------
@settings(max_examples=50)
@given(st.floats(-1e-5, 1e-5), st.floats(-1e-5, 1e-5), st.floats(-1e-5, 1e-5))
def test_a_dry_node_never_pulls_and_stays_in_its_cone(n: float, x: float, y: float) -> None:
    model = block_on_ground(Joint(3), Kind.DRY, 0.03)
    law = NodeLaw.of(model)
    state = NodeState.initial(law)
    force = respond(law, state, np.tile([n, x, y], (len(law.friction), 1))).force
    assert (force[:, 0] >= 0).all()
    assert (np.hypot(force[:, 1], force[:, 2]) <= 0.3 * force[:, 0] * (1 + 1e-12)).all()


@settings(max_examples=50)
@given(st.floats(1e-7, 1e-5), st.floats(-1e-5, 1e-5), st.floats(1e-7, 1e-5))
def test_the_tangent_is_the_derivative_of_the_force(n: float, x: float, y: float) -> None:
    law = NodeLaw.of(block_on_ground(Joint(3), Kind.DRY, 0.03))
    state = NodeState.initial(law)
    delta = np.tile([n, x, y], (len(law.friction), 1))
    derivative = tangent(law, respond(law, state, delta))[0]
    for axis in range(3):
        step = np.zeros_like(delta)
        step[:, axis] = 1e-11
        change = respond(law, state, delta + step).force - respond(law, state, delta - step).force
        slipping = abs(np.hypot(x, y) - 0.3 * n) > 1e-9
        if slipping:
            assert change[0] / 2e-11 == pytest.approx(derivative[:, axis], rel=1e-3, abs=20.0)


# --- theory --------------------------------------------------------------------------------------
def test_one_inner_face_alone_fails_at_T0_in_pure_shear(joint: Joint) -> None:
    model = block_on_ground(joint, Kind.INNER, 0.02)
    found = static_peak(model, load_on_block(model, (0.0, 1.0, 0.0), 0.0))
    assert found.peak.load == pytest.approx(joint.T0, rel=1e-5)


def test_without_tensile_strength_the_first_tension_breaks_a_bond() -> None:
    joint = Joint(3, inner=replace(INNER, tensile_strength=0.0))
    _, found = solved(joint, 0.0)
    assert 0.0 <= found.first_failure_load < 240.0
    assert found.peak.load >= found.first_failure_load


def test_a_face_in_pure_torsion_fails_at_the_elastic_torque_of_its_nodes(joint: Joint) -> None:
    model = block_on_ground(joint, Kind.INNER, 0.02)
    arm = np.linalg.norm(model.nodes.position[:, :2] - model.pieces[1].centre[:2], axis=1)
    elastic = joint.inner.cohesion * float(model.nodes.area @ arm**2) / arm.max()
    found = static_peak(model, load_on_block(model, (0.0, 0.0, 0.0), joint.a))
    assert found.peak.load * joint.a == pytest.approx(elastic, rel=1e-5)


def test_a_dry_block_slides_at_friction_times_its_weight(joint: Joint) -> None:
    model = block_on_ground(replace(joint, density=1e6), Kind.DRY, 0.02)
    found = static_peak(model, load_on_block(model, (0.0, 1.0, 0.0), 0.0))
    assert found.peak.load == pytest.approx(0.3 * model.pieces[1].weight, rel=1e-4)


def test_one_lower_lock_without_friction_carries_T0() -> None:
    model, found = solved(Joint(2, dry=replace(DRY, friction=0.0)), 0.0)
    assert found.peak.load == pytest.approx(240.0, rel=1e-5)
    assert lock_shear(model, found)[1] == pytest.approx(1.0, abs=1e-5)


def test_an_unsupported_joint_does_not_stand(joint: Joint) -> None:
    model = block_on_ground(joint, Kind.DRY, 0.02)
    pieces = (model.pieces[0], replace(model.pieces[1], mass=-1.0))  # it floats away
    with pytest.raises(NoEquilibriumError, match="no equilibrium at 0 N"):
        static_peak(replace(model, pieces=pieces), load_on_block(model, (0.0, 1.0, 0.0), 0.0))


def test_the_peak_is_found_from_nearby_where_newton_fails_from_afar() -> None:
    joint = Joint(5, a=0.03, b=0.1, h=0.0132, H=0.0468)
    ratios = (math.tan(math.radians(angle)) for angle in (75, 80, 85))
    before, found, after = (solved(joint, r * joint.a, 0.005)[1].peak.load for r in ratios)
    assert found == pytest.approx((before + after) / 2, rel=0.01)


# --- properties ----------------------------------------------------------------------------------
@pytest.mark.parametrize("locks", [3, 4, 5])
@pytest.mark.parametrize("eccentricity", [0.0, 0.03, math.inf])
def test_every_equilibrium_on_the_path_balances_the_loads(locks: int, eccentricity: float) -> None:
    model, found = solved(Joint(locks), eccentricity)
    loads = lateral_load(joint, model, Loading(Direction(eccentricity)))
    permanent, reference = permanent_and_reference(model, loads)
    rows = free_rows(model)
    for point in found.path:
        target = permanent + point.load * reference
        residual = (equilibrium_matrix(model) @ point.force.ravel() - target)[rows]
        assert np.abs(residual).max() <= 1e-9 * np.abs(target).max()


def test_no_bond_is_overstressed_on_the_path(joint: Joint) -> None:
    model, found = solved(joint, 0.03, mesh=0.01)
    law = NodeLaw.of(model)
    for point in found.path:
        assert utilisation(law, point.state, point.force).max() <= 1.0 + 1e-9


def test_the_path_ends_beyond_the_first_failure_or_at_it(joint: Joint) -> None:
    _, found = solved(joint, 0.12, mesh=0.005)
    assert found.first_failure_load < found.peak.load  # corners fail first, the joint goes on
    _, found = solved(joint, 0.0)
    assert found.first_failure_load == pytest.approx(found.peak.load)


@settings(max_examples=10)
@given(st.floats(0.2, 5.0))
def test_scaling_all_lengths_and_loads_scales_the_peak(factor: float) -> None:
    joint = Joint(3)
    scaled = replace(
        joint,
        **{name: factor * getattr(joint, name) for name in ("a", "b", "h", "H")},
        density=joint.density / factor,  # weight grows with the areas, as strength does
        inner=replace(INNER, normal_stiffness=1e10 / factor, shear_stiffness=1e10 / factor),
        dry=replace(DRY, normal_stiffness=1e10 / factor, shear_stiffness=1e10 / factor),
    )
    _, one = solved(joint, 0.02, 0.03)
    _, other = solved(scaled, 0.02 * factor, 0.03 * factor)
    assert other.peak.load == pytest.approx(factor**2 * one.peak.load, rel=1e-5)


@pytest.mark.parametrize("push", Push)
def test_mirrored_torque_and_push_give_the_same_peak_for_odd_locks(
    joint: Joint, push: Push
) -> None:
    model = assemble(joint, 0.03)
    reference = static_peak(model, lateral_load(joint, model, Loading(Direction(0.02)))).peak.load
    for eccentricity in (0.02, -0.02):
        found = static_peak(model, lateral_load(joint, model, Loading(eccentricity, push=push)))
        assert found.peak.load == pytest.approx(reference, rel=1e-5)


def test_the_order_of_faces_and_nodes_does_not_matter(joint: Joint) -> None:
    model = assemble(joint, 0.03)
    loads = lateral_load(joint, model, Loading(Direction(0.02)))
    one, other = static_peak(model, loads), static_peak(renumbered(model), loads)
    assert other.peak.load == pytest.approx(one.peak.load, rel=1e-6)


# --- the other formulation -----------------------------------------------------------------------
@pytest.mark.parametrize("locks", [3, 4, 5])
@pytest.mark.parametrize("eccentricity", [0.0, 0.03, math.inf])
def test_newton_and_least_complementary_energy_agree(locks: int, eccentricity: float) -> None:
    model = assemble(Joint(locks), 0.03)
    loads = lateral_load(joint, model, Loading(Direction(eccentricity)))
    path = static_peak(model, loads).path
    load = 0.6 * path[-1].load
    solver = Solver(model, loads)
    state = NodeState.initial(solver.law)
    nearest = min(path, key=lambda point: abs(point.load - load))
    newton = solver.solve(load, nearest.displacement, state).force  # in one step, as the programme
    programme = least_energy_forces(model, loads, load)
    assert programme == pytest.approx(newton, abs=5e-5 * load)


def test_associated_friction_overestimates(joint: Joint) -> None:
    model = assemble(joint, 0.03)
    loads = lateral_load(joint, model, Loading(Direction(0.0)))
    coulomb, associated = (first_failure_load(model, loads, rule) for rule in FrictionRule)
    path = static_peak(model, loads)
    assert coulomb == pytest.approx(path.first_failure_load, rel=0.01)  # but for its history
    assert associated > 1.02 * coulomb


# --- the published study -------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("locks", "published", "weights", "within"),
    [
        (3, 240.76, [0.77, 0.99, 0.0], 0.035),
        (5, 408.26, [0.57, 0.99, 0.68, 0.68, 0.0], 0.02),
    ],
)
def test_peak_and_weights_of_the_published_samples(
    locks: int, published: float, weights: list[float], within: float
) -> None:
    model, found = solved(Joint(locks), 0.0, mesh=0.02)
    assert found.peak.load == pytest.approx(published, rel=within)
    assert lock_shear(model, found) == pytest.approx(weights, abs=0.06)  # first two swapped
