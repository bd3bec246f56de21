"""The joint, its pieces, faces and nodes, and the load on them."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from joints import loaded, sawn

from sidmacib import OPTIONS, Sidmacib, capacity, limit_load
from sidmacib.joint import DRY, INNER, Direction, HoldDown, Joint, OwnLock, Side, UpperBody
from sidmacib.joint.loading import Loading, LoadShare, Push, lateral_load, posed
from sidmacib.joint.pieces import assemble, lock_faces, lock_weights, shared_face, upper_block
from sidmacib.mechanics.assembly import Assembly, Cuboid, FaceMaterial, Kind, NodeLayout, Rectangle
from sidmacib.mechanics.static import StaticSolution, static_peak


def test_locks_belong_to_the_blocks_in_turn_from_the_first_on() -> None:
    joint, other = sawn(locks=5), sawn(locks=5, first=Side.LOWER)
    assert joint.upper_locks == other.lower_locks == (1, 3, 5)
    assert joint.lower_locks == other.upper_locks == (2, 4)


@given(st.floats(-100, 100))
def test_direction_keeps_its_eccentricity(eccentricity: float) -> None:
    direction = Direction(eccentricity)
    assert direction.torque / direction.shear == pytest.approx(eccentricity)
    assert math.hypot(direction.shear, direction.torque) == pytest.approx(1.0)
    torsion = Direction(math.copysign(math.inf, eccentricity))
    assert (torsion.shear, torsion.torque) == (0.0, math.copysign(1.0, eccentricity))


joints = st.builds(
    Joint,
    locks=st.integers(1, 7),
    first=st.sampled_from(Side),
    hold_down=st.sampled_from([HoldDown(), HoldDown.force(9.0), HoldDown.weight()]),
    a=st.floats(0.02, 0.2),
    b=st.floats(0.02, 0.2),
    h=st.floats(0.005, 0.1),
    H=st.floats(0.01, 0.2),
    upper_body=st.sampled_from(UpperBody),
)


def on_coarse_cells(joint: Joint) -> Assembly:
    return assemble(joint, 0.99 * joint.least_side, NodeLayout.CENTRES)


@given(joints)
def test_every_lock_has_one_inner_face_of_area_ab(joint: Joint) -> None:
    model = on_coarse_cells(joint)
    locks = lock_faces(joint)
    inner = {locks[face.name]: face for face in model.faces if face.name in locks}
    assert sorted(inner) == list(range(1, joint.locks + 1))
    for lock, face in inner.items():
        assert face.kind is Kind.INNER
        assert face.area == pytest.approx(joint.a * joint.b)
        assert face.low[2] == (joint.h if joint.is_upper(lock) else 0.0)


@given(joints)
def test_pieces_fill_the_upper_block_and_the_locks(joint: Joint) -> None:
    pieces = on_coarse_cells(joint).pieces
    volume = joint.a * joint.b * joint.locks * (joint.h + joint.H)
    mass = sum(piece.mass for piece in pieces if not piece.fixed)
    assert mass == pytest.approx(joint.density * volume)


@given(joints)
def test_faces_lie_on_both_of_their_pieces(joint: Joint) -> None:
    model = on_coarse_cells(joint)
    for face in model.faces:
        below, above = model.pieces[face.below], model.pieces[face.above]
        assert below.high[face.axis] == pytest.approx(above.low[face.axis])
        assert face.low[face.axis] == face.high[face.axis] == below.high[face.axis]
        assert above.centre[face.axis] > below.centre[face.axis]
        assert face.area > 0


def test_inner_faces_join_pieces_of_one_block_and_dry_faces_of_two(joint: Joint) -> None:
    model = assemble(joint, 0.02, NodeLayout.CENTRES)
    upper = set(upper_block(joint))
    for face in model.faces:
        ends = [model.pieces[face.below].name, model.pieces[face.above].name]
        assert len({name in upper for name in ends}) == (1 if face.kind is Kind.INNER else 2)
        assert ("plate" in ends) == (face.kind is Kind.PLATE)


SMOOTH = FaceMaterial(1e10, 1e10, 0.0, 0.0, 0.0)


def boxes(size: float, gap: float, beside: float = 0.5) -> tuple[Cuboid, Cuboid]:
    """Two cubes, one above the other, ``gap`` apart and ``beside`` its middle, over its size."""
    return (
        Cuboid("lower", (0.0, 0.0, 0.0), (size, size, size), 1.0),
        Cuboid("upper", (beside * size, 0.0, size + gap), (2 * size, size, 3 * size), 1.0),
    )


def face(pieces: tuple[Cuboid, ...]) -> Rectangle:
    return shared_face("face", Kind.DRY, SMOOTH, pieces, (0, 1))


@given(st.floats(-6, 6))
def test_pieces_share_the_rectangle_in_which_they_touch(exponent: float) -> None:
    size = 10.0**exponent
    found = face(boxes(size, 1e-12 * size))
    assert found.axis == 2
    assert found.area == pytest.approx(size**2 / 2)


@given(st.floats(-6, 6), st.sampled_from([-1e-3, 1e-6, 1.0]), st.sampled_from([0.5, 1.0]))
def test_pieces_apart_or_at_edges_share_no_face(exponent: float, gap: float, beside: float) -> None:
    size = 10.0**exponent
    with pytest.raises(ValueError, match="face: lower does not touch upper from below"):
        face(boxes(size, (0.0 if beside == 1.0 else gap) * size, beside))


loadings = st.builds(
    Loading,
    st.builds(Direction, st.one_of(st.floats(-10, 10), st.just(math.inf))),
    share=st.sampled_from(LoadShare),
    push=st.sampled_from(Push),
)


@given(loadings, st.integers(2, 6))
def test_loads_on_the_pieces_add_up_to_shear_and_torque(loading: Loading, locks: int) -> None:
    joint = sawn(locks)
    loads = lateral_load(joint, assemble(joint, 0.03, NodeLayout.CENTRES), loading)
    sign = 1 if loading.push is Push.PLUS_Y else -1
    direction = loading.direction
    # All centroids lie at x = 0, so the forces add nothing to the torque about z.
    expected = [0, sign * direction.shear, 0, 0, 0, direction.torque * joint.a]
    assert loads.variable.sum(axis=0) == pytest.approx(expected)


@given(loadings, st.integers(2, 6))
def test_every_piece_carries_its_own_weight_and_nothing_else(loading: Loading, locks: int) -> None:
    joint = sawn(locks)
    model = assemble(joint, 0.03, NodeLayout.CENTRES)
    permanent = lateral_load(joint, model, loading).permanent
    volume = [math.prod(np.subtract(piece.high, piece.low)) for piece in model.pieces]
    assert permanent[:, 2] == pytest.approx(-9.81 * 1400.0 * np.array(volume))
    assert (np.delete(permanent, 2, axis=1) == 0.0).all()


@pytest.mark.parametrize(
    ("locks", "loading", "names"),
    [
        (3, Loading(Direction(0.0)), ["lock1", "column1"]),
        (3, Loading(Direction(0.0), push=Push.MINUS_Y), ["lock3", "column3"]),
        # Lock 4 belongs to the lower block.
        (4, Loading(Direction(0.0), push=Push.MINUS_Y), ["column4"]),
        (3, Loading(Direction(0.0), LoadShare.BODY), ["column1"]),
    ],
)
def test_the_load_is_shared_by_height(locks: int, loading: Loading, names: list[str]) -> None:
    joint = sawn(locks)
    model = assemble(joint, 0.03, NodeLayout.CENTRES)
    force = lateral_load(joint, model, loading).variable[:, 1]
    heights = [joint.h if name.startswith("lock") else joint.H for name in names]
    sign = 1.0 if loading.push is Push.PLUS_Y else -1.0
    shares = {n: sign * h / sum(heights) for n, h in zip(names, heights, strict=True)}
    pieces = zip(model.pieces, force.tolist(), strict=True)
    assert {piece.name: load for piece, load in pieces if load} == pytest.approx(shares)


def test_a_joint_without_cohesion_has_its_weight_for_a_scale(joint: Joint) -> None:
    weak = replace(joint, inner=replace(INNER, cohesion=0.0))
    found = lateral_load(weak, assemble(weak, 0.03, NodeLayout.CENTRES), Loading(Direction(0.0)))
    assert found.scale == pytest.approx(9.81 * 1400.0 * 0.06 * 0.15 * 0.035)


# --- locks that differ ---------------------------------------------------------------------------
own_locks = st.builds(
    OwnLock,
    width=st.one_of(st.none(), st.floats(0.03, 0.1)),
    density=st.one_of(st.none(), st.floats(0.0, 5000.0)),
    inner=st.one_of(
        st.none(), st.builds(lambda c: replace(INNER, cohesion=c), st.floats(1e4, 1e6))
    ),
)
different_joints = st.builds(
    sawn,
    st.just(4),
    first=st.sampled_from(Side),
    different=st.dictionaries(st.integers(1, 4), own_locks),
    hold_down=st.sampled_from([HoldDown(), HoldDown.force(500.0)]),
)


def solved(joint: Joint, loading: Loading, mesh: float = 0.02) -> StaticSolution:
    return static_peak(*posed(joint, loading, mesh, NodeLayout.CENTRES))


# --- what a joint knows of its locks -------------------------------------------------------------
def test_locks_of_their_own_are_the_same_in_any_order_and_hashable() -> None:
    one = sawn(3, different={1: OwnLock(width=0.04), 3: OwnLock(width=0.06)})
    other = sawn(3, different={3: OwnLock(width=0.06), 1: OwnLock(width=0.04)})
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
        assemble(sawn(3, different={2: OwnLock(width=0.04)}), mesh, NodeLayout.CENTRES)


# --- the first lock ------------------------------------------------------------------------------
@pytest.mark.parametrize("locks", range(2, 8))
@pytest.mark.parametrize("first", Side)
@pytest.mark.parametrize("push", Push)
def test_as_many_locks_count_as_pairs_bear(locks: int, first: Side, push: Push) -> None:
    joint = sawn(locks, first=first)
    found = limit_load(*loaded(joint, push=push)).load
    order = joint.numbers if push is Push.PLUS_Y else joint.numbers[::-1]
    upper = [joint.is_upper(lock) for lock in order]
    pairs = sum(one and not other for one, other in pairwise(upper))
    assert found == pytest.approx(pairs * joint.T0, abs=1e-6)


@settings(max_examples=6)
@given(different_joints, st.sampled_from([0.0, 0.3]), st.sampled_from(LoadShare))
def test_a_mirrored_joint_is_as_strong(joint: Joint, eccentricity: float, share: LoadShare) -> None:
    """Seen from behind: its last lock is the first."""
    last = Side.UPPER if joint.is_upper(joint.locks) else Side.LOWER
    own = {joint.locks + 1 - number: changes for number, changes in joint.different}
    mirrored = replace(joint, first=last, different=own)
    one = solved(joint, Loading(Direction(eccentricity), share, Push.PLUS_Y))
    other = solved(mirrored, Loading(Direction(eccentricity), share, Push.MINUS_Y))
    assert other.peak.load == pytest.approx(one.peak.load, rel=1e-3, abs=1e-3 * joint.T0)


# --- strength ------------------------------------------------------------------------------------
@pytest.mark.parametrize("factor", [0.25, 0.5, 2.0])
def test_the_weaker_lock_of_a_pair_decides(factor: float) -> None:
    weak = OwnLock(inner=replace(INNER, cohesion=factor * INNER.cohesion))
    joint = sawn(2, dry=replace(DRY, friction=0.0), different={2: weak})
    expected = min(factor, 1.0) * joint.T0
    problem = posed(joint, Loading(Direction(0.0), LoadShare.BODY), 0.02, NodeLayout.CENTRES)
    assert limit_load(*problem).load == pytest.approx(expected, rel=1e-6)
    assert static_peak(*problem).peak.load == pytest.approx(expected, rel=1e-4)


def test_weights_are_over_a_locks_own_strength() -> None:
    weak = OwnLock(inner=replace(INNER, cohesion=INNER.cohesion / 2))
    joint = sawn(3, dry=replace(DRY, friction=0.0), different={2: weak})
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
        Sidmacib(sawn(1), OPTIONS["option1"])
