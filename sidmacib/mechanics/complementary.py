"""The static model's state as a convex programme: the least complementary energy.

Of all node forces that balance the loads, those minimise the sum of s^2 / (2 K A) that follow from
displacements of the pieces. Dry nodes cannot pull. Friction enters in one of two ways:

- ``FrictionRule.COULOMB``: |s_t| <= mu N with N from the solution before, until it settles. Slip
  does not dilate, as in `sidmacib.mechanics.static`; the load is applied in one step.
- ``FrictionRule.ASSOCIATED``: |s_t| <= mu s_n in one programme. Slip dilates, which presses the
  faces together and overestimates what friction carries.

This is the slow and independent twin of Newton's method in `sidmacib.mechanics.static`, for small
meshes.
"""

from enum import StrEnum

import cvxpy as cp
import numpy as np

from sidmacib.mechanics.assembly import Assembly, Floats, Loads
from sidmacib.mechanics.contact_law import NodeLaw, NodeState, utilisation
from sidmacib.mechanics.equilibrium import equilibrium_matrix, free_rows
from sidmacib.mechanics.optimisation import solve

ACCURACY = {"tol_gap_abs": 1e-7, "tol_gap_rel": 1e-7, "tol_feas": 1e-7}  # of Clarabel
LEAST_BOUND = 1e-6  # of friction, over a node's mean share of the load: solvers need an interior


class FrictionRule(StrEnum):
    """How friction enters the programme."""

    COULOMB = "coulomb"
    ASSOCIATED = "associated"


def least_energy_forces(
    assembly: Assembly,
    loads: Loads,
    load: float,
    rule: FrictionRule = FrictionRule.COULOMB,
    tolerance: float = 1e-6,
) -> Floats:
    """Node forces (N) under ``load`` times ``loads`` and self-weight, while no bond fails.

    Returns (N, 3): what the piece below each node exerts on the piece above, in the frame of the
    face. ``tolerance``: last change of the friction bounds, over the load. Raises
    `sidmacib.errors.CapacityError` where no forces balance the loads, RuntimeError if the
    friction bounds do not settle.
    """
    law = NodeLaw.of(assembly)
    rows = free_rows(assembly)
    target = (loads.permanent + load * loads.variable).ravel()[rows]
    # Per unit of a node's mean share of the load: numbers about 1 for the solver.
    scale = float(np.abs(target).max()) / len(law.friction)
    dry = np.flatnonzero(~law.cohesive)

    force, bound = cp.Variable((len(law.friction), 3)), cp.Parameter(len(dry), nonneg=True)
    mean = float(law.normal_stiffness.mean())
    flexibility = mean / np.column_stack(
        [law.normal_stiffness, law.shear_stiffness, law.shear_stiffness]
    )
    energy = cp.sum(cp.multiply(flexibility, cp.square(force)))
    shear = cp.norm(force[dry, 1:], 2, axis=1)
    balanced = [
        equilibrium_matrix(assembly)[rows] @ cp.vec(force, order="C") == target / scale,
        force[dry, 0] >= 0,
    ]
    what = f"least complementary energy at {load:g} N"
    cone = shear <= cp.multiply(law.friction[dry], force[dry, 0])
    solve(cp.Problem(cp.Minimize(energy), [*balanced, cone]), what, cp.CLARABEL, **ACCURACY)
    if rule is FrictionRule.ASSOCIATED:
        return scale * np.array(force.value)
    problem = cp.Problem(cp.Minimize(energy), [*balanced, shear <= bound])
    before = np.full(len(dry), np.inf)
    for count in range(200):
        after = law.friction[dry] * np.maximum(force.value[dry, 0], LEAST_BOUND)
        if np.abs(after - before).max() <= tolerance * len(law.friction):
            return scale * np.array(force.value)
        # Half way only after some rounds, against going round in circles.
        before = after if count < 10 else (before + after) / 2
        bound.value = before
        solve(problem, what, cp.CLARABEL, **ACCURACY)
    raise RuntimeError(f"the friction bounds do not settle at {load:g} N")


def first_failure_load(assembly: Assembly, loads: Loads, rule: FrictionRule) -> float:
    """Load (N) at which the first bonded node reaches its strength, to 0.01 %.

    Utilisation is all but proportional to the load, so the load over its utilisation settles.
    """
    law = NodeLaw.of(assembly)
    state = NodeState.initial(law)
    load = 0.1 * loads.scale
    for _ in range(50):
        used = utilisation(law, state, least_energy_forces(assembly, loads, load, rule)).max()
        if abs(used - 1.0) <= 1e-4:
            return load
        load /= float(used)
    raise RuntimeError(f"the first failure does not settle at {load:g} N")
