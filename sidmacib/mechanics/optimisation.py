"""Solve a convex programme, and take no answer that the solver does not vouch for."""

import cvxpy as cp

from sidmacib.errors import InfeasibleError, SolverError, UnboundedError


def solve(problem: cp.Problem, what: str, solver: str = cp.HIGHS, **settings: float) -> None:
    """Solve; every status but an optimum raises an error that names ``what``.

    ``settings``: of the solver.
    """
    try:
        problem.solve(solver=solver, **settings)
    except cp.SolverError as error:
        raise SolverError(f"{what}: {error}") from error
    status = problem.status
    if status == cp.OPTIMAL:
        return
    if status == cp.INFEASIBLE:
        raise InfeasibleError(f"{what}: no forces balance the permanent loads")
    if status == cp.UNBOUNDED:
        raise UnboundedError(f"{what}: the load can grow without limit")
    raise SolverError(f"{what}: solver status {status}")
