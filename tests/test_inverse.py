"""Inverse questions of a joint: the fewest locks, the cheapest sizes, all that carry a load."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

import pytest

from sidmacib import Demand, Prices, all_candidates, assemble, cheapest, fewest_locks, safe
from sidmacib.joint import DRY, Direction, Joint, OwnLock, Side, UpperBody
from sidmacib.mechanics.assembly import Kind
from sidmacib.rule.inverse import (
    bonded_area,
    cheapest_of,
    joint_area,
    variants,
    volume_cut,
)

SMOOTH = replace(DRY, friction=0.0)
WEIGHTLESS = Joint(5, a=0.08, H=0.06, density=0.0)
VALUES: Mapping[str, Sequence[float]] = {"locks": (3, 5, 6), "a": (0.06, 0.08, 0.1), "h": (0.008,)}


def test_the_demand_of_a_torque_turns_with_the_length_of_locks_that_of_a_ratio_does_not() -> None:
    short, long = Joint(3, a=0.05), Joint(3, a=0.1)
    fixed, turning = Demand(300.0, ratio=0.3), Demand(300.0, torque=4.5)
    assert fixed.direction(short) == fixed.direction(long) == Direction(0.3)
    assert turning.direction(short) == Direction(0.3)
    assert turning.direction(long) == Direction(0.15)
    assert turning.load(short) == pytest.approx(fixed.load(short))
    assert turning.load(long) * turning.direction(long).shear == pytest.approx(300.0)


@pytest.mark.parametrize("body", [UpperBody.COLUMNS, UpperBody.MONOLITHIC])
@pytest.mark.parametrize("first", list(Side))
def test_bonded_area_is_that_of_the_inner_faces(body: UpperBody, first: Side) -> None:
    joint = Joint(6, a=0.07, b=0.04, H=0.03, upper_body=body, first=first)
    faces = [face for face in assemble(joint, 0.02).faces if face.kind is Kind.INNER]
    assert bonded_area(joint) == pytest.approx(sum(face.area for face in faces))


def test_the_volume_cut_is_that_of_all_locks() -> None:
    joint = Joint(5, a=0.07, b=0.04, h=0.01)
    locks = [piece for piece in assemble(joint, 0.02).pieces if piece.name.startswith("lock")]
    assert volume_cut(joint) == pytest.approx(sum(each.mass for each in locks) / joint.density)
    assert joint_area(joint) == pytest.approx(5 * 0.07 * 0.04)


@pytest.mark.parametrize("demand", [Demand(500.0), Demand(300.0, ratio=0.3), Demand(90.0, 8.0)])
def test_the_fewest_locks_do_and_one_lock_fewer_does_not(demand: Demand) -> None:
    found = fewest_locks(WEIGHTLESS, demand).found
    assert found is not None and found.joint.locks > 2
    fewer = replace(found.joint, locks=found.joint.locks - 1)
    for joint, meets in ((found.joint, True), (fewer, False)):
        assert (safe(joint, demand.direction(joint)).load >= demand.load(joint)) is meets


@pytest.mark.parametrize(
    "prices", [Prices(), Prices(0.0, 1.0), Prices(0.0, 0.0, 1.0), Prices(1.0, 50.0, 0.3)]
)
@pytest.mark.parametrize("demand", [Demand(200.0), Demand(250.0, 5.0)])
def test_the_cheapest_is_that_of_trying_all(demand: Demand, prices: Prices) -> None:
    priced = [
        (prices.of(joint), joint)
        for joint in variants(WEIGHTLESS, VALUES)
        if safe(joint, demand.direction(joint)).load >= demand.load(joint)
    ]
    search = cheapest(WEIGHTLESS, demand, VALUES, prices)
    assert prices.of(search.found.joint) == min(price for price, _ in priced)
    assert search.found == cheapest_of(all_candidates(WEIGHTLESS, demand, VALUES), prices)
    assert not any(each.meets for each in search.tried[:-1])


def test_a_joint_that_the_rule_refuses_is_no_answer_and_has_a_reason() -> None:
    values = {"a": (0.08, 0.7)}  # a / b of 14 was not tested
    weak, refused = all_candidates(WEIGHTLESS, Demand(700.0), values)
    assert not weak.meets and weak.load is not None and not weak.reason
    assert refused.load is None and not refused.meets and "a / b: 14" in refused.reason
    assert cheapest(WEIGHTLESS, Demand(700.0), values).found is None


OTHER_LOCKS = Joint(3, different={2: OwnLock(width=0.03)})


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        (partial(Demand, 0.0), "V or M must not be zero"),
        (partial(Demand, -1.0), "shear: -1.0"),
        (partial(Demand, math.inf), "shear: inf"),
        (partial(Demand, 1.0, math.nan), "torque: nan"),
        (partial(Demand, 1.0, 2.0, 0.3), "not both"),
        (partial(Demand, 1.0, 0.0, math.inf), "give M for torsion"),
        (partial(Demand, 0.0, 0.0, 0.3), "V more than 0"),
        (partial(variants, WEIGHTLESS, {"c": (1.0,)}), "values: 'c'"),
        (partial(variants, WEIGHTLESS, {"a": ()}), "'0 joints'"),
        (partial(variants, WEIGHTLESS, dict.fromkeys("ab", (0.1,) * 200)), "'40000 joints'"),
        (partial(variants, WEIGHTLESS, {"a": (-0.1,)}), "a: -0.1"),
        (partial(fewest_locks, OTHER_LOCKS, Demand(100.0)), "locks that differ"),
        *((partial(Prices, *each), "area") for each in ((0.0,) * 3, (-1.0, 2.0), (math.nan,))),
    ],
)
def test_a_question_without_an_answer_is_refused(asked: partial[object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        asked()
