"""CalculiX on elastic pieces: its deck, its results as they are read, and small real runs."""

import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from conftest import DISTINCT, a_case, as_read, run_case
from joints import loaded, sawn

from sidmacib import Elastic, Loading, NodeLayout
from sidmacib.engines import ENGINES
from sidmacib.engines.calculix.deck import CalculixDeck
from sidmacib.engines.calculix.run import load_at, raised, read_state
from sidmacib.engines.run import EngineError
from sidmacib.joint import DRY, Direction, HoldDown, Joint, UpperBody
from sidmacib.models import MODELS, REFERENCE_MODEL, detailed, first_failure_only
from sidmacib.models.static import solve as static_model
from workflow.configuration import ConfigError, read_study
from workflow.solve import solved

ENGINE = ENGINES["calculix"]
installed = pytest.mark.skipif(ENGINE.missing() is not None, reason="CalculiX is not installed")


def elastic(joint: Joint, body: UpperBody = UpperBody.COLUMNS) -> Joint:
    return replace(joint, elastic=Elastic(1e10, 0.2), upper_body=body)


# --- the deck ------------------------------------------------------------------------------------
@pytest.mark.parametrize("eccentricity", [0.0, 0.5, math.inf])
@pytest.mark.parametrize("hold_down", [HoldDown(), HoldDown.force(500.0)])
def test_nodal_forces_add_up_to_the_loads(eccentricity: float, hold_down: HoldDown) -> None:
    joint = elastic(sawn(3, hold_down=hold_down))
    assembly, loads = loaded(joint, eccentricity, 0.02, NodeLayout.VERTICES)
    deck = CalculixDeck(as_read(assembly, loads))
    for index, (piece, grid) in enumerate(zip(assembly.pieces, deck.grids, strict=True)):
        centre = np.array(deck.assembly.pieces[index].centre_m)
        nodes = grid.nodes.items()
        arms = {number: np.array(grid.place(steps)) - centre for steps, number in nodes}
        for forces, whole in ((deck.permanent, loads.permanent), (deck.variable, loads.variable)):
            resultant = np.zeros(6)
            for (node, direction), force in forces.items():
                if node in arms:
                    vector = force * np.eye(3)[direction - 1]
                    resultant += [*vector, *np.cross(arms[node], vector)]
            expected = np.zeros(6) if piece.fixed else whole[index]
            assert resultant == pytest.approx(expected, abs=1e-12)


def test_every_contact_node_of_a_rough_face_is_a_node_of_both_grids() -> None:
    for layout in (NodeLayout.VERTICES, NodeLayout.LOBATTO):
        joint = elastic(sawn(3), UpperBody.MONOLITHIC)
        deck = CalculixDeck(as_read(*loaded(joint, 0.5, 0.02, layout)))
        for number, node in enumerate(deck.assembly.nodes):
            face, weights = deck.assembly.faces[node.face], deck.jump_weights(number)
            assert sum(weights.values()) == pytest.approx(0.0, abs=1e-12)
            if face.material.friction or face.cohesive:
                assert sorted(weights.values()) == pytest.approx([-1.0, 1.0])


# --- what comes back -----------------------------------------------------------------------------
BLOCK_TEXT = """
  100CL  102 1.062500000           2                     0    2           1
 -4  DISP        4    1
 -5  D1          1    2    1    0
 -1         1 1.00000E-05-2.00000E-06 0.00000E+00
 -1        12-3.50000E-05 0.00000E+00 1.00000E-07"""


def test_displacements_are_read_by_node() -> None:
    time, moved = read_state(BLOCK_TEXT)
    assert time == 1.0625
    assert moved == {1: (1e-5, -2e-6, 0.0), 12: (-3.5e-5, 0.0, 1e-7)}


def test_loads_rise_whatever_is_carried_and_follow_from_the_time() -> None:
    loads = raised(10.0)
    assert all(0.0 < high - low <= max(10.0, 0.3 * low) for low, high in pairwise([0.0, *loads]))
    assert loads[-1] >= 1e7
    found = [load_at(time, loads) for time in (0.5, 1.0, 1.5, 2.0, 2.25)]
    assert found == pytest.approx([0.0, 0.0, 5.0, 10.0, 12.5])


# --- what it can do ------------------------------------------------------------------------------
def test_it_is_no_model_of_the_peak() -> None:
    assert first_failure_only("calculix")
    assert not any(map(first_failure_only, set(MODELS) - {"calculix"}))
    assert detailed(["calculix", REFERENCE_MODEL]) == (REFERENCE_MODEL,)


def test_a_study_with_rigid_pieces_refuses_it_and_one_with_elastic_pieces_takes_it() -> None:
    config = {"samples": {"n3": {"locks": 3}}}
    assert read_study(config).dem.engines == DISTINCT
    with pytest.raises(ConfigError, match="pieces: rigid is not allowed with calculix; it must"):
        read_study({**config, "dem": {"engines": ["calculix"]}})
    assert read_study({**config, "assembly": {"pieces": "elastic"}}).dem.engines == ("calculix",)


# --- real runs, small ones -----------------------------------------------------------------------
@installed
@pytest.mark.engine
@pytest.mark.parametrize(
    ("body", "eccentricity", "allowed"),
    [(UpperBody.MONOLITHIC, 0.0, 0.005), (UpperBody.COLUMNS, 0.5, 0.01)],
)
def test_the_static_model_agrees(run, body: UpperBody, eccentricity: float, allowed: float) -> None:
    joint = elastic(sawn(3), body)
    loading = Loading(Direction(eccentricity))
    case = a_case("calculix", joint, loading, 0.02, NodeLayout.LOBATTO, first_increment=0.2)
    found = run(case)
    assert found.record.mode == "first failure"
    assert found.first_failure_load == found.peak_load < found.failed_load
    expected, _, _ = solved(case, static_model)
    assert found.peak_load == pytest.approx(expected.first_failure_load_N, rel=allowed)
    assert found.unbalanced_share < 0.02
    assert found.weights["max_shear_ratio"].max() <= 1.0 + 1e-6
    history = found.history[found.history["stage"] == "equilibrium"]
    assert history["load_N"].is_monotonic_increasing
    assert history["displacement_m"].is_monotonic_increasing


@installed
@pytest.mark.engine
def test_pieces_that_slide_with_all_bonds_whole_have_no_first_failure(tmp_path: Path) -> None:
    joint = elastic(sawn(1, hold_down=HoldDown.force(100.0), dry=replace(DRY, friction=0.1)))
    with pytest.raises(EngineError, match=r"no first failure: at 10\.1\d* N \d+\.?\d* % of"):
        run_case(a_case("calculix", joint, Loading(Direction(0.0)), 0.03), tmp_path)
