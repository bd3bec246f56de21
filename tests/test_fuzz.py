"""A short part of what `make fuzz` tries."""

import fuzz


def test_whatever_comes_in_is_an_answer_or_a_clear_no() -> None:
    with fuzz.begun(seed=11) as begun:
        fuzz.tried(begun, 2000)
    assert min(begun.accepted.values()) > 0 < min(begun.refused.values())
    assert begun.accepted.keys() == begun.refused.keys()
