"""The torque that dry faces carry: that of a linear pressure, not of pressure in their corners."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import shapely
from structures import dry

from sidmacib import NodeLayout, static_peak
from sidmacib.errors import InfeasibleError, UnboundedError
from sidmacib.mechanics.assembly import Vector
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.limit import limit_load, require_standing, solved
from sidmacib.mechanics.polygons import outline_nodes
from sidmacib.mechanics.sliding import sliding_limit
from sidmacib.mechanics.solution import Mode
from sidmacib.mechanics.twist import Pressure, Resultants, linear_pressure
from sidmacib.problem import Problem
from sidmacib.structure.analysis.reserve import geometrical_factor
from sidmacib.structure.blocks import box
from sidmacib.structure.files.structure_file import structure_of
from sidmacib.structure.loads import force_at
from sidmacib.structure.structure import refined, structure

SIDE = 0.3  # m
UNIT = shapely.box(-0.5, -0.5, 0.5, 0.5)
PIER = box("pier", (0.0, 0.0, -1.0), (SIDE, SIDE, 0.0), 2e3, fixed=True)
# Mean distance of the points of a square of side 1 from its centre.
SQUARE = (math.sqrt(2.0) + math.asinh(1.0)) / 6.0


def lintel(at: Vector, shift: float = 0.0, mesh: float = 0.03) -> Problem:
    """A lintel on a square pier, ``shift`` off its middle, pushed sideways by a force ``at``."""
    blocks = [PIER, box("lintel", (shift - 0.6, 0.0, 0.0), (shift + 0.9, SIDE, 0.2), 2e3)]
    model = structure(blocks, dry(0.6), mesh=mesh)
    return Problem(model, force_at(model, "lintel", at, (0.0, 1.0, 0.0)))


def square(centre: tuple[float, float], cells: int = 4) -> Pressure:
    places, areas = outline_nodes(UNIT, 1.0 / cells, NodeLayout.LOBATTO)[:2]
    return Pressure(places, *linear_pressure(places, areas, np.array(centre)), 1.0)


def torque(pressure: Pressure) -> float:
    """Of a face without shear, over mu N and its size."""
    used, _ = pressure.worst(np.array([0.0, 0.0, 1.0]))
    return 1.0 / used


def test_a_square_under_pure_torque_has_its_closed_form() -> None:
    assert pytest.approx(0.3826, abs=5e-5) == SQUARE
    assert torque(square((0.0, 0.0))) == pytest.approx(SQUARE, rel=1e-3)


@pytest.mark.parametrize("centre", [(0.0, 0.0), (0.1, 0.05), (0.25, 0.0), (0.3, -0.2), (0.45, 0.0)])
def test_pressure_has_its_resultant_and_is_linear_on_contact(centre: tuple[float, float]) -> None:
    pressure = square(centre)
    assert pressure.shares.sum() == pytest.approx(1.0, abs=1e-6)
    assert pressure.shares @ pressure.places == pytest.approx(centre, abs=1e-3)
    _, areas = outline_nodes(UNIT, 0.25, NodeLayout.LOBATTO)[:2]
    pressed = pressure.shares > 1e-9
    stress = (pressure.shares / areas)[pressed]
    basis = np.column_stack([np.ones(pressed.sum()), pressure.places[pressed]])
    plane, *_ = np.linalg.lstsq(basis, stress, rcond=None)
    assert basis @ plane == pytest.approx(stress, rel=1e-3, abs=1e-3 * stress.max())


def test_a_face_that_is_pressed_on_an_edge_has_the_torque_of_the_edge() -> None:
    assert torque(square((0.5, 0.0))) == pytest.approx(0.25, rel=2e-3)
    assert torque(square((0.5, 0.5))) == pytest.approx(0.0, abs=2e-3)


def test_shear_alone_is_limited_by_coulomb_wherever_the_pressure_is() -> None:
    for centre in ((0.0, 0.0), (0.2, 0.1), (0.49, 0.0)):
        x, y = centre
        through_it = np.array([0.6, 0.8, 0.8 * x - 0.6 * y])
        assert square(centre).worst(through_it)[0] == pytest.approx(1.0, rel=2e-3)


@pytest.mark.parametrize("lever", [0.05, 0.35, 0.7, 2.0])
def test_a_lintel_that_is_pushed_off_its_pier_turns_about_one_point(lever: float) -> None:
    model = structure([PIER, box("lintel", (-2.0, 0.0, 0.0), (2.3, SIDE, 0.2), 2e3)], dry(0.6))
    loads = force_at(model, "lintel", (SIDE / 2 + lever, SIDE / 2, 0.0), (0.0, 1.0, 0.0))
    found = limit_load(model, loads, friction=True).load
    points = (np.arange(80) + 0.5) / 80 * SIDE - SIDE / 2
    x, y = np.meshgrid(points, points)  # of the pier, which is pressed uniformly
    centres = np.linspace(-SIDE, 0.0, 1001)
    resistance = np.array([float(np.hypot(x - centre, y).mean()) for centre in centres])
    by_hand = 0.6 * model.pieces[1].weight * (resistance / (lever - centres)).min()
    assert found == pytest.approx(by_hand, rel=3e-3)


def test_pressure_does_not_gather_in_the_corners_of_a_lintel_on_any_mesh() -> None:
    problem = lintel((0.85, 0.15, 0.0))
    gathered = solved(*problem, ContactLaw.of(problem.assembly).cone(), set()).load
    assert gathered == pytest.approx(297.7, abs=0.1)
    found = limit_load(*problem, friction=True)
    assert found.load == pytest.approx(170.4, abs=0.2)
    assert found.untwisted == pytest.approx(297.7, abs=0.1)
    assert sliding_limit(*problem).state.load == pytest.approx(170.4, abs=0.2)
    for mesh in (math.inf, 0.1):
        given = lintel((0.85, 0.15, 0.0), mesh=mesh)
        assert limit_load(*given, friction=True).load == pytest.approx(170.4, abs=0.3)


@pytest.mark.parametrize(
    ("at", "shift"),
    [
        ((0.18, 0.15, 0.0), 0.0),
        ((0.85, 0.15, 0.0), 0.05),
        ((0.50, 0.15, 0.1), 0.05),
        ((0.50, 0.15, 0.2), 0.0),
    ],
)
def test_an_eccentric_lintel_carries_what_the_static_model_finds(at: Vector, shift: float) -> None:
    problem = lintel(at, shift)
    found, static = limit_load(*problem, friction=True).load, static_peak(*problem)
    assert found == pytest.approx(static.peak.load, rel=0.015)
    assert static.mode in (Mode.TURNED, Mode.MECHANISM)


def test_forces_obey_coulomb_and_carry_the_load_of_a_face_that_is_twisted() -> None:
    problem = lintel((0.85, 0.15, 0.0))
    found = limit_load(*problem, friction=True)
    shear = np.hypot(found.force[:, 1], found.force[:, 2])
    assert (shear - 0.6 * found.force[:, 0]).max() <= 1e-5 * found.force[:, 0].max()
    carried = found.force[:, 1:].sum(axis=0) @ problem.assembly.faces[0].axes[1:]
    assert carried == pytest.approx([0.0, -found.load, 0.0], abs=1e-4 * found.load)


def turned_cap(torque: float, push: tuple[float, ...]) -> Problem:
    """A block that fits its pier, under a permanent ``torque`` (N m) about z, and a ``push``.

    ``push``: force (N) and moment (N m) at its centroid per newton of the load.
    """
    model = structure([PIER, box("cap", (0.0, 0.0, 0.0), (SIDE, SIDE, 0.2), 2e3)], dry(0.6))
    loads = force_at(model, "cap", (SIDE / 2, SIDE / 2, 0.2), (0.0, 0.0, -1.0))
    permanent, variable = loads.permanent.copy(), np.zeros_like(loads.permanent)
    permanent[1, 5], variable[1] = torque, push
    return Problem(model, replace(loads, permanent=permanent, variable=variable))


HELD = 0.6 * 0.2 * SIDE**2 * 2e3 * 9.81 * SQUARE * SIDE  # N m, by friction of the cap's weight


@pytest.mark.parametrize("share", [0.98, -0.98, 1.02, -1.02, 1.5])
def test_a_block_stands_under_a_permanent_torque_that_its_friction_resists(share: float) -> None:
    problem = turned_cap(share * HELD, (0.0, 0.0, -1.0, 0.0, 0.0, 0.0))
    if abs(share) < 1.0:
        require_standing(*problem, friction=True)
        with pytest.raises(UnboundedError):
            limit_load(*problem, friction=True)
    else:
        with pytest.raises(InfeasibleError, match="does not stand"):
            require_standing(*problem, friction=True)


@pytest.mark.parametrize(("lever", "limited"), [(0.06, False), (0.08, True), (0.12, True)])
def test_a_load_that_presses_and_turns_is_limited_by_its_torque(
    lever: float, limited: bool
) -> None:
    # In the corners alone friction would resist 0.6 * 0.212 N m per newton that presses.
    problem = turned_cap(0.0, (0.0, 0.0, -1.0, 0.0, 0.0, lever))
    if not limited:
        with pytest.raises(UnboundedError):
            limit_load(*problem, friction=True)
        return
    found = limit_load(*problem, friction=True)
    assert found.load == pytest.approx(HELD / (lever - 0.6 * SQUARE * SIDE), rel=5e-3)
    assert found.untwisted == math.inf


def test_smaller_interfaces_resist_less_torque() -> None:
    problem = turned_cap(HELD / 2.0, (0.0, 0.0, -1.0, 0.0, 0.0, 0.0))
    assert geometrical_factor(*problem) == pytest.approx(2.0, rel=5e-3)


@pytest.mark.parametrize("friction", [0.0, 0.05, 0.3])
@pytest.mark.parametrize(
    "across",
    [
        {"acceleration": [0, 1, 0]},
        {"force": {"block": "bar", "at": [1.4, 0, 0], "direction": [0, 1, 0]}},
    ],
)
def test_pressure_goes_where_a_bar_on_two_piers_carries_most(
    friction: float, across: dict[str, Any]
) -> None:
    """A bar on a pier of 0.4 m and on a pad of 0.2 by 0.1 m that it slips on.

    No less than the static model, whose forces are admissible.
    """
    blocks: dict[str, Any] = {
        "a": {"low": [-0.2, -0.2, -0.5], "high": [0.2, 0.2, 0], "fixed": True},
        "b": {"low": [1.3, -0.05, -0.5], "high": [1.5, 0.05, 0], "fixed": True},
        "bar": {"low": [-0.2, -0.2, 0], "high": [1.5, 0.2, 0.3], "density": 2e3},
    }
    laws = {"interfaces": {"friction": 0.5}, "special": [{"between": ["b", "bar"]}]}
    laws["special"][0]["friction"] = friction
    problem = structure_of({"blocks": blocks, "load": across, **laws})
    found = limit_load(*problem, friction=True)
    fine = refined(problem.assembly, 8)
    static = static_peak(fine, problem.loads).peak.load
    assert 0.98 * static <= found.load <= 1.1 * static
    assert Resultants.of(problem.assembly, found.force).most_used <= 1.02
