"""The least complementary energy: theory, the other formulation, and verdicts."""

import math
from dataclasses import replace

import numpy as np
import pytest
from complementary_energy import FrictionRule, first_failure_load, least_energy_forces
from conftest import block_on_ground, load_on_block
from hypothesis import given, settings
from hypothesis import strategies as st

from sidmacib.errors import InfeasibleError
from sidmacib.joint.joint import Direction, Joint
from sidmacib.joint.loading import Loading, lateral_load
from sidmacib.joint.pieces import assemble
from sidmacib.mechanics.assembly import Kind, NodeLayout
from sidmacib.mechanics.contact_law import NodeState
from sidmacib.mechanics.equilibrium import free_rows
from sidmacib.mechanics.equilibrium_matrix import equilibrium_matrix
from sidmacib.mechanics.rigid.solver import RigidSolver
from sidmacib.mechanics.static.model import static_peak


@pytest.mark.parametrize("locks", [3, 4, 5])
@pytest.mark.parametrize("eccentricity", [0.0, 0.5, math.inf])
def test_newton_and_least_complementary_energy_agree(locks: int, eccentricity: float) -> None:
    joint = Joint(locks)
    model = assemble(joint, 0.03, NodeLayout.CENTRES)
    loads = lateral_load(joint, model, Loading(Direction(eccentricity)))
    path = static_peak(model, loads).path
    load = 0.6 * path[-1].load
    solver = RigidSolver(model, loads)
    nearest = min(path, key=lambda point: abs(point.load - load))
    # In one step, as the programme.
    initial = NodeState.initial(solver.contact_law)
    newton = solver.solve(load, nearest.unknowns, initial).force
    programme = least_energy_forces(model, loads, load)
    assert programme == pytest.approx(newton, abs=3e-6 * load)


@pytest.mark.parametrize("rule", FrictionRule)
@pytest.mark.parametrize("eccentricity", [0.0, 0.5, math.inf])
def test_the_forces_balance_every_piece_and_keep_the_law_of_dry_nodes(
    joint: Joint, rule: FrictionRule, eccentricity: float
) -> None:
    model = assemble(joint, 0.03, NodeLayout.CENTRES)
    loads = lateral_load(joint, model, Loading(Direction(eccentricity)))
    force = least_energy_forces(model, loads, 50.0, rule)
    target = (loads.permanent + 50.0 * loads.variable).ravel()
    residual = (equilibrium_matrix(model) @ force.ravel() - target)[free_rows(model)]
    assert np.abs(residual).max() <= 1e-8 * 50.0
    kinds = np.array([face.kind for face in model.faces])[model.nodes.face]
    assert (force[kinds != Kind.INNER, 0] >= -1e-6).all()
    dry = force[kinds == Kind.DRY]
    assert (np.hypot(dry[:, 1], dry[:, 2]) <= 0.3 * dry[:, 0] + 1e-4).all()
    assert np.abs(force[kinds == Kind.PLATE, 1:]).max() <= 1e-4


def test_a_face_under_a_torque_carries_shear_in_proportion_to_the_arm(joint: Joint) -> None:
    model = block_on_ground(joint, Kind.INNER, 0.02)
    force = least_energy_forces(model, load_on_block(model, (0.0, 0.0, 0.0), 1.0), 2.0)
    arm = model.nodes.position[:, :2] - model.pieces[1].centre[:2]
    expected = 2.0 * arm / (arm**2).sum()  # equal areas; against the torque
    assert force[:, 1] == pytest.approx(expected[:, 1], abs=1e-5)
    assert force[:, 2] == pytest.approx(-expected[:, 0], abs=1e-5)


def test_associated_friction_overestimates(joint: Joint) -> None:
    model = assemble(joint, 0.03, NodeLayout.CENTRES)
    loads = lateral_load(joint, model, Loading(Direction(0.0)))
    coulomb, associated = (first_failure_load(model, loads, rule) for rule in FrictionRule)
    path = static_peak(model, loads)
    assert coulomb == pytest.approx(path.first_failure_load, rel=0.01)  # but for its history
    assert associated > 1.02 * coulomb


@settings(max_examples=15)
@given(
    st.floats(-6, 6).map(lambda power: 10**power),
    st.floats(-6, 6).map(lambda power: 10**power),
    st.one_of(st.floats(0.0, 3.0), st.just(math.inf)),
)
def test_forces_scale_with_lengths_and_stresses_over_twelve_orders_of_magnitude(
    length: float, stress: float, eccentricity: float
) -> None:
    joint, factor = Joint(3), stress * length**2
    scaled = replace(
        joint,
        **{name: length * getattr(joint, name) for name in ("a", "b", "h", "H")},
        density=stress / length * joint.density,
    )

    def forces(joint: Joint, mesh: float, load: float) -> np.ndarray:
        model = assemble(joint, mesh, NodeLayout.CENTRES)
        loads = lateral_load(joint, model, Loading(Direction(eccentricity)))
        return least_energy_forces(model, loads, load)

    one, other = forces(joint, 0.03, 50.0), forces(scaled, 0.03 * length, 50.0 * factor)
    assert other / factor == pytest.approx(one, abs=1e-6 * 50.0)


def test_loads_that_nothing_balances_are_an_error_that_names_the_load(joint: Joint) -> None:
    model = block_on_ground(joint, Kind.DRY, 0.02)
    with pytest.raises(InfeasibleError, match=r"^least complementary energy at 100 N: no forces"):
        least_energy_forces(model, load_on_block(model, (0.0, 0.0, 1.0), 0.0), 100.0)
