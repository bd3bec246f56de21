"""Direction and number of locks of all sites at once: a mixed-integer programme, cut by mechanisms.

Each site gets one of its rows of locks or none. Which strengths of locks carry a case is known by
its mechanisms: for each, locks must do as much work as the loads do beyond friction. A linear
programme in whole numbers (HiGHS) picks the cheapest rows that resist the mechanisms found so far;
the conic programme of each case then finds a mechanism that these rows do not resist, or that there
is none (Benders' decomposition, Geoffrion 1972, doi:10.1007/BF00934810). So the bound holds for
friction cones as they are, and what is found is checked with them.
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import cvxpy as cp
import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csr_array, eye_array, hstack

from sidmacib.design import Layout
from sidmacib.design.model import DesignProblem, LoadCase, case_forces
from sidmacib.design.sizing import ENOUGH, WHAT, Mechanism, least_cost, work_of
from sidmacib.errors import InfeasibleError, SolverError
from sidmacib.mechanics.assembly import Floats
from sidmacib.mechanics.contact_law import Flags
from sidmacib.mechanics.optimisation import silent, solve

GAP = 0.01  # of the cost, over the cost
TIME_LIMIT = 600.0  # s of a processor
SHORT = 1e-6  # over their largest strength: what locks lack at most, as conic programmes round
INWARDS = (1.0, 0.5, 0.2)  # steps from strengths that carry all to those asked for: where to cut
MIXED = 1e-3  # cost of further directions of a site over that of the first, that counts as mixed
_INFEASIBLE = 2

Directions = frozenset[tuple[int, int]]  # pairs of a site and the direction that its locks have


@dataclass(frozen=True, eq=False)
class FoundRows:
    """The cheapest rows found, or mixtures of rows that have one direction.

    ``parts``: of each of `DesignProblem.layouts`; ``cost``: theirs; ``bound``: no choice without
    what is barred costs less.
    """

    parts: Floats
    cost: float
    bound: float


class RowSearch:
    """The search for the cheapest rows that carry ``factor`` times every case of a structure.

    Mechanisms are kept, as they hold whatever is barred, and whether rows are whole or mixed.
    """

    def __init__(self, structure: DesignProblem, factor: float) -> None:
        """Errors of `least_cost`."""
        self.structure, self.factor = structure, factor
        self.relaxed = least_cost(structure, factor)
        self.strengths = csr_array(structure.strengths / structure.unit)
        largest = np.asarray(self.strengths.max(axis=1).todense()).ravel()
        self.lacks = [_Lack(structure, case, factor, largest) for case in structure.all_cases]
        self.mechanisms = list(self.relaxed.mechanisms)

    def cheapest(
        self,
        *,
        whole: bool = True,
        barred: Sequence[Directions] = (),
        gap: float = GAP,
        time_limit: float = TIME_LIMIT,
        note: Callable[[str], None] = lambda _: None,
    ) -> FoundRows:
        """The cheapest choice: ``whole`` rows, or mixtures of rows of one direction at each site.

        ``barred``: sets of sites with directions of which at least one must be otherwise. ``gap``:
        when to stop, over the cost; ``time_limit`` in s of a processor: after it the best rows
        found are given with the bound reached. `InfeasibleError` if no rows do; `SolverError` if
        none are found in time.
        """
        end = time.process_time() + time_limit
        best = self._dive(whole, barred, end)
        cost = np.inf if best is None else float(self.structure.costs @ best)
        bound, rounds = self.relaxed.cost, 0
        while (best is None or cost - bound > gap * cost) and (
            left := end - time.process_time()
        ) > 0:
            parts, low = self._master(whole, barred, gap / 2, left)
            bound, rounds = max(bound, low), rounds + 1
            if parts is None:
                break
            if self._cut(parts):
                parts = self._repaired(parts, whole, barred, end)
            if parts is not None and self.structure.costs @ parts < cost:
                cost, best = float(self.structure.costs @ parts), parts
            count = len(self.mechanisms)
            note(f"round {rounds}: {count} mechanisms, cost {cost:.6g}, at least {bound:.6g}")
        if best is None:
            raise SolverError(f"{WHAT}: no rows of locks found in {time_limit:g} s")
        return FoundRows(best, cost, min(bound, cost))

    def carries(self, parts: Floats) -> bool:
        """Whether rows, of which there are these parts, carry all cases."""
        strength = self.strengths @ parts
        for lack in self.lacks:
            if lack.of(strength)[0] > SHORT:
                self.lacks = sorted(self.lacks, key=lambda each: each is not lack)  # first next
                return False
        return True

    def _master(
        self, whole: bool, barred: Sequence[Directions], gap: float, time_limit: float
    ) -> tuple[Floats | None, float]:
        """The cheapest rows against the mechanisms so far, if any are found, and a bound.

        Unknowns: the parts of layouts, then whether each site has locks of each direction.
        """
        structure = self.structure
        layouts, rows = len(structure.layouts), len(structure.rows)
        cost = structure.costs / structure.costs.max()
        of_row = csr_array(structure.strengths > 0.0, dtype=float)
        ends = structure.site_of_row, np.arange(rows)
        once = csr_array((np.ones(rows), ends), (len(structure.sites), rows))
        none = csr_array((len(structure.sites), layouts))
        mixture = float(self.relaxed.cost / structure.costs.max()) * (1.0 - SHORT)
        constraints = [
            LinearConstraint(hstack([of_row, -eye_array(rows)], format="csr"), -np.inf, 0.0),
            LinearConstraint(hstack([none, once], format="csr"), -np.inf, 1.0),
            LinearConstraint(np.append(cost, np.zeros(rows)), mixture),  # at least
        ]
        for each in barred:
            cut = [0.0] * layouts + [float(row in each) for row in structure.rows]
            constraints.append(LinearConstraint(cut, -np.inf, len(each) - 1.0))
        if self.mechanisms:
            work = np.array([each.work for each in self.mechanisms]) @ self.strengths.toarray()
            least, unit = np.array([each.least for each in self.mechanisms]), work.max(axis=1)
            work = np.hstack([work / unit[:, None], np.zeros((len(work), rows))])
            constraints.append(LinearConstraint(work, least / unit - SHORT))
        with silent():
            answer = milp(
                np.append(cost, np.zeros(rows)),
                integrality=[float(whole)] * layouts + [1.0] * rows,
                bounds=Bounds(0.0, 1.0),
                constraints=constraints,
                options={"mip_rel_gap": gap, "time_limit": max(time_limit, 1.0)},
            )
        if answer.status == _INFEASIBLE:
            placed = " and leave every block a way to its place" if barred else ""
            raise InfeasibleError(
                f"{WHAT}: no rows of locks, of one direction in each interface, carry all cases"
                f"{placed}; allow other directions (angles), more locks (most) or a higher cohesion"
            )
        bound = float(structure.costs.max() * (answer.mip_dual_bound or 0.0))
        if answer.x is None:
            return None, bound
        found = np.clip(answer.x[:layouts], 0.0, 1.0)
        return np.asarray(np.round(found) if whole else found), bound

    def _cut(self, parts: Floats) -> bool:
        """Whether rows do not carry all cases; mechanisms that they do not resist are kept."""
        asked, enough = self.strengths @ parts, self.strengths @ self.relaxed.parts
        short = False
        for lack in self.lacks:
            for inwards in INWARDS:
                strength = inwards * asked + (1.0 - inwards) * enough
                size, work = lack.of(strength)
                if size <= SHORT:
                    break
                short = True
                self.mechanisms.append(Mechanism(work, size + float(work @ strength)))
        return short

    def _dive(self, whole: bool, barred: Sequence[Directions], end: float) -> Floats | None:
        """Rows that carry all cases, from mixed ones whose directions are settled step by step."""
        structure = self.structure
        allowed, parts = np.ones(len(structure.layouts), bool), self.relaxed.parts
        sites = structure.site_of_row
        while True:
            sums = np.bincount(structure.row_of, parts * structure.costs)
            best = along(structure, parts * structure.costs)
            used = np.bincount(sites, sums, minlength=len(structure.sites))
            main = np.zeros(len(structure.sites))
            np.maximum.at(main, sites, sums)
            mixed = (used > main * (1.0 + MIXED)) & (used > SHORT * structure.costs.max())
            if not mixed.any():
                return self._repaired(parts, whole, barred, end)
            open_sites = np.flatnonzero(mixed)
            order = open_sites[np.argsort(-main[mixed] / used[mixed], kind="stable")]
            settled = order[: max(1, len(order) // 3)]
            trial = allowed & (best | ~np.isin(structure.site_of, settled))
            try:
                parts = least_cost(structure, self.factor, trial).parts
            except InfeasibleError:
                return None
            allowed = trial

    def _repaired(
        self, parts: Floats, whole: bool, barred: Sequence[Directions], end: float
    ) -> Floats | None:
        """Rows that carry all cases, in the directions of ``parts`` and else of the mixed rows."""
        structure = self.structure
        allowed = along(structure, 1e-3 * self.relaxed.parts + parts)
        try:
            settled = least_cost(structure, self.factor, allowed)
        except InfeasibleError:
            return None
        self.mechanisms += settled.mechanisms
        mixed = settled.parts
        if not whole:
            return None if _is_barred(structure, mixed > SHORT, barred) else mixed * allowed
        rounded = rounded_up(structure, mixed)
        if not self.carries(rounded) or _is_barred(structure, rounded > 0.0, barred):
            return None
        return self._trimmed(rounded, end)

    def _trimmed(self, taken: Floats, end: float) -> Floats:
        """Without locks that are not needed, the dearest first; as many as are seen by ``end``."""
        structure = self.structure
        paid, sites = structure.costs * taken, len(structure.sites)
        spent = np.bincount(structure.site_of, paid, minlength=sites)
        order = [k for k in np.argsort(-spent, kind="stable").tolist() if spent[k] > 0.0]
        size = len(order) // 2
        while size >= 1:  # many sites at once first
            for start in range(0, len(order), size):
                less = taken.copy()
                less[np.isin(structure.site_of, order[start : start + size])] = 0.0
                if time.process_time() < end and less.any() and self.carries(less):
                    taken = less
            size //= 2
        for site in order:
            fewer = _less(structure, taken, site)
            while fewer is not None and time.process_time() < end and self.carries(fewer):
                taken = fewer
                fewer = _less(structure, taken, site)
        return taken


class _Lack:
    """Strength that locks lack for a case: one programme for many strengths."""

    def __init__(
        self, structure: DesignProblem, case: LoadCase, factor: float, largest: Floats
    ) -> None:
        """``largest``: strengths along `DesignProblem.rows` in units; a part of them is lacking."""
        self.structure = structure
        self._strength, self._short = cp.Parameter(len(largest)), cp.Variable(nonneg=True)
        strength = self._strength + self._short * largest
        self._forces = case_forces(structure, case, factor, strength)
        self._problem = cp.Problem(cp.Minimize(self._short), self._forces.constraints)

    def of(self, strength: Floats) -> tuple[float, Floats]:
        """Strength that is lacking, and how much less for a unit more along each of the rows."""
        self._strength.value = strength
        solve(self._problem, WHAT, ENOUGH)
        return float(self._short.value), work_of(self.structure, self._forces)


def along(structure: DesignProblem, wish: Floats) -> Flags:
    """Whether each layout has the direction of its site for which there is the largest ``wish``."""
    sums = np.bincount(structure.row_of, wish)
    best: dict[int, int] = {}
    for number, (site, _) in enumerate(structure.rows):
        if site not in best or sums[number] > sums[best[site]]:
            best[site] = number
    return np.isin(structure.row_of, list(best.values()))


def rounded_up(structure: DesignProblem, parts: Floats) -> Floats:
    """1 for the cheapest row of each site that is at least as strong as its ``parts``, else 0.

    Of a site with rows of several directions the direction with the largest strength counts. The
    strongest row where none is strong enough.
    """
    taken = np.zeros(len(parts))
    strengths = np.array([layout.strength for layout in structure.layouts])
    needed = np.bincount(structure.row_of, parts * strengths)
    here = along(structure, parts * strengths)
    for number in np.unique(structure.row_of[here]):
        rows = np.flatnonzero(structure.row_of == number)
        if needed[number] > SHORT * strengths[rows].max():
            least = min(needed[number] * (1.0 - SHORT), strengths[rows].max())
            enough = rows[strengths[rows] >= least]
            taken[enough[np.argmin(structure.costs[enough])]] = 1.0
    return taken


def choice_of(structure: DesignProblem, taken: Floats) -> tuple[Layout | None, ...]:
    """The row of each site, None without one, of whole ones: ``taken`` is 1 for each."""
    row = {int(structure.site_of[k]): structure.layouts[k] for k in np.flatnonzero(taken)}
    return tuple(row.get(site) for site in range(len(structure.sites)))


def _less(structure: DesignProblem, taken: Floats, site: int) -> Floats | None:
    """``taken`` with the next cheaper row of a site and direction, or none there.

    None if there is none to take away.
    """
    here = np.flatnonzero((structure.site_of == site) & (taken > 0.0))
    if not len(here):
        return None
    same = np.flatnonzero(structure.row_of == structure.row_of[here[0]])
    cheaper = same[structure.costs[same] < structure.costs[here[0]]]
    less = taken.copy()
    less[here] = 0.0
    if len(cheaper):
        less[cheaper[np.argmax(structure.costs[cheaper])]] = 1.0
    return less


def _is_barred(structure: DesignProblem, taken: Flags, barred: Sequence[Directions]) -> bool:
    chosen = {structure.rows[row] for row in structure.row_of[taken].tolist()}
    return any(each <= chosen for each in barred)
