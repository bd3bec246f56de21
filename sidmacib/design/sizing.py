"""Sizing: the least locks so that all load cases are carried, and what a design carries.

The strengths of locks are unknowns of a conic programme. Of each site it mixes the rows that fit,
in parts that add up to at most 1: its optimum is below the cost of any choice of whole rows, in any
direction, that carries the same in this model.
"""

from dataclasses import dataclass

import cvxpy as cp
import numpy as np

from sidmacib.design import Choice
from sidmacib.design.model import CaseForces, DesignProblem, LoadCase, case_forces
from sidmacib.errors import InfeasibleError, UnboundedError
from sidmacib.mechanics.assembly import Floats
from sidmacib.mechanics.contact_law import Flags
from sidmacib.mechanics.optimisation import solve

WHAT = "design"
ACCURACIES = (1e-9, 1e-7, 1e-5)  # of factors, whose multipliers are sensitivities
ENOUGH = 1e-6  # accuracy of costs


@dataclass(frozen=True, eq=False)
class Mechanism:
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


@dataclass(frozen=True, eq=False)
class Carried:
    """Share of a case that a design carries.

    ``factor``: of the case's load; infinite if it carries any. ``by_strength``: by how much the
    factor grows for each N that the locks of a site in the choice are stronger, (sites,); 0 where
    there are none.
    """

    case: str
    factor: float
    by_strength: Floats


@dataclass(frozen=True, eq=False)
class Needed:
    """Forces of locks in a case: of all that carry it, those with the least sum of squares.

    ``across``: forces across the locks of each site in N, (sites,). The squares are of forces over
    strengths.
    """

    case: str
    across: Floats


def least_cost(structure: DesignProblem, factor: float, allowed: Flags | None = None) -> Bound:
    """The least cost of locks that carry ``factor`` times every case, rows being mixed.

    ``allowed``: whether each of `DesignProblem.layouts` is; by default all. `InfeasibleError` if no
    locks do.
    """
    parts = cp.Variable(len(structure.layouts), nonneg=True)
    strength = structure.strengths / structure.unit @ parts
    constraints: list[cp.Constraint] = [_each_once(structure, parts)]
    if allowed is not None:
        constraints.append(parts <= allowed.astype(float))
    forces = [case_forces(structure, case, factor, strength) for case in structure.all_cases]
    constraints += [constraint for each in forces for constraint in each.constraints]
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
    parts = cp.Variable(len(structure.layouts), nonneg=True)
    factor = cp.Variable()
    strength = structure.strengths / structure.unit @ parts
    constraints: list[cp.Constraint] = [_each_once(structure, parts)]
    for case in structure.all_cases:
        constraints += case_forces(structure, case, factor, strength).constraints
    return _largest(factor, constraints)


def carried(structure: DesignProblem, choice: Choice) -> tuple[Carried, ...]:
    """Loads of all cases that the rows of ``choice`` carry.

    `InfeasibleError` if a structure does not stand with them.
    """
    return tuple(_carried(structure, choice, case) for case in structure.cases)


def _carried(structure: DesignProblem, choice: Choice, case: LoadCase) -> Carried:
    strength = _strength(structure, choice)
    factor = cp.Variable()
    forces = case_forces(structure, case, factor, cp.Constant(strength))
    largest = _largest(factor, forces.constraints)
    count = len(structure.sites)
    if not np.isfinite(largest):
        return Carried(case.name, largest, np.zeros(count))
    slopes = work_of(structure, forces) / structure.unit
    slopes = np.where(strength > 0.0, slopes, 0.0)
    by_strength = np.bincount(structure.site_of_row, slopes, minlength=count)
    return Carried(case.name, largest, by_strength.astype(float))


def needed(structure: DesignProblem, choice: Choice, factor: float) -> tuple[Needed, ...]:
    """Forces in the rows of ``choice`` under ``factor`` times each case.

    `InfeasibleError` if they do not carry it.
    """
    return tuple(_needed(structure, choice, factor, case) for case in structure.cases)


def _needed(structure: DesignProblem, choice: Choice, factor: float, case: LoadCase) -> Needed:
    strength = _strength(structure, choice)
    forces = case_forces(structure, case, factor, cp.Constant(strength))
    row = np.repeat(np.arange(len(strength)), len(structure.option.portions))
    used = strength[row] > 0.0
    shares = cp.multiply(1.0 / np.where(used, strength[row], 1.0)[used], forces.locks[used])
    solve(cp.Problem(cp.Minimize(cp.sum_squares(shares)), forces.constraints), WHAT, ENOUGH)
    size = structure.unit * np.where(used, np.asarray(forces.locks.value), 0.0)
    across = np.bincount(structure.site_of_row[row], size, minlength=len(structure.sites))
    return Needed(case.name, across.astype(float))


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


def _each_once(structure: DesignProblem, parts: cp.Variable) -> cp.Constraint:
    """The parts of a site's rows add up to at most 1."""
    sums = np.zeros((len(structure.sites), len(structure.layouts)))
    sums[structure.site_of, np.arange(len(structure.layouts))] = 1.0
    return sums @ parts <= 1.0
