"""Interfaces whose blocks have a compressive strength, against closed forms."""

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from command_runner import answers, assembly
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq
from structures import CUBE, PUSH, example, study

from sidmacib import CapacityError, capacity_curve, limit_load
from sidmacib.answers.structure import static_answer
from sidmacib.answers.structure_paths import CRUSHING
from sidmacib.design.file import task_of
from sidmacib.engines import ENGINES
from sidmacib.engines.run import refusal
from sidmacib.mechanics.assembly import GRAVITY
from sidmacib.mechanics.crushing import stress_blocks
from sidmacib.problem import Problem
from sidmacib.structure.analysis.limit import limit_tilt
from sidmacib.structure.analysis.tilt import tilting
from sidmacib.structure.files.structure_file import structure_of
from workflow.schema import with_changes

STRENGTH = 5e5  # Pa
WIDTH, DEPTH, HEIGHT = 1.0, 0.6, 2.0
WEIGHT = 2000.0 * GRAVITY * WIDTH * DEPTH * HEIGHT
CLOSE = 0.985  # of the exact limit, which is never exceeded


def pier(load: dict[str, Any], strength: float = STRENGTH, **law: float) -> dict[str, Any]:
    """On joints so stiff that it hardly turns before an edge is crushed."""
    stiff = {"normal_stiffness": 1e14, "shear_stiffness": 1e14}
    interfaces = {"friction": 0.7, "compressive_strength": strength, **stiff, **law}
    changes = {"blocks": {"cube": {"high": [WIDTH, DEPTH, HEIGHT]}}, "interfaces": interfaces}
    return with_changes(CUBE, changes) | {"load": load}


def limit_of(description: dict[str, Any]) -> float:
    return limit_load(*structure_of(description), friction=True).load


def pressed(x: float, y: float) -> dict[str, Any]:
    """A force downwards at this eccentricity."""
    at = [WIDTH / 2 + x, DEPTH / 2 + y, HEIGHT]
    return {"force": {"block": "cube", "at": at, "direction": [0, 0, -1]}}


def assert_both_crush(problem: Problem, limit: float) -> None:
    """Forces can go nowhere else: an interface is crushed at the ``limit`` of limit analysis."""
    found = static_answer(problem)
    assert found.mode == CRUSHING
    assert found.load == found.path[-1].load == pytest.approx(limit, rel=1e-6)
    words = found.counts.why.split("; ")[1]
    told = re.fullmatch(r"ground-cube is at its compressive strength from (\S+) \w+ on", words)
    assert told and float(told[1]) == pytest.approx(limit, rel=1e-3)


@pytest.mark.long
@pytest.mark.parametrize("share", [0.0, 0.07, 0.2, 0.25, 0.37, 0.45])
def test_a_block_under_an_eccentric_load_carries_a_rectangular_stress_block(share: float) -> None:
    """N = f_c b (h - 2 e), of the load and the weight, which is in the middle."""
    for load in (pressed(share * WIDTH, 0.0), pressed(0.0, share * DEPTH)):
        found = limit_of(pier(load))
        normal = found + WEIGHT
        exact = STRENGTH * WIDTH * DEPTH * (1.0 - 2.0 * share * found / normal)
        assert CLOSE * exact <= normal <= exact * (1.0 + 1e-6)
        if share == 0.25:  # and in the static model, which has no other limit
            assert_both_crush(structure_of(pier(load)), found)


def test_a_pier_overturns_about_the_middle_of_what_is_pressed() -> None:
    """H h / 2 = W (b - c) / 2, with c = W / (f_c d)."""
    depth = WEIGHT / (STRENGTH * DEPTH)
    exact = WEIGHT * (WIDTH - depth) / HEIGHT
    load = limit_of(pier(PUSH))
    assert CLOSE * exact <= load <= exact
    assert_both_crush(structure_of(pier(PUSH)), load)


@pytest.mark.long
def test_a_pier_that_is_tilted_is_crushed_before_it_overturns() -> None:
    def left(angle: float) -> float:
        e = HEIGHT / 2 * math.tan(angle)
        return STRENGTH * DEPTH * (WIDTH - 2 * e) - WEIGHT * math.cos(angle)

    exact = math.degrees(brentq(left, 0.0, math.atan(WIDTH / HEIGHT)))
    problem = structure_of(pier({"tilt": {"axis": [0, 1, 0]}}))
    found = limit_tilt(problem.assembly, tilting(problem.assembly, (0, 1, 0))).angle
    assert found == pytest.approx(exact, rel=5e-3)
    assert_both_crush(problem, found)


def test_bonds_that_pull_press_the_other_side_more() -> None:
    """All of a ductile bond pulls but the nodes at the edge where the stress block is."""
    law = {"cohesion": 1e6, "tensile_strength": 1e5}
    description, loads = pier(PUSH, **law), []
    for changes in ({}, {"compressive_strength": 10 * STRENGTH}, {"tensile_strength": 1e4}):
        description["interfaces"] |= changes
        loads.append(limit_of(description))
    assert loads[1] > loads[0] > loads[2]
    tension = 1e5 * WIDTH * DEPTH  # by Simpson's rule: 1/6 at one edge, 4/6 in the middle
    pressed = WEIGHT + 5 / 6 * tension
    moment = tension / 6 * WIDTH / 2 + pressed * (WIDTH - pressed / (STRENGTH * DEPTH)) / 2
    assert CLOSE <= loads[0] * HEIGHT / 2 / moment <= 1.0


OUTLINES = {
    "rectangle": shapely.box(-0.5, -0.2, 0.5, 0.2),
    "triangle": shapely.Polygon([(-0.3, -0.2), (0.6, -0.2), (-0.3, 0.4)]),
    "hexagon": shapely.Polygon([(math.cos(k), math.sin(k)) for k in np.arange(6) * math.pi / 3]),
}


@pytest.mark.parametrize("name", OUTLINES)
@settings(max_examples=30, deadline=None)
@given(angle=st.floats(0, 2 * math.pi), share=st.floats(0.02, 1.0))
def test_no_stress_block_is_taken_to_carry_more(name: str, angle: float, share: float) -> None:
    outline = OUTLINES[name]
    blocks = stress_blocks(outline)
    way = np.array([math.cos(angle), math.sin(angle)])
    reach = shapely.get_coordinates(outline) @ way
    least = reach.max() - share * np.ptp(reach)
    across = 9.0 * np.array([-way[1], way[0]])
    corners = [least * way - across, 9.0 * way - across, 9.0 * way + across, least * way + across]
    part = outline.intersection(shapely.Polygon(corners))
    place = np.array([part.centroid.x, part.centroid.y]) / blocks.size
    use = blocks.use(part.area / outline.area * np.array([1.0, *place]))
    assert use >= 1.0 - 1e-9  # it is at the exact limit
    if share > 0.2:
        assert use <= 1.3  # which the polyhedron is not far inside of, however askew


@pytest.mark.long
def test_forces_that_can_go_elsewhere_carry_more_than_what_crushes_first() -> None:
    """An arch with its first hinge is no mechanism: limit analysis decides, below the peak."""
    without = static_answer(structure_of(study("arch/arch"))).load
    arch = study("arch/arch", compressive_strength=2e5)
    found, limit = static_answer(structure_of(arch)), limit_of(arch)
    assert found.load == pytest.approx(limit, rel=1e-6)
    assert limit < 0.95 * without
    assert float(found.counts.why.split(" N on")[0].split()[-1]) < 0.96 * limit
    smooth = study("arch/arch", compressive_strength=1e12, friction=0.35)
    slides = static_answer(structure_of(smooth))
    assert slides.load < limit_of(smooth)
    assert slides.mode != CRUSHING


@pytest.mark.long
def test_the_command_names_what_is_crushed_and_decides_by_it(path: Path) -> None:
    demand = PUSH | {"newtons": "5kN"}
    found = assembly(path, pier(demand))
    assert "; crushed: ground-cube; largest displacement: cube" in found.output
    line = found.output.splitlines()[0]
    assert line == (
        "Yes: it carries 5000 N with a factor of 2.17; the peak counts: limited by crushing in "
        "limit analysis; ground-cube is at its compressive strength from 10847 N on; without "
        "crushing 11751 N"
    )
    (row,) = answers("assembly", str(path), "--interfaces")
    assert row["utilisation"] == pytest.approx(1.0, abs=1e-3)
    found = assembly(path, pier(demand, strength=0.9 * 2000 * GRAVITY * 2))
    assert found.exit_code == 1
    assert found.output.startswith("No: the structure does not stand under its own weight")
    keyed = example("keyed") | {"interfaces": {"friction": 0.5, "compressive_strength": "5MPa"}}
    words = "Note: compressive_strength: does not limit interfaces with"
    assert words in assembly(path, keyed).output


def test_what_knows_no_crushing_refuses_it() -> None:
    description = pier(PUSH)
    problem = structure_of(description)
    with pytest.raises(CapacityError, match="leave out compressive_strength"):
        capacity_curve(*problem)
    for name in ("yade", "liggghts"):
        said = refusal(ENGINES[name], problem.assembly)
        assert said == "ground-cube has a compressive_strength; no engine models crushing"
    locks, cases = {"width": 0.05, "height": 0.02}, {"push": PUSH | {"newtons": 1}}
    with pytest.raises(ValueError, match="compressive_strength: is for multilock assembly"):
        task_of({**description, "design": {"locks": locks, "cases": cases}})
