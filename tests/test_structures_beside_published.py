"""The study of structures: its programmes against theory, its samples, and its page."""

import math

import pytest
import yaml
from structures import BLOCK, GROUND, LEANING, degrees, dry, on_ground

from sidmacib.mechanics.assembly import Assembly, Loads, Vector
from sidmacib.structure.analysis.limit import limit_tilt
from sidmacib.structure.analysis.tilt import static_tilt, tilting
from sidmacib.structure.blocks import Block, box, prism
from sidmacib.structure.structure import structure
from studies.structures.compare import PUBLISHED, TYPES
from studies.structures.other_methods import pyramid_tilt, relaxed_tilt
from studies.structures.shapes import AXES, answers, pushed_walls

Y = (0.0, 1.0, 0.0)


def tilts(model: Assembly, axis: Vector = Y) -> tuple[Assembly, Loads]:
    return model, tilting(model, axis)


def notch(width: float, height: float) -> list[Block]:
    """A long block in a notch between two flanks, as type c: it turns over before it slides."""
    low, high = 0.5, 0.5 + width / math.sqrt(3.0)
    blocks = []
    for name, side in (("left", -1.0), ("right", 1.0)):
        top = [(side * 2.0, 0, high), (side * width, 0, high), (0, 0, low)]
        outline = [(0, 0, 0), (side * 2.0, 0, 0), *top]
        blocks.append(prism(name, outline, (0.0, 1.0, 0.0), 2e3, fixed=True))
    outline = [(0, 0, low), (width, 0, high), (width, 0, height), (-width, 0, height)]
    return [*blocks, prism("key", [*outline, (-width, 0, high)], (0.0, 1.0, 0.0), 2e3)]


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize(("friction", "expected"), [(0.2, degrees(0.2)), (0.84, degrees(0.4))])
def test_a_block_rests_on_a_slope_as_by_hand(
    friction: float, expected: float, finite: bool
) -> None:
    found = relaxed_tilt(*tilts(on_ground(friction)), finite=finite)
    assert found == pytest.approx(expected, abs=0.3)


@pytest.mark.study
def test_finite_rotations_wedge_a_block_that_small_ones_let_go() -> None:
    """It then slides as a whole, at a friction of mu over the sine of half the notch's angle."""
    model, tilt = tilts(structure(notch(1.0, 2.3), dry(0.84)), (1.0, 0.0, 0.0))
    small = relaxed_tilt(model, tilt, finite=False)
    assert small == pytest.approx(static_tilt(model, tilt).angle, abs=0.3)
    slides = degrees(0.84 / math.cos(math.radians(30.0)))
    assert small < slides - 5.0
    assert relaxed_tilt(model, tilt, finite=True) == pytest.approx(slides, abs=0.3)


def test_relaxation_is_for_one_free_block() -> None:
    other = box("other", (0.0, 0.0, 1.0), (0.4, 0.6, 2.0), 2e3)
    with pytest.raises(ValueError, match="one block must be free"):
        relaxed_tilt(*tilts(structure([GROUND, BLOCK, other], dry(0.5))), finite=True)


def test_a_pyramid_around_the_cone_holds_at_most_8_percent_more() -> None:
    model = on_ground(0.2)
    assert pyramid_tilt(*tilts(model)) == pytest.approx(degrees(0.2), rel=1e-6)
    turn = math.radians(22.5)
    between = pyramid_tilt(*tilts(model, (math.cos(turn), math.sin(turn), 0.0)))
    assert between == pytest.approx(degrees(0.2 / math.cos(turn)), rel=1e-6)


def test_a_pyramid_sees_what_stands_upside_down_and_what_falls() -> None:
    wedged = tilts(structure(notch(1.0, 2.3), dry(3.0)))
    assert limit_tilt(*wedged).angle == pyramid_tilt(*wedged)
    assert pyramid_tilt(*tilts(structure([GROUND, LEANING], dry(0.7)))) is None


def test_shapes_have_their_known_answers() -> None:
    published = yaml.safe_load(PUBLISHED.read_text())
    for answer in answers(published["shapes"]):
        near = 0.003 if answer.source in published["sources"] else 1e-6
        assert answer.limit == pytest.approx(answer.known, rel=near), answer.name
        if answer.static is not None:
            assert answer.static == pytest.approx(answer.limit, rel=1e-4), answer.name


def test_walls_that_slide_carry_their_known_acceleration_and_less_along_a_path() -> None:
    """Those of Ferris & Tin-Loi: sliding that dilates holds more than friction with a history."""
    published = yaml.safe_load(PUBLISHED.read_text())
    for answer in pushed_walls(published["shapes"]):
        assert answer.limit == pytest.approx(answer.known, abs=6e-6), answer.name
        assert answer.static is not None
        assert 0.85 * answer.limit < answer.static < answer.limit - 1e-3, answer.name


def test_published_values_are_of_samples_and_axes_that_there_are() -> None:
    published = yaml.safe_load(PUBLISHED.read_text())
    keys = [(each["sample"], each["friction"], each["axis"]) for each in published["tilts"]]
    assert len(set(keys)) == len(keys) == 12
    assert {sample for sample, _, _ in keys} <= set(TYPES)
    assert {axis for _, _, axis in keys} == set(AXES)
