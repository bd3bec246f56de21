"""The assembly's nodes as springs between its pieces."""

import numpy as np
import pytest
from conftest import point_at
from stack import tilted_stack

from sidmacib.joint import Joint, UpperBody
from sidmacib.joint.pieces import assemble
from sidmacib.mechanics.assembly import Assembly, Loads, NodeLayout
from sidmacib.mechanics.contact_law import ContactLaw, NodeState, components
from sidmacib.mechanics.contact_law.kernels import put_slip
from sidmacib.mechanics.equilibrium import free_rows
from sidmacib.mechanics.newton.equilibrium import solve_linear
from sidmacib.mechanics.newton.faces import tangent_stiffness
from sidmacib.mechanics.optimisation import equilibrium_matrix
from sidmacib.mechanics.rigid import RigidSolver, ordering
from sidmacib.mechanics.springs import Springs

ASSEMBLIES = {
    "columns": assemble(Joint(4), 0.03, NodeLayout.CENTRES),
    "monolithic": assemble(Joint(5, upper_body=UpperBody.MONOLITHIC), 0.03, NodeLayout.CENTRES),
    "stack": tilted_stack(3)[0],
}


@pytest.fixture(params=ASSEMBLIES)
def model(request: pytest.FixtureRequest) -> Assembly:
    return ASSEMBLIES[request.param]


def solver(model: Assembly) -> RigidSolver:
    none = np.zeros((len(model.pieces), 6))
    return RigidSolver(model, Loads(none, none + 1.0, 1.0))


def dense(solver: RigidSolver) -> np.ndarray:
    """The solver's matrix, with rows and columns in the order of the solver."""
    inner, outer, band = solver.contacts.inner, solver.contacts.outer, solver.contacts.band
    full = np.zeros((inner + outer, inner + outer))
    for i in range(inner):
        first, last = max(i - band, 0), min(i + band, inner - 1)
        full[i, first : last + 1] = solver.matrix.band[i, band + first - i : band + last - i + 1]
    full[:inner, inner:], full[inner:] = solver.matrix.right, solver.matrix.below
    return full


def some_state(model: Assembly, seed: int = 1) -> tuple[np.ndarray, NodeState]:
    """Displacements (m) under which nodes stick, slide and open; bonds broken, faded and whole."""
    random, contact_law = np.random.default_rng(seed), ContactLaw.of(model)
    slip = 1e-7 * random.normal(size=(len(contact_law.friction), 2))
    whole = contact_law.cohesive * random.choice([0.0, 0.0, 0.4, 1.0], len(slip))
    return 1e-6 * random.normal(size=len(free_rows(model))), NodeState(slip, whole)


def test_the_stiffness_is_that_of_the_equilibrium_matrix(model: Assembly) -> None:
    balance, contact_law, springs = (
        equilibrium_matrix(model).toarray(),
        ContactLaw.of(model),
        Springs.of(model),
    )
    balance = balance[free_rows(model)] / springs.units[:, None]
    stiffness = np.column_stack(
        [contact_law.normal_stiffness, contact_law.shear_stiffness, contact_law.shear_stiffness]
    )
    expected = (balance * stiffness.ravel()) @ balance.T
    assert springs.elastic_stiffness() == pytest.approx(expected, rel=1e-9, abs=1e-6)


def test_the_compiled_stiffness_of_bonded_nodes_is_the_elastic_one(model: Assembly) -> None:
    rigid_solver = solver(model)
    unknowns, state = some_state(model)
    contacts, whole = rigid_solver.contacts, np.ones_like(state.whole)
    slip = components(state.slip)
    here = point_at(contacts, slip, whole, unknowns)
    tangent_stiffness(contacts, slip, whole, here, 0.0, rigid_solver.matrix)
    expected = Springs.of(model).elastic_stiffness()
    assert dense(rigid_solver)[np.ix_(rigid_solver.place, rigid_solver.place)] == pytest.approx(
        expected, rel=1e-9, abs=1e-5
    )


def test_unbalanced_forces_are_those_of_the_equilibrium_matrix(model: Assembly) -> None:
    rigid_solver = solver(model)
    unknowns, state = some_state(model)
    here = point_at(rigid_solver.contacts, components(state.slip), state.whole, unknowns)
    inside = (equilibrium_matrix(model) @ here.force.T.ravel())[free_rows(model)]
    expected = inside / rigid_solver.units
    assert -here.residual[rigid_solver.place] == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_the_stiffness_is_the_derivative_of_the_unbalanced_forces(model: Assembly) -> None:
    rigid_solver = solver(model)
    unknowns, state = some_state(model)
    contacts, nodes = rigid_solver.contacts, (components(state.slip), state.whole)
    here = point_at(contacts, *nodes, unknowns)
    tangent_stiffness(contacts, *nodes, here, 0.0, rigid_solver.matrix)
    direction = np.random.default_rng(2).normal(size=len(unknowns))
    after, before = (
        point_at(contacts, *nodes, unknowns + step * direction).residual for step in (1e-12, -1e-12)
    )
    expected = dense(rigid_solver) @ direction
    found = (before - after) / 2e-12
    assert found == pytest.approx(expected, abs=1e-4 * np.abs(expected).max())


def test_slip_is_what_the_springs_do_not_take(model: Assembly) -> None:
    rigid_solver = solver(model)
    unknowns, state = some_state(model)
    contacts, whole, before = rigid_solver.contacts, state.whole, components(state.slip)
    here = point_at(contacts, before, whole, unknowns)
    slip, same = np.empty_like(before), np.empty_like(before)
    put_slip(contacts.law, before, whole, here.moved, here.force, slip)
    again = point_at(contacts, slip, whole, unknowns)
    assert again.force == pytest.approx(here.force, rel=1e-9, abs=1e-9)
    put_slip(contacts.law, slip, whole, again.moved, again.force, same)
    assert same == pytest.approx(slip, rel=1e-9, abs=1e-18)
    assert (slip[:, state.bonded] == before[:, state.bonded]).all()


@pytest.mark.parametrize("seed", range(2))
def test_linear_equations_are_solved_with_row_exchanges(model: Assembly, seed: int) -> None:
    rigid_solver, random = solver(model), np.random.default_rng(seed)
    rigid_solver.matrix.band[:] = random.normal(size=rigid_solver.matrix.band.shape)
    rigid_solver.matrix.band[:, 2 * rigid_solver.contacts.band + 1 :] = 0.0  # filled by elimination
    rigid_solver.matrix.right[:] = random.normal(size=rigid_solver.matrix.right.shape)
    rigid_solver.matrix.below[:] = random.normal(size=rigid_solver.matrix.below.shape)
    rigid_solver.matrix.band[::3, rigid_solver.contacts.band] = (
        0.0  # small pivots, unless rows are exchanged
    )
    full, right = dense(rigid_solver), random.normal(size=len(rigid_solver.place))
    solution = right.copy()
    assert solve_linear(rigid_solver.contacts, rigid_solver.matrix, solution)
    assert full @ solution == pytest.approx(right, rel=1e-7, abs=1e-7)


def test_equations_without_a_solution_are_reported(model: Assembly) -> None:
    rigid_solver = solver(model)
    for part in (rigid_solver.matrix.band, rigid_solver.matrix.right, rigid_solver.matrix.below):
        part[:] = 0.0
    assert not solve_linear(
        rigid_solver.contacts, rigid_solver.matrix, np.ones(len(rigid_solver.place))
    )
    rigid_solver.matrix.band[:, rigid_solver.contacts.band] = 1.0
    solved = solve_linear(
        rigid_solver.contacts, rigid_solver.matrix, np.ones(len(rigid_solver.place))
    )
    assert solved is (rigid_solver.contacts.outer == 0)


@pytest.mark.parametrize("locks", [7, 31])
def test_a_body_in_one_piece_goes_into_the_border(locks: int) -> None:
    joint = Joint(locks, upper_body=UpperBody.MONOLITHIC)
    order = ordering(Springs.of(assemble(joint, 0.03, NodeLayout.CENTRES)))
    assert (order.inner, order.outer, order.band) == (6 * locks, 6, 11)


def test_columns_make_a_band_that_does_not_grow_with_the_locks() -> None:
    few, many = (
        ordering(Springs.of(assemble(Joint(n), 0.03, NodeLayout.CENTRES))) for n in (7, 31)
    )
    assert few.band == many.band
    assert many.outer == 0
