"""The lateral load."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sidmacib.joint import Direction, Joint
from sidmacib.loading import Loading, LoadShare, Push, lateral_load

loadings = st.builds(
    Loading,
    eccentricity=st.one_of(st.floats(0, 1), st.just(math.inf)),
    share=st.sampled_from(LoadShare),
    push=st.sampled_from(Push),
)


@given(loadings, st.integers(2, 6))
def test_loads_on_the_pieces_add_up_to_shear_and_torque(loading: Loading, locks: int) -> None:
    model = assemble(Joint(locks), 0.03)
    loads = lateral_load(joint, model, loading)
    direction = Direction.at_eccentricity(loading.eccentricity, model.joint.a)
    sign = 1 if loading.push is Push.PLUS_Y else -1
    assert sum(load.force for load in loads) == pytest.approx([0, sign * direction.shear, 0])
    # All centroids lie at x = 0, so the forces add nothing to the torque about z.
    assert sum(load.moment for load in loads) == pytest.approx([0, 0, direction.torque])


def test_the_first_lock_takes_the_share_of_its_height(joint: Joint) -> None:
    model = assemble(joint, 0.03)
    loads = {
        model.pieces[p.piece].name: p for p in lateral_load(joint, model, Loading(Direction(0.0)))
    }
    assert set(loads) == {"lock1", "column1"}
    assert loads["lock1"].force[1] == pytest.approx(joint.h / (joint.h + joint.H))


@pytest.mark.parametrize(
    ("locks", "push", "loaded"),
    [
        (3, Push.MINUS_Y, {"lock3", "column3"}),
        (4, Push.MINUS_Y, {"column4"}),  # lock 4 belongs to the lower block
        (4, Push.PLUS_Y, {"lock1", "column1"}),
    ],
)
def test_the_load_acts_on_the_upper_block_only(locks: int, push: Push, loaded: set[str]) -> None:
    model = assemble(Joint(locks), 0.03)
    loads = lateral_load(joint, model, Loading(Direction(0.0), push=push))
    assert {model.pieces[load.piece].name for load in loads} == loaded
    assert np.sign(sum(load.force[1] for load in loads)) == (1 if push is Push.PLUS_Y else -1)


def test_a_load_on_the_body_spares_the_lock(joint: Joint) -> None:
    model = assemble(joint, 0.03)
    loads = lateral_load(joint, model, Loading(Direction(0.0), LoadShare.BODY))
    assert [model.pieces[load.piece].name for load in loads] == ["column1"]
