"""Equilibrium matrices, their scales, and the nodes of an assembly as springs between pieces."""

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import block_on_ground, load_on_block
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from joints import sawn
from stack import tilted_stack

from sidmacib import Assembly, FaceMaterial, Loads, NodeLayout, UpperBody, assemble
from sidmacib.joint import DRY, Joint
from sidmacib.mechanics.assembly import Cuboid, Floats, Kind, Rectangle
from sidmacib.mechanics.contact_law import ContactLaw, NodeState, components
from sidmacib.mechanics.contact_nodes import contact_nodes
from sidmacib.mechanics.equilibrium import (
    compliance,
    equilibrium_matrix,
    free_rows,
    natural_frequencies,
    wrenches,
)
from sidmacib.mechanics.newton import put_at
from sidmacib.mechanics.newton.faces import Applied, ContactFaces, Point, new_point, put_slips
from sidmacib.mechanics.newton.linear import solve_linear
from sidmacib.mechanics.newton.stiffness import tangent_stiffness
from sidmacib.mechanics.ordering import ordering
from sidmacib.mechanics.rigid import RigidSolver

vectors = arrays(float, 3, elements=st.floats(-10, 10))


@given(vectors, vectors)
def test_a_wrench_is_the_force_and_its_moment(point: np.ndarray, about: np.ndarray) -> None:
    found = wrenches(point[None], np.eye(3)[None], about)
    for axis, unit in enumerate(np.eye(3)):
        assert found[:3, axis] == pytest.approx(unit)
        assert found[3:, axis] == pytest.approx(np.cross(point - about, unit))


def test_every_node_force_acts_on_two_pieces_in_balance(joint: Joint) -> None:
    model = assemble(joint, 0.02, NodeLayout.CENTRES)
    matrix = equilibrium_matrix(model).toarray().reshape(len(model.pieces), 6, -1)
    centres = np.array([piece.centre for piece in model.pieces])
    forces, moments = matrix[:, :3], matrix[:, 3:]
    about_origin = moments + np.cross(centres[:, :, None], forces, axis=1)
    assert forces.sum(axis=0) == pytest.approx(0.0)
    assert about_origin.sum(axis=0) == pytest.approx(0.0)


def test_a_block_rocks_at_the_frequency_of_its_inertia() -> None:
    # A cube's inertia is m l^2 / 6 about any axis; a face in its middle plane decouples the modes.
    side, stiffness, density = 0.2, 1e9, 2000.0
    half = side / 2
    mass = density * side**3
    pieces = (
        Cuboid("ground", (-half, -half, -side), (half, half, 0.0), mass, fixed=True),
        Cuboid("cube", (-half, -half, -half), (half, half, half), mass),
    )
    material = FaceMaterial(stiffness, stiffness, 0.0, 0.0, 0.0)
    face = Rectangle("middle", Kind.DRY, material, 0, 1, 2, (-half, -half, 0.0), (half, half, 0.0))
    cube = Assembly(pieces, (face,), contact_nodes((face,), side / 40, NodeLayout.CENTRES), side)
    around = np.sqrt(stiffness * side**4 / 12 / (mass * side**2 / 6))  # second moment of area
    twist = np.sqrt(2.0) * around  # polar moment
    straight = np.sqrt(stiffness * side**2 / mass)
    expected = sorted([around, around, twist, straight, straight, straight])
    assert natural_frequencies(cube) == pytest.approx(expected, rel=1e-3)  # finite cells


def test_compliance_of_a_block_under_torque_is_that_of_its_polar_moment(joint: Joint) -> None:
    model = block_on_ground(joint, Kind.INNER, mesh=0.01)
    xy = model.nodes.position[:, :2] - model.pieces[1].centre[:2]
    polar = float(model.nodes.area @ (xy**2).sum(axis=1))
    found = compliance(model, load_on_block(model, (0.0, 0.0, 0.0), 1.0))
    assert found == pytest.approx(1.0 / (joint.inner.shear_stiffness * polar))


ASSEMBLIES = {
    "columns": assemble(sawn(4), 0.03, NodeLayout.CENTRES),
    "monolithic": assemble(sawn(5, upper_body=UpperBody.MONOLITHIC), 0.03, NodeLayout.CENTRES),
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


def point_at(contacts: ContactFaces, slip: Floats, whole: Floats, unknowns: Floats) -> Point:
    """What ``unknowns`` of compiled ``contacts`` make of its nodes, without other forces."""
    here = new_point(contacts)
    put_at(contacts, slip, whole, unloaded(here), here, unknowns)
    return here


def unloaded(here: Point) -> Applied:
    """No loads on the pieces."""
    return Applied(np.zeros_like(here.unknowns), np.zeros_like(here.turn))


def test_the_stiffness_is_the_derivative_of_the_unbalanced_forces(model: Assembly) -> None:
    rigid_solver = solver(model)
    unknowns, state = some_state(model)
    contacts, nodes = rigid_solver.contacts, (components(state.slip), state.whole)
    here = point_at(contacts, *nodes, unknowns)
    tangent_stiffness(contacts, *nodes, unloaded(here), here, 0.0, rigid_solver.matrix, 1.0)
    direction = np.random.default_rng(2).normal(size=len(unknowns))
    ends = (unknowns + step * direction for step in (1e-12, -1e-12))
    after, before = (point_at(contacts, *nodes, end).residual for end in ends)
    expected = dense(rigid_solver) @ direction
    found = (before - after) / 2e-12
    assert found == pytest.approx(expected, abs=1e-4 * np.abs(expected).max())


def test_slip_is_what_the_springs_do_not_take(model: Assembly) -> None:
    rigid_solver = solver(model)
    unknowns, state = some_state(model)
    contacts, whole, before = rigid_solver.contacts, state.whole, components(state.slip)
    here = point_at(contacts, before, whole, unknowns)
    slip, same = np.empty_like(before), np.empty_like(before)
    put_slips(contacts, before, whole, here, slip)
    again = point_at(contacts, slip, whole, unknowns)
    assert again.force == pytest.approx(here.force, rel=1e-9, abs=1e-9)
    put_slips(contacts, slip, whole, again, same)
    assert same == pytest.approx(slip, rel=1e-9, abs=1e-18)
    assert (slip[:, state.bonded] == before[:, state.bonded]).all()


@pytest.mark.parametrize("seed", range(2))
def test_linear_equations_are_solved_with_row_exchanges(model: Assembly, seed: int) -> None:
    rigid_solver, random = solver(model), np.random.default_rng(seed)
    matrix, band = rigid_solver.matrix, rigid_solver.contacts.band
    for part in (matrix.band, matrix.right, matrix.below):
        part[:] = random.normal(size=part.shape)
    matrix.band[:, 2 * band + 1 :] = 0.0  # filled by elimination
    matrix.band[::3, band] = 0.0  # small pivots, unless rows are exchanged
    full, right = dense(rigid_solver), random.normal(size=len(rigid_solver.place))
    solution = right.copy()
    assert solve_linear(rigid_solver.contacts, matrix, solution)
    assert full @ solution == pytest.approx(right, rel=1e-7, abs=1e-7)


def test_equations_without_a_solution_are_reported(model: Assembly) -> None:
    rigid_solver = solver(model)
    contacts, matrix = rigid_solver.contacts, rigid_solver.matrix
    for part in (matrix.band, matrix.right, matrix.below):
        part[:] = 0.0
    assert not solve_linear(contacts, matrix, np.ones(len(rigid_solver.place)))
    matrix.band[:, contacts.band] = 1.0
    solved = solve_linear(contacts, matrix, np.ones(len(rigid_solver.place)))
    assert solved is (contacts.outer == 0)


def test_the_band_does_not_grow_with_the_locks_as_a_body_in_one_piece_is_in_its_border() -> None:
    for locks in (7, 31):
        order = ordering(assemble(sawn(locks, upper_body=UpperBody.MONOLITHIC), 0.03))
        assert (order.inner, order.outer, order.band) == (6 * locks, 6, 11)
    few, many = (ordering(assemble(sawn(n), 0.03)) for n in (7, 31))
    assert (many.band, many.outer) == (few.band, 0)


# --- what an assembly refuses --------------------------------------------------------------------
NONE = math.nan, math.inf, -math.inf


@pytest.mark.parametrize(
    ("name", "value"),
    [
        *((name, value) for name in vars(DRY) for value in (*NONE, -1.0)),
        *(("normal_stiffness", 0.0), ("shear_stiffness", 0.0)),
    ],
)
def test_a_material_has_stiffness_and_nothing_negative_or_infinite(name: str, value: float) -> None:
    with pytest.raises(ValueError, match=f"{name}: {value}"):
        replace(DRY, **{name: value})


def test_nodes_stand_face_by_face(joint: Joint) -> None:
    nodes = block_on_ground(joint, Kind.DRY, 0.02).nodes
    with pytest.raises(ValueError, match="in the order of their faces"):
        replace(nodes, face=np.arange(len(nodes.face))[::-1])


@pytest.mark.parametrize("value", [*NONE, -1.0, 0.0])
def test_sizes_masses_scales_and_loads_are_numbers(joint: Joint, value: float) -> None:
    model = block_on_ground(joint, Kind.DRY, 0.02)
    loads, piece = load_on_block(model, (0.0, 1.0, 0.0), 0.0), model.pieces[1]
    refused = [
        (model, {"length": value}, f"length: {value} is"),
        (loads, {"scale": value}, f"scale: {value} is"),
        (model.nodes, {"area": model.nodes.area * value}, "areas"),
    ]
    if value:  # a piece may have no mass, and begins at 0
        refused.append((piece, {"mass": value}, f"block, mass .*: {value} is"))
        refused.append((piece, {"high": (value, 1.0, 1.0)}, "block, edge x"))
    if not math.isfinite(value):
        given = np.full((2, 6), value)
        refused += [(loads, {n: given}, f"{n} loads") for n in ("permanent", "variable")]
    for whole, change, words in refused:
        with pytest.raises(ValueError, match=words):
            replace(whole, **change)
