"""Direction and number of locks of all sites at once: a mixed-integer linear programme.

Each site gets one of its rows of locks or none. Friction cones are inscribed pyramids, so that what
the programme says is carried is carried with the cones too. A node of friction alone needs no
constraint: its force is a sum, with parts that are not negative, of the edges of its pyramid.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import block_diag, csr_array, eye_array, hstack, vstack

from sidmacib.design.layouts import Layout
from sidmacib.design.model import Case, NodeLimits, Structure
from sidmacib.errors import InfeasibleError, SolverError
from sidmacib.mechanics.assembly import Floats
from sidmacib.validation import require_positive, require_whole

SIDES = 8  # of a pyramid: at least 0.92 of the friction, all of it along the tangents
GAP = 0.01  # of the cost, over the cost
TIME_LIMIT = 600.0  # s
_OPTIMAL, _STOPPED, _INFEASIBLE = 0, 1, 2

Directions = frozenset[tuple[int, int]]  # pairs of a site and the direction that its locks have


@dataclass(frozen=True, eq=False)
class Found:
    """The cheapest rows found, one or None for each site.

    ``cost``: theirs; ``bound``: no choice with pyramids, and without what is barred, costs less.
    ``gap``: the difference over the cost.
    """

    choice: tuple[Layout | None, ...]
    cost: float
    bound: float

    @property
    def gap(self) -> float:
        """How much cheaper a choice might be, over the cost; 0 without locks."""
        return max(1.0 - self.bound / self.cost, 0.0) if self.cost > 0.0 else 0.0


def cheapest(
    structure: Structure,
    factor: float,
    *,
    barred: Iterable[Directions] = (),
    gap: float = GAP,
    time_limit: float = TIME_LIMIT,
    sides: int = SIDES,
) -> Found:
    """The rows of least cost that carry ``factor`` times every case.

    ``barred``: sets of sites with directions of which at least one must be otherwise. ``gap``: when
    to stop, over the cost; ``time_limit`` in s. `InfeasibleError` if no rows do; `SolverError` if
    none are found in time.
    """
    require_positive(gap=gap, time_limit=time_limit)
    require_whole(4, sides=sides)
    every = structure.all_cases
    blocks = [_case(structure, case, factor, sides) for case in every]
    of_case = block_diag([block[0] for block in blocks], format="csr")
    locks = vstack([block[1] for block in blocks], format="csr")
    low, high = (np.concatenate([block[k] for block in blocks]) for k in (2, 3))
    choice = _choice_rows(structure, barred)
    matrix = vstack(
        [hstack([of_case, locks]), hstack([_zeros(choice[0], of_case), choice[0]])], format="csr"
    )
    limits = LinearConstraint(
        matrix,
        np.concatenate([low, np.full(len(choice[1]), -np.inf)]),
        np.concatenate([high, choice[1]]),
    )
    lower = np.concatenate([*(block[4] for block in blocks), np.zeros(len(structure.layouts))])
    upper = np.concatenate([np.full(of_case.shape[1], np.inf), np.ones(len(structure.layouts))])
    whole = np.concatenate([np.zeros(of_case.shape[1]), np.ones(len(structure.layouts))])
    scale = float(structure.costs.max())
    answer = milp(
        np.concatenate([np.zeros(of_case.shape[1]), structure.costs / scale]),
        integrality=whole,
        bounds=Bounds(lower, upper),
        constraints=limits,
        options={"mip_rel_gap": gap, "time_limit": time_limit},
    )
    if answer.status == _INFEASIBLE:
        raise InfeasibleError(f"design: no rows of locks carry {factor:g} times all cases")
    if answer.x is None:
        late = answer.status == _STOPPED
        reason = f"none found in {time_limit:g} s" if late else str(answer.message)
        raise SolverError(f"design: no rows of locks: {reason}")
    taken = np.asarray(answer.x[of_case.shape[1] :]) > 0.5
    bound = scale * float(answer.mip_dual_bound)
    return Found(_rows(structure, taken), float(structure.costs @ taken), bound)


def _case(
    structure: Structure, case: Case, factor: float, sides: int
) -> tuple[csr_array, csr_array, Floats, Floats, Floats]:
    """Rows of a case: of its forces, of the parts of layouts; their bounds; and the unknowns'.

    Unknowns: of dry nodes the edges of the pyramid, of bonded ones compression, then the corners of
    the pyramid's section; of locks forces either way.
    """
    limits = NodeLimits.of(structure)
    simple = (limits.held == 0.0) & (limits.torn == 0.0)
    angles = 2 * np.pi * np.arange(sides) / sides
    corners = np.array([0 * angles, np.cos(angles), np.sin(angles)])
    columns: list[csr_array] = []
    least: list[Floats] = []
    held_rows: list[tuple[int, float, float]] = []  # first column, held, slope
    count = 0
    for node, plain in enumerate(simple.tolist()):
        here = structure.at_nodes[:, 3 * node : 3 * node + 3]
        if plain:
            edges = limits.slope[node] * corners + np.array([[1.0], [0.0], [0.0]])
            columns.append(csr_array(here @ edges))
            least.append(np.zeros(sides))
            count += sides
        else:
            columns.append(csr_array(here @ np.hstack([np.eye(3)[:, :1], corners])))
            least.append(np.array([-limits.torn[node], *np.zeros(sides)]))
            held_rows.append((count, float(limits.held[node]), float(limits.slope[node])))
            count += 1 + sides
    points = structure.at_locks.shape[1]
    balance = hstack([*columns, structure.at_locks, -structure.at_locks], format="csr")
    held = np.zeros((len(held_rows), count + 2 * points))
    for row, (first, _, slope) in enumerate(held_rows):
        held[row, first] = -slope
        held[row, first + 1 : first + 1 + sides] = 1.0
    either = hstack(
        [csr_array((points, count)), eye_array(points), eye_array(points)], format="csr"
    )
    of_case = vstack([balance, csr_array(held), either], format="csr")
    strength = structure.share / structure.unit * (structure.portions @ structure.strengths)
    blank = csr_array((balance.shape[0] + len(held_rows), len(structure.layouts)))
    load = structure.permanent(case) + factor * structure.variable(case)
    limit = np.array([each for _, each, _ in held_rows])
    low = np.concatenate([load, np.full(len(held_rows) + points, -np.inf)])
    high = np.concatenate([load, limit, np.zeros(points)])
    lower = np.concatenate([*least, np.zeros(2 * points)])
    return of_case, vstack([blank, -strength], format="csr"), low, high, lower


def _choice_rows(structure: Structure, barred: Iterable[Directions]) -> tuple[csr_array, Floats]:
    """At most one row a site, and not all of each set that is barred; with their upper bounds."""
    count, layouts = len(structure.sites), structure.layouts
    once = csr_array(
        (np.ones(len(layouts)), (structure.site_of, np.arange(len(layouts)))),
        (count, len(layouts)),
    )
    pairs = [
        (int(site), each.direction) for site, each in zip(structure.site_of, layouts, strict=True)
    ]
    cuts = [np.array([float(pair in each) for pair in pairs]) for each in barred]
    most = [1.0] * count + [len(each) - 1.0 for each in barred]
    return vstack([once, *(csr_array(cut[None]) for cut in cuts)], format="csr"), np.array(most)


def _rows(structure: Structure, taken: Floats) -> tuple[Layout | None, ...]:
    choice: list[Layout | None] = [None] * len(structure.sites)
    for number in np.flatnonzero(taken).tolist():
        choice[int(structure.site_of[number])] = structure.layouts[number]
    return tuple(choice)


def _zeros(rows: csr_array, columns: csr_array) -> csr_array:
    return csr_array((rows.shape[0], columns.shape[1]))
