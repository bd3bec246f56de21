"""A design from a task: rows that carry all cases, can be built, and pass the checks.

Directions and numbers are searched with the share of the locks' strength that counts. Layouts that
cannot be built are barred, and the search goes on. Where a check fails, the share is lowered in
proportion and all is done again, as locks that share their load unevenly must be stronger.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

from sidmacib.design.blocking import Order, conflict, order_of
from sidmacib.design.checks import Check, checks_of
from sidmacib.design.direction import Directions, Found, Search, choice_of
from sidmacib.design.file import Task, with_share
from sidmacib.design.layouts import Layout
from sidmacib.design.sizing import Carried, Needed, carried, largest_factor, needed
from sidmacib.errors import InfeasibleError, SolverError

LEAST_CUT = 0.9  # of the share, when a check fails by less
LEAST_SHARE = 0.02
MOST_BARRED = 50  # layouts that cannot be built


@dataclass(frozen=True, eq=False)
class Design:
    """A design of a task.

    ``choice``: a row or None for each site. ``mixed``: the search with mixed rows, whose bound
    holds for any rows in any direction that carry the cases with the whole strength of locks and
    can be built; ``whole``: with whole rows. ``share``: of the strength that the design counted on
    at last. ``states``: what the design's model carries; ``needed``: what it needs of
    the locks at the factor. ``raised``: how often strength was raised.
    """

    task: Task
    choice: tuple[Layout | None, ...]
    cost: float
    bound: float
    mixed: Found
    whole: Found
    share: float
    states: tuple[Carried, ...]
    needed: tuple[Needed, ...]
    order: Order
    checks: tuple[Check, ...]
    raised: int

    @property
    def failing(self) -> tuple[Check, ...]:
        """The checks that speak against the design."""
        return tuple(check for check in self.checks if not check.passes(self.task.factor))

    @property
    def passes(self) -> bool:
        """Whether all checks pass and all blocks can be placed."""
        return not self.failing and not (self.task.buildable and self.order.stuck)


def design_of(task: Task, note: Callable[[str], None] = lambda _: None) -> Design:
    """The cheapest rows found that carry all cases of a ``task``, in every model.

    If some check still fails in the end, that which came closest. `InfeasibleError` if no locks
    that there is room for carry the cases in the design's model, or can be built.
    """
    best: Design | None = None
    last: Design | None = None
    share = 1.0
    for raised in range(task.raised + 1):
        try:
            found = _once(with_share(task, share), last, raised, note)
        except InfeasibleError as error:
            if best is None:
                raise
            note(f"no locks do with {share:.3g} of the strength: {error}")
            break
        except SolverError as error:  # of this share; the next one may be solved
            if best is None and raised == task.raised:
                raise
            note(f"no answer with {share:.3g} of the strength: {error}")
            share *= LEAST_CUT
            continue
        last = found
        if best is None or _worst(found) > _worst(best):
            best = found
        if best.passes:
            break
        ratio = _worst(found) / task.factor
        share *= min(LEAST_CUT, max(ratio, 0.3))
        if ratio >= 1.0 or share < LEAST_SHARE or not found.cost:  # which no strength changes
            break
        worst = min(found.failing, key=lambda check: check.factor or 0.0, default=None)
        which = f"{worst.model} of {worst.case}" if worst else "a check"
        note(f"{which} fails at {ratio:.3g} of the factor: counting on {share:.3g} of the strength")
    if best is None:
        raise SolverError(f"design: no answer in {task.raised + 1} rounds")
    return best


def _worst(design: Design) -> float:
    """The least factor of checks that decide; 0 if one that must has no answer."""
    failing = [0.0 for check in design.failing if check.factor is None]
    known = [check.factor for check in design.checks if check.decides and check.factor is not None]
    return min([*failing, *known])


def _once(task: Task, last: Design | None, raised: int, note: Callable[[str], None]) -> Design:
    """A design with the share of the strength that ``task`` has; ``last``: of the round before."""
    structure = task.structure
    try:
        search = Search(structure, task.factor)
    except InfeasibleError:
        raise InfeasibleError(_why_not(task)) from None
    barred: list[Directions] = []
    while True:
        mixed, whole = (
            search.cheapest(
                whole=kind, barred=barred, gap=task.gap, time_limit=task.time_limit, note=note
            )
            for kind in (False, True)
        )
        note(
            f"mixed rows: cost {mixed.cost:.6g}, at least {mixed.bound:.6g}; "
            f"whole rows: {whole.cost:.6g}, at least {whole.bound:.6g}"
        )
        choice = choice_of(structure, whole.parts)
        assembly, sites = structure.assembly, structure.sites
        blocking = conflict(assembly, sites, choice) if task.buildable else None
        if not blocking or len(barred) == MOST_BARRED:
            break
        note(f"{len(blocking)} rows of locks leave a block no way to its place: barred")
        barred.append(blocking)
    sure = replace(task.structure, share=1.0)
    return Design(
        task,
        choice,
        whole.cost,
        max(mixed.bound, whole.bound) if last is None else last.bound,
        mixed,
        whole,
        structure.share,
        carried(sure, choice),
        needed(sure, choice, task.factor),
        order_of(assembly, sites, choice),
        last.checks if last and last.choice == choice else checks_of(task, choice, note),
        raised,
    )


def _why_not(task: Task) -> str:
    share = task.structure.share
    most = " with all locks that there is room for"
    if share < 1.0:
        most += f", of whose strength {share:.3g} counts"
    try:
        largest = largest_factor(task.structure)
    except InfeasibleError:
        return f"design: the structure does not stand{most}"
    return f"design: a factor of {largest:.4g} is reached{most}; {task.factor:g} is asked for"
