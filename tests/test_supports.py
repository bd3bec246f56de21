"""Supports that settle, spread or turn: reactions, and where structures fall."""

import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import shapely
from command_runner import by_model
from structures import dry, example

from sidmacib import InfeasibleError, greatest_reaction, least_reaction, support_path
from sidmacib.engines.curve import yade_answer
from sidmacib.mechanics.assembly import Assembly, Floats
from sidmacib.structure.analysis.kinematics import Kinematics
from sidmacib.structure.analysis.supports import static_reactions, support_answers
from sidmacib.structure.blocks import Block, box
from sidmacib.structure.files.structure_file import structure_of
from sidmacib.structure.loads import SupportMotion, free_weight, support_moves
from sidmacib.structure.structure import structure
from studies.structures.shapes import arch

COUNT, THICKNESS, HINGE = 16, 0.2, 3
SPREADS = (1.0, 0.0, 0.0)


def semicircle() -> tuple[Assembly, SupportMotion]:
    model = structure(arch(COUNT, THICKNESS), dry(0.8))
    return model, support_moves(model, "right", SPREADS)


class HalfArch:
    """Half of a symmetric arch on spreading supports, in 2D: see docs/howto/displacements.md.

    The part above joint ``HINGE`` turns about its hinge at the intrados, while the hinge at the
    crown, at the extrados, stays in the axis of symmetry. The part below stays upright.
    """

    def __init__(self) -> None:
        self.joints = np.arange(COUNT // 2 + 1) * math.pi / COUNT
        self.inner, self.outer = 1.0 - THICKNESS / 2, 1.0 + THICKNESS / 2
        ends = [
            [self._at(r, joint) for r in (self.inner, self.outer)]
            for joint in range(COUNT // 2 + 1)
        ]
        parts = [shapely.Polygon([*one, *other[::-1]]) for one, other in pairwise(ends)]
        self.areas = np.array([part.area for part in parts])
        self.centres = np.array([part.centroid.coords[0] for part in parts])
        self.low, self.crown = self._at(self.inner, HINGE), np.array([0.0, self.outer])

    def _at(self, radius: float, joint: int) -> Floats:
        return radius * np.array([math.cos(self.joints[joint]), math.sin(self.joints[joint])])

    def thrust(self, spread: float) -> tuple[float, bool]:
        """The thrust over the weight of the arch, and whether it is inside all joints below."""
        shift = np.array([spread / 2, 0.0])
        foot, arm = self.low + shift, self.crown - self.low
        rise = math.sqrt(float(arm @ arm) - foot[0] ** 2)
        turn = math.atan2(rise, -foot[0]) - math.atan2(arm[1], arm[0])
        matrix = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
        centres = self.centres + shift
        centres[HINGE:] = foot + (self.centres[HINGE:] - self.low) @ matrix.T
        above = self.areas[HINGE:]
        thrust = float(above @ (foot[0] - centres[HINGE:, 0])) / rise
        crown = foot[1] + rise
        inside = True
        for joint in range(HINGE):
            moments = []
            for radius in (self.inner, self.outer):
                x, z = self._at(radius, joint) + shift
                weights = float(self.areas[joint:] @ (x - centres[joint:, 0]))
                moments.append(weights - thrust * (crown - z))
            inside &= moments[0] < 0.0 < moments[1]
        return thrust / (2.0 * self.areas.sum()), inside

    def falls(self) -> float:
        """The spread at which the thrust leaves a joint below, m."""
        low, high = 0.0, 0.5
        while high - low > 1e-6:
            middle = (low + high) / 2
            low, high = (middle, high) if self.thrust(middle)[1] else (low, middle)
        return low


def test_the_least_thrust_of_an_arch_has_hinges_at_the_crown_and_the_haunches() -> None:
    model, loads = semicircle()
    least = least_reaction(model, loads)
    assert least.size / free_weight(model) == pytest.approx(HalfArch().thrust(0.0)[0], rel=1e-7)
    between = ("voussoir2-voussoir3", "voussoir7-voussoir8", "voussoir12-voussoir13")
    assert least.hinges == between


def test_least_and_greatest_thrust_bracket_the_path_of_the_static_model() -> None:
    model, loads = semicircle()
    least, greatest = least_reaction(model, loads), greatest_reaction(model, loads)
    movement, reaction = static_reactions(model, loads, least.size)
    assert least.size * (1 - 1e-4) <= reaction.min()
    assert reaction.max() < greatest.size
    assert (np.diff(reaction) < 0.0).all()
    assert reaction[-1] == pytest.approx(least.size, rel=0.02)
    assert movement[-1] < 1e-3


@pytest.mark.long
def test_an_arch_on_spreading_supports_falls_where_its_hinges_say() -> None:
    model, loads = semicircle()
    path, known = support_path(model, loads), HalfArch()
    assert path.falls
    assert path.movement[-1] == pytest.approx(known.falls(), rel=0.005)
    some = slice(None, -2, 6)
    for moved, reaction in zip(path.movement[some], path.reaction[some], strict=True):
        assert reaction / free_weight(model) == pytest.approx(known.thrust(moved)[0], rel=1e-3)


def supports_at(**places: float) -> list[Block]:
    return [box(name, (x, 0, -1), (x + 0.2, 0.3, 0), 2e3, fixed=True) for name, x in places.items()]


def two_spans(friction: float = 0.7) -> Assembly:
    """Two beams on three supports, which do not touch each other, with a wall on the right one."""
    supports = supports_at(left=-0.1, pier=1.9, right=3.9)
    beams = [
        box("beam1", (-0.1, 0, 0), (1.99, 0.3, 0.3), 2e3),
        box("beam2", (2.01, 0, 0), (4.1, 0.3, 0.3), 2e3),
        box("wall", (2.51, 0, 0.3), (3.51, 0.3, 0.9), 2e3),
    ]
    return structure([*supports, *beams], dry(friction))


def test_an_abutment_that_settles_below_a_wall_on_two_spans() -> None:
    model = two_spans()
    loads = support_moves(model, "right", (0, 0, -1))
    least, greatest = least_reaction(model, loads), greatest_reaction(model, loads)
    beam, wall = (model.pieces[number].weight for number in (4, 5))
    # The beam turns about the edge of the pier, x = 2.1, and rests on its own end, x = 4.1.
    by_hand = (beam * (3.055 - 2.1) + wall * (3.01 - 2.1)) / (4.1 - 2.1)
    assert least.size == pytest.approx(by_hand, rel=1e-6)
    assert least.hinges == ("pier-beam2", "right-beam2")
    # Pushed up: about its other end, x = 2.01, at the inner edge of the abutment, x = 3.9.
    by_hand = (beam * (3.055 - 2.01) + wall * (3.01 - 2.01)) / (3.9 - 2.01)
    assert greatest.size == pytest.approx(by_hand, rel=1e-6)
    rest = static_reactions(model, loads, least.size)[1][0]
    assert least.size < rest < greatest.size
    assert rest == pytest.approx((beam + wall) / 2, rel=0.05)


def test_a_wall_slides_off_a_settling_beam_where_it_is_steeper_than_friction() -> None:
    model = two_spans(0.2)
    path = support_path(model, support_moves(model, "right", (0, 0, -1)))
    # The beam's end stays where it is on the abutment, 2 m from the edge of the pier.
    assert path.falls
    assert path.movement[-1] == pytest.approx(0.2 * (4.1 - 2.1), rel=2e-3)
    assert np.diff(path.path.positions[-1].motion[[4, 5], 4]) == pytest.approx(0.0, abs=1e-6)


def test_a_support_that_nothing_needs_comes_free() -> None:
    blocks = supports_at(left=0.0, middle=1.9, right=3.8)
    model = structure([*blocks, box("beam", (0, 0, 0), (4, 0.3, 0.3), 2e3)], dry(0.6))
    loads = support_moves(model, "middle", (0, 0, -1))
    assert least_reaction(model, loads).size == pytest.approx(0.0, abs=1e-6 * free_weight(model))
    path = support_path(model, loads)
    assert path.free and not path.falls


@pytest.mark.parametrize(
    ("places", "support", "stands"),
    [
        ({"left": 0.0, "right": 3.8}, "right", False),
        ({"left": 0.0, "middle": 1.9, "right": 3.8}, "middle", True),
    ],
)
def test_smooth_contacts_do_not_pull_where_a_support_is_left_out(
    places: dict[str, float], support: str, stands: bool
) -> None:
    blocks = supports_at(**places)
    model = structure([*blocks, box("beam", (0, 0, 0), (4, 0.3, 0.3), 2e3)], dry(0.0))
    loads = support_moves(model, support, (0, 0, -1))
    kinematics = Kinematics(model, loads)
    assert kinematics.stands_without(loads.support, kinematics.start()) is stands


def test_the_moment_of_a_support_that_turns_is_its_force_times_the_lever() -> None:
    model = two_spans()
    settles = support_moves(model, "right", (0, 0, -1))
    turns = support_moves(model, "right", None, (0, 1, 0), (4.1 - 2.0, 0.15, 0.0))
    # Both move the point where the beam rests straight down: by 2 m for 1 rad.
    force, moment = (least_reaction(model, loads).size for loads in (settles, turns))
    assert moment == pytest.approx(2.0 * force, rel=1e-3)


def beam(
    left: tuple[float, float],
    right: tuple[float, float],
    end: float,
    moves: list[float],
    **given: Any,
) -> dict[str, Any]:
    """A beam from the outer edge of the left support to ``end`` (m); the right support moves."""
    blocks: dict[str, Any] = {
        name: {"low": [low, 0, -1], "high": [high, 0.3, 0], "fixed": True}
        for name, (low, high) in (("left", left), ("right", right))
    }
    blocks["beam"] = {"low": [left[0], 0, 0], "high": [end, 0.3, 0.3]}
    return {
        "blocks": blocks,
        "load": {"support": {"block": "right", "displacement": moves}},
    } | given


BEAM = beam((-0.1, 0.1), (1.9, 2.1), 2.1, [0, 0, -1])


@pytest.mark.long
def test_the_command_prints_reactions_of_a_support_that_moves(tmp_path: Path) -> None:
    curve, picture = tmp_path / "curve.csv", tmp_path / "curve.png"
    options = "--capacity-curve", str(curve), "--picture", str(picture)
    rows = by_model(tmp_path / "beam.yaml", BEAM, *options)
    models = ("static, at rest", "static, yields", "limit, least", "limit, greatest", "kinematics")
    assert tuple(rows) == models
    weight = 2.2 * 0.3 * 0.3 * 2000 * 9.81
    assert rows["limit, least"]["reaction_N"] == pytest.approx(weight * 0.9 / 2.0, rel=1e-6)
    assert rows["static, at rest"]["reaction_N"] == pytest.approx(weight / 2, rel=1e-3)
    assert picture.stat().st_size > 0
    first = pd.read_csv(curve).iloc[0]
    assert first["reaction_N"] == pytest.approx(weight * 0.9 / 2.0, rel=1e-6)


def drawn_away(span: float, overlap: float, **of_right: float) -> dict[str, Any]:
    """A beam that a support is drawn from, on which it lies by the ``overlap`` (m)."""
    special = {"special": [{"between": ["right", "beam"], **of_right}]} if of_right else {}
    ends = (-0.3, 0.2), (span - overlap, span + 0.3)
    return beam(*ends, span, [1, 0, 0], interfaces={"friction": 0.4}, **special)


@pytest.mark.parametrize(
    ("span", "overlap", "friction"),
    [(1.5, 0.02, 0.1), (6.0, 0.05, 0.1), (1.5, 0.02, 0.0)],  # without: no reaction at any place
)
def test_a_beam_falls_when_its_support_moved_by_the_overlap(
    span: float, overlap: float, friction: float
) -> None:
    path = support_path(*structure_of(drawn_away(span, overlap, friction=friction)))
    assert path.falls
    assert path.movement[-1] == pytest.approx(overlap, rel=0.02)


@pytest.mark.long
@pytest.mark.parametrize("about", [0.5, 0.49, 0.3])  # below its centre: no reaction at first
def test_a_block_on_a_support_that_turns_falls_when_its_weight_leaves_its_foot(
    about: float,
) -> None:
    ground = box("ground", (-1, -1, -1), (2, 1, 0), 2e3, fixed=True)
    model = structure([ground, box("block", (0.25, 0, 0), (0.75, 0.4, 1.2), 2e3)], dry(0.7))
    path = support_path(model, support_moves(model, "ground", None, (0, 1, 0), (about, 0.2, -0.5)))
    assert path.falls
    assert math.tan(path.movement[-1]) == pytest.approx(0.5 / 1.2, rel=2e-3)


def test_what_only_the_moving_support_carries_does_not_stand_without_it() -> None:
    ground = box("ground", (-1, -1, -1), (2, 1, 0), 2e3, fixed=True)
    model = structure([ground, box("block", (0, 0, 0), (0.5, 0.4, 1.0), 2e3)], dry(0.5))
    loads = support_moves(model, "ground", (1, 0, 0))
    kinematics = Kinematics(model, loads)
    assert not kinematics.stands_without(loads.support, kinematics.start())


@pytest.mark.engine
def test_a_beam_falls_in_yade_when_its_support_has_moved_by_the_overlap() -> None:
    found = yade_answer(structure_of(drawn_away(6.0, 0.05, friction=0.1)))
    assert found.movement == pytest.approx(0.05, rel=0.04)


@pytest.mark.long
def test_where_several_joints_slide_the_least_movement_is_told() -> None:
    """Rigid blocks do not say which: each may lose its overlap of 0.5 and 0.2 m first."""
    problem = structure_of(drawn_away(2.0, 0.2))
    found, _ = support_answers(*problem)
    told = {each.answer: each for each in found}
    assert told["kinematics, least"].movement == pytest.approx(0.2, rel=0.02)
    assert told["kinematics"].movement > told["kinematics, least"].movement
    assert "only right-beam slides" in told["kinematics, least"].note


@pytest.mark.long
def test_a_settling_support_lets_a_beam_slide_off_the_pier() -> None:
    """By hand, step by step: from 0.161 m on the beam slides over the pier, at 0.628 m off it.

    With two contacts, the edge of the pier and the end of the beam, of which the one slides whose
    friction is at its limit while that of the other is not.
    """
    path = support_path(*structure_of(example("settling")))
    assert path.movement[-1] == pytest.approx(0.628, rel=0.03)


PAD, LENGTH, BREADTH = 0.2, 4.0, 0.3  # m: along the beam, between its supports, across


def on_pads(across: float, **given: Any) -> dict[str, Any]:
    """A beam on two pads, of which one moves ``across`` it, or along it."""
    ends = (-PAD / 2, PAD / 2), (LENGTH - PAD / 2, LENGTH + PAD / 2)
    moves = [1 - across, across, 0]
    return beam(*ends, LENGTH + PAD / 2, moves, interfaces={"friction": 0.5}, **given)


def test_a_support_that_moves_across_a_beam_twists_both_its_pads() -> None:
    """Each resists by friction of its uniform pressure: the force is both torques over the span."""
    assembly, loads = structure_of(on_pads(1))
    x, y = np.meshgrid(*((np.arange(200) + 0.5) / 200 - 0.5 for _ in "xy"))
    lever = float(np.hypot(PAD * x, BREADTH * y).mean())
    torque = 0.5 * free_weight(assembly) / 2 * lever
    (_, yields, least, greatest, path), why = support_answers(assembly, loads)
    assert least.reaction == pytest.approx(-2 * torque / LENGTH, rel=0.01)
    assert greatest.reaction == pytest.approx(-least.reaction, rel=1e-3)
    assert yields.reaction == pytest.approx(least.reaction, rel=0.01)
    assert path.reaction is None and path.note == str(why)
    assert "twist" in path.note


def test_a_support_that_moves_under_a_twisted_block_does_not_hold_it() -> None:
    twist = {"block": "beam", "at": [LENGTH, 0.15, 0], "direction": [0, 1, 0], "newtons": 2500}
    with pytest.raises(InfeasibleError, match="and the other permanent loads"):
        support_answers(*structure_of(on_pads(1, permanent=[{"force": twist}])))


def test_static_reactions_stay_in_equilibrium_as_far_as_the_support_moves() -> None:
    """Friction at the left, less loaded end limits what draws the beam to the right."""
    push = {"block": "beam", "at": [3, 0.15, 0.3], "direction": [0, 0, -1], "newtons": 1e3}
    assembly, loads = structure_of(on_pads(0, permanent=[{"force": push}]))
    least = -0.5 * (free_weight(assembly) * (LENGTH / 2 + PAD / 2) + 1e3 * (1 + PAD / 2)) / LENGTH
    _, reaction = static_reactions(assembly, loads, least)
    assert least_reaction(assembly, loads).size == pytest.approx(least, rel=1e-3)
    assert reaction.min() >= least
    assert np.ptp(reaction[-10:]) <= 1e-3 * abs(least)
