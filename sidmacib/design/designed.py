"""A design from a task: rows that carry all cases, can be built, and pass the checks.

Directions and numbers are searched so that the design's model carries what is demanded. Layouts
that cannot be built are barred, and the search goes on. Where a case fails a check, more of it is
demanded in proportion and all is done again: the design's model promises too much, as its locks
share their load evenly and its friction is associated. Where the design's model cannot carry that
whatever its locks, as friction or weight decides in it, each row gets one lock more.

Checks are by models that had no part in the design, on locks that are cut out of the blocks. Limit
analysis of the locks as pieces has their height, their sides and their roots in tension; without
dilation sliding does not open joints; the static model follows elastic joints with brittle roots
and the history of friction.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

from sidmacib.answers.structure import static_answer
from sidmacib.answers.structure_paths import bond_fails
from sidmacib.design import Choice, Layout
from sidmacib.design.blocking import conflict, order_of
from sidmacib.design.direction import Directions, FoundRows, RowSearch, choice_of
from sidmacib.design.file import DesignSection, Task, designed, load_cases
from sidmacib.design.model import DesignProblem, LoadCase
from sidmacib.design.sizing import carried, largest_factor, needed
from sidmacib.errors import CapacityError, InfeasibleError, SolverError, UnboundedError
from sidmacib.mechanics.assembly import Assembly, Floats
from sidmacib.mechanics.sliding import sliding_limit
from sidmacib.mechanics.static import static_peak
from sidmacib.problem import Problem
from sidmacib.structure.analysis.limit import limit_state
from sidmacib.structure.files.structure_file import assembly_of
from sidmacib.structure.loads import naming_permanent
from sidmacib.structure.placing import Order
from sidmacib.structure.structure import refined

DESIGN, LIMIT, SLIDING = "design", "limit", "limit, no dilation"
FIRST, PEAK = "static, first failure", "static, peak"
CLOSE = 1e-6  # over the factor: what a check may lack, for rounding
LEAST_RISE, MOST_RISE = 1.1, 3.0  # of the demand on a case that fails a check, in one round
MOST_DEMAND = 50.0  # over what is asked
MOST_BARRED = 50  # layouts that cannot be built


@dataclass(frozen=True)
class Check:
    """Share of a case that a model carries.

    ``factor``: load over that of the case; infinite if it can grow without limit, None without an
    answer. ``decides``: whether the design stands or falls by it.
    """

    case: str
    model: str
    factor: float | None
    note: str
    decides: bool

    def passes(self, factor: float) -> bool:
        """Whether it does not speak against the design."""
        enough = self.factor is not None and self.factor >= factor * (1.0 - CLOSE)
        return enough or not self.decides


def checks_of(
    task: Task, choice: Choice, factors: Floats, note: Callable[[str], None] = lambda _: None
) -> tuple[Check, ...]:
    """Loads of all cases by the design's model and the others, with the rows of ``choice``.

    ``factors``: by the design's model.
    """
    found = [
        Check(case.name, DESIGN, factor, "condensed locks, associated friction", True)
        for case, factor in zip(task.structure.cases, factors.tolist(), strict=True)
    ]
    assembly = assembly_of(designed(task, choice), folder=task.folder)
    for case in load_cases(assembly, task.asked, task.description):
        note(f"checking {case.name} on {len(assembly.pieces)} pieces")
        found += [
            Check(case.name, model, load and load / case.load, words, decides)
            for model, load, words, decides in _of_case(assembly, case, task.asked)
        ]
    return tuple(found)


def _of_case(
    assembly: Assembly, case: LoadCase, asked: DesignSection
) -> Iterator[tuple[str, float | None, str, bool]]:
    """Model, load (N), note, whether it decides."""
    loads, words = case.loads, "locks modelled as solids; ductile bonds"
    yield LIMIT, *_answer(lambda: limit_state(assembly, loads).load, words), True
    if asked.no_dilation:
        # Its rounds need not settle: without an answer it counts neither way.
        words = "non-dilatant sliding"
        load, words = _answer(lambda: sliding_limit(assembly, loads).state.load, words)
        yield SLIDING, load, words, load is not None
    try:
        with naming_permanent(loads):
            problem, needed = Problem(assembly, loads), case.load * asked.factor
            yield from tuple(_static(problem, asked.first_failure, needed))
    except CapacityError as error:
        yield FIRST, *_without(error), asked.first_failure
        yield PEAK, *_without(error), not asked.first_failure


def _static(
    problem: Problem, first_failure: bool, needed: float
) -> Iterator[tuple[str, float, str, bool]]:
    """Model, load (N), note, whether it decides: of the first failure and of the peak.

    That decides which counts, see `static_answer`, or the ``first_failure`` where that is asked
    for. Both are less their mesh errors. Where already the peak on cells as large as the file's is
    below what is ``needed`` (N), there are no other meshes.
    """
    coarse = static_peak(refined(problem.assembly, 1), problem.loads)
    if coarse.peak.load < needed:
        ends = f"failure mode: {coarse.mode}"
        yield FIRST, coarse.first_failure_load, "first bond failure, else the peak", first_failure
        yield PEAK, coarse.peak.load, ends, not first_failure
        return
    answer = static_answer(problem)
    first, peak = (
        load * (1.0 - (error or 0.0))
        for load, error in zip(answer.failures, answer.mesh_errors, strict=True)
    )
    decides = first_failure or not answer.counts.peak
    about = [f"less its mesh error of {error or 0.0:.2g}" for error in answer.mesh_errors]
    if not bond_fails(answer.failures):
        first = peak = min(first, peak)
    elif peak < first:  # it never is, whatever the estimates of their errors
        peak, about[1] = first, "less its mesh error, below the first failure, which counts"
    ends = f"{about[1]}; {answer.counts}; failure mode: {answer.mode}"
    yield FIRST, first, f"{about[0]}; first bond failure, else the peak", decides
    yield PEAK, peak, ends, not decides


def _answer(model: Callable[[], float], words: str) -> tuple[float | None, str]:
    try:
        return model(), words
    except CapacityError as error:
        return _without(error)


def _without(error: CapacityError) -> tuple[float | None, str]:
    """The load of a model without an answer, infinite where it has no limit, and why."""
    return math.inf if isinstance(error, UnboundedError) else None, " ".join(str(error).split())


@dataclass(frozen=True, eq=False)
class Design:
    """A design of a task.

    ``choice``: a row or None for each site. ``mixed``: the search with mixed rows, whose bound
    holds for any rows in any direction that carry the cases with the whole strength of locks and
    can be built; ``whole``: with whole rows. ``demand``: what was demanded at last of each case
    over what is asked, by its name. ``by_strength``: see `carried`; ``needed``: the forces that the
    design's model needs of the locks at the factor, see `needed`.
    """

    task: Task
    choice: tuple[Layout | None, ...]
    cost: float
    bound: float
    mixed: FoundRows
    whole: FoundRows
    demand: Mapping[str, float]
    by_strength: Floats
    needed: Floats
    order: Order
    checks: tuple[Check, ...]

    @property
    def failing(self) -> tuple[Check, ...]:
        """The checks that speak against the design."""
        return tuple(check for check in self.checks if not check.passes(self.task.asked.factor))

    @property
    def passes(self) -> bool:
        """Whether all checks pass and all blocks can be placed."""
        return not self.failing and not (self.task.asked.buildable and self.order.stuck)


def design_of(task: Task, note: Callable[[str], None] = lambda _: None) -> Design:
    """The cheapest rows found that carry all cases of a ``task``, in every model.

    If some check still fails in the end, that which came closest. `InfeasibleError` if no locks
    that there is room for carry the cases in the design's model, or can be built.
    """
    best: Design | None = None
    last: Design | None = None
    demand = dict.fromkeys(task.loads, 1.0)
    for raised in range(task.asked.raised + 1):
        try:
            found = _once(task, demand, last, note)
        except InfeasibleError as error:
            if best is None or last is None:
                raise
            note(f"no locks do where {_words(demand)}: {error}")
            stronger = _stronger(task.structure, last.choice)
            if stronger is None:
                break
            note("each row gets the next stronger one")
            searched = last.mixed, last.whole, last.bound
            found = _checked(task, stronger, searched, last.demand, last, note)
        except SolverError as error:  # of this demand; the next one may be solved
            if best is None and raised == task.asked.raised:
                raise
            note(f"no answer where {_words(demand)}: {error}")
            demand = {case: LEAST_RISE * each for case, each in demand.items()}
            continue
        last = found
        if best is None or _worst(found) > _worst(best):
            best = found
        if best.passes or not found.failing or not found.cost:  # which no strength changes
            break
        demand = _raised(found)
        if max(demand.values()) > MOST_DEMAND:
            break
        note(f"{_reason(found)}; now {_words(demand)}")
    if best is None:
        raise SolverError(f"design: no answer in {task.asked.raised + 1} rounds")
    return best


def _raised(design: Design) -> dict[str, float]:
    """The next demand: more of each case that fails a check."""
    demand = dict(design.demand)
    for case in {check.case for check in design.failing}:
        factors = [check.factor or 0.0 for check in design.failing if check.case == case]
        missing = design.task.asked.factor / max(min(factors), design.task.asked.factor / MOST_RISE)
        demand[case] *= max(LEAST_RISE, missing)
    return demand


def _stronger(structure: DesignProblem, choice: Choice) -> tuple[Layout | None, ...] | None:
    """The next stronger row in place of each row, along the same direction; None if none is."""
    found = list(choice)
    for number, (site, row) in enumerate(zip(structure.sites, choice, strict=True)):
        if row is not None:
            along = [each for each in site.layouts if each.direction == row.direction]
            stronger = [each for each in along if each.strength > row.strength]
            found[number] = min(stronger, key=lambda each: each.strength, default=row)
    return None if found == list(choice) else tuple(found)


def _checked(
    task: Task,
    choice: tuple[Layout | None, ...],
    searched: tuple[FoundRows, FoundRows, float],
    demand: Mapping[str, float],
    last: Design | None,
    note: Callable[[str], None],
) -> Design:
    """The design with the rows of ``choice``; ``searched``: for mixed and whole rows, the bound."""
    structure, (mixed, whole, bound) = task.structure, searched
    factors, by_strength = carried(structure, choice)
    if last is not None and last.choice == choice:
        checks = last.checks
    else:
        checks = checks_of(task, choice, factors, note)
    return Design(
        task,
        choice,
        float(structure.costs @ structure.chosen(choice)),
        bound,
        mixed,
        whole,
        dict(demand),
        by_strength,
        needed(structure, choice, task.asked.factor),
        order_of(structure.assembly, structure.sites, choice),
        checks,
    )


def _reason(design: Design) -> str:
    """The check that fails by most, in words."""
    worst = min(design.failing, key=lambda check: check.factor or 0.0)
    found = "has no answer" if worst.factor is None else f"carries {worst.factor:.4g} times"
    return f"{worst.model} {found} {worst.case}"


def _words(demand: Mapping[str, float]) -> str:
    return "demanded are " + ", ".join(f"{each:.3g} times {case}" for case, each in demand.items())


def _worst(design: Design) -> float:
    """The least factor of checks that decide; 0 if one that must has no answer."""
    failing = [0.0 for check in design.failing if check.factor is None]
    known = [check.factor for check in design.checks if check.decides and check.factor is not None]
    return min([*failing, *known])


def _once(
    task: Task,
    demand: Mapping[str, float],
    last: Design | None,
    note: Callable[[str], None],
) -> Design:
    """A design for a ``demand`` on each case; ``last``: of the round before."""
    cases = [replace(case, load=case.load * demand[case.name]) for case in task.structure.cases]
    structure = replace(task.structure, cases=tuple(cases))
    try:
        search = RowSearch(structure, task.asked.factor)
    except (InfeasibleError, SolverError) as error:
        # Proofs that no strengths do are often inexact; a largest factor says it as well.
        raise _why_not(structure, task.asked.factor) or error from None
    barred: list[Directions] = []
    while True:
        mixed, whole = (
            search.cheapest(
                whole=kind,
                barred=barred,
                gap=task.asked.gap,
                time_limit=task.asked.time_limit,
                note=note,
            )
            for kind in (False, True)
        )
        note(
            f"mixed rows: cost {mixed.cost:.6g}, at least {mixed.bound:.6g}; "
            f"whole rows: {whole.cost:.6g}, at least {whole.bound:.6g}"
        )
        choice = choice_of(structure, whole.parts)
        blocking = None
        if task.asked.buildable:
            blocking = conflict(structure.assembly, structure.sites, choice)
        if not blocking or len(barred) == MOST_BARRED:
            break
        note(f"{len(blocking)} rows of locks leave a block no way to its place: barred")
        barred.append(blocking)
    bound = max(mixed.bound, whole.bound) if last is None else last.bound
    return _checked(task, choice, (mixed, whole, bound), demand, last, note)


def _why_not(structure: DesignProblem, factor: float) -> InfeasibleError | None:
    """Why no locks carry ``factor`` times all cases; None if some do."""
    most = "even with every possible lock"
    alone: dict[str, float] = {}
    for case in structure.cases:
        try:
            alone[case.name] = largest_factor(replace(structure, cases=(case,)))
        except InfeasibleError:
            return InfeasibleError(f"No design found: the structure does not stand {most}")
    worst = min(alone, key=lambda name: alone[name])
    reached, of = alone[worst], f'load case "{worst}" reaches'
    if reached >= factor:
        reached, of = largest_factor(structure), "all load cases together reach"
    if reached >= factor:
        return None
    return InfeasibleError(
        f"No design found: even with every possible lock, {of} a factor of {reached:.4g} (required "
        f"{factor:g}). Allow more locks (most), other directions (angles) or a higher cohesion; if "
        "the factor stays the same, the blocks overturn, which no locks prevent"
    )
