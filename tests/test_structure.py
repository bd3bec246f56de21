"""Structures of blocks against theory, and against the joint as one of them."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from joints import sawn
from scipy.spatial.transform import Rotation
from structures import BLOCK, GROUND, dry, moved, on_ground

from sidmacib import (
    Direction,
    HoldDown,
    UpperBody,
    limit_load,
    static_peak,
)
from sidmacib.joint.loading import Loading, posed
from sidmacib.mechanics.assembly import Assembly, FaceMaterial, NodeLayout
from sidmacib.mechanics.loads import Loads
from sidmacib.mechanics.sliding import sliding_limit
from sidmacib.structure.blocks import Block, box, prism
from sidmacib.structure.cutting import cut
from sidmacib.structure.interfaces import common, interfaces
from sidmacib.structure.loads import acceleration, force_at, free_weight
from sidmacib.structure.overlaps import shared_volume
from sidmacib.structure.structure import refined, structure
from studies.structures.shapes import arch


def factor(assembly: Assembly) -> float:
    """Acceleration along x over g that limit analysis allows."""
    loads = acceleration(assembly, (1.0, 0.0, 0.0))
    return limit_load(assembly, loads, friction=True).load / free_weight(assembly)


@pytest.mark.parametrize(("friction", "slope", "turn"), [(0.2, 0.2, 0.0), (0.84, 0.4, 2.0)])
def test_a_block_slides_or_overturns_as_by_hand(friction: float, slope: float, turn: float) -> None:
    """Either way it moves up, 1 m along: by dilation, or about its foot 0.5 m below."""
    model = on_ground(friction)
    loads = acceleration(model, (1.0, 0.0, 0.0))
    limit, sliding = limit_load(model, loads, friction=True), sliding_limit(model, loads)
    assert limit.mechanism[1] == pytest.approx([1.0, 0.0, slope, 0.0, turn, 0.0], abs=1e-6)
    for load, near in (
        (limit.load, 1e-6),
        (sliding.associated.load, 1e-6),
        (sliding.state.load, 1e-4),
        (static_peak(model, loads).peak.load, 1e-3),
    ):
        assert load == pytest.approx(slope * BLOCK.weight, rel=near)


def test_friction_of_the_bond_adds_its_share_of_the_weight_to_the_cohesion() -> None:
    slab = box("slab", (0.0, 0.0, 0.0), (0.4, 0.6, 0.01), 2e3)
    glue = FaceMaterial(1e10, 1e10, 0.0, 5e3, 1e6, bond_friction=0.5)
    model = structure([GROUND, slab], glue)
    at_foot = force_at(model, "slab", (0.0, 0.3, 0.0), (1.0, 0.0, 0.0))
    expected = 5e3 * 0.4 * 0.6 + 0.5 * slab.weight
    assert limit_load(model, at_foot).load == pytest.approx(expected, rel=1e-6)
    assert static_peak(model, at_foot).peak.load == pytest.approx(expected, rel=1e-4)


GLUE = FaceMaterial(1e10, 1e10, 0.0, 1e9, 2e4)


def test_a_bonded_block_tears_off_where_the_stress_of_a_beam_reaches_its_strength() -> None:
    glue = replace(GLUE, normal_stiffness=1e13, shear_stiffness=1e13)  # does not tilt
    model = structure([GROUND, BLOCK], glue)
    first = static_peak(model, acceleration(model, (1.0, 0.0, 0.0))).first_failure_load
    section, arm = 0.6 * 0.4**2 / 6, 0.5  # load at mid-height
    expected = (2e4 + BLOCK.weight / (0.4 * 0.6)) * section / arm
    assert first == pytest.approx(expected, rel=1e-6)


def test_a_refined_structure_has_each_cell_divided_and_the_same_faces() -> None:
    model = structure(arch(5, 0.3), dry(0.7), mesh=0.1)
    fine = refined(model)
    assert fine.faces == model.faces
    assert fine.mesh == model.mesh / 2
    areas = [np.bincount(each.nodes.face, each.nodes.area) for each in (model, fine)]
    assert areas[1] == pytest.approx(areas[0])
    # Vertices of p x q cells are (p + 1)(q + 1): 2 x 3 cells become 4 x 6.
    assert {*np.bincount(model.nodes.face)} == {4 * 4}
    assert {*np.bincount(fine.nodes.face)} == {7 * 7}


@settings(max_examples=5, deadline=None)
@given(
    turn=st.lists(st.floats(-3.0, 3.0), min_size=3, max_size=3),
    shift=st.lists(st.floats(-9.0, 9.0), min_size=3, max_size=3),
)
def test_a_bonded_pair_carries_the_same_anywhere(turn: list[float], shift: list[float]) -> None:
    glue = FaceMaterial(1e10, 5e9, 0.0, 5e3, 4e3)
    about = Rotation.from_rotvec(turn)
    blocks = [GROUND, BLOCK]
    here = structure(blocks, glue)
    there = structure([moved(block, about, shift) for block in blocks], glue)
    found = []
    for model, rotation in ((here, Rotation.identity()), (there, about)):
        push = acceleration(model, rotation.apply([1.0, 0.5, 0.0]).tolist()).variable
        found.append(limit_load(model, Loads(np.zeros((2, 6)), push, 1e3)).load)
    assert found[1] == pytest.approx(found[0], rel=1e-6)


@pytest.mark.parametrize(("size", "density"), [(1e-3, 1e6), (1e3, 1e-6)])
def test_size_and_density_do_not_change_the_tilt_of_a_dry_arch(size: float, density: float) -> None:
    model = structure(arch(9, 0.25, size, 0.3 * size, density), dry(0.7))
    assert factor(model) == pytest.approx(factor(structure(arch(9, 0.25), dry(0.7))), rel=1e-5)


@pytest.mark.parametrize("body", [UpperBody.COLUMNS, UpperBody.MONOLITHIC])
def test_the_joint_is_a_structure_of_its_pieces(body: UpperBody) -> None:
    joint = sawn(3, upper_body=body, hold_down=HoldDown.force(500.0))
    model, loads = posed(joint, Loading(Direction(0.3)), 0.03, NodeLayout.LOBATTO, least=1)
    blocks = [
        box(p.name, p.low, p.high, p.mass / math.prod(p.size) or 1.0, fixed=p.fixed)
        for p in model.cuboids
    ]
    names = [block.name for block in blocks]
    laws = {frozenset({names[f.below], names[f.above]}): f.material for f in model.faces}
    same = structure(blocks, dry(0.0), laws, mesh=0.03, nodes=NodeLayout.LOBATTO)
    same = replace(same, length=model.length, share=0.5)
    assert len(same.faces) == len(model.faces)
    found, expected = static_peak(same, loads), static_peak(model, loads)
    assert found.first_failure_load == pytest.approx(expected.first_failure_load, rel=1e-9)
    assert found.peak.load == pytest.approx(expected.peak.load, rel=1e-9)
    assert limit_load(same, loads).load == pytest.approx(limit_load(model, loads).load, rel=1e-8)


# --- blocks and interfaces -----------------------------------------------------------------------
L_SHAPE = [(0, 0, 0), (2, 0, 0), (2, 1, 0), (1, 1, 0), (1, 2, 0), (0, 2, 0)]


def test_mass_and_centroid_of_a_block_that_is_not_convex() -> None:
    corner = prism("corner", L_SHAPE, (0.0, 0.0, 0.5), 100.0)
    assert corner.mass == pytest.approx(150.0)
    assert corner.centre == pytest.approx([5 / 6, 5 / 6, 0.25])


def test_inertia_of_a_cuboid() -> None:
    expected = BLOCK.mass / 12 * np.array([0.52, 1.16, 1.36])
    assert sorted(BLOCK.inertia) == pytest.approx(expected)


def test_an_interface_that_is_not_convex_has_nodes_of_its_whole_area() -> None:
    on_it = prism("corner", L_SHAPE, (0.0, 0.0, 0.5), 100.0)
    for layout in NodeLayout:
        model = structure([replace(GROUND, name="g"), on_it], dry(0.5), mesh=0.7, nodes=layout)
        assert model.nodes.area.sum() == pytest.approx(3.0)
        middle = model.nodes.area @ model.nodes.position / 3.0
        assert middle == pytest.approx([5 / 6, 5 / 6, 0.0])


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"faces": BLOCK.faces[1:]}, "block: its faces must close a volume"),
        ({"faces": tuple(face[::-1] for face in BLOCK.faces)}, "anticlockwise seen from outside"),
        ({"vertices": (*BLOCK.vertices[:7], (9.0, 9.0, 9.0))}, "block, face .: must be plane"),
        ({"vertices": (BLOCK.vertices[1], *BLOCK.vertices[1:])}, "block: no two vertices"),
        ({"density": -1.0}, r"block, density \(kg/m3\)"),
    ],
)
def test_bad_geometry_is_refused_by_name(change: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        replace(BLOCK, **change)


SUNK = moved(BLOCK, Rotation.identity(), (0.0, 0.0, -0.01))
BESIDE = box("beside", (1.0, 0.0, 0.0), (1.4, 0.6, 1.0), 2e3)
INSIDE = box("inside", (0.1, 0.1, 0.5), (0.2, 0.2, 0.6), 2e3)
FLOATING = [
    box("one", (5.0, 0.0, 3.0), (6.0, 1.0, 4.0), 2e3),
    box("two", (5.0, 0.0, 4.0), (6.0, 1.0, 5.0), 2e3),
]


@pytest.mark.parametrize(
    ("blocks", "more", "words"),
    [
        ([BLOCK, BESIDE], {"special": {frozenset({"block", "beside"}): GLUE}}, "beside and block"),
        ([BLOCK, INSIDE], {}, r"^blocks: block and inside overlap by 0\.2 m$"),
        ([SUNK], {}, r"^blocks: ground and block overlap by 0\.01 m; .*tolerance: 0\.009$"),
        # Beside several small blocks the ground is a large one.
        ([SUNK, BESIDE], {}, r"^blocks: ground and block overlap by 0\.01 m; .*tolerance: 0\.009$"),
        ([BLOCK, *FLOATING], {}, "one, two: must be linked to a fixed block"),
        # Before it is made:
        ([BLOCK], {"mesh": 1e-4}, r"mesh: 0.0001 .* at least 0.0011 m: more than 200,000"),
    ],
)
def test_blocks_that_make_no_structure_are_named(
    blocks: list[Block], more: dict[str, Any], words: str
) -> None:
    with pytest.raises(ValueError, match=words):
        structure([GROUND, *blocks], dry(0.5), **more)


@pytest.mark.parametrize("turn", [(0, 0, 0), (20, 30, 40)])
def test_blocks_that_are_not_convex_may_touch_but_not_overlap(turn: tuple[int, int, int]) -> None:
    ell = [(0, 0, 0), (2, 0, 0), (2, 0, 1), (1, 0, 1), (1, 0, 2), (0, 0, 2)]
    angle = prism("angle", ell, (0.0, 1.0, 0.0), 2e3, fixed=True)
    for depth in (0.0, 0.01):
        seat = box("seat", (1.0 - depth, 0.0, 1.0), (2.0, 1.0, 2.0), 2e3)
        turned = Rotation.from_euler("xyz", turn, degrees=True)
        pair = [moved(each, turned, (0.0, 0.0, 0.0)) for each in (angle, seat)]
        assert shared_volume(*pair) == pytest.approx(depth, abs=1e-9)
        if depth:
            words = r"^blocks: angle and seat overlap by 0\.01 m3; to accept"
            with pytest.raises(ValueError, match=words):
                structure(pair, dry(0.5))
        else:
            assert len(structure(pair, dry(0.5)).faces) == 2


# --- geometry that would give wrong numbers, and rounding ----------------------------------------


@pytest.mark.parametrize("seed", range(8))
def test_interfaces_have_the_area_of_the_cuts_however_they_are_turned(seed: int) -> None:
    """A box cut by random planes, which cut one or all blocks."""
    random = np.random.default_rng(seed)
    blocks, area = [box("all", (0.0, 0.0, 0.0), (1.0, 0.6, 1.2), 2e3)], 0.0
    for _ in range(4):
        normal, point = random.normal(size=3), random.uniform(0.2, 0.8, 3)
        normal /= np.linalg.norm(normal)
        one = random.integers(len(blocks)) if random.random() < 0.4 else None
        parts = [
            (block, *(cut(block, point, normal) if one in (None, k) else (block, None)))
            for k, block in enumerate(blocks)
        ]
        blocks = [part for _, *halves in parts for part in halves if part]
        for whole, low, high in parts:
            if low and high:
                area += (_surface(low) + _surface(high) - _surface(whole)) / 2.0
    blocks = [replace(block, name=f"block{k}") for k, block in enumerate(blocks)]
    turn = Rotation.random(rng=seed)
    turned = [moved(block, turn, (1.0, 2.0, 3.0)) for block in blocks]
    for pieces in (blocks, turned):
        assert sum(each.outline.area for each in interfaces(pieces)) == pytest.approx(area)


def _surface(block: Block) -> float:
    twice = [np.cross(face, np.roll(face, -1, axis=0)).sum(axis=0) for face in block.outlines]
    return float(np.linalg.norm(twice, axis=1).sum() / 2.0)


def test_outlines_that_share_an_edge_but_for_rounding_have_no_region_in_common() -> None:
    # GEOS 3.14 returns the whole of the first one.
    shared = (0.0682526665519692, 0.0476427763183629)
    one = [(-0.2670668943015513, -0.0363457684521236), shared]
    one.append((-0.1863093686091628, 0.2424331647574919))
    low, high, right = -0.4596556840549527, -0.0704736890492468, -0.2455636384976831
    x = -0.4033207058033848
    other = [(x, low), (x, high), shared, (0.451429794930642, right)]
    found = common(shapely.Polygon(one), shapely.Polygon(other), 1e-6)
    assert found.area == pytest.approx(0.0, abs=1e-6)


def test_fixed_blocks_may_overlap_but_not_below_a_block() -> None:
    wall = box("wall", (0.4, -1.0, -0.5), (1.0, 1.0, 1.0), 2e3, fixed=True)
    assert len(structure([GROUND, wall, BLOCK], dry(0.5)).faces) == 2
    with pytest.raises(ValueError, match="ground and again, which are fixed, overlap where block"):
        structure([GROUND, replace(GROUND, name="again"), BLOCK], dry(0.5))


def test_a_pit_that_pierces_another_face_is_refused() -> None:
    pierced = (*BLOCK.vertices, (0.2, 0.3, -0.2))
    top = next(number for number, normal in enumerate(BLOCK.normals) if normal[2] > 0.9)
    around = BLOCK.faces[top]
    sides = [(a, b, 8) for a, b in zip(around, (*around[1:], around[0]), strict=True)]
    faces = (*BLOCK.faces[:top], *BLOCK.faces[top + 1 :], *sides)
    with pytest.raises(ValueError, match=r"block: faces . and . must not cross each other"):
        replace(BLOCK, vertices=pierced, faces=faces)


@pytest.mark.parametrize("shift", [(0.1, 0.1, 0.1), (5.0, 0.0, 0.0)])
def test_several_bodies_as_one_block_are_refused(shift: tuple[float, float, float]) -> None:
    second = tuple(tuple(np.add(vertex, shift).tolist()) for vertex in BLOCK.vertices)
    faces = (*BLOCK.faces, *(tuple(v + 8 for v in face) for face in BLOCK.faces))
    with pytest.raises(ValueError, match=r"block: (must be one body|faces . and .)"):
        replace(BLOCK, vertices=(*BLOCK.vertices, *second), faces=faces)


def test_a_block_may_have_a_cavity() -> None:
    middle = BLOCK.centre
    inner = tuple(tuple(((vertex + middle) / 2).tolist()) for vertex in BLOCK.places)
    faces = (*BLOCK.faces, *(tuple(v + 8 for v in face[::-1]) for face in BLOCK.faces))
    hollow = replace(BLOCK, vertices=(*BLOCK.vertices, *inner), faces=faces)
    assert hollow.volume == pytest.approx(BLOCK.volume * 7 / 8)


@pytest.mark.parametrize("half", [2.0, 100.0, 1e4])
def test_the_size_of_the_ground_decides_nothing(half: float) -> None:
    ground = box("ground", (-half, -half, -1.0), (half, half, 0.0), 2e3, fixed=True)
    small = box("small", (0.0, 0.0, 0.0), (0.06, 0.06, 0.06), 2e3)
    beside = box("beside", (0.06, 0.0, 0.0), (0.12, 0.06, 0.06), 2e3)
    assert len(structure([ground, small, beside], dry(0.5)).faces) == 3
    above = moved(small, Rotation.identity(), (0.0, 0.0, 1e-4))
    assert len(structure([ground, above, beside], dry(0.5)).faces) == 2
