"""`multilock joint`: the fewest locks and the cheapest sizes for V and M."""

import re
from pathlib import Path

import pytest
from command_runner import answers, run

from sidmacib import Demand, Joint, Prices, cheapest, fewest_locks
from sidmacib.command.inverse import chart, prices_of, sought, values_of
from sidmacib.joint.loading import Push

SIZES = ("-a", "0.08", "-H", "0.06")
JOINT = Joint(5, a=0.08, H=0.06)


def test_the_fewest_locks_are_those_of_the_library() -> None:
    rows = answers("joint", "-V", "300", "-e", "0.3", *SIZES)
    found = fewest_locks(JOINT, Demand(300.0, ratio=0.3))
    assert [row["locks"] for row in rows] == [each.joint.locks for each in found.tried]
    assert found.found is not None and rows[-1]["safe V (N)"] == found.found.shear
    assert rows[-1]["note"] == "strong enough"
    assert all(row["note"].startswith("too weak") for row in rows[:-1])


def test_the_cheapest_sizes_are_those_of_the_library() -> None:
    vary = ("--vary", "a=0.06:0.1:0.01", "--vary", "h=0.006,0.008")
    (row,) = answers("joint", "-n", "6", "-V", "300", "-M", "5", *SIZES, *vary)
    values = {"a": (0.06, 0.07, 0.08, 0.09, 0.1), "h": (0.006, 0.008)}
    found = cheapest(Joint(6, H=0.06), Demand(300.0, 5.0), values).found
    assert (row["a (m)"], row["h (m)"]) == (found.joint.a, found.joint.h)
    assert (row["safe V (N)"], row["safe M (N m)"]) == (found.shear, found.torque)


def test_what_no_joint_carries_ends_with_how_far_they_are() -> None:
    found = run("joint", "-V", "3e4")
    assert found.exit_code == 1
    assert "no joint with 2 to 31 locks is strong enough;" in found.output
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
