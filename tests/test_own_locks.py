"""Locks that differ, and the block that the first lock belongs to."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from joints import loaded

from sidmacib import OPTIONS, NodeLayout, Sidmacib, capacity, limit_load
from sidmacib.joint import DRY, INNER, Direction, HoldDown, Joint, OwnLock, Side
from sidmacib.joint.loading import Loading, LoadShare, Push, posed
from sidmacib.joint.pieces import assemble, lock_faces, lock_weights
from sidmacib.mechanics.static import StaticSolution, static_peak

own_locks = st.builds(
    OwnLock,
    width=st.one_of(st.none(), st.floats(0.03, 0.1)),
    density=st.one_of(st.none(), st.floats(0.0, 5000.0)),
    inner=st.one_of(
        st.none(), st.builds(lambda c: replace(INNER, cohesion=c), st.floats(1e4, 1e6))
    ),
)
different_joints = st.builds(
    Joint,
    st.just(4),
    first=st.sampled_from(Side),
    different=st.dictionaries(st.integers(1, 4), own_locks),
    hold_down=st.sampled_from([HoldDown(), HoldDown.force(500.0)]),
)


def solved(joint: Joint, loading: Loading, mesh: float = 0.02) -> StaticSolution:
    return static_peak(*posed(joint, loading, mesh, NodeLayout.CENTRES))


def mirrored(joint: Joint) -> Joint:
    """The same joint seen from behind: its last lock is the first."""
    last = Side.UPPER if joint.is_upper(joint.locks) else Side.LOWER
    own = dict(joint.different).items()
    different = {joint.locks + 1 - number: changes for number, changes in own}
    return replace(joint, first=last, different=different)


# --- what a joint knows of its locks -------------------------------------------------------------
def test_locks_of_their_own_are_the_same_in_any_order_and_hashable() -> None:
    one = Joint(3, different={1: OwnLock(width=0.04), 3: OwnLock(width=0.06)})
    other = Joint(3, different={3: OwnLock(width=0.06), 1: OwnLock(width=0.04)})
    assert one == other
    assert len({one, other, replace(one, h=0.01)}) == 2
    assert replace(one, h=0.01).different == one.different


@given(different_joints)
def test_locks_lie_side_by_side_at_their_widths(joint: Joint) -> None:
    widths = [joint.width(lock) for lock in joint.numbers]
    ends = np.cumsum([0.0, *widths])
    assert joint.total_width == pytest.approx(ends[-1])
    centres = [joint.lock_centre_y(lock) for lock in joint.numbers]
    assert centres == pytest.approx((ends[1:] + ends[:-1]) / 2)
    model = assemble(joint, 0.02, NodeLayout.CENTRES)
    for number in joint.numbers:
        for name in (f"lock{number}", f"column{number}"):
            (piece,) = (piece for piece in model.pieces if piece.name == name)
            assert (piece.low[1], piece.high[1]) == pytest.approx(ends[number - 1 : number + 1])
        density_of_lock = joint.own(number).density
        (lock,) = (piece for piece in model.pieces if piece.name == f"lock{number}")
        density = joint.density if density_of_lock is None else density_of_lock
        assert lock.mass == pytest.approx(density * float(np.prod(lock.size)))


@given(different_joints)
def test_every_locks_face_has_its_own_strength(joint: Joint) -> None:
    numbers = lock_faces(joint)
    found = {
        numbers[face.name]: face.material.cohesion * face.area
        for face in assemble(joint, 0.02, NodeLayout.CENTRES).faces
        if face.name in numbers
    }
    assert [found[lock] for lock in joint.numbers] == pytest.approx(joint.strengths)


@pytest.mark.parametrize("mesh", [0.04, 0.05])
def test_a_mesh_must_fit_the_narrowest_lock(mesh: float) -> None:
    with pytest.raises(ValueError, match=r"mesh: must be more than 0 and less than 0.04 m"):
        assemble(Joint(3, different={2: OwnLock(width=0.04)}), mesh, NodeLayout.CENTRES)


# --- the first lock ------------------------------------------------------------------------------
@pytest.mark.parametrize("locks", range(2, 8))
@pytest.mark.parametrize("first", Side)
@pytest.mark.parametrize("push", Push)
def test_as_many_locks_count_as_pairs_bear(locks: int, first: Side, push: Push) -> None:
    joint = Joint(locks, first=first)
    found = limit_load(*loaded(joint, push=push)).load
    order = joint.numbers if push is Push.PLUS_Y else joint.numbers[::-1]
    upper = [joint.is_upper(lock) for lock in order]
    pairs = sum(one and not other for one, other in pairwise(upper))
    assert found == pytest.approx(pairs * joint.T0, abs=1e-6)


@settings(max_examples=6)
@given(different_joints, st.sampled_from([0.0, 0.3]), st.sampled_from(LoadShare))
def test_a_mirrored_joint_is_as_strong(joint: Joint, eccentricity: float, share: LoadShare) -> None:
    one = solved(joint, Loading(Direction(eccentricity), share, Push.PLUS_Y))
    other = solved(mirrored(joint), Loading(Direction(eccentricity), share, Push.MINUS_Y))
    assert other.peak.load == pytest.approx(one.peak.load, rel=1e-3, abs=1e-3 * joint.T0)


# --- strength ------------------------------------------------------------------------------------
@pytest.mark.parametrize("factor", [0.25, 0.5, 2.0])
def test_the_weaker_lock_of_a_pair_decides(factor: float) -> None:
    weak = OwnLock(inner=replace(INNER, cohesion=factor * INNER.cohesion))
    joint = Joint(2, dry=replace(DRY, friction=0.0), different={2: weak})
    expected = min(factor, 1.0) * joint.T0
    problem = posed(joint, Loading(Direction(0.0), LoadShare.BODY), 0.02, NodeLayout.CENTRES)
    assert limit_load(*problem).load == pytest.approx(expected, rel=1e-6)
    assert static_peak(*problem).peak.load == pytest.approx(expected, rel=1e-4)


def test_weights_are_over_a_locks_own_strength() -> None:
    weak = OwnLock(inner=replace(INNER, cohesion=INNER.cohesion / 2))
    joint = Joint(3, dry=replace(DRY, friction=0.0), different={2: weak})
    problem = loaded(joint, mesh=0.02)
    _, lower, _ = lock_weights(joint, problem.assembly, static_peak(*problem).peak.force)
    assert lower.weight == pytest.approx(1.0, abs=1e-3)
    assert abs(lower.shear_y_N) == pytest.approx(120.0, rel=1e-3)


# --- SiDMACIB ------------------------------------------------------------------------------------
@settings(max_examples=10)
@given(different_joints)
def test_sidmacib_adds_up_the_locks_own_strengths(joint: Joint) -> None:
    joint = replace(joint, hold_down=HoldDown.force(1e5))
    model = Sidmacib(joint, OPTIONS["option2"], friction=False)
    assert capacity(model, Direction(0.0)).load == pytest.approx(sum(joint.strengths), rel=1e-6)
    torsion = capacity(model, Direction(math.inf)).torque
    assert torsion == pytest.approx(sum(joint.strengths) * joint.a / 3, rel=1e-6)


def test_sidmacib_refuses_a_lock_that_no_other_bears_against() -> None:
    with pytest.raises(ValueError, match=r"^locks: 1 is not allowed with SiDMACIB, .* at least 2"):
        Sidmacib(Joint(1), OPTIONS["option1"])
