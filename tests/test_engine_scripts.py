"""The parts of the engines' scripts that need no engine: decks, motions, records, numbers."""

import itertools
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from conftest import as_read
from hypothesis import given
from hypothesis import strategies as st
from joints import loaded, sawn
from scipy.spatial.transform import Rotation
from stack import tilted_stack
from structures import dry
from structures import moved as at_another_place

from sidmacib.engines.liggghts.deck import LiggghtsDeck, flat_radii, patches
from sidmacib.engines.liggghts.loads import handle_forces
from sidmacib.engines.liggghts.model import Placement, utilisation
from sidmacib.engines.liggghts.process import dumped_rows, printed_values
from sidmacib.engines.scripts import assembly as scripts
from sidmacib.engines.scripts.assembly import GivenAssembly
from sidmacib.engines.scripts.motion import STILL, Fall, PieceMotion, moved
from sidmacib.engines.scripts.records import BONDS, EnginePeak, History, NodeForce
from sidmacib.engines.scripts.surroundings import LOOK, MET, Surroundings, meeting
from sidmacib.engines.sides import vertices_above
from sidmacib.structure.blocks import box, prism
from sidmacib.structure.loads import acceleration
from sidmacib.structure.structure import structure

SEARCH = scripts.GivenSearch(1e-6, 20.0, 800, 8000, 1e-4, 1e-3, 12.0, 1e-3)
RADII = 1e-3, 12.0  # m, of vertices and of flat sides
PILE = [("low", 0.0), ("middle", 0.2), ("top", 0.4)]
LAW = scripts.GivenMaterial(1e10, 1e10, 0.0, 8e4, 3.7e5, 0.0)


@pytest.fixture
def three() -> GivenAssembly:
    return as_read(*loaded(sawn(3), 0.5, 0.02))


@pytest.fixture
def stack() -> GivenAssembly:
    return as_read(*tilted_stack(2))


# --- LIGGGHTS' deck ------------------------------------------------------------------------------
def test_the_handles_of_a_piece_have_its_mass_and_inertia(three: GivenAssembly) -> None:
    deck = LiggghtsDeck(three, SEARCH, RADII, 0.05)
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


def test_spheres_of_a_node_touch_there_and_no_others_of_the_face(three: GivenAssembly) -> None:
    deck = LiggghtsDeck(three, SEARCH, RADII, 0.05)
    rows = [line.split() for line in deck.atoms.lines]
    centre = np.array([[float(v) for v in row[2:5]] for row in rows])
    radius = np.array([float(row[5]) / 2 for row in rows])
    for pair, node in zip(deck.atoms.spheres, three.nodes, strict=True):
        below, above = np.array(pair) - 1
        normal, place = np.array(three.faces[node.face].normal), np.array(node.position_m)
        assert centre[below] + radius[below] * normal == pytest.approx(place)
        assert centre[above] - radius[above] * normal == pytest.approx(place)
        point = above if node.vertex_above else below
        assert radius[point] == pytest.approx(RADII[0])
        assert radius[below + above - point] > 100 * RADII[0]
    for patch in deck.patches:
        for one, other in itertools.permutations(patch.nodes, 2):
            below, above = deck.atoms.spheres[one][0] - 1, deck.atoms.spheres[other][1] - 1
            apart = np.linalg.norm(centre[below] - centre[above])
            assert apart > radius[below] + radius[above] + 1e-6


def test_radii_shrink_where_a_face_is_soft_up_to_some_softness(stack: GivenAssembly) -> None:
    def radii(assembly: GivenAssembly) -> list[float]:
        return flat_radii(assembly, patches(assembly), 1.0)

    def softened(stiffness: float) -> GivenAssembly:
        soft = replace(stack.faces[0].material, normal_stiffness=stiffness)
        return replace(stack, faces=[replace(stack.faces[0], material=soft), stack.faces[1]])

    assert set(radii(stack)) == {1.0}
    found = radii(softened(4e6))
    first = [found[k] for k, patch in enumerate(patches(stack)) if patch.face == 0]
    assert max(first) < 1.0 and set(found) - set(first) == {1.0}
    pressed = stack.permanent_N / (4e6 * 0.2 * 0.2)
    assert 0.05**2 / (2 * min(first)) == pytest.approx(2 * pressed)
    with pytest.raises(SystemExit, match=r"is too soft for nodes 0\.05 m apart"):
        radii(softened(1e5))


# --- LIGGGHTS' answers ---------------------------------------------------------------------------


def test_the_last_snapshot_is_read_and_values_that_are_no_numbers_end_the_run() -> None:
    text = "ITEM: ATOMS id fx\n1 5.0\nITEM: TIMESTEP\n7\nITEM: ATOMS id fx\n2 1.5\n1 -2.5\n"
    assert dumped_rows(text) == {2: [1.5], 1: [-2.5]}
    assert printed_values(["WARNING: x", "values 1.5 -2"]) == [1.5, -2.0]
    with pytest.raises(SystemExit, match="diverged"):
        printed_values(["values 1.5 nan"])


@given(st.tuples(*[st.floats(-1e-3, 1e-3)] * 3), st.tuples(*[st.floats(-1e-4, 1e-4)] * 3))
def test_a_placement_finds_displacement_rotation_and_points(
    shift: tuple[float, float, float], turn: tuple[float, float, float]
) -> None:
    start, reach = np.array([0.1, 0.2, 0.3]), 0.05
    arms = np.array([s * reach * np.eye(3)[k] for k in range(3) for s in (1, -1)])
    turned = Rotation.from_rotvec(turn)
    places = start + np.array(shift) + turned.apply(arms)
    placement = Placement(start.tolist(), reach, places.ravel().tolist())
    motion = placement.motion()
    assert motion.displacement == pytest.approx(shift, abs=1e-12)
    assert motion.rotation == pytest.approx(turn, abs=1e-12)
    point = start + np.array([0.01, -0.02, 0.03])
    moved = start + np.array(shift) + turned.apply(point - start)
    assert placement.place(point.tolist()) == pytest.approx(moved.tolist(), abs=1e-12)


def test_without_tensile_strength_only_more_than_rounding_breaks_a_bond() -> None:
    law, up = replace(LAW, tensile_strength=0.0), (0.0, 0.0, 1.0)
    assert utilisation((0.0, 0.0, -1e-12), up, law, 1e-4) < 1e-3
    assert utilisation((0.0, 0.0, -1e-3), up, law, 1e-4) > 1.0


# --- motions -------------------------------------------------------------------------------------
def shifted(*far: float) -> list[PieceMotion]:
    """Motions of the pieces of a stack along x, from the lowest one up."""
    return [PieceMotion((x, 0.0, 0.0), (0.0, 0.0, 0.0)) for x in far]


@pytest.mark.parametrize(
    ("ways", "falls"), [((1, 3, 6, 10, 15), True), ((5, 9, 12, 14, 14.1), False)]
)
def test_what_has_moved_far_falls_if_it_gains_speed(
    stack: GivenAssembly, ways: tuple[float, ...], falls: bool
) -> None:
    fall = Fall(stack, 1e-2, [STILL] * 3)
    seen = [fall.sees(shifted(0.0, 0.0, 1e-3 * way), 10) for way in ways]
    assert seen == [False] * 4 + [falls]


def test_a_spin_is_a_motion_too_and_motions_count_from_the_last_equilibrium(
    stack: GivenAssembly,
) -> None:
    spun = [STILL, STILL, PieceMotion((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))]
    assert Fall(stack, 1e-2, [STILL] * 3).sees(spun, 10)
    assert not Fall(stack, 1e-2, shifted(0.0, 0.5, 0.5)).sees(shifted(0.0, 0.5, 0.509), 10)


def test_a_fall_that_the_load_does_no_work_on_is_a_drift(stack: GivenAssembly) -> None:
    sideways = [STILL, STILL, PieceMotion((0.0, 0.02, 0.0), (0.0, 0.0, 0.0))]
    for motions, outcome in ((shifted(0.0, 0.0, 0.02), "collapse"), (sideways, "drift")):
        fall = Fall(stack, 1e-2, [STILL] * 3)
        assert fall.sees(motions, 10)
        assert fall.outcome(motions).value == outcome


@pytest.mark.parametrize("nowhere", [math.nan, math.inf])
def test_a_motion_that_is_no_number_ends_the_run(stack: GivenAssembly, nowhere: float) -> None:
    with pytest.raises(SystemExit, match="diverged"):
        Fall(stack, 1e-2, [STILL] * 3).sees(shifted(0.0, 0.0, nowhere), 10)


def test_a_point_moves_on_a_circle_however_far_its_piece_turns() -> None:
    quarter = PieceMotion((0.0, 0.0, 1.0), (0.0, 0.0, math.pi / 2))
    assert moved((3.0, 0.0, 0.0), (1.0, 0.0, 0.0), quarter) == pytest.approx([-2.0, 2.0, 1.0])


def test_vertices_past_the_edge_of_a_side_have_left_it(stack: GivenAssembly) -> None:
    def lost(*far: float) -> list[int]:
        return Surroundings(stack).look(shifted(*far))

    width = max(node.position_m[0] for node in stack.nodes) * 2
    assert lost(0.0, 0.0, 0.04 * stack.length_m) == []
    upper = [n for n, node in enumerate(stack.nodes) if node.face == 1]
    off = lost(0.0, 0.0, width / 4)
    assert off and set(off) < set(upper)
    assert lost(0.0, 0.0, 1.4 * width) == upper
    assert lost(0.0, width, width) != upper  # they move as one


def test_small_motions_that_add_up_are_seen(stack: GivenAssembly) -> None:
    around, width = Surroundings(stack), max(node.position_m[0] for node in stack.nodes) * 2
    steps = 1 + int(width / 2 / (0.6 * LOOK * stack.length_m))
    lost = [
        node
        for step in range(1, steps)
        for node in around.look(shifted(0.0, 0.0, 0.6 * LOOK * stack.length_m * step))
    ]
    assert lost and len(lost) == len(set(lost))
    # Where vertices have passed an edge, this is the vertex from now on.
    assert not around.lost
    for number in lost:
        before, now = stack.nodes[number], around.nodes[number]
        assert now.vertex_above is not before.vertex_above
        face = stack.faces[now.face]
        edges = face.edges_below if before.vertex_above else face.edges_above
        apart = [scripts.dot(now.position_m, edge[:3]) - edge[3] for edge in edges]
        assert max(apart) == pytest.approx(0.0, abs=1e-12)


@pytest.fixture
def row() -> GivenAssembly:
    """Two blocks side by side on the ground, with a gap of 0.05 m along x."""
    ground = box("ground", (-1.0, -1.0, -0.2), (1.0, 1.0, 0.0), 2e3, fixed=True)
    ends = {"left": (-0.25, 0.0), "right": (0.05, 0.3)}
    cubes = [box(n, (x, -0.1, 0.0), (to, 0.1, 0.2), 2e3) for n, (x, to) in ends.items()]
    model = structure([ground, *cubes], dry(0.5))
    return as_read(model, acceleration(model, (1.0, 0.0, 0.0)))


def test_blocks_without_an_interface_meet_where_their_gap_has_closed(row: GivenAssembly) -> None:
    met = "left meets right, where they had no interface"
    closed = 0.05 + MET * row.length_m
    assert meeting(row, shifted(0.0, 0.99 * closed, 0.0), row.nodes) is None
    assert meeting(row, shifted(0.0, 1.01 * closed, 0.0), row.nodes) == met
    assert meeting(row, shifted(0.0, 0.4 * closed, -0.61 * closed), row.nodes) == met
    # Turned by 45 degrees, a corner is ahead by half the sum of its sides over the root of two.
    closed -= 0.5 * (0.25 + 0.2) / math.sqrt(2.0) - 0.125
    for share, expected in ((0.99, None), (1.01, met)):
        turned = PieceMotion((share * closed, 0.0, 0.0), (0.0, 0.0, math.pi / 4))
        assert meeting(row, [STILL, turned, STILL], row.nodes) == expected


def test_a_block_that_sinks_where_it_lost_its_contacts_meets_another(row: GivenAssembly) -> None:
    leaning = PieceMotion((0.0, 0.0, 0.0), (0.0, 0.2, 0.0))
    lost = range(len(row.nodes))
    met = "ground meets left, beyond their interface"
    assert meeting(row, [STILL, leaning, STILL], row.nodes, lost) == met
    assert meeting(row, [STILL, leaning, STILL], row.nodes) is None  # pressed in at its nodes
    rocked = PieceMotion((0.0, 0.0, 0.125 * math.sin(0.2)), (0.0, 0.2, 0.0))
    assert meeting(row, [STILL, rocked, STILL], row.nodes, lost) is None


def test_crosswise_edges_meet_where_no_face_does() -> None:
    turn = Rotation.from_rotvec([0.4, 0.3, 0.2])
    ridge = ((-1.0, -1.0), (1.0, -1.0), (0.0, 0.0))
    low = prism("low", [(0.0, y, z) for y, z in ridge], (1.0, 0.0, 0.0), 2e3)
    high = prism("high", [(x + 0.5, -0.5, 0.03 - z) for x, z in ridge], (0.0, 1.0, 0.0), 2e3)
    ground = box("ground", (-1.0, -1.0, -1.2), (1.0, 1.0, -1.0), 2e3, fixed=True)
    blocks = (ground, low, replace(high, fixed=True))
    solids = [at_another_place(each, turn, (0.0, 0.0, 0.0)) for each in blocks]
    model = structure(solids, dry(0.5))
    given = as_read(model, acceleration(model, (1.0, 0.0, 0.0)))
    closed = 0.03 + MET * given.length_m
    for share, met in ((0.99, None), (1.01, "low meets high, where they had no interface")):
        up = turn.apply([0.0, 0.0, share * closed])
        motions = [STILL, PieceMotion(tuple(up), STILL.rotation), STILL]
        assert meeting(given, motions, given.nodes) == met


# --- vertices and sides --------------------------------------------------------------------------
def test_the_piece_whose_corner_a_node_is_brings_the_vertex() -> None:
    ground = box("ground", (-1.0, -1.0, -0.2), (1.0, 1.0, 0.0), 2e3)
    small = box("small", (-0.2, -0.2, 0.0), (0.2, 0.2, 0.3), 2e3)
    slab = box("slab", (-0.6, -0.6, 0.3), (0.6, 0.6, 0.5), 2e3, fixed=True)
    assembly = structure([ground, small, slab], dry(0.5))
    above = vertices_above(assembly)
    for number, face in enumerate(assembly.faces):
        ends = above[assembly.nodes.face == number]
        brought = {face.above if end else face.below for end in ends}
        assert brought == {1}


def test_between_two_corners_the_flat_side_is_the_fixed_ones() -> None:
    blocks = [box(n, (0.0, 0.0, z), (0.4, 0.4, z + 0.2), 2e3, fixed=z == 0.0) for n, z in PILE]
    assembly = structure(blocks, dry(0.5))
    above = vertices_above(assembly)
    fixed_below = np.array([assembly.pieces[face.below].fixed for face in assembly.faces])
    assert (above == fixed_below[assembly.nodes.face]).all()


# --- records -------------------------------------------------------------------------------------
def test_results_are_written_with_stresses_mode_and_engine(
    three: GivenAssembly, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
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
    node, area = pd.read_csv(tmp_path / "nodes.csv").iloc[0], three.nodes[0].area_m2
    assert node["normal_Pa"] == pytest.approx(2.0 / area)
    assert node["shear_y_Pa"] == pytest.approx(-1.0 / area)
    row = pd.read_csv(tmp_path / "history.csv").iloc[0]
    inner = [f for f in three.faces if f.cohesive]
    for face in inner:
        numbers = [n for n, node in enumerate(three.nodes) if three.faces[node.face] is face]
        assert row[f"{face.name}_shear_x_N"] == pytest.approx(0.5 * len(numbers))
        whole = sum(n % 2 == 0 for n in numbers) / len(numbers)
        assert row[f"{face.name}_broken_share"] == pytest.approx(1.0 - whole)
