"""Short parts of two campaigns: `make faults` and `make fuzz` run them in full."""

from collections.abc import Callable, Iterator

import pytest
from campaigns import faults, fuzz


@pytest.fixture(scope="module")
def campaign() -> Iterator[faults.Campaign]:
    with faults.begun(seed=7) as begun:
        begun.kills = 2
        yield begun


@pytest.mark.engine
@pytest.mark.parametrize("fault", [faults.deleted, faults.killed], ids=lambda fault: fault.__name__)
def test_whatever_happens_the_next_run_ends_as_if_nothing_had(
    campaign: faults.Campaign, fault: Callable[[faults.Campaign], None]
) -> None:
    faults.held(campaign, fault)


def test_whatever_comes_in_is_an_answer_or_a_clear_no() -> None:
    with fuzz.begun(seed=11) as begun:
        fuzz.tried(begun, 600)
    assert min(begun.accepted.values()) > 0 < min(begun.refused.values())
    assert begun.accepted.keys() == begun.refused.keys()
