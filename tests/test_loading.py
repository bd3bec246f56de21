"""The lateral load."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sidmacib.joint import INNER, Direction, Joint
from sidmacib.joint.loading import Loading, LoadShare, Push, lateral_load
from sidmacib.joint.pieces import assemble
from sidmacib.mechanics.assembly import NodeLayout

loadings = st.builds(
    Loading,
    st.builds(Direction, st.one_of(st.floats(-10, 10), st.just(math.inf))),
    share=st.sampled_from(LoadShare),
    push=st.sampled_from(Push),
)


@given(loadings, st.integers(2, 6))
def test_loads_on_the_pieces_add_up_to_shear_and_torque(loading: Loading, locks: int) -> None:
    joint = Joint(locks)
    loads = lateral_load(joint, assemble(joint, 0.03, NodeLayout.CENTRES), loading)
    sign = 1 if loading.push is Push.PLUS_Y else -1
    direction = loading.direction
    # All centroids lie at x = 0, so the forces add nothing to the torque about z.
    expected = [0, sign * direction.shear, 0, 0, 0, direction.torque * joint.a]
    assert loads.variable.sum(axis=0) == pytest.approx(expected)


@given(loadings, st.integers(2, 6))
def test_every_piece_carries_its_own_weight_and_nothing_else(loading: Loading, locks: int) -> None:
    joint = Joint(locks)
    model = assemble(joint, 0.03, NodeLayout.CENTRES)
    permanent = lateral_load(joint, model, loading).permanent
    volume = [math.prod(np.subtract(piece.high, piece.low)) for piece in model.pieces]
    assert permanent[:, 2] == pytest.approx(-9.81 * 1400.0 * np.array(volume))
    assert (np.delete(permanent, 2, axis=1) == 0.0).all()


def loaded(joint: Joint, loading: Loading) -> dict[str, float]:
    """Force in y on each loaded piece, per newton of load."""
    model = assemble(joint, 0.03, NodeLayout.CENTRES)
    force = lateral_load(joint, model, loading).variable[:, 1]
    return {p.name: float(f) for p, f in zip(model.pieces, force, strict=True) if f}


def test_the_first_lock_takes_the_share_of_its_height(joint: Joint) -> None:
    found = loaded(joint, Loading(Direction(0.0)))
    share = joint.h / (joint.h + joint.H)
    assert found == pytest.approx({"lock1": share, "column1": 1.0 - share})


@pytest.mark.parametrize(
    ("locks", "push", "names"),
    [
        (3, Push.MINUS_Y, {"lock3", "column3"}),
        (4, Push.MINUS_Y, {"column4"}),  # lock 4 belongs to the lower block
        (4, Push.PLUS_Y, {"lock1", "column1"}),
    ],
)
def test_the_load_acts_on_the_upper_block_only(locks: int, push: Push, names: set[str]) -> None:
    found = loaded(Joint(locks), Loading(Direction(0.0), push=push))
    assert set(found) == names
    assert np.sign(sum(found.values())) == (1 if push is Push.PLUS_Y else -1)


def test_a_load_on_the_body_spares_the_lock(joint: Joint) -> None:
    assert set(loaded(joint, Loading(Direction(0.0), LoadShare.BODY))) == {"column1"}


def test_a_joint_without_cohesion_has_its_weight_for_a_scale(joint: Joint) -> None:
    weak = replace(joint, inner=replace(INNER, cohesion=0.0))
    found = lateral_load(weak, assemble(weak, 0.03, NodeLayout.CENTRES), Loading(Direction(0.0)))
    assert found.scale == pytest.approx(9.81 * 1400.0 * 0.06 * 0.15 * 0.035)
