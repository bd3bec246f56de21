"""Whether a structure carries a load, and by what factor.

The lower decides of the load that counts in the static model and of limit analysis of dry blocks,
which may overestimate: where the static model has no answer, it can say no, but not yes. Of blocks
that are bonded it is no bound, neither above nor below: there the static model decides. A load
within the mesh error of what is carried is left open. Only where contact points stand for locks
limit analysis decides alone. Both models may be asked here, or have been asked by a study.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from sidmacib.answers.answer import Answer
from sidmacib.answers.structure_paths import CRUSHING, LOWER, bond_fails
from sidmacib.errors import (
    InfeasibleError,
    NoEquilibriumError,
    NoStiffnessError,
    UnboundedError,
)
from sidmacib.mechanics.solution import Mode
from sidmacib.quantities import digits, four_digits

BY_LIMIT = "limit analysis"
MOST_CASES = 3  # that are named
FOLLOWED_UNTIL: dict[str | None, str] = {  # where a path ends at which nothing has failed, by mode
    Mode.PRESSED: "joints are pressed in by a tenth of the blocks",
    Mode.TURNED: "a block has turned by 0.05 rad",
}


@dataclass(frozen=True)
class Verdict:
    """What is carried over the ``newtons`` (N) that are to be carried, and what follows.

    ``factor``: of the load that decides; ``first``, ``peak``: of the first failure and the peak in
    the static model; ``limit``: of limit analysis; None where there is no answer, or no limit.
    ``words``: without yes or no; ``note``: what the factors rest on; ``decides``: the model and
    the load that does, if one does. ``open``: neither yes nor no, so that it does not pass.
    """

    newtons: float
    passes: bool
    words: str
    note: str = ""
    decides: str = ""
    open: bool = False
    factor: float | None = None
    first: float | None = None
    peak: float | None = None
    limit: float | None = None

    def __str__(self) -> str:
        return f"{self.said}: {self.reasons}"

    @property
    def told(self) -> dict[str, Any]:
        """What a file says of it, by name."""
        return {
            "verdict": self.said.lower(),
            "carried": self.passes,
            "decides": self.decides or None,
            "deciding factor": self.factor,
            "answer": str(self),
        }

    @property
    def said(self) -> str:
        """Yes, no or open."""
        return "Open" if self.open else "Yes" if self.passes else "No"

    @property
    def reasons(self) -> str:
        """The words and the note."""
        return "; ".join(filter(None, (self.words, self.note)))


def verdict(newtons: float, static: Answer, limit: Answer) -> Verdict:
    """The verdict on a load of ``newtons``, by the answers of both models."""
    most = None if limit.value is None else limit.value / newtons
    if static.value is not None:
        found = _by_static(newtons, static, most)
        assert found.factor is not None
        if most is None or not limit.bounds or most >= found.factor * (1.0 - LOWER):
            return found
        of_static = factor_of(static.value / newtons)
        note = f"limit analysis decides, as it is lower: the static model has {of_static}"
        by_limit = _by_limit(newtons, most, note)
        return replace(by_limit, first=found.first, peak=found.peak)
    for error in (static.error, limit.error):
        if isinstance(error, NoEquilibriumError | InfeasibleError):
            return Verdict(newtons, False, lower_first(str(error)), limit=most)
    return _without_static(newtons, static, limit, most)


def _without_static(newtons: float, static: Answer, limit: Answer, most: float | None) -> Verdict:
    """The verdict by limit analysis, whose factor is ``most``, if it has one."""
    if isinstance(static.error, NoStiffnessError | UnboundedError):
        if isinstance(limit.error, UnboundedError):
            words = f"it carries {four_digits(newtons)} N and any multiple of it"
            return Verdict(newtons, True, words, "neither bending nor splitting is considered")
        if most is not None and (limit.bounds or isinstance(static.error, NoStiffnessError)):
            return _by_limit(newtons, most, str(static.error))
    without = f"the static model has no answer: {static.error}"
    if most is not None and most < 1.0 and limit.bounds:
        return _by_limit(newtons, most, f"limit analysis; {without}")
    words = f"nothing shows that it carries {four_digits(newtons)} N"
    told = str(limit.error)
    if most is not None:
        rests = "may overestimate" if limit.bounds else "is no bound"
        told = f"limit analysis: {factor_of(most)}; it {rests}"
    note = f"{without}; {told}"
    return Verdict(newtons, False, words, note, open=True, limit=most)


def _by_limit(newtons: float, most: float, note: str) -> Verdict:
    words = by_factors(f"{four_digits(newtons)} N", most, f"{factor_of(most)} to the limit")
    return Verdict(newtons, most >= 1.0, words, note, BY_LIMIT, factor=most, limit=most)


def _by_static(newtons: float, static: Answer, most: float | None) -> Verdict:
    assert static.value is not None
    assert static.failures is not None
    assert static.counts is not None
    first, peak = static.failures.first / newtons, static.failures.peak / newtons
    factor, error = static.value / newtons, static.mesh_error or 0.0
    factors, notes = factor_of(peak), []
    if bond_fails(static.failures):
        factors = f"{factor_of(first)} to the first failure, {factor_of(peak)} to the peak"
    if bond_fails(static.failures) or static.mode == CRUSHING:
        notes.append(str(static.counts))
    if static.mode in FOLLOWED_UNTIL:
        notes.append(f"followed until {FOLLOWED_UNTIL[static.mode]}")
    left_open = factor * (1.0 - error) < 1.0 <= factor
    words = by_factors(f"{four_digits(newtons)} N", factor, factors)
    if left_open:
        within = f"it may carry {four_digits(newtons)} N, within the mesh error"
        words = f"{within} of {100.0 * error:.2g} %: its factor is {factors}"
    return Verdict(
        newtons,
        factor >= 1.0 and not left_open,
        words,
        "; ".join(notes),
        f"static model, {static.counts.name}",
        left_open,
        *(factor, first, peak, most),
    )


def factor_of(value: float) -> str:
    """Three digits of a factor, or as many as tell it from 1."""
    shown = (digits(value, count) for count in range(3, 7))
    return next((each for each in shown if each != "1"), "1")


def by_factors(load: str, factor: float, factors: str) -> str:
    """Whether a ``load`` in words is carried, by its ``factor``; ``factors``: that, or all."""
    if factor >= 1.0:
        return f"it carries {load} with a factor of {factors}"
    return f"it does not carry {load}: its factor is {factors}"


def on_all(names: Sequence[str], verdicts: Sequence[Verdict]) -> Verdict:
    """The verdict on several load cases, with the numbers of the one that governs.

    ``names``: of the cases.
    """
    lost = [name for name, each in zip(names, verdicts, strict=True) if not each.passes]
    left_open = bool(lost) and all(each.open for each in verdicts if not each.passes)
    first = governing(verdicts)
    if len(names) == 1:
        return replace(verdicts[0], words=f"{names[0]}; {verdicts[0].words}")
    carried = f"all {len(names)} cases"
    if lost:
        ends = "left open" if left_open else "not carried"
        which = ", ".join(lost) if len(lost) <= MOST_CASES else f"{len(lost)} of {len(names)} cases"
        carried = f"{which} {'is' if len(lost) == 1 else 'are'} {ends}"
    words = f"{carried}; {names[first]} governs: {verdicts[first].words}"
    return replace(verdicts[first], passes=not lost, open=left_open, words=words)


def governing(verdicts: Sequence[Verdict]) -> int:
    """The index of the verdict that governs: one without an answer, else the lowest factor."""

    def key(number: int) -> tuple[bool, float]:
        passes, factor = verdicts[number].passes, verdicts[number].factor
        return passes, (math.inf if passes else -1.0) if factor is None else factor

    return min(range(len(verdicts)), key=key)


def lower_first(words: str) -> str:
    """``words`` that go on in a sentence."""
    return words[:1].lower() + words[1:]
