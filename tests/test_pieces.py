"""Pieces, faces and nodes of the joint."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sidmacib.joint import HoldDown, Joint, Side, UpperBody
from sidmacib.joint.pieces import assemble, lock_faces, shared_face, upper_block
from sidmacib.mechanics.assembly import Cuboid, FaceMaterial, Kind, NodeLayout, Rectangle

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


@given(joints)
def test_every_lock_has_one_inner_face_of_area_ab(joint: Joint) -> None:
    model = assemble(joint, 0.99 * min(joint.a, joint.b), NodeLayout.CENTRES)
    locks = lock_faces(joint)
    inner = {locks[face.name]: face for face in model.faces if face.name in locks}
    assert sorted(inner) == list(range(1, joint.locks + 1))
    for lock, face in inner.items():
        assert face.kind is Kind.INNER
        assert face.area == pytest.approx(joint.a * joint.b)
        assert face.low[2] == (joint.h if joint.is_upper(lock) else 0.0)


@given(joints)
def test_pieces_fill_the_upper_block_and_the_locks(joint: Joint) -> None:
    free = [
        piece
        for piece in assemble(joint, 0.99 * min(joint.a, joint.b), NodeLayout.CENTRES).pieces
        if not piece.fixed
    ]
    volume = joint.a * joint.b * joint.locks * (joint.h + joint.H)
    assert sum(piece.mass for piece in free) == pytest.approx(joint.density * volume)


@given(joints)
def test_faces_lie_on_both_of_their_pieces(joint: Joint) -> None:
    model = assemble(joint, 0.99 * min(joint.a, joint.b), NodeLayout.CENTRES)
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


def boxes(size: float, gap: float) -> tuple[Cuboid, Cuboid]:
    """Two cubes, one above the other, ``gap`` apart."""
    return (
        Cuboid("lower", (0.0, 0.0, 0.0), (size, size, size), 1.0),
        Cuboid("upper", (size / 2, 0.0, size + gap), (3 * size / 2, size, 3 * size), 1.0),
    )


def face(pieces: tuple[Cuboid, ...]) -> Rectangle:
    return shared_face("face", Kind.DRY, SMOOTH, pieces, (0, 1))


@given(st.floats(-6, 6))
def test_pieces_share_the_rectangle_in_which_they_touch(exponent: float) -> None:
    size = 10.0**exponent
    found = face(boxes(size, 1e-12 * size))
    assert found.axis == 2
    assert found.area == pytest.approx(size**2 / 2)


@given(st.floats(-6, 6), st.sampled_from([-1e-3, 1e-6, 1.0]))
def test_pieces_apart_share_no_face_whatever_their_size(exponent: float, gap: float) -> None:
    size = 10.0**exponent
    with pytest.raises(ValueError, match="face: lower does not touch upper from below"):
        face(boxes(size, gap * size))


def test_pieces_that_meet_along_an_edge_share_no_face() -> None:
    lower = Cuboid("lower", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), 1.0)
    upper = Cuboid("upper", (1.0, 0.0, 1.0), (2.0, 1.0, 2.0), 1.0)
    with pytest.raises(ValueError, match="does not touch"):
        face((lower, upper))
