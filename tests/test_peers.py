"""What `make bench` measures beside: the same programme, and the same pieces."""

import numpy as np
import pytest

from benchmarks.peers import box, furthest_by_highs, peer_times, standard_form
from sidmacib.contact_points.options import OPTIONS
from sidmacib.contact_points.programme import Sidmacib, SupportFunction
from sidmacib.joint.joint import Joint
from sidmacib.joint.pieces import cut_pieces


@pytest.mark.parametrize("way", [(1.0, 0.0), (0.3, 0.7), (-0.2, -0.9)])
def test_highs_of_scipy_solves_the_same_programme(way: tuple[float, float]) -> None:
    model, along = Sidmacib(Joint(5), OPTIONS["option4"]), np.array(way)
    ours = SupportFunction(model)(along)
    theirs = furthest_by_highs(standard_form(model), along)
    assert along @ theirs == pytest.approx(along @ ours, rel=1e-9)


def test_sides_of_a_box_face_outwards_and_enclose_the_piece() -> None:
    piece = cut_pieces(Joint(3))[0]
    corners, sides = np.array(box(piece)[0]), box(piece)[1]
    volume = 0.0
    for a, b, c, d in sides:
        for one, two, three in ((a, b, c), (a, c, d)):
            volume += np.linalg.det(corners[[one, two, three]]) / 6
    assert volume == pytest.approx(float(np.prod(piece.size)))


def test_programs_that_are_not_installed_are_left_out() -> None:
    names = [name for name, _ in peer_times(Joint(3))]
    assert names[:2] == ["SiDMACIB, one point", "the same programme, HiGHS of SciPy"]
