"""A joint whose locks are no cuboids, as a structure: dovetails in the static model."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from sidmacib.joint import Direction, Joint, UpperBody
from sidmacib.joint.loading import Loading, LoadShare, posed
from sidmacib.mechanics.assembly import Assembly, Kind, Loads, NodeLayout, self_weight
from sidmacib.mechanics.static import static_peak
from sidmacib.mechanics.static.peaks import lowest_peak
from sidmacib.structure.blocks import Block, box, prism
from sidmacib.structure.structure import structure

MESH = 0.02
JOINT = Joint(3, upper_body=UpperBody.MONOLITHIC)


def tapered(joint: Joint, taper: float) -> Assembly:
    """``joint`` under its plate; each side between two locks leans by ``taper`` (m) at either end.

    Locks are widest at their inner faces. The two ends of the joint are upright.
    """
    x, top = joint.a / 2, joint.h + joint.H
    blocks = [
        _box(joint, "lower", -joint.H, 0.0, fixed=True),
        _box(joint, "plate", top, top + joint.h, fixed=True),
        _box(joint, "body", joint.h, top),
    ]
    special = {frozenset(("body", "plate")): replace(joint.dry, friction=0.0)}
    lean = [0.0] + [taper if joint.is_upper(k) else -taper for k in joint.numbers[:-1]] + [0.0]
    sides = [(joint.edge(k) - each, joint.edge(k) + each) for k, each in enumerate(lean)]
    for lock, ((foot, head), (next_foot, next_head)) in enumerate(pairwise(sides), start=1):
        outline = [(foot, 0.0), (next_foot, 0.0), (next_head, joint.h), (head, joint.h)]
        base = [(-x, y, z) for y, z in outline]
        blocks.append(prism(f"lock{lock}", base, (joint.a, 0.0, 0.0), joint.density))
        whole = "body" if joint.is_upper(lock) else "lower"
        special[frozenset((whole, f"lock{lock}"))] = joint.inner
    return structure(blocks, joint.dry, special, mesh=MESH, nodes=NodeLayout.LOBATTO)


def _box(joint: Joint, name: str, low: float, high: float, fixed: bool = False) -> Block:
    """A block as long and wide as the joint, from ``low`` to ``high`` (m)."""
    x = joint.a / 2
    corners = (-x, 0.0, low), (x, joint.total_width, high)
    return box(name, *corners, joint.density, fixed=fixed)


def on_body(joint: Joint, assembly: Assembly, direction: Direction) -> Loads:
    """V and M on the upper body, at its centroid."""
    variable = np.zeros((len(assembly.pieces), 6))
    (body,) = (k for k, piece in enumerate(assembly.pieces) if piece.name == "body")
    variable[body, 1], variable[body, 5] = direction.shear, direction.torque * joint.a
    return Loads(self_weight(assembly.pieces), variable, joint.T0)


@pytest.mark.parametrize("eccentricity", [0.0, 0.5, np.inf])
def test_locks_without_taper_carry_what_the_joint_carries(eccentricity: float) -> None:
    direction = Direction(eccentricity)
    cuboids = lowest_peak(*posed(JOINT, Loading(direction, LoadShare.BODY), MESH))
    assembly = tapered(JOINT, 0.0)
    found = static_peak(assembly, on_body(JOINT, assembly, direction))
    assert found.first_failure_load == pytest.approx(cuboids.first_failure_load, rel=1e-8)
    assert found.peak.load == pytest.approx(cuboids.peak.load, rel=1e-8)


def test_tapered_locks_fill_the_joint_and_are_widest_at_their_inner_faces() -> None:
    taper = 0.004
    assembly = tapered(JOINT, taper)
    inner = {face.name: face.area for face in assembly.faces if face.kind is Kind.INNER}
    widths = {
        "body-lock1": JOINT.b + taper,
        "lower-lock2": JOINT.b + 2 * taper,
        "body-lock3": JOINT.b + taper,
    }
    assert inner == pytest.approx({name: JOINT.a * width for name, width in widths.items()})
    locks = sum(piece.mass for piece in assembly.pieces if piece.name.startswith("lock"))
    assert locks == pytest.approx(JOINT.density * JOINT.a * JOINT.total_width * JOINT.h)
