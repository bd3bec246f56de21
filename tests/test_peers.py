"""What `make bench` measures beside: the same programme, and the same pieces."""

import numpy as np
import pytest

from benchmarks.peers import furthest_by_highs, standard_form
from sidmacib.contact_points import OPTIONS
from sidmacib.contact_points.programme import Sidmacib, SupportFunction
from sidmacib.joint import Joint


@pytest.mark.parametrize("way", [(1.0, 0.0), (0.3, 0.7), (-0.2, -0.9)])
def test_highs_of_scipy_solves_the_same_programme(way: tuple[float, float]) -> None:
    model, along = Sidmacib(Joint(5), OPTIONS["option4"]), np.array(way)
    ours = SupportFunction(model)(along)
    theirs = furthest_by_highs(standard_form(model), along)
    assert along @ theirs == pytest.approx(along @ ours, rel=1e-9)
