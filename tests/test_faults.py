"""A short part of the campaign of faults; `make faults` has the rest."""

from collections.abc import Callable, Iterator

import faults
import pytest

pytestmark = pytest.mark.engine


@pytest.fixture(scope="module")
def campaign() -> Iterator[faults.Campaign]:
    with faults.begun(seed=7) as begun:
        yield begun


@pytest.mark.parametrize("fault", [faults.garbled, faults.killed], ids=lambda own: own.__name__)
def test_whatever_happens_the_next_run_ends_as_if_nothing_had(
    campaign: faults.Campaign, fault: Callable[[faults.Campaign], None]
) -> None:
    faults.held(campaign, fault)
