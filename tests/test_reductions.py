"""Reductions: how much of each lock counts."""

import math

import pytest

from sidmacib.contact_points import REDUCTIONS, active, half_rule
from sidmacib.joint import Joint, OwnLock, Side

WEIGHTS = (0.6, 1.0, 0.67, 0.68, 0.01)


@pytest.mark.parametrize(
    ("reduction", "strength"),
    [
        ("none", (1, 1, 1, 1, 1)),
        ("floor_of_sum", (0, 1, 0, 1, 0)),  # 2.96, rounded down
        ("half", (0, 1, 0, 1, 0)),
        ("lower_sum", (0, 1.0, 0, 0.68, 0)),
        ("per_lock", WEIGHTS),
    ],
)
def test_reductions_of_five_locks(reduction: str, strength: tuple[float, ...]) -> None:
    assert REDUCTIONS[reduction](Joint(5), WEIGHTS) == pytest.approx(strength)


def test_upper_locks_count_only_when_all_lower_ones_do() -> None:
    assert active(Joint(5), 3) == (1, 1, 0, 1, 0)


def test_half_of_an_even_number_is_refused() -> None:
    with pytest.raises(ValueError, match=r"^locks: 4 is not allowed .*; it must be odd$"):
        half_rule(Joint(4), ())


@pytest.mark.parametrize("rule", ["half", "floor_of_sum"])
def test_rules_that_count_locks_refuse_locks_that_differ_in_strength(rule: str) -> None:
    wide = Joint(3, different={2: OwnLock(width=0.06)})
    message = r"^different: a strength from 240 to 288 N is not allowed with .* the same for all$"
    with pytest.raises(ValueError, match=message):
        REDUCTIONS[rule](wide, (1.0, 1.0, 1.0))
    heavy = Joint(3, different={2: OwnLock(density=2000.0)})
    assert sum(REDUCTIONS[rule](heavy, (0.5, 0.5, 0.0))) == 1.0


def test_from_the_lower_block_on_lower_locks_count_first_too() -> None:
    joint = Joint(3, first=Side.LOWER)
    assert half_rule(joint, ()) == (1.0, 0.0, 0.0)
    assert REDUCTIONS["lower_sum"](joint, (0.1, 1.0, 0.9)) == (0.1, 0.0, 0.9)


@pytest.mark.parametrize("sum_", [0.0, 0.999, 1.0, 2.5, 5.0, 9.0])
def test_the_sum_of_weights_counts_rounded_down_and_at_most_all_locks(sum_: float) -> None:
    strength = REDUCTIONS["floor_of_sum"](Joint(5), (sum_ / 5,) * 5)
    assert sum(strength) == min(math.floor(sum_ + 1e-12), 5)
