"""What `make bench` measures: time and memory of a command, and the same programme elsewhere."""

import sys
from pathlib import Path

import numpy as np
import pytest

from benchmarks import used
from benchmarks.peers import furthest_by_highs, standard_form
from sidmacib import OPTIONS, Joint
from sidmacib.contact_points.programme import Sidmacib, SupportFunction


@pytest.mark.parametrize("way", [(1.0, 0.0), (0.3, 0.7), (-0.2, -0.9)])
def test_highs_of_scipy_solves_the_same_programme(way: tuple[float, float]) -> None:
    model, along = Sidmacib(Joint(5), OPTIONS["option4"]), np.array(way)
    ours = SupportFunction(model)(along)
    theirs = furthest_by_highs(standard_form(model), along)
    assert along @ theirs == pytest.approx(along @ ours, rel=1e-9)


def test_memory_is_that_of_the_command_alone(tmp_path: Path) -> None:
    held = np.ones(30_000_000)  # 240 MB in the process that measures
    code = "held = b'1' * int({}e6)"
    little, much = (
        used([sys.executable, "-c", code.format(megabytes)], tmp_path).memory
        for megabytes in (0.0, 100.0)
    )
    assert little < held.nbytes / 1e6 / 2.0
    assert much - little == pytest.approx(100.0 * 1e6 / 2**20, rel=0.1)
