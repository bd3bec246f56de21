"""What bonds carry in time, against the beam's formula and equilibrium."""

from itertools import product
from typing import Any

import numpy as np
import pytest
from test_in_time import FLAT, GROUND, SLENDER, described, pulse

import sidmacib
from sidmacib.answers.in_time import TimeAnswer
from sidmacib.dynamics.roots import SURE
from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import GRAVITY
from sidmacib.structure.files.structure_file import demands_of, structure_of


def bonded(load: dict[str, Any], **more: Any) -> TimeAnswer:
    given = described({"ground": GROUND, "block": SLENDER}, load, 0.5) | more
    return TimeAnswer.of(demands_of(given, in_time=True)[0].problem)


@pytest.mark.parametrize("level", [0.2, 1.0])
def test_the_bond_of_a_block_that_is_shaken_carries_its_inertia(level: float) -> None:
    """By the beam's formula at its root: M / W - N / A, and V / A."""
    b, d, H = 0.2, 0.1, 1.0
    mass = 2000.0 * b * d * H
    strengths = {"friction": 0.5, "bond_friction": 0.0}
    load = {"ground": pulse(level * GRAVITY, 0.1), "duration": 0.1}
    V, N = mass * level * GRAVITY, mass * GRAVITY
    torn = 6.0 * V * H / 2.0 / (b * d**2) - N / (b * d)
    for strong, expected in ((1e9, V / (b * d) / 5e4), (5e5, torn / 5e5)):
        law = strengths | {"cohesion": 5e4 if strong > 1e6 else 1e9, "tensile_strength": strong}
        answer = bonded(load, interfaces=law)
        assert answer.history.used[0] == pytest.approx([expected], rel=1e-6)
        assert answer.said == ("Yes" if expected <= 1.0 else "Open")
        assert answer.history.stands
        assert answer.history.holds == (expected <= 1.0)
    assert ("bond of block may break" in answer.words) == (expected > 1.0)


@pytest.mark.parametrize("level", [0.1, 0.3])
def test_the_root_of_the_one_lock_that_bears_carries_the_inertia(level: float) -> None:
    side, height = 0.4, 0.2
    blocks = {
        "ground": {"low": [-0.3, 0, -0.3], "high": [0.3, side, 0], "fixed": True},
        "block": {"low": [-0.3, 0, 0], "high": [0.3, side, height]},
    }
    inner = {"cohesion": 8e4, "tensile_strength": 1e9}
    locks = {"between": ["ground", "block"], "count": 3, "height": 0.02, "row": [1, 0, 0]}
    locks |= {"first": "block", "inner": inner, "dry": {"friction": 0}}
    load = {"ground": pulse(level * GRAVITY, 0.1), "duration": 0.1}
    given = described(blocks, load, 0.0) | {"locks": [locks]}
    answer = TimeAnswer.of(demands_of(given, in_time=True)[0].problem)
    pieces = answer.problem.assembly.pieces
    own = [pieces[int(piece)].mass for piece in answer.history.roots]
    # Block and locks are all pushed by the ground's lock, which the two others hold between them.
    V = sum(piece.mass for piece in pieces if not piece.fixed) * level * GRAVITY
    of_block, of_ground, other = answer.history.used[0] * (8e4 * 0.2 * side)
    assert answer.history.used[1] == pytest.approx(answer.history.used[0] / SURE)
    assert of_ground == pytest.approx(V, rel=1e-4)
    assert of_block - other == pytest.approx(
        V - (own[1] + 2.0 * own[2]) * level * GRAVITY, rel=0.02
    )
    assert answer.said == "Yes"
    assert np.abs(answer.history.shift).max() < 1e-8


def test_chains_of_bonds_are_refused_and_other_doors_say_where_time_is_for() -> None:
    blocks = {"ground": GROUND, "block": FLAT}
    given = described(blocks, {"duration": 1}, 0.5)
    given["interfaces"] |= {"cohesion": 1e5, "tensile_strength": 1e5}
    blocks["other"] = {**FLAT, "low": [-0.3, -0.15, 0.2], "high": [0.3, 0.15, 0.4]}
    with pytest.raises(CapacityError, match="in time: ground-block is bonded, and so are others"):
        TimeAnswer.of(demands_of(given, in_time=True)[0].problem)
    del blocks["other"]
    given["interfaces"] = {"friction": 0.5, "compressive_strength": 1e6}
    with pytest.raises(CapacityError, match="in time: blocks are not crushed"):
        TimeAnswer.of(demands_of(given, in_time=True)[0].problem)
    for door in (structure_of, sidmacib.ask):
        with pytest.raises(ValueError, match="and earthquakes of a study"):
            door(described(blocks, {"duration": 1}, 0.5))


@pytest.mark.long
def test_copies_of_a_joint_differ_by_less_than_what_is_sure_allows() -> None:
    """Turned, mirrored and renamed; of thirty random joints one differed by 2.6 times."""
    blocks = {
        "ground": {"low": [-0.335, 0, -0.3], "high": [0.335, 0.4, 0], "fixed": True},
        "block": {"low": [-0.335, 0, 0], "high": [0.335, 0.4, 0.34]},
    }
    locks = {"between": ["ground", "block"], "count": 6, "height": 0.02, "first": "ground"}
    locks |= {"inner": {"cohesion": 2e4, "tensile_strength": 9e4}, "dry": {"friction": 0.48}}
    shape = {"shape": "cycle", "acceleration": 0.51 * GRAVITY, "duration": 0.2}
    used = []
    for push, row, order in product((1, -1), (1, -1), (1, -1)):
        load = {"ground": {"pulse": shape, "direction": [push, 0, 0]}, "duration": 0.2}
        named = dict([*blocks.items()][::order])
        given = described(named, load, 0.32) | {"locks": [{**locks, "row": [row, 0, 0]}]}
        answer = TimeAnswer.of(demands_of(given, in_time=True)[0].problem)
        used.append(answer.history.used[0].max())
    assert 1.5 < max(used) / min(used) < 1.0 / SURE


@pytest.mark.parametrize(
    "load",
    [
        {"blow": {"block": "block", "velocity": [5, 0, 0]}},
        {"force": {"block": "block", "at": [0.05, 0.1, 1.0], "direction": [1, 0, 0]}, "newtons": 1},
    ],
)
def test_what_acts_on_a_bonded_block_beside_its_weight_is_refused(load: dict[str, Any]) -> None:
    law = {"cohesion": 1e6, "tensile_strength": 1e6, "friction": 0.5}
    with pytest.raises(CapacityError, match="block is bonded; with bonds no blow may act"):
        bonded({"duration": 0.1, **load}, interfaces=law)
