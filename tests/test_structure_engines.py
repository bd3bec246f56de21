"""What distinct elements must find for structures of blocks. Real runs, small ones."""

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import DISTINCT, run_guided
from scipy.spatial.transform import Rotation
from structures import GROUND, dry, moved
from test_capacity_curve import wall
from test_supports import HalfArch, semicircle, two_spans

from sidmacib import capacity_curve, static_peak
from sidmacib.engines import ENGINES, Numerics
from sidmacib.engines.curve import engine_curve, engine_support_path
from sidmacib.engines.results import read_outcome
from sidmacib.engines.run import EngineNoAnswerError, engine_outcome
from sidmacib.mechanics.assembly import Assembly, FaceMaterial, NodeLayout, Vector
from sidmacib.mechanics.equilibrium import unbalanced_share
from sidmacib.problem import Outcome, Problem
from sidmacib.structure.analysis.tilt import static_tilt, tilting
from sidmacib.structure.blocks import box, prism
from sidmacib.structure.loads import acceleration, force_at, support_moves
from sidmacib.structure.locks import ALL, Condensed, Locks
from sidmacib.structure.structure import structure
from studies.structures.shapes import arch

MORTAR = FaceMaterial(1e10, 1e10, 0.4, cohesion=2e4, tensile_strength=1e4)


def leaning(law: FaceMaterial, angle: float) -> Assembly:
    """Two blocks on a fixed one, turned by an angle in degrees about an axis that is oblique."""
    axis = np.array([0.3, 1.0, 0.2])
    turn = Rotation.from_rotvec(math.radians(angle) * axis / np.linalg.norm(axis))
    blocks = [
        moved(block, turn, (0.1, 0.2, 0.3))
        for block in (
            box("ground", (-0.3, -0.3, -0.2), (0.3, 0.3, 0.0), 2e3, fixed=True),
            box("one", (-0.2, -0.15, 0.0), (0.2, 0.15, 0.3), 2e3),
            box("two", (-0.2, -0.15, 0.3), (0.2, 0.15, 0.5), 2e3),
        )
    ]
    return structure(blocks, law, nodes=NodeLayout.VERTICES)


def pushed(assembly: Assembly) -> Problem:
    return Problem(assembly, acceleration(assembly, (1.0, 0.3, 0.0)))


def found(engine: str, problem: Problem, folder: Path) -> Outcome:
    run_guided(engine, problem, Numerics(), folder, 300)
    return read_outcome(folder, problem.assembly)


@pytest.mark.engine
def test_leaning_mortar_fails_where_the_static_model_says(engine: str, tmp_path: Path) -> None:
    problem = pushed(leaning(MORTAR, 25.0))
    expected, outcome = static_peak(*problem), found(engine, problem, tmp_path)
    assert outcome.path[-1].load == pytest.approx(expected.peak.load, rel=2e-3)
    assert outcome.first_failure_load == pytest.approx(expected.first_failure_load, rel=2e-3)
    assert outcome.mode == "bonds"


@pytest.mark.engine
def test_a_stack_tilts_as_far_as_the_static_model_says(engine: str, tmp_path: Path) -> None:
    model = leaning(MORTAR, 0.0)
    problem = Problem(model, tilting(model, (0.2, 1.0, 0.3)))
    expected = static_tilt(*problem)
    outcome, tilt = found(engine, problem, tmp_path), problem.loads.raised
    assert tilt.value(outcome.path[-1].load) == pytest.approx(expected.angle, rel=2e-3)
    if outcome.first_failure_load is not None:
        first = tilt.value(outcome.first_failure_load)
        assert first == pytest.approx(expected.first_failure, rel=2e-3)
    peak = outcome.path[-1]
    assert peak.force is not None
    assert unbalanced_share(*problem, peak.load, peak.force) < 2e-3


@pytest.mark.engine
def test_compression_strengthens_a_bond_by_its_friction(engine: str, tmp_path: Path) -> None:
    rough = replace(MORTAR, friction=1.0, tensile_strength=1e6)
    slab = box("block", (0.0, 0.0, 0.0), (0.4, 0.4, 0.1), 1e4)
    model = structure([GROUND, slab], rough)
    problem = Problem(model, force_at(model, "block", (0.2, 0.2, 0.0), (1.0, 0.0, 0.0)))
    outcome = found(engine, problem, tmp_path)
    expected = rough.cohesion * 0.4 * 0.4 + slab.weight
    assert outcome.first_failure_load == pytest.approx(expected, rel=2e-3)


@pytest.mark.engine
@pytest.mark.parametrize(
    ("law", "close"),
    [(dry(0.7), 5e-3), (replace(MORTAR, cohesion=5e4, tensile_strength=2e4), 0.01)],
)
def test_an_arch_carries_what_the_static_model_says(
    tmp_path: Path, law: FaceMaterial, close: float
) -> None:
    problem = pushed(structure(arch(5, 0.25), law))
    expected, outcome = static_peak(*problem), found("yade", problem, tmp_path)
    assert outcome.path[-1].load == pytest.approx(expected.peak.load, rel=close)


# --- blocks that move far ------------------------------------------------------------------------
def on_the_ground(width: float, height: float, law: FaceMaterial, far: float = 2.0) -> Assembly:
    """A block, a third of a metre deep, on a fixed one that ends ``far`` (m) from its middle."""
    return structure(
        [
            box("ground", (-2.0, -1.0, -0.2), (far, 1.0, 0.0), 2e3, fixed=True),
            box("block", (-width / 2, -0.15, 0.0), (width / 2, 0.15, height), 2e3),
        ],
        law,
    )


def tilted_until_it_falls(engine: str, model: Assembly, axis: Vector, folder: Path) -> float:
    """The tilt (degrees) at which an engine sees ``model`` fall."""
    problem = Problem(model, tilting(model, axis))
    return problem.loads.raised.value(found(engine, problem, folder).path[-1].load)


@pytest.mark.engine
@pytest.mark.parametrize("far", [0.1, 0.05])
def test_a_block_that_juts_out_turns_over_its_edge(engine: str, far: float, tmp_path: Path) -> None:
    model = on_the_ground(0.4, 0.4, dry(2.0), far)
    # The ground's edge is the vertex here, and the block's underside the flat side.
    expected = math.degrees(math.atan(far / 0.2))
    angle = tilted_until_it_falls(engine, model, (0.0, -1.0, 0.0), tmp_path)
    assert angle == pytest.approx(expected, abs=0.2)


@pytest.mark.engine
def test_a_block_turns_over_where_its_centroid_passes_an_edge(engine: str, tmp_path: Path) -> None:
    gap, tips = 0.009, 200.0
    # A force at the bottom moves the block on soft shear springs. Just before it turns over, all of
    # its weight and so all friction is at the edge, on half of the interface.
    area = 0.3 * (0.2 + gap)
    soft = FaceMaterial(1e10, tips / (area / 2) / gap, 2.0, 0.0, 0.0)
    model = on_the_ground(0.4, 0.2, soft, far=gap)
    problem = Problem(model, force_at(model, "block", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)))
    outcome = engine_outcome(ENGINES[engine], problem, folder=tmp_path, time_limit=300)
    assert outcome.path[-1].load == pytest.approx(tips, rel=0.01)
    assert outcome.path[-1].displacement == pytest.approx(gap, rel=0.01)


@pytest.mark.engine
@pytest.mark.parametrize("gap", [0.01, 0.1])
def test_a_block_that_meets_another_has_no_peak(engine: str, gap: float, tmp_path: Path) -> None:
    model = structure(
        [
            box("ground", (-2.0, -1.0, -0.2), (2.0, 1.0, 0.0), 2e3, fixed=True),
            box("block", (-0.2, -0.15, 0.0), (0.2, 0.15, 0.2), 2e3),
            box("wall", (0.2 + gap, -0.15, 0.05), (0.5, 0.15, 0.2), 2e3, fixed=True),
        ],
        dry(0.3),
    )
    problem = Problem(model, acceleration(model, (1.0, 0.0, 0.0)))
    slides = 0.3 * model.pieces[1].weight
    if gap > 0.05:  # it is in full motion before it is there
        assert found(engine, problem, tmp_path).path[-1].load == pytest.approx(slides, rel=2e-3)
        return
    with pytest.raises(
        EngineNoAnswerError, match="block meets wall, where they had no interf"
    ) as no:
        found(engine, problem, tmp_path)
    load = float(re.search(r"at ([\d.]+) N", str(no.value))[1])
    assert load == pytest.approx(slides, rel=2e-3)


@pytest.mark.engine
@pytest.mark.parametrize(
    ("engine", "friction", "top"),
    # The last one rocks first, and its rotation wedges it: small rotations say 35 degrees.
    [*((name, mu, None) for name in DISTINCT for mu in (0.2, 0.5)), ("yade", 0.84, 1.8382)],
)
def test_a_block_wedged_in_a_groove_slides_along_it_as_friction_over_the_flanks_cosine(
    engine: str, friction: float, top: float | None, tmp_path: Path
) -> None:
    """Flanks 30 degrees from the horizontal, as in type c; the block fills the groove up to top."""
    above = [(1.0, top), (-1.0, top)] if top else []
    rise = math.tan(math.radians(30.0))
    left = ((-1.0, rise), (0.0, 0.0), (0.0, -0.5), (-1.0, -0.5))
    bases = {
        "left": left,
        "right": tuple((-x, z) for x, z in left),
        "block": ((0.0, 0.0), (1.0, rise), *above, (-1.0, rise)),
    }
    blocks = [
        prism(n, [(x, 0.0, z) for x, z in base], (0.0, 1.0, 0.0), 2e3, fixed=n != "block")
        for n, base in bases.items()
    ]
    model = structure(blocks, dry(friction))
    expected = math.degrees(math.atan(friction / math.cos(math.radians(30.0))))
    if top:
        tilt = tilting(model, (1.0, 0.0, 0.0))
        assert static_tilt(model, tilt).angle == pytest.approx(expected, abs=0.7)
    angle = tilted_until_it_falls(engine, model, (1.0, 0.0, 0.0), tmp_path)
    assert angle == pytest.approx(expected, abs=0.4)


# --- capacity curves -----------------------------------------------------------------------------
@pytest.mark.engine
@pytest.mark.parametrize("what", ["block", "wall", "arch"])
def test_what_yade_moves_carries_what_its_kinematics_say(what: str, tmp_path: Path) -> None:
    models = {
        "block": on_the_ground(0.4, 1.0, dry(0.7)),
        "wall": wall(0.1)[0],
        "arch": structure(arch(3, 0.3), dry(0.9)),
    }
    model = models[what]
    problem = Problem(model, acceleration(model, (1.0, 0.0, 0.0)))
    known = capacity_curve(*problem)
    furthest = 0.95 * float(known.displacement[-1])  # at the end of its curve, the wall falls
    displacement, load = engine_curve(problem, Numerics(damping=0.7), furthest, tmp_path, 300)
    assert displacement[-1] == pytest.approx(furthest, rel=0.01)
    moves = displacement > 0.01 * furthest  # before, joints only give way
    apart = load - np.interp(displacement, known.displacement, known.load)
    assert np.abs(apart[moves]).max() < 0.03 * known.load[0]


@pytest.mark.engine
def test_a_block_that_yade_pulls_over_an_edge_slides_and_then_turns_over(tmp_path: Path) -> None:
    model = on_the_ground(0.4, 0.2, dry(0.2), far=0.1)
    problem = Problem(model, acceleration(model, (1.0, 0.0, 0.0)))
    moved_by, load = engine_curve(problem, Numerics(damping=0.7), 0.098, tmp_path, 300)
    # The load is 0.1 m above the edge, which the centroid reaches at 0.1 m.
    # Where it slides, friction may hold it at rest under less.
    weight, tips = model.pieces[1].weight, moved_by > 0.085
    known = weight * (0.1 - moved_by) / 0.1
    assert tips.sum() > 4
    assert load[tips] == pytest.approx(known[tips], abs=0.002 * weight)
    assert load.max() < 0.201 * weight


# --- supports that move --------------------------------------------------------------------------
@pytest.mark.engine
def test_an_arch_on_spreading_supports_falls_in_yade_where_its_hinges_say(tmp_path: Path) -> None:
    model, loads = semicircle()
    numerics = Numerics(ramp_periods=10.0, tolerance=0.0025)
    movement, reaction = engine_support_path(Problem(model, loads), numerics, tmp_path, 500)
    known, weight = HalfArch(), loads.scale
    assert movement[-1] == pytest.approx(known.falls(), rel=0.02)
    least = known.thrust(0.0)[0]
    assert reaction[0] / weight > 1.1 * least  # at rest
    yields = (movement > 1e-4) & (movement < 1e-3)
    assert reaction[yields] / weight == pytest.approx(least, rel=0.02)
    expected = [known.thrust(each)[0] for each in movement[movement > 1e-4].tolist()]
    assert reaction[movement > 1e-4] / weight == pytest.approx(expected, rel=0.03)


@pytest.mark.engine
def test_a_wall_slides_off_a_settling_beam_in_yade_where_friction_says(tmp_path: Path) -> None:
    problem = Problem(model := two_spans(0.2), support_moves(model, "right", (0, 0, -1)))
    movement, _ = engine_support_path(problem, Numerics(), tmp_path, 300)
    assert movement[-1] == pytest.approx(0.2 * (4.1 - 2.1), rel=0.01)


def test_supports_that_move_are_for_support_paths_only(engine: str, tmp_path: Path) -> None:
    problem = Problem(model := two_spans(), support_moves(model, "right", (0, 0, -1)))
    with pytest.raises(ValueError, match="a support moves"):
        engine_outcome(ENGINES[engine], problem, folder=tmp_path)


def test_a_capacity_curve_of_yade_is_one_of_an_acceleration(tmp_path: Path) -> None:
    model = on_the_ground(0.4, 1.0, dry(0.7))
    tilts = Problem(model, tilting(model, (0.0, 1.0, 0.0)))
    with pytest.raises(EngineNoAnswerError, match="needs an acceleration as the load"):
        engine_curve(tilts, Numerics(), 0.1, tmp_path, 300)


# --- what is written for the engines ------------------------------------------------------------


def test_what_an_engine_cannot_do_is_refused_by_name(engine: str, tmp_path: Path) -> None:
    pair = frozenset(("one", "two"))
    blocks = [
        box("one", (0.0, 0.0, 0.0), (0.4, 0.4, 0.2), 2e3, fixed=True),
        box("two", (0.0, 0.0, 0.2), (0.4, 0.4, 0.4), 2e3),
    ]
    locks = Locks(3, 0.02, row=(0.0, 1.0, 0.0), condensed=Condensed(ALL))
    condensed = structure(blocks, dry(0.5), locked={pair: locks})
    with pytest.raises(EngineNoAnswerError, match=f"^{engine}: one-two has condensed locks"):
        found(engine, pushed(condensed), tmp_path)
    rough = structure(blocks, replace(MORTAR, bond_friction=0.5))
    if engine == "yade":
        words = "^yade: one-two has a bond_friction of 0.5; it must be 0 or 0.4, the friction"
        with pytest.raises(EngineNoAnswerError, match=words):
            found(engine, pushed(rough), tmp_path)
