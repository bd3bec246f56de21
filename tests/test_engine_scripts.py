"""The parts of the engines' scripts that need no engine: decks, records, flatness, numbers."""

import csv
import itertools
import json
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stack import tilted_stack

from sidmacib.engines.liggghts.deck import (
    LiggghtsDeck,
    patches,
)
from sidmacib.engines.liggghts.loads import handle_forces
from sidmacib.engines.liggghts.model import Placement, utilisation
from sidmacib.engines.liggghts.process import dumped_rows, printed_values
from sidmacib.engines.render import assembly_data, engine_material
from sidmacib.engines.scripts import assembly as scripts
from sidmacib.engines.scripts.flatness import (
    STILL,
    PieceMotion,
    check_flat,
    contact_shift,
    spurious_force,
)
from sidmacib.engines.scripts.records import BONDS, EnginePeak, History, NodeForce
from sidmacib.joint.joint import Direction, Joint
from sidmacib.joint.loading import Loading, lateral_load
from sidmacib.joint.pieces import assemble
from sidmacib.mechanics import assembly as mechanics
from sidmacib.mechanics.assembly import NodeLayout

SEARCH = scripts.GivenSearch(1e-6, 20.0, 800, 8000, 1e-4, 1e-6, 12.0, 1e-3)
LAW = scripts.GivenMaterial(1e10, 1e10, 0.0, 8e4, 3.7e5)


def as_read(
    assembly: mechanics.Assembly, loads: mechanics.Loads, tmp: Path
) -> scripts.GivenAssembly:
    """The assembly as a script reads it."""
    data = assembly_data(assembly, loads)
    (tmp / "data.json").write_text(json.dumps(data))
    names = {
        row["material"]: f.material for row, f in zip(data["faces"], assembly.faces, strict=True)
    }
    materials = {name: engine_material(law) for name, law in names.items()}
    return scripts.read_assembly(str(tmp / "data.json"), materials)


@pytest.fixture
def three(tmp_path: Path) -> scripts.GivenAssembly:
    joint = Joint(3)
    assembly = assemble(joint, 0.02, NodeLayout.CENTRES)
    loads = lateral_load(joint, assembly, Loading(Direction(0.5)))
    return as_read(assembly, loads, tmp_path)


@pytest.fixture
def stack(tmp_path: Path) -> scripts.GivenAssembly:
    return as_read(*tilted_stack(2), tmp_path)


# --- LIGGGHTS' deck ------------------------------------------------------------------------------
def test_the_handles_of_a_piece_have_its_mass_and_inertia(three: scripts.GivenAssembly) -> None:
    deck = LiggghtsDeck(three, SEARCH, 0.12)
    for index in three.free:
        piece = three.pieces[index]
        rows = [deck.atoms.lines[atom - 1].split() for atom in deck.atoms.handles[index]]
        place = np.array([[float(v) for v in row[2:5]] for row in rows])
        diameter, density = np.array([[float(v) for v in row[5:7]] for row in rows]).T
        mass = density * math.pi / 6 * diameter**3
        assert mass.sum() == pytest.approx(piece.mass_kg)
        assert mass @ place / mass.sum() == pytest.approx(np.array(piece.centre_m))
        arm = place - np.array(piece.centre_m)
        inertia = (mass[:, None] * ((arm**2).sum(axis=1)[:, None] - arm**2)).sum(axis=0)
        assert inertia == pytest.approx(np.full(3, piece.inertia_kgm2))


@given(*[st.tuples(*[st.floats(-5.0, 5.0)] * 3)] * 2, st.floats(0.01, 1.0))
def test_the_forces_on_the_handles_add_up_to_force_and_moment(
    force: tuple[float, float, float], moment: tuple[float, float, float], reach: float
) -> None:
    forces = np.array(handle_forces(force, moment, reach))
    places = reach * np.array([s * np.eye(3)[k] for k in range(3) for s in (1, -1)])
    assert forces.sum(axis=0) == pytest.approx(np.array(force), abs=1e-9)
    turning = np.cross(places, forces).sum(axis=0)
    assert turning == pytest.approx(np.array(moment), abs=1e-9)


def test_spheres_of_a_node_touch_at_the_node_and_no_others_of_the_face(
    three: scripts.GivenAssembly,
) -> None:
    deck = LiggghtsDeck(three, SEARCH, 0.12)
    centre = np.array([[float(v) for v in line.split()[2:5]] for line in deck.atoms.lines])
    for pair, node in zip(deck.atoms.spheres, three.nodes, strict=True):
        below, above = centre[pair[0] - 1], centre[pair[1] - 1]
        assert (below + above) / 2 == pytest.approx(np.array(node.position_m))
        radius = deck.patch_radii[deck.patch_of[three.nodes.index(node)]]
        assert np.linalg.norm(above - below) == pytest.approx(2 * radius)
    for patch, radius in zip(deck.patches, deck.patch_radii, strict=True):
        for one, other in itertools.permutations(patch.nodes, 2):
            apart = np.linalg.norm(
                centre[deck.atoms.spheres[one][0] - 1] - centre[deck.atoms.spheres[other][1] - 1]
            )
            assert apart > 2 * radius + 1e-6


def test_nodes_of_one_area_are_a_patch_and_have_its_stiffness(joint: Joint, tmp_path: Path) -> None:
    built = assemble(joint, 0.03, NodeLayout.LOBATTO)
    three = as_read(built, lateral_load(joint, built, Loading(Direction(0.0))), tmp_path)
    found = patches(three)
    assert sorted(n for patch in found for n in patch.nodes) == [*range(len(three.nodes))]
    for patch in found:
        areas = [three.nodes[n].area_m2 for n in patch.nodes]
        assert areas == pytest.approx([patch.area_m2] * len(areas))
    # A corner of a cell, or two, or four; a middle of an edge, of one cell or two; a cell's middle.
    assert len({patch.area_m2 for patch in found if patch.face == 0}) == 5


def test_springs_are_as_stiff_as_their_nodes(three: scripts.GivenAssembly) -> None:
    deck = LiggghtsDeck(three, SEARCH, 0.12)
    lines = [line.split() for line in deck.input_script() if line.startswith("bond_coeff")]
    assert len(lines) == sum(three.faces[node.face].cohesive for node in three.nodes)
    total = sum(2 * float(line[2]) for line in lines)  # the energy is coefficient * length^2
    area = sum(node.area_m2 for node in three.nodes if three.faces[node.face].cohesive)
    assert total == pytest.approx(1e10 * area)


# --- LIGGGHTS' answers ---------------------------------------------------------------------------


def test_a_dump_is_read_from_its_last_snapshot() -> None:
    text = "ITEM: ATOMS id fx\n1 5.0\nITEM: TIMESTEP\n7\nITEM: ATOMS id fx\n2 1.5\n1 -2.5\n"
    assert dumped_rows(text) == {2: [1.5], 1: [-2.5]}


def test_values_that_are_no_numbers_end_the_run() -> None:
    assert printed_values(["WARNING: x", "values 1.5 -2"]) == [1.5, -2.0]
    with pytest.raises(SystemExit, match="diverged"):
        printed_values(["values 1.5 nan"])


@given(st.tuples(*[st.floats(-1e-3, 1e-3)] * 3), st.tuples(*[st.floats(-1e-4, 1e-4)] * 3))
def test_a_placement_finds_displacement_rotation_and_points(
    shift: tuple[float, float, float], turn: tuple[float, float, float]
) -> None:
    start, reach = np.array([0.1, 0.2, 0.3]), 0.05
    arms = np.array([s * reach * np.eye(3)[k] for k in range(3) for s in (1, -1)])
    places = start + arms + np.array(shift) + np.cross(np.array(turn), arms)
    placement = Placement(start.tolist(), reach, places.ravel().tolist())
    motion = placement.motion()
    assert motion.displacement == pytest.approx(shift, abs=1e-12)
    assert motion.rotation == pytest.approx(turn, abs=1e-12)
    point = start + np.array([0.01, -0.02, 0.03])
    moved = point + np.array(shift) + np.cross(np.array(turn), point - start)
    assert placement.place(point.tolist()) == pytest.approx(moved.tolist(), abs=1e-12)


def test_utilisation_is_the_larger_of_shear_and_tension() -> None:
    area, up = 1e-4, (0.0, 0.0, 1.0)
    shear, tension = LAW.cohesion * area, LAW.tensile_strength * area
    assert utilisation((0.6 * shear, 0.8 * shear, 0.0), up, LAW, area) == pytest.approx(1.0)
    assert utilisation((0.0, 0.0, -0.5 * tension), up, LAW, area) == pytest.approx(0.5)
    assert utilisation((0.1 * shear, 0.0, 9 * tension), up, LAW, area) == pytest.approx(0.1)


# --- flatness ------------------------------------------------------------------------------------
def pressed(assembly: scripts.GivenAssembly) -> list[NodeForce]:
    return [NodeForce(1.0, (0.0, 0.0, 0.0), False) for _ in assembly.nodes]


def test_slip_parts_two_spheres_as_geometry_requires(stack: scripts.GivenAssembly) -> None:
    # The exact distance of two spheres' centres, against what is taken of it to second order.
    radius, slip, area, stiffness = 0.4, 1e-4, 0.04, 1e10
    moved = [STILL, PieceMotion((slip, 0.0, 0.0), (0.0, 0.0, 0.0)), STILL]
    gap = math.hypot(slip, 2 * radius) - 2 * radius
    found = spurious_force(stack, moved, [radius] * 2, pressed(stack))
    assert found == pytest.approx(2 * gap * stiffness * area, rel=1e-3)  # two faces slip


def test_a_turn_moves_the_point_of_contact_of_two_spheres_as_geometry_requires(
    stack: scripts.GivenAssembly,
) -> None:
    # The middle of two spheres' centres, of which one turns about the node by a small angle.
    radius, turn = 0.4, 1e-4
    below = stack.pieces[1].centre_m[2]
    turned = [STILL, PieceMotion((turn * below, 0.0, 0.0), (0.0, turn, 0.0)), STILL]
    middle = radius * math.sin(turn) / 2
    found = contact_shift(stack, turned, [radius] * 2, pressed(stack))
    assert found == pytest.approx(middle / 0.1)  # over half the width of the stack
    with pytest.raises(SystemExit, match=r"contacts move by 0\.12 of half a face"):
        large = [STILL, PieceMotion((0.0, 0.0, 0.0), (0.0, 6e-2, 0.0)), STILL]
        only_last = [NodeForce(float(n.face), (0.0, 0.0, 0.0), False) for n in stack.nodes]
        check_flat(stack, large, [0.4] * 2, only_last, 1e12)


def test_a_peak_on_round_contacts_ends_with_a_reason(stack: scripts.GivenAssembly) -> None:
    def at(slip: float) -> None:
        moved = [STILL, PieceMotion((slip, 0.0, 0.0), (0.0, 0.0, 0.0)), STILL]
        check_flat(stack, moved, [0.4] * 2, pressed(stack), 100.0)

    # Two faces of 4e8 N/m, a load of 157 N (the weight): 0.1 of it at slip^2 / 1.6 m = 2e-8 m.
    at(1.7e-4)
    with pytest.raises(SystemExit, match=r"spurious forces are 0\.11 of the load"):
        at(1.9e-4)


@pytest.mark.parametrize("displacement", [math.nan, math.inf, -math.inf])
def test_a_displacement_that_is_no_number_ends_the_run(displacement: float) -> None:
    with pytest.raises(SystemExit, match="diverged"):
        SEARCH.collapsed(displacement, 12.0)


def test_collapse_is_a_displacement_beyond_the_limit_to_either_side() -> None:
    assert SEARCH.collapsed(1.01e-4, 100.0) and SEARCH.collapsed(-1.01e-4, 100.0)
    assert not SEARCH.collapsed(0.99e-4, 100.0)
    assert not SEARCH.collapsed(1.1e-5, 0.0)  # next to no load: that of the first increment


# --- records -------------------------------------------------------------------------------------
def test_results_are_written_with_stresses_mode_and_engine(
    three: scripts.GivenAssembly, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    history = History(three, time_steps=7)
    nodes = [NodeForce(2.0, (0.5, -1.0, 0.0), n % 2 == 0) for n in range(len(three.nodes))]
    history.record(12.0, "equilibrium", 1e-6, 1e-5, nodes)
    history.write(EnginePeak(12.0, 12.1, 11.0, BONDS, nodes), "engine", "1.2")
    assert json.loads((tmp_path / "result.json").read_text()) == {
        "peak_load_N": 12.0,
        "failed_load_N": 12.1,
        "first_failure_load_N": 11.0,
        "mode": "bonds",
        "time_steps": 7,
        "engine": "engine",
        "engine_version": "1.2",
    }
    with (tmp_path / "nodes.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    area = three.nodes[0].area_m2
    assert float(rows[0]["normal_Pa"]) == pytest.approx(2.0 / area)
    assert float(rows[0]["shear_y_Pa"]) == pytest.approx(-1.0 / area)
    with (tmp_path / "history.csv").open() as stream:
        row = next(csv.DictReader(stream))
    inner = [f for f in three.faces if f.cohesive]
    for face in inner:
        numbers = [n for n, node in enumerate(three.nodes) if three.faces[node.face] is face]
        assert float(row[f"{face.name}_shear_x_N"]) == pytest.approx(0.5 * len(numbers))
        whole = sum(n % 2 == 0 for n in numbers) / len(numbers)
        assert float(row[f"{face.name}_broken_share"]) == pytest.approx(1.0 - whole)
