"""The static brittle model: against theory, its convex twin and published values."""

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import block_on_ground, load_on_block, renumbered, scaled
from hypothesis import given, settings
from hypothesis import strategies as st
from joints import PUBLISHED, loaded, sawn
from stack import tilted_stack

from sidmacib import limit_load, lock_weights
from sidmacib.errors import NoEquilibriumError
from sidmacib.joint import INNER, Direction, HoldDown, Joint
from sidmacib.joint.loading import Loading, Push, posed
from sidmacib.joint.parameters import PARAMETERS, with_parameters
from sidmacib.mechanics.assembly import (
    Cuboid,
    Elastic,
    FaceMaterial,
    Failure,
    Kind,
    NodeLayout,
)
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.contact_law.kernels import utilisation
from sidmacib.mechanics.equilibrium import placed, unbalanced_forces
from sidmacib.mechanics.static import (
    MOST_ROTATION,
    Mode,
    StaticSolution,
    static_first_failure,
    static_peak,
)


def solved(joint: Joint, e_over_a: float, mesh: float = 0.03) -> StaticSolution:
    return static_peak(*loaded(joint, e_over_a, mesh))


# --- rotations -----------------------------------------------------------------------------------
STRONG = replace(sawn(3), inner=replace(INNER, cohesion=1e6))


ALMOST_RIGID = Elastic(1e11, 0.2)


def lobatto(joint: Joint, e_over_a: float) -> StaticSolution:
    return static_peak(*posed(joint, Loading(Direction(e_over_a)), 0.02))


@pytest.mark.long
def test_no_equilibrium_counts_in_which_a_piece_that_has_broken_off_turns_far() -> None:
    # At e = a/2 column 1 breaks off, and its load acts above the edge of lock 2. YADE: 542.7 N.
    elastic = (replace(STRONG, elastic=law) for law in (Elastic(1e10, 0.2), ALMOST_RIGID))
    rigid, soft, stiff = (lobatto(joint, 0.5) for joint in (STRONG, *elastic))
    # Elastic pieces stay where they were built.
    for found, load in ((rigid, 542.1), (soft, 548.6), (stiff, 550.1)):
        assert found.peak.load == pytest.approx(load, rel=1e-3)
    assert (rigid.mode, rigid.turns) == (Mode.BONDS, False)
    assert stiff.peak.rotation == pytest.approx(rigid.peak.rotation, rel=0.01)


@pytest.mark.parametrize("failure", [Failure.DUCTILE, Failure.SOFTENING])
def test_nor_where_bonds_yield_or_soften(failure: Failure) -> None:
    inner = replace(STRONG.inner, fracture_energy=50.0)
    found = lobatto(replace(STRONG, inner=inner, failure=failure), 0.5)
    assert found.peak.rotation <= 0.035
    assert found.turns == (failure is Failure.DUCTILE)


@pytest.mark.long
def test_a_path_ends_where_a_piece_that_has_broken_off_has_turned_by_2_degrees() -> None:
    rigid, found = (lobatto(each, 0.4) for each in (STRONG, replace(STRONG, elastic=ALMOST_RIGID)))
    assert rigid.first_failure_load < rigid.peak.load < 905.0  # LIGGGHTS; YADE 972 N
    assert found.turns
    assert found.peak.rotation == pytest.approx(0.035, rel=1e-3)
    assert found.first_failure_load < found.peak.load < 972.0


def test_rotations_before_the_first_failure_are_not_limited() -> None:
    names = [f"{way}_stiffness" for way in ("normal", "shear", "dry")]
    soft = {name: PARAMETERS[name].of(sawn(3)) / 20 for name in names}
    found, stiff = lobatto(with_parameters(sawn(3), soft), 0.5), lobatto(sawn(3), 0.5)
    assert found.peak.rotation > MOST_ROTATION
    assert 0.97 * stiff.peak.load < found.peak.load < stiff.peak.load


# --- theory --------------------------------------------------------------------------------------


def test_a_face_in_pure_torsion_fails_at_the_elastic_torque_of_its_nodes(joint: Joint) -> None:
    model = block_on_ground(joint, Kind.INNER, 0.02)
    arm = np.linalg.norm(model.nodes.position[:, :2] - model.pieces[1].centre[:2], axis=1)
    elastic = joint.inner.cohesion * float(model.nodes.area @ arm**2) / arm.max()
    found = static_peak(model, load_on_block(model, (0.0, 0.0, 0.0), joint.a))
    assert found.peak.load * joint.a == pytest.approx(elastic, rel=1e-5)


def test_a_block_that_floats_away_or_touches_nothing_does_not_stand(joint: Joint) -> None:
    model = block_on_ground(joint, Kind.DRY, 0.02)
    loads = load_on_block(model, (0.0, 1.0, 0.0), 0.0)
    loose = Cuboid("loose", (1.0, 1.0, 1.0), (2.0, 2.0, 2.0), 1.0)
    alone = replace(model, pieces=(*model.pieces, loose))
    for problem in (
        (model, replace(loads, permanent=-loads.permanent)),
        (alone, load_on_block(alone, (0.0, 1.0, 0.0), 0.0)),
    ):
        with pytest.raises(NoEquilibriumError, match="no equilibrium at 0 N"):
            static_peak(*problem)


@pytest.mark.parametrize(
    ("density", "strength"),
    [(1e7, INNER.tensile_strength), (1e6, 0.0), (1400.0, 1e3), (1400.0, INNER.tensile_strength)],
)
def test_a_pulled_bond_fails_at_its_strength(joint: Joint, density: float, strength: float) -> None:
    joint = replace(joint, density=density, inner=replace(INNER, tensile_strength=strength))
    model = block_on_ground(joint, Kind.INNER, 0.02)
    loads = load_on_block(model, (0.0, 0.0, 1.0), 0.0)
    expected = strength * joint.a * joint.b + model.pieces[1].weight
    assert static_peak(model, loads).peak.load == pytest.approx(expected, rel=1e-5)
    near = {"rel": 1e-7, "abs": 1e-8 * joint.T0}
    assert limit_load(model, loads).load == pytest.approx(expected, **near)


@pytest.mark.parametrize("e_over_a", [0.0, 0.5, math.inf])
def test_without_tensile_strength_no_bond_of_a_joint_pulls(e_over_a: float) -> None:
    found = solved(sawn(3, inner=replace(INNER, tensile_strength=0.0)), e_over_a)
    for point in found.path:
        assert (point.force[:, 0] >= -2e-9 * np.abs(point.force).max()).all()
    assert 0.0 < found.peak.load < 1.001 * solved(sawn(3), e_over_a).peak.load


@pytest.mark.long
# --- how it ends ----------------------------------------------------------------------------------
def test_a_stack_carries_weight_until_its_faces_are_pressed_in() -> None:
    model, loads = tilted_stack(2)
    found = static_peak(model, replace(loads, variable=loads.permanent))
    assert found.mode is Mode.PRESSED
    assert found.peak.load > 100.0 * loads.scale


def test_the_peak_is_found_from_nearby_where_newton_fails_from_afar() -> None:
    joint = sawn(5, a=0.03, b=0.1, h=0.0132, H=0.0468)
    ratios = (math.tan(math.radians(angle)) for angle in (75, 80, 85))
    before, found, after = (solved(joint, ratio, 0.005).peak.load for ratio in ratios)
    assert found == pytest.approx((before + after) / 2, rel=0.01)


def test_a_joint_of_which_a_piece_is_loose_for_a_moment_stands() -> None:
    # The first step of Newton's method throws a piece far off, and the second brings it back.
    one, other = (solved(sawn(4, a=0.11, h=h, H=0.016), 1.0, 0.02) for h in (0.0265, 0.0266))
    assert one.path[0].load == 0.0
    assert one.peak.load == pytest.approx(other.peak.load, rel=1e-3)


# --- properties ----------------------------------------------------------------------------------
@pytest.mark.parametrize("locks", [3, 4])
@pytest.mark.parametrize("e_over_a", [0.0, 0.5, math.inf])
def test_every_equilibrium_balances_loads_within_strengths(locks: int, e_over_a: float) -> None:
    model, loads = loaded(sawn(locks), e_over_a)
    contact_law = ContactLaw.of(model)
    for point in static_peak(model, loads).path:
        assert utilisation(contact_law, point.state, point.force).max() <= 1.0 + 1e-9
        motion = placed(model, point.unknowns)
        unbalanced = unbalanced_forces(model, loads, point.load, point.force, motion)
        assert np.abs(unbalanced).max() <= 1e-9 * np.abs(loads.at(point.load)).max()


@pytest.mark.long
@pytest.mark.parametrize("failure", Failure)
def test_the_first_failure_alone_is_that_of_the_path_to_the_peak(failure: Failure) -> None:
    model, loads = loaded(sawn(5, failure=failure), 2.0)
    found = static_first_failure(model, loads)
    assert found.point.load == static_peak(model, loads).first_failure_load
    used = utilisation(ContactLaw.of(model), found.point.state, found.point.force)
    assert found.mode is Mode.BONDS
    assert used[found.failing].min() == pytest.approx(1.0, abs=2e-5)
    assert found.point.state.whole.min() == 0.0 and found.failing.any()  # dry nodes have no bond
    assert found.point.state.bonded[found.failing].all()


def test_where_no_bond_fails_first_failure_is_the_last_point_with_a_reason(joint: Joint) -> None:
    model = block_on_ground(joint, Kind.DRY, 0.02)
    loads = load_on_block(model, (0.0, 1.0, 0.0), 0.0)
    found, whole = static_first_failure(model, loads), static_peak(model, loads)
    assert not found.failing.any()
    assert (found.mode, found.point.load) == (Mode.MECHANISM, whole.peak.load)


def test_a_smaller_increment_follows_the_history_of_friction_more_closely() -> None:
    joint = sawn(
        9,
        a=0.036345,
        h=0.0076148,
        H=0.016506,
        inner=replace(INNER, shear_stiffness=2.885e10),
        dry=FaceMaterial(4.999e9, 4.999e9, 0.2535, 0.0, 0.0),
        hold_down=HoldDown.pressure(66497.0),
    )
    problem = loaded(joint, 1.12, 0.016, NodeLayout.LOBATTO)
    increments = (0.1, 0.05, 0.025, 0.0125)
    found = [static_first_failure(*problem, increment=each).point.load for each in increments]
    changes = np.diff(found)
    assert (changes < 0.0).all() and (np.abs(changes[1:]) < 0.8 * np.abs(changes[:-1])).all()
    default = static_first_failure(*problem).point.load  # as small as friction asks for
    assert default == pytest.approx(2 * found[-1] - found[-2], rel=5e-3)
    assert found[0] > 1.04 * default and static_peak(*problem).first_failure_load == default
    with pytest.raises(ValueError, match=r"increment: 0\.0 is not allowed"):
        static_first_failure(*problem, increment=0.0)


@pytest.mark.long
@settings(max_examples=15)
@given(st.floats(-6, 6), st.floats(-6, 6), st.sampled_from([0.0, 0.35, math.inf]))
def test_peaks_scale_with_stress_and_area(size: float, strength: float, e_over_a: float) -> None:
    length, stress, joint = 10.0**size, 10.0**strength, sawn(4)
    factor = stress * length**2
    one = solved(joint, e_over_a)
    other = solved(scaled(joint, length, stress), e_over_a, 0.03 * length)
    assert other.peak.load == pytest.approx(factor * one.peak.load, rel=1e-6)
    assert other.first_failure_load == pytest.approx(factor * one.first_failure_load, rel=1e-6)
    within = 1e-6 * factor * one.peak.load
    assert other.peak.force == pytest.approx(factor * one.peak.force, abs=within)


@settings(max_examples=5)
@given(st.floats(-6, 6))
def test_the_length_that_measures_rotations_is_a_matter_of_taste(exponent: float) -> None:
    model, loads = loaded(sawn(4), 0.35)
    # The other lengths are within four orders of magnitude of the assembly's.
    other = static_peak(replace(model, length=model.length * 10.0 ** (exponent / 3)), loads)
    assert other.peak.load == pytest.approx(static_peak(model, loads).peak.load, rel=1e-6)


@pytest.mark.parametrize("push", Push)
@pytest.mark.parametrize("e_over_a", [0.35, -0.35])
def test_odd_locks_carry_the_same_when_mirrored(joint: Joint, push: Push, e_over_a: float) -> None:
    one, mirrored = loaded(joint, 0.35), loaded(joint, e_over_a, push=push)
    peak = static_peak(*one).peak.load
    assert static_peak(*mirrored).peak.load == pytest.approx(peak, rel=1e-5)
    assert limit_load(*mirrored).load == pytest.approx(limit_load(*one).load, rel=1e-7)


def test_the_order_of_faces_and_nodes_does_not_matter(joint: Joint) -> None:
    model, loads = loaded(joint, 0.35)
    one = static_peak(model, loads)
    assert static_peak(renumbered(model), loads).peak.load == pytest.approx(one.peak.load, rel=1e-6)


# --- the published study -------------------------------------------------------------------------
@pytest.mark.parametrize(("locks", "published", "weights", "within"), PUBLISHED)
def test_peak_and_weights_of_the_published_samples(
    locks: int, published: float, weights: list[float], within: float
) -> None:
    joint = sawn(locks)
    model, loads = loaded(joint, mesh=0.02)
    found = static_peak(model, loads)
    assert found.peak.load == pytest.approx(published, rel=within)
    carried = lock_weights(joint, model, found.peak.force)
    assert [lock.weight for lock in carried] == pytest.approx(weights, abs=0.06)
