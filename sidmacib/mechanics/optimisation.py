"""Solve a convex programme and check every answer, independently of the solver.

The verdict of a solver depends on its tolerances, on scaling and on rounding. So every optimum is
checked against the conditions of optimality (Boyd & Vandenberghe, Convex Optimization, 2004,
section 5.5) of the standard form that the solver was given,

    minimise x'Px / 2 + c'x    subject to    A x + s = b,  s in K,

and every verdict of infeasible or unbounded against its certificate. If an answer does not pass,
other settings or another solver are tried. Programmes should be stated in units in which their
numbers are about 1.
"""

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import cvxpy as cp
import numpy as np

from sidmacib.errors import InfeasibleError, SolverError, UnboundedError
from sidmacib.mechanics.assembly import Floats

ACCURACY = 1e-8  # of the optimum's value
FEASIBLE = 1e-8  # largest violation of a constraint, over the largest unknown or 1
CERTAIN = 1e-7  # residual of a certificate over what it proves
DIVERGED = 1e100  # an unknown or a multiplier: the square of a larger one may overflow

# As tight as solvers accept. Answers that miss these tolerances may still pass the check.
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
    (cp.HIGHS, _SIMPLEX | {"presolve": "off"}),  # presolve takes longer than such programmes
    (cp.HIGHS, _SIMPLEX),
    *_CONIC[:2],
)
OUTPUT = 1  # the file descriptor


@dataclass(frozen=True)
class _Answer:
    """The answer of a solver: its verdict, unknowns and multipliers of the standard form.

    Without an optimum, the unknowns or multipliers are the certificate.
    """

    status: str
    x: Floats
    z: Floats


def solve(problem: cp.Problem, what: str, *accuracies: float) -> float:
    """Solve ``problem``; its variables then hold a checked optimum.

    ``accuracies``: of the optimum's value, relative to the value or to 1, whichever is larger;
    tightest first. Returns the first that a solver meets. Otherwise raises an error that names
    ``what``: `sidmacib.errors.InfeasibleError`, `sidmacib.errors.UnboundedError`, or
    `sidmacib.errors.SolverError` if no solver's verdict passes its check.
    """
    verdicts: list[str] = []
    optima: list[tuple[float, Any, Any]] = []  # error, reductions, raw answer with its inverse
    wanted = accuracies or (ACCURACY,)
    for solver, settings in _LINEAR if problem.is_lp() else _CONIC:
        try:
            # Options do not change the form; cvxpy compiles it once for all values of parameters.
            data, reductions, inverse = problem.get_problem_data(solver, solver_opts={})
            raw = reductions.solve_via_data(problem, data, solver_opts=dict(settings))
        except (cp.SolverError, ValueError) as refusal:
            verdicts.append(f"{solver}: {refusal}")
            continue
        answer = _answer(solver, raw)
        verdicts.append(f"{solver}: {answer.status}")
        error = _error(data, answer) if answer.x.size and answer.z.size else np.inf
        if error <= wanted[-1]:
            optima.append((error, reductions, (raw, inverse)))
            if error <= wanted[0] and _taken(problem, reductions, raw, inverse):
                return wanted[0]
        elif "infeasible" in answer.status and _infeasible(data, answer.z):
            raise InfeasibleError(f"{what}: no forces balance the permanent loads")
        elif "unbounded" in answer.status and _unbounded(data, answer.x):
            raise UnboundedError(f"{what}: the load can grow without limit")
    for error, reductions, (raw, inverse) in sorted(optima, key=lambda each: each[0]):
        if _taken(problem, reductions, raw, inverse):
            return next(accuracy for accuracy in wanted if error <= accuracy)
    raise SolverError(f"{what}: no solver's verdict passes its check ({'; '.join(verdicts)})")


def _taken(problem: cp.Problem, reductions: Any, raw: Any, inverse: Any) -> bool:
    """Whether ``problem`` accepts the answer as an optimum; it then holds the values."""
    problem.unpack(reductions.invert(raw, inverse))
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
    """Largest error of the optimum by its unknowns and multipliers, over its value or 1.

    Infinite if a constraint is violated.
    """
    A, b, c, x = data["A"], data["b"], data["c"], answer.x
    largest = max(1.0, float(np.abs(x).max()))
    if not max(largest, float(np.abs(answer.z).max(initial=0.0))) < DIVERGED:
        return np.inf
    curved = data["P"] @ x if "P" in data else np.zeros_like(x)
    slack = b - A @ x
    violation = slack - _projected(slack, data["dims"], dual=False)
    z = _projected(answer.z, data["dims"], dual=True)
    residual = curved + c + A.T @ z
    value = float(np.sum((curved / 2 + c) * x))
    # To first order: the duality gap, and the residuals weighed by unknowns and multipliers.
    error = abs(float(np.sum((curved + c) * x) + np.sum(b * z))) + float(
        np.sum(np.abs(residual * x)) + np.sum(np.abs(violation * z))
    )
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
    """Whether ``ray``, of unknowns, improves the objective without limit and stays feasible."""
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
    projected = np.zeros_like(values)
    if dual:
        projected[: dims.zero] = values[: dims.zero]
    linear = slice(dims.zero, dims.zero + dims.nonneg)
    projected[linear] = np.maximum(values[linear], 0.0)
    sizes = np.array(dims.soc, np.int64)
    starts = linear.stop + np.cumsum(sizes) - sizes
    for size in np.unique(sizes):  # self-dual
        cones = starts[sizes == size, None] + np.arange(size)
        projected[cones] = _projected_on_second_order(values[cones])
    return projected


def _projected_on_second_order(cones: Floats) -> Floats:
    """Project each row (t, v) on |v| <= t."""
    t, v = cones[:, :1], cones[:, 1:]
    size = np.sqrt(np.sum(v**2, axis=1, keepdims=True))
    share = np.clip((t + size) / 2, 0.0, None)
    scale = np.divide(share, size, out=np.zeros_like(size), where=size > 0.0)
    outside = np.hstack([share, scale * v])
    return np.asarray(np.where(size <= t, cones, outside))


def _length(vector: Floats) -> float:
    return float(np.sqrt(np.sum(vector**2)))  # not by BLAS, whose rounding depends on the processor


@contextmanager
def silent() -> Iterator[None]:
    """Drop what compiled code writes to standard output meanwhile.

    HiGHS writes debugging lines there (``HighsMipSolverData::transformNewIntegerFeasibleSolution``)
    even without a log, which would end up between the lines of a table or of JSON.
    """
    try:
        kept = os.dup(OUTPUT)
    except OSError:  # there is none
        yield
        return
    c_library = ctypes.CDLL(None)
    sys.stdout.flush()
    c_library.fflush(None)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, OUTPUT)
    os.close(nowhere)
    try:
        yield
    finally:
        c_library.fflush(None)  # else it comes later, out of C's own buffer
        os.dup2(kept, OUTPUT)
        os.close(kept)
