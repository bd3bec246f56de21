"""Newton's method: derivatives are those of the forces, and equations are solved."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sidmacib.joint import DRY, Direction, Joint, UpperBody
from sidmacib.loading import Loading, lateral_load
from sidmacib.mechanics.newton import (
    Matrix,
    Structure,
    node_force,
    node_laws,
    node_tangent,
    solve_linear,
    tangent_stiffness,
    unbalanced,
)
from sidmacib.mechanics.rigid import RigidSolver
from sidmacib.pieces import assemble

BODIES = [UpperBody.COLUMNS, UpperBody.MONOLITHIC]


def structure_of(inner: int, outer: int, band: int) -> Structure:
    """Of no faces, for equations alone."""
    none = np.zeros(0, dtype=np.int64)
    motion = np.zeros((0, 2, 6, 6))
    return Structure(
        np.zeros((0, 5)),
        np.zeros(1, dtype=np.int64),
        motion,
        none.reshape(0, 2),
        inner,
        outer,
        band,
    )


def dense(structure: Structure, matrix: Matrix) -> np.ndarray:
    """The whole of ``matrix``."""
    inner, width = structure.inner, structure.band
    whole = np.zeros((inner + structure.outer,) * 2)
    for i in range(inner):
        for j in range(max(0, i - width), min(inner, i + width + 1)):
            whole[i, j] = matrix.band[i, width + j - i]
    whole[:inner, inner:] = matrix.right
    whole[inner:] = matrix.below
    return whole


# --- derivatives ---------------------------------------------------------------------------------
@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("locks", [2, 5, 6])
@pytest.mark.parametrize("part", [0.0, 0.4, 1.0])
def test_the_tangent_stiffness_is_the_derivative_of_the_forces(
    locks: int, body: UpperBody, part: float
) -> None:
    joint = Joint(locks, upper_body=body, dry=replace(DRY, friction=0.3))
    assembly = assemble(joint, 0.03)
    solver = RigidSolver(assembly, lateral_load(joint, assembly, Loading(Direction(0.5))))
    random = np.random.default_rng(locks)
    size, count = len(solver.load), len(solver.law.friction)
    unknowns = 1e-6 * random.normal(size=size)
    whole = np.where(random.random(count) < 0.5, part, 0.0)
    slip = 1e-7 * random.normal(size=(count, 2))
    tangent_stiffness(solver.structure, slip, whole, unknowns, 0.0, solver.matrix)
    found = dense(solver.structure, solver.matrix)
    expected = np.empty_like(found)
    step = 1e-12
    for column in range(size):
        sides = []
        for sign in (1.0, -1.0):
            moved, left = unknowns.copy(), np.empty(size)
            moved[column] += sign * step
            unbalanced(solver.structure, slip, whole, moved, np.zeros(size), left)
            sides.append(-left)
        expected[:, column] = (sides[0] - sides[1]) / (2.0 * step)
    assert np.abs(found).max() > 1e4
    assert found == pytest.approx(expected, abs=2e-4 * np.abs(expected).max())


def test_nodes_together_have_the_law_of_each() -> None:
    random = np.random.default_rng(1)
    count = 50
    stiffness, friction = 1e6 * (1.0 + random.random((count, 2))), random.random(count)
    whole = random.choice([0.0, 0.3, 1.0], count)
    moved = 1e-6 * random.normal(size=(count, 3))
    force, tangent = node_laws(stiffness, friction, whole, moved)
    for n in range(count):
        law = (*stiffness[n], friction[n], whole[n], *moved[n])
        assert force[n] == pytest.approx(node_force(*law))
        t00, t10, t20, t11, t12, t22 = node_tangent(*law)
        assert tangent[n] == pytest.approx(
            np.array([[t00, 0.0, 0.0], [t10, t11, t12], [t20, t12, t22]])
        )


# --- linear equations ----------------------------------------------------------------------------
@settings(max_examples=100)
@given(st.integers(1, 12), st.integers(0, 4), st.integers(1, 4), st.integers(0, 10**6))
def test_equations_with_a_band_and_a_border_are_solved(
    inner: int, outer: int, band: int, seed: int
) -> None:
    random = np.random.default_rng(seed)
    structure = structure_of(inner, outer, band)
    matrix = Matrix(
        np.zeros((inner, 3 * band + 1)),
        random.normal(size=(inner, outer)),
        random.normal(size=(outer, inner + outer)),
    )
    for i in range(inner):
        for j in range(max(0, i - band), min(inner, i + band + 1)):
            # Small on the diagonal: rows have to be exchanged.
            matrix.band[i, band + j - i] = random.normal() * (1e-3 if i == j else 1.0)
    whole, right = dense(structure, matrix), random.normal(size=inner + outer)
    found = right.copy()
    # Rows are exchanged within the band and then within the border: that may not be enough.
    inside = np.linalg.cond(whole[:inner, :inner])
    if inside < 1e6 and np.linalg.cond(whole) < 1e6:
        assert solve_linear(structure, matrix, found)
        assert whole @ found == pytest.approx(right, abs=1e-6)


@pytest.mark.parametrize("outer", [0, 2])
def test_equations_without_a_solution_are_told(outer: int) -> None:
    structure = structure_of(3, outer, 1)
    matrix = Matrix(np.zeros((3, 4)), np.zeros((3, outer)), np.zeros((outer, 3 + outer)))
    assert not solve_linear(structure, matrix, np.ones(3 + outer))
    matrix.band[:, 1] = 1.0
    assert solve_linear(structure, matrix, np.ones(3 + outer)) is (outer == 0)
