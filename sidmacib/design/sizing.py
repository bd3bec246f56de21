"""Sizing: the least locks so that all load cases are carried, and what a design carries.

The strengths of locks are unknowns of a conic programme. Of each site it mixes the rows that fit,
in parts that add up to at most 1: its optimum is below the cost of any choice of whole rows, in any
direction, that carries the same in this model.
"""

from dataclasses import dataclass
from typing import NamedTuple

import cvxpy as cp
import numpy as np

from sidmacib.design import Choice
from sidmacib.design.model import CaseForces, DesignProblem, case_forces
from sidmacib.errors import InfeasibleError, UnboundedError
from sidmacib.mechanics.assembly import Floats
from sidmacib.mechanics.contact_law import Flags
from sidmacib.mechanics.optimisation import solve

WHAT = "design"
ACCURACIES = (1e-9, 1e-7, 1e-5)  # of factors, whose multipliers are sensitivities
ENOUGH = 1e-6  # accuracy of costs


class Mechanism(NamedTuple):
    """A mechanism that locks must resist: ``work`` times their strengths is at least ``least``.

    ``work``: for each of `DesignProblem.rows`; strengths in units, as much as counts.
    """

    work: Floats
    least: float


@dataclass(frozen=True, eq=False)
class Bound:
    """The least cost of mixed rows, and the part of each of `DesignProblem.layouts` in the mixture.

    ``mechanisms``: why nothing costs less.
    """

    cost: float
    parts: Floats
    mechanisms: tuple[Mechanism, ...]


def least_cost(structure: DesignProblem, factor: float, allowed: Flags | None = None) -> Bound:
    """The least cost of locks that carry ``factor`` times every case, rows being mixed.

    ``allowed``: whether each of `DesignProblem.layouts` is; by default all. `InfeasibleError` if no
    locks do.
    """
    parts, strength, forces, constraints = _mixed(structure, factor)
    if allowed is not None:
        constraints.insert(1, parts <= allowed.astype(float))
    scale = float(structure.costs.max())
    problem = cp.Problem(cp.Minimize((structure.costs / scale) @ parts), constraints)
    try:
        solve(problem, WHAT, ENOUGH)
    except InfeasibleError:
        raise InfeasibleError(f"{WHAT}: no locks carry {factor:g} times all cases") from None
    found = np.clip(np.asarray(parts.value), 0.0, 1.0)
    work = [work_of(structure, each) for each in forces]
    whole = np.asarray(strength.value)
    mechanisms = tuple(Mechanism(each, float(each @ whole)) for each in work if each.any())
    return Bound(scale * float(problem.value), found, mechanisms)


def largest_factor(structure: DesignProblem) -> float:
    """The largest factor of all cases that mixed rows carry; infinite if they carry any.

    `InfeasibleError` if no locks make it stand.
    """
    factor = cp.Variable()
    return _largest(factor, _mixed(structure, factor)[-1])


def _mixed(
    structure: DesignProblem, factor: cp.Variable | float
) -> tuple[cp.Variable, cp.Expression, list[CaseForces], list[cp.Constraint]]:
    """Parts of all layouts and their strengths in units, with the forces that carry all cases.

    And the constraints; the parts of a site's rows add up to at most 1.
    """
    parts = cp.Variable(len(structure.layouts), nonneg=True)
    strength = structure.strengths / structure.unit @ parts
    sums = np.zeros((len(structure.sites), len(structure.layouts)))
    sums[structure.site_of, np.arange(len(structure.layouts))] = 1.0
    forces = [case_forces(structure, case, factor, strength) for case in structure.all_cases]
    constraints = [constraint for each in forces for constraint in each.constraints]
    return parts, strength, forces, [sums @ parts <= 1.0, *constraints]


def carried(structure: DesignProblem, choice: Choice) -> tuple[Floats, Floats]:
    """The part of the load of each case that the rows of ``choice`` carry, and what it depends on.

    The factors, (cases,), are infinite of cases that are carried at any size. They grow for each N
    that the locks of a site are stronger by the second result, (cases, sites), which is 0 where
    there are none. `InfeasibleError` if a structure does not stand with these rows.
    """
    strength, count = _strength(structure, choice), len(structure.sites)
    factors, by_strength = [], []
    for case in structure.cases:
        factor = cp.Variable()
        forces = case_forces(structure, case, factor, cp.Constant(strength))
        factors.append(_largest(factor, forces.constraints))
        slopes = np.zeros(len(strength))
        if np.isfinite(factors[-1]):
            slopes = np.where(strength > 0.0, work_of(structure, forces) / structure.unit, 0.0)
        by_strength.append(np.bincount(structure.site_of_row, slopes, minlength=count))
    return np.array(factors), np.array(by_strength)


def needed(structure: DesignProblem, choice: Choice, factor: float) -> Floats:
    """Forces (N) across the rows of ``choice`` under ``factor`` times each case, (cases, sites).

    Of all that carry it, those with the least sum of squares of forces over strengths.
    `InfeasibleError` if they do not carry it.
    """
    strength, found = _strength(structure, choice), []
    row = np.repeat(np.arange(len(strength)), len(structure.option.portions))
    used = strength[row] > 0.0
    over_strength = 1.0 / np.where(used, strength[row], 1.0)[used]
    for case in structure.cases:
        forces = case_forces(structure, case, factor, cp.Constant(strength))
        shares = cp.multiply(over_strength, forces.locks[used])
        solve(cp.Problem(cp.Minimize(cp.sum_squares(shares)), forces.constraints), WHAT, ENOUGH)
        size = structure.unit * np.where(used, np.asarray(forces.locks.value), 0.0)
        sites = structure.site_of_row[row]
        found.append(np.bincount(sites, size, minlength=len(structure.sites)))
    return np.array(found)


def _strength(structure: DesignProblem, choice: Choice) -> Floats:
    """Strength along each of `DesignProblem.rows` in units, as much as counts."""
    whole = np.asarray(structure.strengths @ structure.chosen(choice))
    return np.asarray(whole / structure.unit)


def work_of(structure: DesignProblem, forces: CaseForces) -> Floats:
    """Work of each of `DesignProblem.rows` in a mechanism, in units: multipliers of strengths."""
    duals = sum(np.asarray(limit.dual_value) for limit in forces.limits)
    return np.clip(np.asarray(structure.portions.T @ duals), 0.0, None)


def _largest(factor: cp.Variable, constraints: list[cp.Constraint]) -> float:
    try:
        solve(cp.Problem(cp.Maximize(factor), constraints), WHAT, *ACCURACIES)
    except UnboundedError:
        return float("inf")
    return float(factor.value)
