"""Asking what a structure carries: both models, what they answer, and the verdict."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from sidmacib.answers.answer import NO_DILATION, Answer
from sidmacib.answers.said import Static, of_limit, of_static
from sidmacib.answers.structure import Limit, static_answer
from sidmacib.answers.verdict import Verdict, governing, lower_first, verdict
from sidmacib.errors import CapacityError, NoEquilibriumError, reason
from sidmacib.mechanics.limit import LimitState
from sidmacib.mechanics.sliding import sliding_limit
from sidmacib.problem import Problem
from sidmacib.quantities import four_digits
from sidmacib.structure.analysis.limit import limit_or_tilt
from sidmacib.structure.files.structure_file import Demand, demands_of, description_in
from sidmacib.structure.loads import SupportMotion, free_weight, naming_permanent
from sidmacib.structure.partial_factors import NO_FACTORS, PartialFactors

Tell = Callable[[str], object]


def limit_of(problem: Problem, tell: Tell = str) -> Limit:
    """What limit analysis with friction finds, or why it has no answer."""
    assembly = problem.assembly
    free, faces = sum(not piece.fixed for piece in assembly.pieces), len(assembly.faces)
    tell(f"{free:,} free blocks, {faces:,} contact faces: limit analysis ...")
    try:
        found = limit_or_tilt(problem)
    except CapacityError as error:
        return error
    if isinstance(found, LimitState):
        share = found.load / free_weight(assembly)
        tell(f"limit: {four_digits(found.load)} N, {share:.4g} of the weight")
    return found


def static_of(problem: Problem, limit: Limit | None, tell: Tell = str) -> Static:
    """The answer of the static model, or why it has none; ``limit``: by `limit_of`, if known."""
    tell("static model ...")
    try:
        return static_answer(problem, limit)
    except CapacityError as error:
        tell(f"static: no answer: {reason(error)}")
        return error


@dataclass(frozen=True, eq=False, repr=False)
class Solved:
    """What limit analysis and the static model answer for a ``demand``."""

    demand: Demand
    limit: Limit
    static: Static

    def __repr__(self) -> str:
        """The verdict, or else both answers, in a line: what a notebook shows."""
        if self.verdict is not None:
            return f"<{self.verdict}>"
        told = self.demand.problem.loads.raised.told
        both = (
            f"{each.model}: {each.note if each.value is None else told(each.value)}"
            for each in (self.of_limit, self.of_static)
        )
        return f"<{'; '.join(both)}>"

    @classmethod
    def of(cls, demand: Demand, tell: Tell = str) -> "Solved":
        """By `limit_of` and `static_of`."""
        limit = limit_of(demand.problem, tell)
        return cls(demand, limit, static_of(demand.problem, limit, tell))

    @cached_property
    def of_limit(self) -> Answer:
        """The answer of limit analysis with associated friction."""
        return of_limit(self.demand.problem, self.limit)

    @cached_property
    def of_static(self) -> Answer:
        """The answer of the static model."""
        return of_static(self.static)

    @cached_property
    def without_dilation(self) -> Answer | None:
        """The answer of limit analysis with sliding that opens no joint.

        None where gravity turns, and where limit analysis has no answer.
        """
        if not isinstance(self.limit, LimitState):
            return None
        problem = self.demand.problem
        try:
            with naming_permanent(problem.loads):
                found = sliding_limit(*problem, self.limit)
        except CapacityError as failure:
            return Answer(model=NO_DILATION, error=failure)
        notes = ("sliding does not open the joints",)
        return Answer(model=NO_DILATION, value=found.state.load, notes=notes)

    @property
    def answers(self) -> tuple[Answer, ...]:
        """Every answer; limit analysis says so where the structure falls in the static model."""
        limits = [each for each in (self.of_limit, self.without_dilation) if each]
        if isinstance(self.static, NoEquilibriumError):
            falls = f"static model: {lower_first(str(self.static))}"
            limits = [replace(each, notes=(*each.notes, falls)) for each in limits]
        return *limits, self.of_static

    @cached_property
    def verdict(self) -> Verdict | None:
        """On the load that is to be carried; None unless the demand says how much that is."""
        if self.demand.newtons is None:
            return None
        found = verdict(self.demand.newtons, self.of_static, self.of_limit)
        if not (factors := self.demand.factors):
            return found
        return replace(found, note="; ".join(filter(None, (found.note, f"with {factors}"))))


def ask(
    structure: str | Path | Mapping[str, Any],
    folder: Path = Path(),
    factors: PartialFactors = NO_FACTORS,
) -> dict[str, Solved]:
    """What a structure carries: the answers to each of its load cases, the one that governs first.

    ``structure``: its file, or what would stand in it; ``folder``: that paths of meshes start from,
    by default that of the file. The case of a file with one load is ``load``. ``factors``: partial
    ones. ValueError, in one line, for what is at fault; also for a structure without a load or with
    a support that moves.
    """
    description: Any = structure
    if isinstance(structure, str | Path):
        folder, description = Path(structure).parent, description_in(Path(structure))
    demands = demands_of(description, folder, factors=factors)
    if not demands[0].raises or isinstance(demands[0].problem.loads, SupportMotion):
        raise ValueError(
            "load: nothing is raised; multilock assembly answers without a load and for supports"
        )
    found = {demand.case or "load": Solved.of(demand) for demand in demands}
    verdicts = [each.verdict for each in found.values()]
    told = [each for each in verdicts if each is not None]
    if len(told) < len(found):
        return found
    first = [*found][governing(told)]
    return {first: found[first], **found}
