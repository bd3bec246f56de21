"""Locks in the interfaces of structures, cut out and condensed, and laws of interfaces."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from joints import sawn
from structures import dry

from sidmacib import OPTIONS, InfeasibleError, Sidmacib, capacity, limit_load, static_peak
from sidmacib.joint import DRY, Direction, HoldDown, Joint, UpperBody
from sidmacib.joint.loading import Loading, Push, posed
from sidmacib.mechanics.assembly import Kind, NodeLayout
from sidmacib.mechanics.limit import require_standing
from sidmacib.mechanics.loads import Loads
from sidmacib.rule import RULES
from sidmacib.structure.blocks import Block, box
from sidmacib.structure.files.structure_file import structure_of
from sidmacib.structure.locks import ALL, Condensed, Locks
from sidmacib.structure.structure import Pair, structure
from studies.structures.shapes import arch

PAIR: Pair = frozenset(("lower", "upper"))
PUSH = 3000.0  # N, on the top


def two_blocks(joint: Joint) -> list[Block]:
    half, width, middle = joint.a / 2, joint.total_width, joint.h / 2
    return [
        box("lower", (-half, 0.0, -joint.H), (half, width, middle), joint.density, fixed=True),
        box("upper", (-half, 0.0, middle), (half, width, joint.h + joint.H), joint.density),
    ]


def locks_of(joint: Joint, condensed: Condensed | None = None) -> Locks:
    materials = {"inner": joint.inner, "dry": joint.dry, "condensed": condensed}
    return Locks(joint.locks, joint.h, row=(0.0, 1.0, 0.0), first="upper", **materials)


def pressed(
    joint: Joint, direction: Direction, force: float = PUSH, sign: float = 1.0, arm: float = 0.0
) -> Loads:
    """A ``force`` (N) on the upper of two blocks; its load acts ``arm`` (m) below its middle."""
    permanent, variable = np.zeros((2, 2, 6))
    permanent[1, 2] = -force
    variable[1, 1], variable[1, 5] = sign * direction.shear, direction.torque * joint.a
    variable[1, 3] = variable[1, 1] * arm
    return Loads(permanent, variable, joint.T0)


@pytest.mark.long
@pytest.mark.parametrize("eccentricity", [0.0, 0.5])
def test_the_joint_as_two_blocks_has_the_numbers_of_the_joint(eccentricity: float) -> None:
    joint = sawn(5, upper_body=UpperBody.MONOLITHIC, hold_down=HoldDown.force(PUSH))
    problem = posed(joint, Loading(Direction(eccentricity)), 0.02, least=1)
    cells = {"mesh": 0.02, "nodes": NodeLayout.LOBATTO}
    two = structure(two_blocks(joint), joint.dry, locked={PAIR: locks_of(joint)}, **cells)
    two = replace(two, share=0.5)
    centres = np.array([piece.centre for piece in two.pieces])
    permanent, variable = np.zeros((2, len(centres), 6))
    for number, piece in enumerate(problem.assembly.pieces):
        if not piece.fixed:  # the pieces are the same, in another order
            same = int(np.argmin(np.linalg.norm(centres - piece.centre, axis=1)))
            assert two.pieces[same].mass == pytest.approx(piece.mass)
            permanent[same] = problem.loads.permanent[number]
            variable[same] = problem.loads.variable[number]
    loads = Loads(permanent, variable, problem.loads.scale)
    here, there = static_peak(*problem), static_peak(two, loads)
    assert there.first_failure_load == pytest.approx(here.first_failure_load, rel=1e-10)
    assert there.peak.load == pytest.approx(here.peak.load, rel=1e-10)
    for friction in (False, True):
        ours = limit_load(two, loads, friction=friction).load
        assert ours == pytest.approx(limit_load(*problem, friction=friction).load, rel=1e-8)


@pytest.mark.parametrize("option", ["option1", "option4"])
@pytest.mark.parametrize("working", [ALL, 2.0])
def test_condensed_locks_carry_what_sidmacib_says(option: str, working: float) -> None:
    joint = sawn(5, density=1e-6, upper_body=UpperBody.MONOLITHIC, hold_down=HoldDown.force(PUSH))
    condensed = Condensed(working, OPTIONS[option])
    two = structure(two_blocks(joint), joint.dry, locked={PAIR: locks_of(joint, condensed)})
    strength = None if working == ALL else (working / joint.locks,) * joint.locks
    model = Sidmacib(joint, OPTIONS[option], strength)
    for direction in map(Direction, (0.0, 0.5, math.inf)):
        found = limit_load(two, pressed(joint, direction), friction=True)
        assert found.load == pytest.approx(capacity(model, direction).load, rel=1e-7)


@pytest.mark.parametrize("rule", ["law", "safe"])
@pytest.mark.parametrize(("locks", "eccentricity"), [(4, 0.0), (5, -math.tan(math.pi / 6))])
@pytest.mark.parametrize("push", [Push.PLUS_Y, Push.MINUS_Y])
def test_condensed_locks_obey_rules(rule: str, locks: int, eccentricity: float, push: Push) -> None:
    joint = sawn(locks, upper_body=UpperBody.MONOLITHIC, dry=replace(DRY, friction=0.0))
    condensed = Condensed(rule=rule)
    two = structure(two_blocks(joint), joint.dry, locked={PAIR: locks_of(joint, condensed)})
    joint = replace(joint, H=joint.H + joint.h / 2)  # the block reaches to the middle of the locks
    direction, sign = Direction(eccentricity), 1.0 if push is Push.PLUS_Y else -1.0
    # Not overturned: the load acts in the plane of the interface.
    arm = two.pieces[1].centre[2] - joint.h / 2
    found = limit_load(two, pressed(joint, direction, sign=sign, arm=arm)).load
    allowed = RULES[rule](joint, direction, push).load
    # The loads of four locks in all directions are no convex polygon: the one inside is smaller.
    assert (0.98 if locks == 4 else 1.0 - 1e-6) * allowed <= found <= (1.0 + 1e-6) * allowed


def test_a_rule_under_pressure_counts_only_where_the_interface_is_compressed_as_much() -> None:
    joint = sawn(5, density=1e-6, upper_body=UpperBody.MONOLITHIC, dry=replace(DRY, friction=0.0))
    locks = locks_of(joint, Condensed(rule="law", hold_down=HoldDown.pressure(2e4)))
    two = structure(two_blocks(joint), joint.dry, locked={PAIR: locks})
    arm = (joint.H - joint.h / 2) / 2  # in the plane of the interface

    def carried(pressure: float) -> float:
        force = pressure * joint.a * joint.total_width
        return limit_load(two, pressed(joint, Direction(0.0), force, arm=arm)).load

    assert carried(3e4) == pytest.approx(carried(2.1e4))
    with pytest.raises(InfeasibleError):
        carried(1.9e4)
    with pytest.raises(InfeasibleError, match="pressed by less than their hold_down"):
        require_standing(two, pressed(joint, Direction(0.0), 10.0, arm=arm), friction=True)


def test_locks_take_nothing_from_the_mass_of_an_arch_and_alternate() -> None:
    blocks = arch(5, 0.3)
    pairs = [frozenset((f"voussoir{k}", f"voussoir{k + 1}")) for k in range(4)]
    locks = Locks(3, 0.02, run=(0.0, 1.0, 0.0))
    model = structure(blocks, dry(0.5), locked=dict.fromkeys(pairs, locks))
    assert sum(piece.mass for piece in model.pieces) == pytest.approx(sum(b.mass for b in blocks))
    assert sum("-lock" in piece.name for piece in model.pieces) == 12
    roots = [face.name for face in model.faces if face.kind is Kind.INNER]
    assert "voussoir0-voussoir0-voussoir1-lock1" in roots
    assert "voussoir1-voussoir0-voussoir1-lock2" in roots
    assert len(roots) == 12


def test_a_block_across_a_joint_of_two_others_can_have_locks_to_both() -> None:
    def brick(name: str, x: float, z: float, *, fixed: bool) -> Block:
        return box(name, (x, 0.0, z), (x + 0.4, 0.3, z + 0.2), 2e3, fixed=fixed)

    below = [brick("left", 0.0, 0.0, fixed=True), brick("right", 0.4, 0.0, fixed=True)]
    bricks = [*below, brick("top", 0.2, 0.2, fixed=False)]
    locks = Locks(3, 0.02, row=(0.0, 1.0, 0.0))
    pairs = [frozenset(("left", "top")), frozenset(("right", "top"))]
    model = structure(bricks, dry(0.5), locked=dict.fromkeys(pairs, locks))
    # In each interface the lock of the top, of 0.1 x 0.2 m, bears on one of the block below.
    variable = np.zeros((len(model.pieces), 6))
    variable[2] = [0.0, 1.0, 0.0, 0.1, 0.0, 0.0]  # 1 N in the plane of the interfaces
    found = limit_load(model, Loads(np.zeros_like(variable), variable, 1e3))
    assert found.load == pytest.approx(2 * locks.inner.cohesion * 0.1 * 0.2, rel=1e-6)


# --- laws and locks by name, by material, by direction or by a rule ------------------------------
def block(x: float, z: float, **more: Any) -> dict[str, Any]:
    return {"low": [x, 0, z], "high": [x + 1, 1, z + 1], **more}


WALL: dict[str, Any] = {  # two by two on a base: bed joints are level, head joints upright
    "blocks": {
        "base": {"low": [0, 0, -1], "high": [2, 1, 0], "fixed": True, "material": "rock"},
        "low-1": block(0, 0, material="stone"),
        "low-2": block(1, 0, material="brick"),
        "top-1": block(0, 1, material="stone"),
        "top-2": block(1, 1, material="brick"),
    },
    "load": {"acceleration": [1, 0, 0]},
}


def frictions(*special: dict[str, Any]) -> dict[str, float]:
    """The friction of each interface."""
    assembly = structure_of({**WALL, "special": list(special)}).assembly
    return {face.name: face.material.friction for face in assembly.faces}


def chosen(between: Any) -> set[str]:
    """The interfaces that a rule fits."""
    found = frictions({"between": between, "friction": 0.1})
    return {name for name, friction in found.items() if friction == 0.1}


BEDS = {"base-low-1", "base-low-2", "low-1-top-1", "low-2-top-2"}
HEADS = {"low-1-low-2", "top-1-top-2"}


@pytest.mark.parametrize(
    ("between", "expected"),
    [
        (["top-1", "low-1"], {"low-1-top-1"}),
        ("all", BEDS | HEADS),
        ({"normal": [0, 0, 1]}, BEDS),
        ({"normal": [-3, 0, 0]}, HEADS),
        ({"normal": [1, 0, 1], "within": 45}, BEDS | HEADS),
        ({"materials": ["brick", "stone"]}, HEADS),
        ({"materials": ["stone", "brick"]}, HEADS),
        ({"materials": "stone"}, {"low-1-top-1"}),
        ({"blocks": ["top-*", "*"]}, {"low-1-top-1", "low-2-top-2", "top-1-top-2"}),
        ({"blocks": "low-*"}, {"low-1-low-2"}),
        ({"blocks": ["*", "*-1"], "normal": [0, 0, 1]}, {"base-low-1", "low-1-top-1"}),
    ],
)
def test_a_law_is_for_the_pairs_that_a_rule_fits(between: Any, expected: set[str]) -> None:
    assert chosen(between) == expected


def test_the_last_law_that_fits_counts() -> None:
    rough = {"between": ["low-1", "low-2"], "friction": 0.9}
    found = frictions({"between": {"normal": [1, 0, 0]}, "friction": 0.2}, rough)
    assert (found["low-1-low-2"], found["top-1-top-2"]) == (0.9, 0.2)
    assert frictions(rough, {"between": "all", "friction": 0.2})["low-1-low-2"] == 0.2


def test_locks_are_of_the_pairs_that_a_rule_fits() -> None:
    locks = {"count": 3, "height": 0.1, "row": [0, 1, 0], "condensed": {"working": "all"}}
    locks["between"] = {"materials": ["stone", "brick"]}  # type: ignore[assignment]
    locked = [
        face.name
        for face in structure_of({**WALL, "locks": [locks]}).assembly.faces
        if face.kind is Kind.LOCKED
    ]
    assert set(locked) == HEADS
