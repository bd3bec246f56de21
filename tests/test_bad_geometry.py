"""Geometry that would give wrong numbers is refused, and rounding makes no interfaces."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from scipy.spatial.transform import Rotation
from structures import BLOCK, GROUND, dry, moved

from sidmacib.structure.blocks import Block, box
from sidmacib.structure.cutting import cut
from sidmacib.structure.interfaces import common, interfaces
from sidmacib.structure.structure import structure

SEEDS = range(8)


def cut_box(seed: int) -> tuple[list[Block], float]:
    """A box cut by random planes, which cut one or all blocks, and the area (m2) of the cuts."""
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
    return [replace(block, name=f"block{k}") for k, block in enumerate(blocks)], area


def _surface(block: Block) -> float:
    twice = [np.cross(face, np.roll(face, -1, axis=0)).sum(axis=0) for face in block.outlines]
    return float(np.linalg.norm(twice, axis=1).sum() / 2.0)


@pytest.mark.parametrize("seed", SEEDS)
def test_interfaces_have_the_area_of_the_cuts_however_they_are_turned(seed: int) -> None:
    blocks, area = cut_box(seed)
    turn = Rotation.random(rng=seed)
    turned = [moved(block, turn, (1.0, 2.0, 3.0)) for block in blocks]
    for pieces in (blocks, turned):
        assert sum(each.outline.area for each in interfaces(pieces)) == pytest.approx(area)


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
