"""Where Newton's method gives up: rounds of given friction limits find equilibrium, or end soon."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from conftest import block_on_ground, load_on_block
from hypothesis import given, settings
from hypothesis import strategies as st

from sidmacib.errors import NoEquilibriumError
from sidmacib.joint import Direction, HoldDown, Joint, UpperBody
from sidmacib.joint.loading import Loading, Push, lateral_load
from sidmacib.joint.pieces import assemble
from sidmacib.mechanics.assembly import Assembly, FaceMaterial, Kind, Loads, NodeLayout
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.contact_law.kernels import utilisation
from sidmacib.mechanics.equilibrium import free_rows, row_units
from sidmacib.mechanics.newton import friction_rounds
from sidmacib.mechanics.newton.friction_rounds import EquilibriumSearch
from sidmacib.mechanics.optimisation import equilibrium_matrix
from sidmacib.mechanics.rigid import RigidSolver
from sidmacib.mechanics.solution import Equilibrium, FirstFailure, Mode
from sidmacib.mechanics.static import static_first_failure, static_peak

# Joint 9783 of a sampling of 13,312 joints: rough locks, soft roots, stiff dry faces.
ROUGH = Joint(
    16,
    a=0.066531,
    h=0.0294074,
    H=0.0159384,
    inner=FaceMaterial(1e10, 5.1013e7, 0.0, 8e4, 3.7e5),
    dry=FaceMaterial(1.504817e11, 1.504817e11, 0.61608, 0.0, 0.0),
    upper_body=UpperBody.MONOLITHIC,
)
# Its weight opens and closes nodes in turn.
SOUND = Joint(
    12,
    a=0.31102,
    b=0.37215,
    h=0.04653,
    H=0.22903,
    density=910.3,
    inner=FaceMaterial(1e10, 4.532e8, 0.0, 8e4, 6.911e5),
    dry=FaceMaterial(4.746e10, 1.935e11, 0.01096, 0.0, 0.0),
    upper_body=UpperBody.MONOLITHIC,
)


def loaded(
    joint: Joint,
    e_over_a: float,
    mesh: float,
    push: Push = Push.MINUS_Y,
    layout: NodeLayout = NodeLayout.VERTICES,
) -> tuple[Assembly, Loads]:
    model = assemble(joint, mesh, layout)
    return model, lateral_load(joint, model, Loading(Direction(e_over_a), push=push))


def require_equilibrium(model: Assembly, loads: Loads, point: Equilibrium) -> None:
    """The point's forces balance the loads, and no node carries what it cannot.

    Uses nothing of the solver: the equilibrium matrix, and the contact law as inequalities.
    """
    rows, size = free_rows(model), row_units(model)
    target = ((loads.permanent + point.load * loads.variable).ravel())[rows] / size
    carried = (equilibrium_matrix(model) @ point.force.ravel())[rows] / size
    assert np.abs(carried - target).max() <= 1e-9 * np.abs(target).max()
    contact_law, dry = ContactLaw.of(model), ~point.state.bonded
    normal, shear = point.force[:, 0], np.hypot(point.force[:, 1], point.force[:, 2])
    assert (normal[dry] >= 0.0).all()
    assert (shear[dry] <= contact_law.friction[dry] * normal[dry] * (1.0 + 1e-9)).all()
    assert utilisation(contact_law, point.state, point.force).max() <= 1.0 + 1e-9


def first_failure(model: Assembly, loads: Loads) -> FirstFailure:
    found = static_first_failure(model, loads, increment=0.1)  # halved, they take ten times as long
    require_equilibrium(model, loads, found.point)
    return found


@pytest.mark.parametrize("layout", NodeLayout)
def test_rough_locks_in_torsion_carry_until_a_bond_fails(layout: NodeLayout) -> None:
    model, loads = loaded(ROUGH, math.inf, 0.033, layout=layout)
    found = first_failure(model, loads)
    assert found.mode is Mode.BONDS
    # Four nodes on a lock, at cells' centres, miss the corners.
    least, most = (12.0, 12.6) if layout is not NodeLayout.CENTRES else (14.0, 18.0)
    assert least < found.point.load / ROUGH.T0 < most


@pytest.mark.study
def test_a_finer_path_on_which_the_solver_gives_up_is_not_taken() -> None:
    model, loads = loaded(ROUGH, math.inf, 0.033, layout=NodeLayout.CENTRES)
    found = static_first_failure(model, loads)
    assert found.mode is Mode.BONDS
    assert 14.0 < found.point.load / ROUGH.T0 < 18.0


def test_a_sound_joint_stands_under_its_own_weight() -> None:
    model, loads = loaded(SOUND, 0.4984, 0.15, Push.PLUS_Y, NodeLayout.LOBATTO)
    found = first_failure(model, loads)
    # An independent solver has 20,094 N.
    assert found.point.load == pytest.approx(20_094.0, rel=2e-3)
    assert found.mode is Mode.BONDS


def test_a_joint_without_weight_carries_what_one_of_next_to_none_does() -> None:
    joint = Joint(3, density=0.0, hold_down=HoldDown.weight())
    found, light = (
        first_failure(*loaded(each, math.inf, 0.02, Push.PLUS_Y))
        for each in (joint, replace(joint, density=1e-6))
    )
    assert found.point.load == pytest.approx(light.point.load, rel=1e-6)
    assert found.mode is light.mode is Mode.BONDS


@settings(max_examples=3)
@given(st.integers(9, 14), st.floats(0.3, 0.8), st.floats(0.002, 0.02))
def test_every_equilibrium_of_rough_locks_obeys_the_law(
    locks: int, friction: float, shear: float
) -> None:
    inner = replace(ROUGH.inner, shear_stiffness=1e10 * shear)
    joint = replace(ROUGH, locks=locks, inner=inner, dry=replace(ROUGH.dry, friction=friction))
    model, loads = loaded(joint, math.inf, 0.033)
    found = static_peak(model, loads)
    for point in found.path:
        require_equilibrium(model, loads, point)
    assert found.path[0].load == 0.0


@pytest.mark.parametrize(
    ("force", "rounds"),
    [((0.0, 1.0, 0.0), 1 + 2 * friction_rounds.IN_A_ROW), ((0.0, 0.0, 1.0), 1)],
    ids=["slides", "floats away"],
)
def test_where_pieces_move_off_the_search_ends_soon(
    joint: Joint,
    force: tuple[float, float, float],
    rounds: int,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    model = block_on_ground(joint, Kind.DRY, 0.02)
    loads, counted = load_on_block(model, force, 0.0), []
    plain = EquilibriumSearch.with_given_limits

    def counting(*given: Any) -> bool:
        counted.append(given)
        return plain(*given)

    monkeypatch.setattr(EquilibriumSearch, "with_given_limits", counting)
    solver = RigidSolver(model, loads)
    start = solver.start()
    assert not counted  # Newton's method finds this
    with pytest.raises(NoEquilibriumError, match="no equilibrium at 100 N"):
        solver.solve(100.0, start.unknowns, start.state, thorough=True)
    assert 0 < len(counted) <= rounds
