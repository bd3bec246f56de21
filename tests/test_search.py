"""The engines' searches for a peak, on models whose peaks are known: no engine runs here."""

import math
from collections.abc import Iterable, Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sidmacib.engines.scripts.assembly import GivenSearch, Guide
from sidmacib.engines.scripts.increments import peak_by_increments
from sidmacib.engines.scripts.next_failure import failing, next_load, peak_by_failures
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
        guide=guide,
    )


class Breaking:
    """Bonds that break by themselves, each at its load; after ``needed`` of them it collapses."""

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
        self.attempts = 0

    def raised(self, start: float, end: float, permanent: tuple[float, float]) -> EngineOutcome:
        self.permanent, self.load = permanent[1], end
        self.attempts += 1
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


@given(LOAD, st.floats(1.01, 3.0))
def test_increments_find_the_first_failure_and_the_peak_after_it(
    first: float, ratio: float
) -> None:
    peak = peak_by_increments(Breaking([first, ratio * first], 2), search())
    assert peak.load <= ratio * first <= peak.failed_load
    assert peak.first_failure_load == pytest.approx(first, rel=1.1e-3, abs=1.1e-3 * FIRST)
    assert peak.mode == BONDS


GUIDED = st.builds(Guide, st.one_of(st.none(), LOAD), LOAD)


@given(LOAD, st.floats(1.01, 3.0), GUIDED)
def test_what_increments_find_does_not_depend_on_the_guide(
    first: float, ratio: float, guide: Guide
) -> None:
    peak = peak_by_increments(Breaking([first, ratio * first], 2), search(guide=guide))
    assert peak.load <= ratio * first <= peak.failed_load <= peak.load * (1 + 1e-3)
    assert peak.first_failure_load == pytest.approx(first, rel=1.1e-3, abs=1.1e-3 * FIRST)


@given(LOAD, st.floats(1.01, 3.0), st.floats(0.995, 1.009))
def test_a_guide_that_is_right_saves_most_attempts(first: float, ratio: float, off: float) -> None:
    guided = Breaking([first, ratio * first], 2)
    peak_by_increments(guided, search(guide=Guide(off * first, off * ratio * first)))
    assert guided.attempts <= 30


def test_the_last_failure_is_tried_from_nearby() -> None:
    """One that was found in a long stride may be due to the stride."""

    class Swinging(Breaking):
        def raised(self, start: float, end: float, permanent: tuple[float, float]) -> EngineOutcome:
            outcome = super().raised(start, end + 0.05 * (end - start), permanent)
            self.load = end
            return outcome

    peak = peak_by_increments(Swinging([100.0], 1), search(guide=Guide(100.0, 100.0)))
    assert 99.8 <= peak.load <= 100.0 <= 1.001 * peak.failed_load


def test_with_a_guide_small_parts_of_the_load_are_raised_in_less_time() -> None:
    guided = search(guide=Guide(None, 100.0))
    assert [guided.ramp(rise, 90.0) for rise in (90.0, 50.0, 12.5)] == [100, 100, 50]
    assert guided.ramp(0.1, 90.0) == guided.ramp(0.0, 0.0) == 10
    assert search().ramp(0.1, 90.0) == 100


def test_a_bond_that_fails_under_next_to_no_load_does_not_end_the_search() -> None:
    peak = peak_by_increments(Breaking([1e-7, 100.0], 2), search())
    assert peak.load == pytest.approx(100.0, rel=1e-3)
    assert peak.first_failure_load == pytest.approx(0.0, abs=1e-3 * FIRST)


def test_a_bond_that_fails_under_the_permanent_loads_fails_at_no_load() -> None:
    peak = peak_by_increments(Breaking([-1.0, 100.0], 2), search())
    assert peak.load == pytest.approx(100.0, rel=1e-3)
    assert peak.first_failure_load == 0.0


def test_what_slides_with_all_bonds_whole_is_a_mechanism_without_first_failure() -> None:
    peak = peak_by_increments(Breaking([500.0], 1, slides_at=70.0), search())
    assert peak.load <= 70.0 <= peak.failed_load
    assert (peak.mode, peak.first_failure_load) == (MECHANISM, None)


def test_ductile_faces_fail_as_a_mechanism() -> None:
    peak = peak_by_increments(Breaking([70.0], 1, breakable=False), search())
    assert (peak.mode, peak.first_failure_load) == (MECHANISM, None)


def test_what_neither_breaks_nor_moves_off_is_no_failure() -> None:
    with pytest.raises(SystemExit, match=r"no peak: at 43\.\d+ N no bond breaks"):
        peak_by_increments(Breaking([69.4], 1, drifts_at=43.5), search())


def test_what_drifts_off_where_the_load_does_no_work_is_no_failure() -> None:
    with pytest.raises(SystemExit, match=r"no peak: at 43\.\d+ N .* the load does no work"):
        peak_by_increments(Breaking([69.4], 1, unloaded_at=43.5), search())


def test_what_does_not_stand_alone_or_carries_nothing_or_anything_has_no_peak() -> None:
    with pytest.raises(SystemExit, match="fails under its permanent loads"):
        peak_by_increments(Breaking([-1.0], 1), search())
    with pytest.raises(SystemExit, match="carries no load in this direction"):
        peak_by_increments(Breaking([0.0], 1), search())
    with pytest.raises(SystemExit, match="grows without a peak"):
        peak_by_increments(Breaking([], 1), search())


def test_the_peak_is_expected_as_much_above_the_first_failure_as_the_guide_has_it() -> None:
    assert Guide(100.0, 120.0).peak_after(50.0) == pytest.approx(60.0)
    assert Guide(None, 120.0).first_event_N == 120.0


# --- from failure to failure ---------------------------------------------------------------------
class Cut:
    """Bonds that share a load by stiffness: equal shares of it, over strengths (N).

    ``hurries``: it does not wait for an equilibrium where more bonds must fail.
    """

    def __init__(
        self,
        strengths: Sequence[float],
        slides_at: float = math.inf,
        drifts_at: float = math.inf,
        hurries: bool = False,
    ) -> None:
        self.strengths, self.slides_at, self.drifts_at = strengths, slides_at, drifts_at
        self.hurries = hurries
        self.load, self.events = 0.0, [(0.0, tuple(range(len(strengths))))]
        self.stages: list[str] = []

    @property
    def bonds(self) -> tuple[int, ...]:
        return self.events[-1][1]

    def _outcome(self) -> EngineOutcome:
        if not self.bonds or self.load > self.slides_at:
            return EngineOutcome.COLLAPSE
        return EngineOutcome.UNSETTLED if self.load > self.drifts_at else EngineOutcome.EQUILIBRIUM

    def raised(self, load: float) -> EngineOutcome:
        self.events.append((load, self.bonds))
        self.load = load
        return self._outcome()

    def cut(self, nodes: Iterable[int]) -> EngineOutcome:
        gone = set(nodes)
        self.events.append((self.load, tuple(b for b in self.bonds if b not in gone)))
        outcome = self._outcome()
        more = outcome is EngineOutcome.EQUILIBRIUM and max(self.utilisation().values()) > 1.0
        return EngineOutcome.OVERSTRESSED if self.hurries and more else outcome

    def back(self) -> None:
        self.events.pop()
        self.load = self.events[-1][0]

    def utilisation(self) -> dict[int, float]:
        share = self.load / len(self.bonds)
        return {bond: share / self.strengths[bond] for bond in self.bonds}

    def record(self, load: float, stage: str) -> Sequence[NodeForce]:
        self.stages.append(stage)
        return []


@given(st.lists(st.floats(1.0, 1e4), min_size=1, max_size=6))
def test_failures_find_the_peak_of_bonds_in_parallel(strengths: list[float]) -> None:
    # With k bonds left, of which the weakest is s, the load is at most k s.
    ordered = sorted(strengths)
    left = range(len(ordered), 0, -1)
    expected = max(k * s for k, s in zip(left, ordered, strict=True))
    peak = peak_by_failures(Cut(strengths), search())
    assert peak.load == pytest.approx(expected, rel=2e-3)
    assert peak.load < peak.failed_load <= peak.load * 1.0011
    assert peak.first_failure_load == pytest.approx(len(ordered) * ordered[0], rel=1.1e-3)
    assert peak.mode == BONDS


@given(st.lists(st.floats(1.0, 1e4), min_size=1, max_size=6), GUIDED)
def test_what_failures_find_does_not_depend_on_the_guide(
    strengths: list[float], guide: Guide
) -> None:
    plain = peak_by_failures(Cut(strengths), search())
    guided = peak_by_failures(Cut(strengths), search(guide=guide))
    assert guided.load == pytest.approx(plain.load, rel=2e-3)
    assert guided.first_failure_load == pytest.approx(plain.first_failure_load, rel=2e-3)


@given(st.lists(st.floats(1.0, 1e4), min_size=1, max_size=6))
def test_a_cascade_goes_on_where_nobody_waits_for_its_equilibria(strengths: list[float]) -> None:
    patient = peak_by_failures(Cut(strengths), search())
    assert peak_by_failures(Cut(strengths, hurries=True), search()).load == patient.load


def test_failures_that_do_not_come_are_a_mechanism_or_no_answer() -> None:
    peak = peak_by_failures(Cut([100.0], slides_at=70.0), search())
    assert peak.load <= 70.0 <= peak.failed_load
    assert (peak.mode, peak.first_failure_load) == (MECHANISM, None)
    with pytest.raises(SystemExit, match="no bond breaks"):
        peak_by_failures(Cut([100.0], drifts_at=70.0), search())


def test_every_stage_is_recorded() -> None:
    model = Cut([10.0, 100.0])
    peak_by_failures(model, search())
    assert model.stages[0] == "equilibrium"
    assert model.stages[-1] == "collapse"


@given(
    st.floats(1.0, 1e3),
    st.floats(0.05, 0.9),
    st.floats(0.01, 0.9),
    st.sampled_from([1e-2, 1e-3]),
)
def test_the_next_load_of_a_linear_model_is_never_past_its_failure(
    strength: float, used: float, share: float, tolerance: float
) -> None:
    before = [(share * used * strength, share * used), (used * strength, used)]
    load = next_load(before, increment=10 * strength, tolerance=tolerance)
    assert used * strength < load <= strength * (1 - tolerance / 2) * (1 + 1e-9)


def test_the_next_load_goes_by_the_increment_where_nothing_can_be_predicted() -> None:
    assert next_load([(0.0, 0.0)], 12.0, 1e-3) == 12.0
    assert next_load([(0.0, 0.0), (12.0, math.inf)], 12.0, 1e-3) == 24.0


def test_bonds_at_their_strength_fail_together_and_no_others() -> None:
    assert failing({0: 1.0, 1: 0.99995, 2: 0.9998}) == [0, 1]
    # Below strength by the tolerance: the most used one, and what is as good as equal.
    assert failing({0: 0.9995, 1: 0.9994, 2: 0.99}) == [0]
    # Overstressed ones go together.
    assert failing({0: 1.2, 1: 1.05, 2: 0.99}) == [0, 1]
