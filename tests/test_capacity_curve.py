"""Capacity curves: rigid blocks followed at finite displacements, against closed forms."""

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import brentq
from structures import BLOCK, GROUND, dry, on_ground

from sidmacib import CapacityCurve, CapacityError, capacity_curve
from sidmacib.mechanics.assembly import Assembly, FaceMaterial, Floats
from sidmacib.structure.analysis.contacts import Placement
from sidmacib.structure.analysis.tilt import tilting
from sidmacib.structure.blocks import box, prism
from sidmacib.structure.loads import acceleration, force_at, free_weight, support_moves
from sidmacib.structure.structure import structure
from studies.structures.shapes import arch

WIDTH, DEPTH, HEIGHT = 0.4, 0.6, 1.0
ALONG_X = (1.0, 0.0, 0.0)


def turns(curve: CapacityCurve, piece: int) -> Floats:
    """The rotation of a piece about y at each position, in rad."""
    matrices = [each.placed.turn[piece] for each in curve.path.positions]
    return np.array([math.atan2(turn[0, 2], turn[0, 0]) for turn in matrices])


@pytest.mark.long
def test_a_rocking_block_carries_its_weight_times_tan_of_what_is_left_of_the_angle() -> None:
    model = on_ground(0.7)
    curve = capacity_curve(model, acceleration(model, ALONG_X))
    weight, alpha = free_weight(model), math.atan(WIDTH / HEIGHT)
    expected = weight * np.tan(alpha - turns(curve, 1))
    assert curve.load[:-1] == pytest.approx(expected[:-1], abs=1e-6 * curve.load[0])
    # The centroid is above the edge at the end.
    assert curve.displacement[-1] == pytest.approx(WIDTH / 2, rel=1e-4)
    assert curve.load[-1] == 0.0
    assert curve.end == "the load falls to 0 at 0.2 m"
    assert curve.hinges == ("ground-block",) and not curve.slides


@pytest.mark.long
def test_the_point_of_a_force_moves_with_its_block() -> None:
    model = on_ground(0.7)
    loads = force_at(model, "block", (0.0, DEPTH / 2, HEIGHT), ALONG_X)
    curve = capacity_curve(model, loads)
    turn = turns(curve, 1)[:-1]
    lever = WIDTH / 2 * np.cos(turn) - HEIGHT / 2 * np.sin(turn)
    expected = free_weight(model) * lever / (HEIGHT * np.cos(turn) + WIDTH * np.sin(turn))
    assert curve.load[:-1] == pytest.approx(expected, abs=1e-6 * curve.load[0])


@pytest.mark.long
def test_a_block_that_slides_does_not_climb_and_tips_where_its_centroid_leaves_the_edge() -> None:
    blocks = [
        box("table", (-0.2, 0.0, -0.1), (0.5, DEPTH, 0.0), 2e3, fixed=True),
        box("block", (0, 0, 0), (WIDTH, DEPTH, 0.2), 2e3),
    ]
    model = structure(blocks, dry(0.2))
    curve = capacity_curve(model, acceleration(model, ALONG_X))
    slides = curve.displacement < 0.2
    assert curve.load[slides] / free_weight(model) == pytest.approx(0.2, rel=1e-6)
    assert curve.slides == ("table-block",)
    assert curve.displacement[-1] == pytest.approx(0.3, abs=0.002)
    heights = [each.placed.centre[1, 2] for each in curve.path.positions]
    assert max(heights) == pytest.approx(0.1, abs=0.002)


@pytest.mark.long
def test_blocks_none_of_which_is_convex_are_followed() -> None:
    angle = [(0, 0, 0), (0.6, 0, 0), (0.6, 0.2, 0), (0.2, 0.2, 0), (0.2, 0.6, 0), (0, 0.6, 0)]
    base = prism("base", angle, (0.0, 0.0, -0.1), 2e3, fixed=True)
    model = structure([base, prism("block", angle, (0.0, 0.0, 1.0), 2e3)], dry(0.7))
    curve = capacity_curve(model, acceleration(model, ALONG_X))
    assert "the load falls to 0" in curve.end


def wall(stop: float) -> tuple[Assembly, Callable[[float], tuple[Floats, Floats]]]:
    """Two blocks that bulge between the ground and a smooth stop, and their centroids by angle.

    The lower block turns about its toe, the upper one about the edge between them while its side
    leans on the lower edge of the stop, which is ``stop`` (m) below its top.
    """
    t, h = 0.3, 1.0
    blocks = [
        GROUND,
        box("lower", (0, 0, 0), (t, 1, h), 2e3),
        box("upper", (0, 0, h), (t, 1, 2 * h), 2e3),
        box("stop", (t, 0, 2 * h - stop), (1 + t, 1, 2 * h + 0.3), 2e3, fixed=True),
    ]
    model = structure(blocks, dry(0.7), {frozenset({"upper", "stop"}): dry(0.0)})

    def centroids(angle: float) -> tuple[Floats, Floats]:
        sine, cosine = math.sin(angle), math.cos(angle)
        hinge = np.array([t - t * cosine + h * sine, h * cosine + t * sine])
        x, z = t - hinge[0], 2 * h - stop - hinge[1]
        back = math.atan2(z, x) - math.acos(t / math.hypot(x, z))
        s, c = math.sin(back), math.cos(back)
        lower = np.array([t - t / 2 * cosine + h / 2 * sine, h / 2 * cosine + t / 2 * sine])
        return lower, hinge + np.array([t / 2 * c - h / 2 * s, t / 2 * s + h / 2 * c])

    return model, centroids


def by_virtual_work(centroids: Callable[[float], tuple[Floats, Floats]], angle: float) -> float:
    """The load, as an acceleration of both, over the weight of one."""
    step = 1e-6
    after, before = (np.array(centroids(angle + change)) for change in (step, -step))
    x, z = (after - before).sum(axis=0)
    return float(2.0 * z / x)


@pytest.mark.long
def test_a_wall_of_two_blocks_follows_its_three_hinges() -> None:
    model, centroids = wall(0.1)
    curve = capacity_curve(model, acceleration(model, ALONG_X))
    weight = free_weight(model) / 2
    expected = [weight * by_virtual_work(centroids, angle) for angle in turns(curve, 1).tolist()]
    assert curve.load == pytest.approx(np.array(expected), abs=3e-3 * curve.load[0])
    # Where both centroids are as far inside the toe as the load needs, the stop is no longer
    # pressed: the upper block falls back, at once.
    assert curve.end.startswith("the blocks fall at")

    def stop_is_pressed(angle: float) -> float:
        """Moment of the load about the toe less that of the weights, which the stop adds to."""
        lower, upper = centroids(angle)
        load = by_virtual_work(centroids, angle)
        return float(load * (lower[1] + upper[1]) / 2 - (0.6 - lower[0] - upper[0]))

    last = brentq(stop_is_pressed, 0.01, 0.4)
    assert turns(curve, 1)[-1] == pytest.approx(last, rel=0.01)


def with_hinges_that_stay(model: Assembly, joints: list[int]) -> Callable[[float], float]:
    """The acceleration (g) of an arch of 15, 0.2 m thick, by the turn of its first bar (rad)."""
    angles = np.array(joints) * math.pi / 15
    radii = 1.0 + 0.1 * np.array([1.0, -1.0, 1.0, -1.0])
    a, b, c, d = hinges = radii * np.exp(1j * angles)  # in the plane of x and z
    coupler, rocker = abs(c - b), abs(d - c)
    side = math.copysign(1.0, ((c - b) * (1j * (d - b)).conjugate()).real)
    centres = Placement.of(model).built[2:, [0, 2]] @ [1, 1j]
    bars = [
        (bar, place) for bar, ends in enumerate(pairwise(joints)) for place in centres[slice(*ends)]
    ]

    def centroids(angle: float) -> Floats:
        moved = a + np.exp(1j * angle) * (b - a)
        apart = abs(d - moved)
        foot = (coupler**2 - rocker**2 + apart**2) / (2 * apart)
        height = math.sqrt(coupler**2 - foot**2) * side
        now = (a, moved, moved + (d - moved) / apart * (foot + 1j * height), d)
        found = []
        for bar, place in bars:
            turn = (now[bar + 1] - now[bar]) / (hinges[bar + 1] - hinges[bar])
            found.append(now[bar] + turn / abs(turn) * (place - hinges[bar]))
        return np.array(found)

    def load(angle: float) -> float:
        change = (centroids(angle + 1e-6) - centroids(angle - 1e-6)).sum()
        return float(change.imag / change.real)

    return load


@pytest.mark.long
def test_hinges_of_a_thin_arch_move_and_it_carries_less_than_with_hinges_that_stay() -> None:
    model = structure(arch(15, 0.2), dry(0.8))
    stay = with_hinges_that_stay(model, [0, 4, 9, 14])
    curve = capacity_curve(model, acceleration(model, ALONG_X))
    between = ("voussoir3-voussoir4", "voussoir8-voussoir9", "voussoir13-voussoir14")
    assert curve.hinges == ("right-voussoir0", *between)
    known = np.array([stay(-angle) for angle in turns(curve, 2).tolist()])
    load = curve.load / free_weight(model)
    first = curve.displacement < 0.016
    assert load[first] == pytest.approx(known[first], abs=1e-3 * known[0])
    assert (load[~first] < known[~first] + 1e-3).all()
    assert load[-2] < known[-2] - 0.1 * known[0]


def test_bonds_gravity_that_turns_and_moving_supports_have_no_capacity_curve() -> None:
    bonded, block = FaceMaterial(1e10, 1e10, 0.7, 1e4, 1e4), on_ground(0.7)
    model = structure([GROUND, BLOCK], bonded)
    with pytest.raises(CapacityError, match="ground-block is not dry"):
        capacity_curve(model, acceleration(model, ALONG_X))
    with pytest.raises(CapacityError, match="gravity turns"):
        capacity_curve(block, tilting(block, (0.0, 1.0, 0.0)))
    with pytest.raises(ValueError, match="a support moves"):
        capacity_curve(block, support_moves(block, "ground", ALONG_X))


def test_a_block_that_twists_on_its_face_has_no_capacity_curve() -> None:
    model = on_ground(0.7)
    loads = force_at(model, "block", (WIDTH, 0.0, 0.0), (0.0, 1.0, 0.0))
    with pytest.raises(CapacityError, match="twist on their faces"):
        capacity_curve(model, loads)


def test_a_curve_ends_where_blocks_meet_that_did_not_touch() -> None:
    gap = 0.1
    post = box("post", (WIDTH + gap, 0, 0), (WIDTH + gap + 0.2, DEPTH, 2 * HEIGHT), 2e3)
    blocks = [GROUND, BLOCK, post]
    model = structure(blocks, dry(0.7))
    loads = force_at(model, "block", (0.0, DEPTH / 2, HEIGHT), ALONG_X)
    curve = capacity_curve(model, loads)
    assert curve.path.met == ("block", "post")
    assert curve.end.startswith("block and post meet at 0.1")
    # The top corner has moved by the gap; the point of the force, at the other one, nearly so.
    assert curve.displacement[-1] == pytest.approx(gap, abs=0.03)


@pytest.mark.parametrize(("height", "friction", "slides_at"), [(0.2, 1.2, 5651), (0.3, 0.7, 3296)])
def test_a_block_whose_lever_shrinks_is_followed_until_it_slides_on(
    height: float, friction: float, slides_at: float
) -> None:
    """A force beyond its toe: the block turns under a rising load, and slides on at mu W."""
    block = box("block", (0, 0, 0), (0.4, 0.5, 1.2), 2e3)
    model = structure([GROUND, block], dry(friction))
    assert friction * free_weight(model) == pytest.approx(slides_at, abs=1.0)
    curve = capacity_curve(model, force_at(model, "block", (1.4, 0.25, height), ALONG_X))
    assert "go on in another way" in curve.end
    assert curve.load[-1] == pytest.approx(slides_at, rel=2e-3)
    assert (np.diff(curve.load) > -1e-3).all()
