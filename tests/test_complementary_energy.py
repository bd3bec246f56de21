"""The least complementary energy: another formulation of the same equilibria of joints."""

import math
from dataclasses import replace

import cvxpy as cp
import numpy as np
import pytest
from joints import loaded, sawn
from scipy.sparse import csr_array

from sidmacib import SolverError, static_peak
from sidmacib.joint import DRY, INNER
from sidmacib.mechanics.assembly import Assembly, Floats
from sidmacib.mechanics.contact_law import ContactLaw, NodeState
from sidmacib.mechanics.equilibrium import equilibrium_matrix, free_rows, row_units
from sidmacib.mechanics.loads import Loads
from sidmacib.mechanics.optimisation import solve
from sidmacib.mechanics.rigid import RigidSolver

ROUNDS = 200
TOLERANCE = 1e-6  # of the last change of the friction bounds, over the load
LEAST_BOUND = 1e-6  # of friction, over a node's share of the load: solvers need an interior


def least_energy_forces(assembly: Assembly, loads: Loads, load: float) -> Floats:
    """Node forces (N), shape (N, 3), under ``load`` times ``loads`` and self-weight.

    No bond may fail. Raises `sidmacib.errors.SolverError` where friction bounds do not settle.
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
    equal = csr_array(matrix) @ cp.vec(force, order="C") == target / largest
    balanced = [equal, force[dry, 0] >= 0]
    what = f"least complementary energy at {load:g} N"
    cone = shear <= cp.multiply(contact_law.friction[dry], force[dry, 0])
    solve(cp.Problem(cp.Minimize(energy), [*balanced, cone]), what)
    problem = cp.Problem(cp.Minimize(energy), [*balanced, shear <= bound])
    before = np.full(len(dry), np.inf)
    for count in range(ROUNDS):
        after = contact_law.friction[dry] * np.maximum(force.value[dry, 0], LEAST_BOUND)
        if (np.abs(after - before) * share[dry]).max(initial=0.0) <= TOLERANCE:
            return unit[:, None] * np.array(force.value)
        # Half way only after some rounds, against going round in circles.
        before = after if count < 10 else (before + after) / 2
        bound.value = before
        solve(problem, what)
    raise SolverError(f"{what}: the friction bounds do not settle in {ROUNDS} rounds")


@pytest.mark.parametrize("locks", [3, 4])
@pytest.mark.parametrize("eccentricity", [0.0, 0.5, math.inf])
def test_newton_and_least_complementary_energy_agree(locks: int, eccentricity: float) -> None:
    stiff = {"normal_stiffness": 1e15, "shear_stiffness": 1e15}  # the programme moves nothing
    joint = sawn(locks, inner=replace(INNER, **stiff), dry=replace(DRY, **stiff))
    model, loads = loaded(joint, eccentricity)
    path = static_peak(model, loads).path
    load = 0.6 * path[-1].load
    solver = RigidSolver(model, loads)
    nearest = min(path, key=lambda point: abs(point.load - load))
    # In one step, as the programme.
    initial = NodeState.initial(solver.contact_law.cohesive)
    newton = solver.solve(load, nearest.unknowns, initial).force
    programme = least_energy_forces(model, loads, load)
    assert programme == pytest.approx(newton, abs=3e-6 * load)
