"""Solve a convex programme, and take no answer that was not checked here.

A solver's own verdict depends on its tolerances, on scaling and on rounding. So every optimum is
checked against the conditions of optimality (Boyd & Vandenberghe, Convex Optimization, 2004,
section 5.5) of the standard form that the solver was given,

    minimise x'Px / 2 + c'x    subject to    A x + s = b,  s in K,

and every verdict that there is none against its certificate. What does not pass is tried again
with other settings or another solver. Programmes should be stated in units in which their numbers
are about 1.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import cvxpy as cp
import numpy as np
import scipy.sparse as sp

from sidmacib.errors import InfeasibleError, SolverError, UnboundedError
from sidmacib.mechanics.assembly import Floats

ACCURACY = 1e-8  # of the optimum's value
FEASIBLE = 1e-8  # largest violation of a constraint, over the largest unknown or 1
CERTAIN = 1e-7  # residual of a certificate over what it proves

# As far as they go: what counts is the check, not whether the solver reaches its tolerance.
_SIMPLEX = {"solver": "simplex", "threads": 1} | dict.fromkeys(
    ["primal_feasibility_tolerance", "dual_feasibility_tolerance"], 1e-10
)
_INTERIOR = {"direct_solve_method": "qdldl", "accept_unknown": True} | dict.fromkeys(
    ["tol_gap_abs", "tol_gap_rel", "tol_feas"], 1e-12
)
_CAREFUL = {
    "max_step_fraction": 0.9,
    "static_regularization_constant": 1e-10,
    "iterative_refinement_max_iter": 50,
}
_CONIC: tuple[tuple[str, dict[str, Any]], ...] = (
    (cp.CLARABEL, _INTERIOR),
    (cp.CLARABEL, _INTERIOR | _CAREFUL),
    (cp.CLARABEL, _INTERIOR | _CAREFUL | {"equilibrate_enable": False}),
)
_LINEAR: tuple[tuple[str, dict[str, Any]], ...] = (
    (cp.HIGHS, _SIMPLEX | {"presolve": "off"}),  # it takes longer than such programmes
    (cp.HIGHS, _SIMPLEX),
    *_CONIC[:2],
)


@dataclass(frozen=True)
class _Answer:
    """What a solver returned: its verdict, and the unknowns and multipliers of the standard form.

    Where there is no optimum they are the certificate.
    """

    status: str
    x: Floats
    z: Floats


def solve(problem: cp.Problem, what: str, *accuracies: float) -> float:
    """Solve; the variables of ``problem`` then hold an optimum that was checked.

    ``accuracies``: of the optimum's value over itself or 1, whichever is larger, the least one
    first; the first that some solver meets is returned. Everything but an optimum raises an error
    that names ``what``: `sidmacib.errors.InfeasibleError`, `sidmacib.errors.UnboundedError`, or
    `sidmacib.errors.SolverError` where no solver came to a verdict that holds.
    """
    given = partial(problem.get_problem_data, solver_opts={})  # they do not change the form
    return _solved(problem, what, accuracies, given)


class Family:
    """A programme that is solved for many values of its only parameter.

    What a solver is given is affine in the parameter (disciplined parametrised programming, Agrawal
    et al. 2019), so it is made once and added up for each value, in place of being made each time.
    """

    def __init__(self, problem: cp.Problem) -> None:
        """``problem``: with one parameter, a vector, and no constant in its aim."""
        (self.parameter,) = problem.parameters()
        self.problem = problem
        self._forms: dict[str, _Form] = {}

    def solve(self, value: Floats, what: str) -> None:
        """Solve for a ``value`` of the parameter, as `solve` does."""

        def form(solver: str) -> _Given:
            if solver not in self._forms:
                self._forms[solver] = _Form.of(self.problem, self.parameter, solver)
            return self._forms[solver].at(value)

        _solved(self.problem, what, (), form)


# What a solver is given, what gives it, and what takes its answer back.
_Given = tuple[dict[str, Any], Any, Any]
_Giver = Callable[[str], _Given]


@dataclass(frozen=True)
class _Form:
    """The standard form as a function of a parameter p: c, b and the entries of A are affine in it.

    ``constant``, ``slopes``: of c, b and A one after the other, (E,) and (E, p).
    """

    given: _Given
    constant: Floats
    slopes: Floats

    @classmethod
    def of(cls, problem: cp.Problem, parameter: cp.Parameter, solver: str) -> "_Form":
        """From the standard forms at 0 and at the unit vectors."""
        count = parameter.size
        forms = []
        for place in np.vstack([np.zeros(count), np.eye(count)]):
            parameter.value = place
            forms.append(problem.get_problem_data(solver, solver_opts={}))
        (data, *rest), matrices = forms[0], [data["A"] for data, _, _ in forms]
        pattern = sp.csc_array(sum(abs(matrix) for matrix in matrices))
        pattern.sort_indices()
        columns = np.repeat(np.arange(pattern.shape[1]), np.diff(pattern.indptr))
        entries = [
            np.concatenate([own["c"], own["b"], matrix.toarray()[pattern.indices, columns]])
            for (own, _, _), matrix in zip(forms, matrices, strict=True)
        ]
        slopes = np.column_stack([each - entries[0] for each in entries[1:]])
        return cls((data | {"A": pattern}, *rest), entries[0], slopes)

    def at(self, value: Floats) -> _Given:
        """What the solver is given at a ``value`` of the parameter, until it is asked for again."""
        data, chain, inverse = self.given
        # Not by BLAS, which rounds as the processor likes.
        now = self.constant + np.sum(self.slopes * value, axis=1)
        A, unknowns = data["A"], len(data["c"])
        rows = unknowns + len(data["b"])
        A.data[:] = now[rows:]
        return {**data, "c": now[:unknowns], "b": now[unknowns:rows]}, chain, inverse


def _solved(problem: cp.Problem, what: str, accuracies: tuple[float, ...], given: _Giver) -> float:
    """Do what `solve` says, with what solvers are ``given``."""
    verdicts: list[str] = []
    found: list[tuple[float, Any, Any]] = []  # of all solvers: errors, and how to take the answer
    wanted = accuracies or (ACCURACY,)
    for solver, settings in _LINEAR if problem.is_lp() else _CONIC:
        try:
            data, chain, inverse = given(solver)
            raw = chain.solve_via_data(problem, data, solver_opts=dict(settings))
        except (cp.SolverError, ValueError) as refusal:
            verdicts.append(f"{solver}: {refusal}")
            continue
        answer = _answer(solver, raw)
        verdicts.append(f"{solver}: {answer.status}")
        error = _error(data, answer) if answer.x.size and answer.z.size else np.inf
        if error <= wanted[-1]:
            found.append((error, chain, (raw, inverse)))
            if error <= wanted[0] and _taken(problem, chain, raw, inverse):
                return wanted[0]
        elif "infeasible" in answer.status and _infeasible(data, answer.z):
            raise InfeasibleError(f"{what}: no forces balance the permanent loads")
        elif "unbounded" in answer.status and _unbounded(data, answer.x):
            raise UnboundedError(f"{what}: the load can grow without limit")
    for error, chain, (raw, inverse) in sorted(found, key=lambda each: each[0]):
        if _taken(problem, chain, raw, inverse):
            return next(accuracy for accuracy in wanted if error <= accuracy)
    raise SolverError(f"{what}: no verdict that holds ({'; '.join(verdicts)})")


def _taken(problem: cp.Problem, chain: Any, raw: Any, inverse: Any) -> bool:
    """Whether ``problem`` takes a solver's answer as an optimum."""
    problem.unpack(chain.invert(raw, inverse))
    return problem.status in (cp.OPTIMAL, cp.OPTIMAL_INACCURATE)


def _answer(solver: str, raw: Any) -> _Answer:
    if solver == cp.CLARABEL:
        names = {"PrimalInfeasible": "infeasible", "DualInfeasible": "unbounded"}
        status = str(raw.status).removeprefix("Almost")
        return _Answer(names.get(status, str(raw.status)), np.array(raw.x), np.array(raw.z))
    status = raw["model_status"].removeprefix("k").lower()
    rows = raw["dual_ray"][2] if "dual_ray" in raw else raw["solution"].row_dual
    return _Answer(status, np.array(raw["solution"].col_value), -np.array(rows))


def _error(data: dict[str, Any], answer: _Answer) -> float:
    """Of an optimum that unknowns and multipliers prove each other, over its value or 1.

    Infinite if a constraint is violated.
    """
    A, b, c, x = data["A"], data["b"], data["c"], answer.x
    curved = data["P"] @ x if "P" in data else np.zeros_like(x)
    slack = b - A @ x
    violation = slack - _projected(slack, data["dims"], dual=False)
    z = _projected(answer.z, data["dims"], dual=True)
    residual = curved + c + A.T @ z
    value = float(np.sum((curved / 2 + c) * x))
    # What the optimum can differ by, to first order: the gap, and what the residuals are worth.
    error = abs(float(np.sum((curved + c) * x) + np.sum(b * z))) + float(
        np.sum(np.abs(residual * x)) + np.sum(np.abs(violation * z))
    )
    largest = max(1.0, float(np.abs(x).max()))
    if np.abs(violation).max(initial=0.0) > FEASIBLE * largest:
        return np.inf
    return error / max(abs(value), 1.0)


def _infeasible(data: dict[str, Any], ray: Floats) -> bool:
    """Whether ``ray``, of multipliers, proves that the constraints contradict each other."""
    if not ray.size:
        return False
    z = _projected(ray, data["dims"], dual=True)
    proof = -float(np.sum(data["b"] * z))
    return proof > 0.0 and bool(_length(data["A"].T @ z) <= CERTAIN * proof)


def _unbounded(data: dict[str, Any], ray: Floats) -> bool:
    """Whether ``ray``, of unknowns, improves the aim for ever and meets no constraint."""
    if not ray.size:
        return False
    slack = -(data["A"] @ ray)
    gain = -float(np.sum(data["c"] * ray))
    against = _length(slack - _projected(slack, data["dims"], dual=False))
    if "P" in data:
        against += _length(data["P"] @ ray)
    return gain > 0.0 and bool(against <= CERTAIN * gain)


def _projected(values: Floats, dims: Any, dual: bool) -> Floats:
    """The nearest point of the cone K, or of its dual."""
    found = np.zeros_like(values)
    if dual:
        found[: dims.zero] = values[: dims.zero]
    linear = slice(dims.zero, dims.zero + dims.nonneg)
    found[linear] = np.maximum(values[linear], 0.0)
    for size, first in _second_order(dims):  # its own dual
        cones = values[first].reshape(-1, size)
        found[first] = _projected_on_second_order(cones).ravel()
    return found


def _second_order(dims: Any) -> Iterator[tuple[int, slice]]:
    """Size of the second-order cones and where they are, neighbours of one size together."""
    start = dims.zero + dims.nonneg
    sizes = list(dims.soc)
    while sizes:
        count = next((i for i, size in enumerate(sizes) if size != sizes[0]), len(sizes))
        yield sizes[0], slice(start, start + count * sizes[0])
        start += count * sizes[0]
        del sizes[:count]


def _projected_on_second_order(cones: Floats) -> Floats:
    """Project each row (t, v) on |v| <= t."""
    t, v = cones[:, :1], cones[:, 1:]
    size = np.sqrt(np.sum(v**2, axis=1, keepdims=True))
    share = np.clip((t + size) / 2, 0.0, None)
    scale = np.divide(share, size, out=np.zeros_like(size), where=size > 0.0)
    outside = np.hstack([share, scale * v])
    return np.asarray(np.where(size <= t, cones, outside))


def _length(vector: Floats) -> float:
    return float(np.sqrt(np.sum(vector**2)))  # not by BLAS, which rounds as the processor likes
