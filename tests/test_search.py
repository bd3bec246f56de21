"""The engines' searches for a peak, on models whose peaks are known: no engine runs here."""

import math
from collections.abc import Iterable, Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sidmacib.engines.scripts.assembly import GivenSearch, Guide
from sidmacib.engines.scripts.increments import peak_by_increments
from sidmacib.engines.scripts.next_failure import failing, peak_by_failures
from sidmacib.engines.scripts.records import BONDS, MECHANISM, EngineOutcome, NodeForce

FIRST = 12.0  # N, the first increment


def search(tolerance: float = 1e-3, guide: Guide | None = None) -> GivenSearch:
    return GivenSearch(
        time_step_s=1e-6,
        period_steps=20.0,
        ramp_steps=100,
        hold_steps=1000,
        unbalanced_ratio=1e-4,
        collapse_m=1e-3,
        first_increment_N=FIRST,
        tolerance=tolerance,
        last_N=1e6 * FIRST,
        guide=guide,
    )


class Breaking:
    """Bonds that break by themselves, each at its load; after ``needed`` of them it collapses."""

    met = None  # no other piece

    def __init__(
        self,
        strengths: Sequence[float],
        needed: int,
        slides_at: float = math.inf,
        drifts_at: float = math.inf,
        breakable: bool = True,
        unloaded_at: float = math.inf,
    ) -> None:
        self.strengths, self.needed, self.breakable = sorted(strengths), needed, breakable
        self.slides_at, self.drifts_at, self.unloaded_at = slides_at, drifts_at, unloaded_at
        self.count, self.kept, self.permanent, self.load = 0, 0, 0.0, 0.0

    def raised(self, start: float, end: float, permanent: tuple[float, float]) -> EngineOutcome:
        self.permanent, self.load = permanent[1], end
        self.count = max(self.count, sum(strength < end for strength in self.strengths))
        if self.count >= self.needed or end > self.slides_at:
            return EngineOutcome.COLLAPSE
        if end > self.unloaded_at:
            return EngineOutcome.DRIFT
        return EngineOutcome.UNSETTLED if end > self.drifts_at else EngineOutcome.EQUILIBRIUM

    def broken(self) -> int:
        return self.count if self.breakable else 0

    def node_forces(self) -> Sequence[NodeForce]:
        return []

    def keep(self) -> None:
        self.kept = self.count

    def go_back(self) -> None:
        self.count = self.kept


LOAD = st.floats(0.5, 1e5)


@given(LOAD, st.sampled_from([1e-2, 1e-3, 1e-4]))
def test_increments_find_the_load_at_which_a_bond_takes_all_down(
    strength: float, tolerance: float
) -> None:
    peak = peak_by_increments(Breaking([strength], 1), search(tolerance))
    assert peak.load <= strength <= peak.failed_load <= peak.load * (1 + tolerance)
    assert peak.mode == BONDS
    assert peak.first_failure_load == peak.load


GUIDES = st.one_of(st.none(), st.builds(Guide, LOAD, LOAD))


@given(LOAD, st.floats(1.01, 3.0), GUIDES)
def test_increments_find_first_failure_and_peak_whatever_guides_them(
    first: float, ratio: float, guide: Guide | None
) -> None:
    peak = peak_by_increments(Breaking([first, ratio * first], 2), search(guide=guide))
    most = peak.load * (1 + 1e-3) * (1 + 1e-12)  # rounding
    assert peak.load <= ratio * first <= peak.failed_load <= most
    assert peak.first_failure_load == pytest.approx(first, rel=1.1e-3, abs=1.1e-3 * FIRST)
    assert peak.mode == BONDS


def test_a_guide_whose_first_node_fails_at_no_load_does_not_say_where_the_peak_is() -> None:
    peak = peak_by_increments(Breaking([50.0, 100.0], 2), search(guide=Guide(0.0, 100.0)))
    assert peak.first_failure_load == pytest.approx(50.0, rel=1.1e-3)
    assert peak.load == pytest.approx(100.0, rel=1e-3)


def test_the_last_failure_is_tried_from_nearby() -> None:
    """One that was found in a long stride may be due to the stride."""

    class Swinging(Breaking):
        def raised(self, start: float, end: float, permanent: tuple[float, float]) -> EngineOutcome:
            outcome = super().raised(start, end + 0.05 * (end - start), permanent)
            self.load = end
            return outcome

    peak = peak_by_increments(Swinging([100.0], 1), search(guide=Guide(100.0, 100.0)))
    assert 99.8 <= peak.load <= 100.0 <= 1.001 * peak.failed_load


def test_a_bond_that_fails_under_the_permanent_loads_fails_at_no_load() -> None:
    peak = peak_by_increments(Breaking([-1.0, 100.0], 2), search())
    assert peak.load == pytest.approx(100.0, rel=1e-3)
    assert peak.first_failure_load == 0.0


def test_ductile_faces_fail_as_a_mechanism() -> None:
    peak = peak_by_increments(Breaking([70.0], 1, breakable=False), search())
    assert (peak.mode, peak.first_failure_load) == (MECHANISM, None)


@pytest.mark.parametrize(
    ("model", "words"),
    [
        (Breaking([69.4], 1, drifts_at=43.5), r"no peak: at 43\.\d+ N no bond breaks"),
        (Breaking([69.4], 1, unloaded_at=43.5), r"no peak: at 43\.\d+ N .* the load does no work"),
        (Breaking([-1.0], 1), "does not stand under its permanent loads"),
        (Breaking([0.0], 1), "carries no load in this direction"),
        (Breaking([], 1), "grows without a peak"),
    ],
)
def test_what_has_no_peak_says_why(model: Breaking, words: str) -> None:
    with pytest.raises(SystemExit, match=words):
        peak_by_increments(model, search())


# --- from failure to failure ---------------------------------------------------------------------
class Cut:
    """Bonds that share a load by stiffness: equal shares of it, over strengths (N)."""

    met = None

    def __init__(self, strengths: Sequence[float]) -> None:
        self.strengths = strengths
        self.load, self.events = 0.0, [(0.0, tuple(range(len(strengths))))]

    @property
    def bonds(self) -> tuple[int, ...]:
        return self.events[-1][1]

    def _outcome(self) -> EngineOutcome:
        return EngineOutcome.EQUILIBRIUM if self.bonds else EngineOutcome.COLLAPSE

    def raised(self, load: float) -> EngineOutcome:
        self.events.append((load, self.bonds))
        self.load = load
        return self._outcome()

    def cut(self, nodes: Iterable[int]) -> EngineOutcome:
        gone = set(nodes)
        self.events.append((self.load, tuple(b for b in self.bonds if b not in gone)))
        return self._outcome()

    def back(self) -> None:
        self.events.pop()
        self.load = self.events[-1][0]

    def utilisation(self) -> dict[int, float]:
        share = self.load / len(self.bonds)
        return {bond: share / self.strengths[bond] for bond in self.bonds}

    def record(self, load: float, stage: str) -> Sequence[NodeForce]:
        return []


@given(st.lists(st.floats(1.0, 1e4), min_size=1, max_size=6), GUIDES)
def test_failures_find_the_peak_of_bonds_in_parallel_whatever_guides_them(
    strengths: list[float], guide: Guide | None
) -> None:
    # With k bonds left, of which the weakest is s, the load is at most k s.
    ordered = sorted(strengths)
    left = range(len(ordered), 0, -1)
    expected = max(k * s for k, s in zip(left, ordered, strict=True))
    peak = peak_by_failures(Cut(strengths), search(guide=guide))
    assert peak.load == pytest.approx(expected, rel=2e-3)
    assert peak.load < peak.failed_load <= peak.load * 1.0011
    assert peak.first_failure_load == pytest.approx(len(ordered) * ordered[0], rel=1.1e-3)
    assert peak.mode == BONDS


def test_bonds_at_their_strength_fail_together_and_no_others() -> None:
    assert failing({0: 1.0, 1: 0.99995, 2: 0.9998}) == [0, 1]
    # Below strength by the tolerance: the most used one, and what is as good as equal.
    assert failing({0: 0.9995, 1: 0.9994, 2: 0.99}) == [0]
    # Overstressed ones go together.
    assert failing({0: 1.2, 1: 1.05, 2: 0.99}) == [0, 1]
