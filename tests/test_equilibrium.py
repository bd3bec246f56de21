"""Equilibrium matrices and the scales derived from them."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import block_on_ground, load_on_block
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from sidmacib.joint import Joint
from sidmacib.joint.pieces import assemble
from sidmacib.mechanics.assembly import (
    Assembly,
    Cuboid,
    FaceMaterial,
    Kind,
    NodeLayout,
    Rectangle,
)
from sidmacib.mechanics.contact_nodes import contact_nodes
from sidmacib.mechanics.equilibrium import wrenches
from sidmacib.mechanics.optimisation import equilibrium_matrix
from sidmacib.mechanics.springs import compliance, natural_frequencies

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


def test_a_rigid_motion_of_all_pieces_moves_no_node(joint: Joint) -> None:
    model = assemble(joint, 0.02, NodeLayout.CENTRES)
    shift, turn = np.array([1.0, -2.0, 0.5]), np.array([0.3, 0.1, -0.7])
    motion = np.concatenate(
        [np.concatenate([shift + np.cross(turn, p.centre), turn]) for p in model.pieces]
    )
    assert equilibrium_matrix(model).T @ motion == pytest.approx(0.0, abs=1e-12)


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


def test_inertia_is_that_of_a_cuboid() -> None:
    # By points all over it: the integral of m (x^2 + y^2) / volume, and so on.
    piece = Cuboid("block", (0.0, 1.0, -2.0), (0.3, 1.5, -1.2), mass=7.0)
    axes = [
        low + (np.arange(60) + 0.5) / 60 * d for low, d in zip(piece.low, piece.size, strict=True)
    ]
    squares = [np.mean((axis - axis.mean()) ** 2) for axis in axes]
    expected = [7.0 * (sum(squares) - square) for square in squares]
    assert piece.inertia == pytest.approx(expected, rel=1e-3)


def test_frequencies_do_not_depend_on_the_length_that_measures_rotations(joint: Joint) -> None:
    model = assemble(joint, 0.03, NodeLayout.CENTRES)
    other = replace(model, length=37.0 * model.length)
    assert natural_frequencies(other) == pytest.approx(natural_frequencies(model), rel=1e-9)


def test_compliance_of_a_block_under_torque_is_that_of_its_polar_moment(joint: Joint) -> None:
    model = block_on_ground(joint, Kind.INNER, mesh=0.01)
    xy = model.nodes.position[:, :2] - model.pieces[1].centre[:2]
    polar = float(model.nodes.area @ (xy**2).sum(axis=1))
    found = compliance(model, load_on_block(model, (0.0, 0.0, 0.0), 1.0))
    assert found == pytest.approx(1.0 / (joint.inner.shear_stiffness * polar))
