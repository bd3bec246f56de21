"""The static model's state as a convex programme: the least complementary energy.

Of all node forces that balance the loads, those minimise the sum of s^2 / (2 K A) that follow from
displacements of the pieces. Dry nodes cannot pull. Friction enters in one of two ways:

- ``FrictionRule.COULOMB``: |s_t| <= mu N with N from the solution before, until it settles. Slip
  does not dilate, as in `sidmacib.mechanics.static`; the load is applied in one step.
- ``FrictionRule.ASSOCIATED``: |s_t| <= mu s_n in one programme. Slip dilates, which presses the
  faces together and overestimates what friction carries.

The tests compare the static model with it: slow, independent of Newton's method, for small meshes.
"""

from enum import StrEnum

import cvxpy as cp
import numpy as np
from scipy.sparse import csr_array

from sidmacib.errors import SolverError
from sidmacib.mechanics.assembly import Assembly, Floats, Loads
from sidmacib.mechanics.contact_law import ContactLaw, NodeState
from sidmacib.mechanics.contact_law.kernels import utilisation
from sidmacib.mechanics.equilibrium import free_rows, row_units
from sidmacib.mechanics.optimisation import equilibrium_matrix, solve

ROUNDS = 200
LEAST_BOUND = 1e-6  # of friction, over a node's share of the load: solvers need an interior


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
    `sidmacib.errors.CapacityError` where no forces balance the loads or the friction bounds do not
    settle.
    """
    contact_law, rows = ContactLaw.of(assembly), free_rows(assembly)
    dry = np.flatnonzero(~contact_law.cohesive)
    # In units of each node's share, by area, of the load; moments over the assembly's length.
    size = row_units(assembly)
    target = (loads.permanent + load * loads.variable).ravel()[rows] / size
    largest = float(np.abs(target).max())
    share = assembly.nodes.area / assembly.nodes.area.sum()
    unit = largest * share
    matrix = equilibrium_matrix(assembly)[rows].toarray() / size[:, None] * np.repeat(share, 3)

    force, bound = cp.Variable((len(share), 3)), cp.Parameter(len(dry), nonneg=True)
    stiffness = np.column_stack(
        [contact_law.normal_stiffness, contact_law.shear_stiffness, contact_law.shear_stiffness]
    )
    softness = share[:, None] ** 2 / stiffness
    weight = np.sqrt(softness / softness.sum() * 3.0)
    energy = cp.sum_squares(cp.multiply(weight, force))
    shear = cp.norm(force[dry, 1:], 2, axis=1)
    balanced = [
        csr_array(matrix) @ cp.vec(force, order="C") == target / largest,
        force[dry, 0] >= 0,
    ]
    what = f"least complementary energy at {load:g} N"
    cone = shear <= cp.multiply(contact_law.friction[dry], force[dry, 0])
    solve(cp.Problem(cp.Minimize(energy), [*balanced, cone]), what)
    if rule is FrictionRule.ASSOCIATED:
        return unit[:, None] * np.array(force.value)
    problem = cp.Problem(cp.Minimize(energy), [*balanced, shear <= bound])
    before = np.full(len(dry), np.inf)
    for count in range(ROUNDS):
        after = contact_law.friction[dry] * np.maximum(force.value[dry, 0], LEAST_BOUND)
        if (np.abs(after - before) * share[dry]).max(initial=0.0) <= tolerance:
            return unit[:, None] * np.array(force.value)
        # Half way only after some rounds, against going round in circles.
        before = after if count < 10 else (before + after) / 2
        bound.value = before
        solve(problem, what)
    raise SolverError(f"{what}: the friction bounds do not settle in {ROUNDS} rounds")


def first_failure_load(assembly: Assembly, loads: Loads, rule: FrictionRule) -> float:
    """Load (N) at which the first bonded node reaches its strength, to 0.01 %.

    Utilisation is all but proportional to the load, so the load over its utilisation settles.
    """
    contact_law = ContactLaw.of(assembly)
    state = NodeState.initial(contact_law)
    load = 0.1 * loads.scale
    for _ in range(50):
        used = utilisation(
            contact_law, state, least_energy_forces(assembly, loads, load, rule)
        ).max()
        if abs(used - 1.0) <= 1e-4:
            return load
        load /= float(used)
    raise SolverError(f"the first failure does not settle at {load:g} N")
