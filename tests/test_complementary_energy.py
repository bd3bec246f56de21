"""The least complementary energy: theory, the other formulation, and verdicts."""

import math

import pytest
from complementary_energy import FrictionRule, first_failure_load, least_energy_forces
from conftest import block_on_ground, load_on_block

from sidmacib.errors import InfeasibleError
from sidmacib.joint import Direction, Joint
from sidmacib.joint.loading import Loading, lateral_load
from sidmacib.joint.pieces import assemble
from sidmacib.mechanics.assembly import Kind, NodeLayout
from sidmacib.mechanics.contact_law import NodeState
from sidmacib.mechanics.rigid import RigidSolver
from sidmacib.mechanics.static import static_peak


@pytest.mark.parametrize("locks", [3, 4])
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


def test_associated_friction_overestimates(joint: Joint) -> None:
    model = assemble(joint, 0.03, NodeLayout.CENTRES)
    loads = lateral_load(joint, model, Loading(Direction(0.0)))
    coulomb, associated = (first_failure_load(model, loads, rule) for rule in FrictionRule)
    path = static_peak(model, loads)
    assert coulomb == pytest.approx(path.first_failure_load, rel=0.01)  # but for its history
    assert associated > 1.02 * coulomb


def test_loads_that_nothing_balances_are_an_error_that_names_the_load(joint: Joint) -> None:
    model = block_on_ground(joint, Kind.DRY, 0.02)
    with pytest.raises(InfeasibleError, match=r"^least complementary energy at 100 N: no forces"):
        least_energy_forces(model, load_on_block(model, (0.0, 0.0, 1.0), 0.0), 100.0)
