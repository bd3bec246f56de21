"""Inverse questions of a joint: the fewest locks, the cheapest sizes, all that carry a load."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from command_runner import answers, run

from sidmacib import Demand, Prices, all_candidates, assemble, cheapest, fewest_locks, safe
from sidmacib.command.inverse import chart, prices_of, sought, values_of
from sidmacib.joint import DRY, Direction, Joint, OwnLock, Side, UpperBody
from sidmacib.joint.loading import Push
from sidmacib.mechanics.assembly import Kind
from sidmacib.quantities import rounded
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


@pytest.mark.long
@pytest.mark.parametrize("demand", [Demand(500.0), Demand(300.0, ratio=0.3), Demand(90.0, 8.0)])
def test_the_fewest_locks_do_and_one_lock_fewer_does_not(demand: Demand) -> None:
    found = fewest_locks(WEIGHTLESS, demand).found
    assert found is not None and found.joint.locks > 2
    fewer = replace(found.joint, locks=found.joint.locks - 1)
    for joint, meets in ((found.joint, True), (fewer, False)):
        assert (safe(joint, demand.direction(joint)).load >= demand.load(joint)) is meets


@pytest.mark.long
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


# --- `multilock joint` ---------------------------------------------------------------------------
SIZES = ("-a", "0.08", "-H", "0.06")
JOINT = Joint(5, a=0.08, H=0.06)


def test_the_fewest_locks_are_those_of_the_library() -> None:
    rows = answers("joint", "-V", "300", "-e", "0.3", *SIZES)
    found = fewest_locks(JOINT, Demand(300.0, ratio=0.3))
    assert [row["locks"] for row in rows] == [each.joint.locks for each in found.tried]
    assert found.found is not None and rows[-1]["safe_V_N"] == rounded(found.found.shear)
    assert rows[-1]["note"] == "strong enough"
    assert all(row["note"].startswith("too weak") for row in rows[:-1])


def test_the_cheapest_sizes_are_those_of_the_library() -> None:
    vary = ("--vary", "a=0.06:0.1:0.01", "--vary", "h=0.006,0.008")
    (row,) = answers("joint", "-n", "6", "-V", "300", "-M", "5", *SIZES, *vary)
    values = {"a": (0.06, 0.07, 0.08, 0.09, 0.1), "h": (0.006, 0.008)}
    found = cheapest(Joint(6, H=0.06), Demand(300.0, 5.0), values).found
    assert (row["a_m"], row["h_m"]) == (found.joint.a, found.joint.h)
    assert (row["safe_V_N"], row["safe_M_Nm"]) == (rounded(found.shear), rounded(found.torque))


@pytest.mark.long
def test_what_no_joint_carries_ends_with_how_far_they_are() -> None:
    found = run("joint", "-V", "3e4")
    assert found.exit_code == 1
    assert "no joint with 2 to 31 locks is strong enough;" in found.output
    assert "at most 0 N, " in run("joint", "-M", "1e4").output
    found = run("joint", "-V", "3e4", "--vary", "a=0.05,0.7")
    assert "none of 2 joints is strong enough" in found.output
    assert "the rule refuses 1 of them, for example: a / b: 14" in found.output


@pytest.mark.parametrize("load", ["3e4", "1e9"])
def test_the_strongest_joint_is_said_to_reach_its_share_of_the_load(load: str) -> None:
    printed = run("joint", "-V", load).output
    words = printed.partition("the strongest reaches ")[2]
    strongest = max(float(most) for most in re.findall(r"at most ([\d.]+) N", printed))
    assert float(words.split()[0]) == pytest.approx(100 * strongest / float(load), rel=0.02)
    assert "e-" not in words.split("%")[0]


def test_values_and_prices_are_read() -> None:
    found = values_of(["a=0.04:0.06:0.01", "locks=3:5"])
    assert found == {"a": (0.04, 0.05, 0.06), "locks": (3, 4, 5)}
    assert prices_of(["volume=2e4", "area=100"]) == Prices(100.0, 2e4, 0.0)
    assert prices_of([]) == Prices()


def test_the_chart_shows_each_joint_once_by_what_it_does(tmp_path: Path) -> None:
    values = values_of(["locks=2:6", "a=0.06:0.76:0.35"])
    found, tried = sought(JOINT, Demand(300.0), values, Prices(), Push.PLUS_Y, every=True)
    (axes,) = chart(found, tried, values).axes
    shown = {each.get_label(): len(each.get_offsets()) for each in axes.collections}
    meets = sum(each.meets for each in tried)
    refused = sum(each.load is None for each in tried)
    weak = len(tried) - meets - refused
    assert shown == {"strong enough": meets, "too weak": weak, "refused": refused, "cheapest": 1}
    picture = tmp_path / "joints.svg"
    assert run("joint", "-V", "300", "-H", "0.06", "--picture", str(picture)).exit_code == 0
    assert "fewest locks" in picture.read_text() or picture.stat().st_size > 1000
