"""Whether a structure carries a load, and by what factor.

The lower decides of the load that counts in the static model and of limit analysis. Where the
static model has no answer limit analysis decides alone, which may overestimate, and the words say
so. Both models may be asked here, or have been asked by a study.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from sidmacib.answers.structure_paths import CRUSHING, LOWER, StaticAnswer, bond_fails
from sidmacib.errors import CapacityError, InfeasibleError, NoEquilibriumError, UnboundedError
from sidmacib.problem import Counts, Failures
from sidmacib.quantities import four_digits
from sidmacib.structure.analysis.second_order import MATTERS

if TYPE_CHECKING:
    from sidmacib.mechanics.limit import LimitState


@dataclass(frozen=True)
class KeptAnswer:
    """What decides of an answer that a study keeps; the same stands in a `StaticAnswer`.

    ``load``: the one that counts, N; ``counts``: whether that is the peak, and why; ``mesh_error``:
    of that load, over it; ``mode``: how it fails; ``rotation``: change of the load by finite
    rotation, over it.
    """

    load: float
    failures: Failures
    counts: Counts
    mesh_error: float | None
    mode: str | None
    rotation: float | None = None


@dataclass(frozen=True)
class Verdict:
    """What is carried over the ``newtons`` (N) that are to be carried, and what follows.

    ``factor``: of the load that decides; ``first``, ``peak``: of the first failure and the peak in
    the static model; ``limit``: of limit analysis; None where there is no answer, or no limit.
    ``words``: without yes or no; ``note``: what the factors rest on.
    """

    newtons: float
    passes: bool
    words: str
    note: str = ""
    factor: float | None = None
    first: float | None = None
    peak: float | None = None
    limit: float | None = None

    def __str__(self) -> str:
        return f"{'Yes' if self.passes else 'No'}: {self.reasons}"

    @property
    def reasons(self) -> str:
        """The words and the note."""
        return "; ".join(filter(None, (self.words, self.note)))


def verdict(
    newtons: float,
    static: StaticAnswer | KeptAnswer | CapacityError,
    limit: "LimitState | KeptAnswer | CapacityError",
) -> Verdict:
    """The verdict on a load of ``newtons``, by the answers of both models."""
    most = None if isinstance(limit, CapacityError) else limit.load / newtons
    if not isinstance(static, CapacityError):
        found = _by_static(newtons, static, most)
        assert found.factor is not None
        if most is None or most >= found.factor * (1.0 - LOWER):
            return found
        of_static = factor_of(static.load / newtons)
        note = f"limit analysis decides, as it is lower: the static model has {of_static}"
        by_limit = _by_limit(newtons, most, note)
        return replace(by_limit, first=found.first, peak=found.peak)
    for error in (static, limit):
        if isinstance(error, NoEquilibriumError | InfeasibleError):
            return Verdict(newtons, False, lower_first(str(error)), limit=most)
    if isinstance(limit, UnboundedError):
        words = f"it carries {four_digits(newtons)} N and any multiple of it"
        return Verdict(
            newtons, True, words, "neither bending nor splitting of blocks is considered"
        )
    if most is None:
        return Verdict(newtons, False, "no model that decides has an answer", f"{static}; {limit}")
    note = f"limit analysis, which may overestimate; the static model has no answer: {static}"
    return _by_limit(newtons, most, note)


def _by_limit(newtons: float, most: float, note: str) -> Verdict:
    words = by_factors(f"{four_digits(newtons)} N", most, f"{factor_of(most)} to the limit")
    return Verdict(newtons, most >= 1.0, words, note, most, limit=most)


def _by_static(newtons: float, static: StaticAnswer | KeptAnswer, most: float | None) -> Verdict:
    first, peak = static.failures.first / newtons, static.failures.peak / newtons
    factor, error = static.load / newtons, static.mesh_error or 0.0
    factors, notes = factor_of(peak), []
    if bond_fails(static.failures):
        factors = f"{factor_of(first)} to the first failure, {factor_of(peak)} to the peak"
    if (change := static.rotation or 0.0) < -MATTERS:
        factor *= 1.0 + change
        factors = f"{factor_of(factor)} with finite rotation (without it {factors})"
    if bond_fails(static.failures) or static.mode == CRUSHING:
        notes.append(str(static.counts))
    if abs(factor - 1.0) < error * factor:
        notes.append(f"the mesh error of {100.0 * error:.2g} % leaves it open")
    words = by_factors(f"{four_digits(newtons)} N", factor, factors)
    return Verdict(newtons, factor >= 1.0, words, "; ".join(notes), factor, first, peak, most)


def factor_of(value: float) -> str:
    """Three digits of a factor, or as many as tell it from 1."""
    shown = (f"{value:.{digits}g}" for digits in range(3, 7))
    return next((each for each in shown if each != "1"), "1")


def by_factors(load: str, factor: float, factors: str) -> str:
    """Whether a ``load`` in words is carried, by its ``factor``; ``factors``: that, or all."""
    if factor >= 1.0:
        return f"it carries {load} with a factor of {factors}"
    return f"it does not carry {load}: its factor is {factors}"


def on_all(names: Sequence[str], verdicts: Sequence[Verdict]) -> str:
    """The verdict on several load cases in words; ``names``: of the cases."""
    lost = [name for name, each in zip(names, verdicts, strict=True) if not each.passes]
    said, first = "No" if lost else "Yes", governing(verdicts)
    if len(names) == 1:
        return f"{said}: {names[0]}; {verdicts[0].reasons}"
    carried = f"all {len(names)} cases"
    if lost:
        carried = f"{', '.join(lost)} {'is' if len(lost) == 1 else 'are'} not carried"
    return f"{said}: {carried}; {names[first]} governs: {verdicts[first].reasons}"


def governing(verdicts: Sequence[Verdict]) -> int:
    """The index of the verdict that governs: one without an answer, else the lowest factor."""

    def key(number: int) -> tuple[bool, float]:
        passes, factor = verdicts[number].passes, verdicts[number].factor
        return passes, (math.inf if passes else -1.0) if factor is None else factor

    return min(range(len(verdicts)), key=key)


def lower_first(words: str) -> str:
    """``words`` that go on in a sentence."""
    return words[:1].lower() + words[1:]
