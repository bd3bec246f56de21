"""The search for joints whose safe load is above what they carry, in small."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sidmacib.rule import SPANS, spans_of
from studies.attack import search as attack
from studies.attack.search import (
    DIMENSIONS,
    MORE,
    MORE_LOCKS,
    SPACES,
    Space,
    Target,
    ratio_at,
    row_of,
    search,
    target_at,
    with_more_locks,
)

RIGID = [space for space in SPACES if not space.elastic]
ELASTIC = next(space for space in SPACES if space.elastic)
PLACE = st.lists(st.floats(0.0, 1.0), min_size=DIMENSIONS, max_size=DIMENSIONS)


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Generations of a sixth of the size: the first one fills the space."""
    monkeypatch.setattr(attack, "POPULATION", 1)


@given(place=PLACE, space=st.sampled_from(SPACES))
def test_every_place_is_a_joint_inside_the_spans(place: list[float], space: Space) -> None:
    for name, value in spans_of(target_at(space, place).joint).items():
        if "Kd h" in name:  # it follows from others: the rule refuses what is beyond
            continue
        low, high = SPANS[name]
        assert low * (1.0 - 1e-9) <= value <= high * (1.0 + 1e-9), name


@pytest.mark.parametrize("end", [0.0, 1.0])
def test_the_ends_of_every_span_are_reached(end: float) -> None:
    found: dict[str, set[float]] = {}
    for space in SPACES:
        for name, value in spans_of(target_at(space, [end] * DIMENSIONS).joint).items():
            found.setdefault(name, set()).add(value)
    for name, span in SPANS.items():
        bound = span[0] if end == 0.0 else span[1]
        sampled = name.startswith("locks of") or "Kd h" in name or math.isinf(bound)
        assert sampled or any(value == pytest.approx(bound, abs=1e-3) for value in found[name])


@settings(max_examples=20, deadline=None)
@given(place=PLACE, space=st.sampled_from(RIGID))
def test_the_safe_load_is_below_the_first_failure(place: list[float], space: Space) -> None:
    found = ratio_at(space, place)
    assert found is not None and found <= 1.0


@pytest.mark.study
@pytest.mark.usefixtures("small")
@pytest.mark.parametrize("space", RIGID[1:3], ids=lambda space: space.name)
def test_a_short_attack_finds_no_unsafe_joint(space: Space) -> None:
    worst = search(space, seed=1, evaluations=40)
    assert worst.evaluations >= 40
    assert worst.answered > 0.2 * worst.evaluations
    assert worst.unsolved == 0
    assert 0.85 < worst.ratio <= 1.0


def test_the_worst_joint_is_solved_with_more_locks(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple[int, float]] = []

    def ratio(target: Target) -> float:
        asked.append((target.joint.locks, target.joint.a))
        return 1.0 / target.joint.locks

    monkeypatch.setattr(attack, "ratio_of", ratio)
    target = target_at(ELASTIC, [0.5] * DIMENSIONS)
    assert with_more_locks(target) == {MORE.format(n): 1.0 / n for n in MORE_LOCKS}
    assert asked == [(n, target.joint.a) for n in MORE_LOCKS]


@pytest.mark.study
@pytest.mark.usefixtures("small")
def test_an_attack_finds_a_rule_that_is_not_safe(monkeypatch: pytest.MonkeyPatch) -> None:
    honest = attack.safe_load
    monkeypatch.setattr(attack, "safe_load", lambda target: 1.2 * (honest(target) or 0.0) or None)
    worst = search(RIGID[1], seed=1, evaluations=1)
    assert worst.ratio > 1.0
    row = row_of(worst)
    assert row["safe_over_first_failure"] == worst.ratio
    assert float(str(row["safe_over_peak_1"])) > 1.0
