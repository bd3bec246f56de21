"""Order of placing blocks: what locks leave free."""

import numpy as np
from structures import dry

from sidmacib.design import LockKind, layouts_of
from sidmacib.design.blocking import conflict, order_of
from sidmacib.design.model import Site
from sidmacib.joint import DRY, INNER
from sidmacib.mechanics.assembly import Assembly, Vector
from sidmacib.structure.blocks import box
from sidmacib.structure.structure import structure
from studies.structures.shapes import arch as voussoirs

KIND = LockKind((0.04,), 0.02, INNER, DRY)
X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


def sites(assembly: Assembly, runs: dict[str, Vector]) -> tuple[Site, ...]:
    """A site for each face that is named in ``runs``, with locks along the direction there."""
    return tuple(
        Site(number, layouts_of(face, KIND, [runs[face.name]], 1))
        for number, face in enumerate(assembly.faces)
        if face.name in runs
    )


def chosen(assembly: Assembly, runs: dict[str, Vector]) -> tuple[Assembly, tuple[Site, ...], list]:
    """The assembly, its sites, and locks at all of them."""
    found = sites(assembly, runs)
    return assembly, found, [site.layouts[0] for site in found]


def corner(walls: int) -> Assembly:
    """A cube on the ground with so many fixed walls around it."""
    around = [
        box("east", (0.4, 0.0, 0.0), (0.6, 0.4, 0.4), 2e3, fixed=True),
        box("west", (-0.2, 0.0, 0.0), (0.0, 0.4, 0.4), 2e3, fixed=True),
        box("north", (0.0, 0.4, 0.0), (0.4, 0.6, 0.4), 2e3, fixed=True),
    ]
    ground = box("ground", (-1.0, -1.0, -0.2), (1.0, 1.0, 0.0), 2e3, fixed=True)
    cube = box("cube", (0.0, 0.0, 0.0), (0.4, 0.4, 0.4), 2e3)
    return structure([ground, cube, *around[:walls]], dry(0.5))


def test_a_block_on_locks_comes_from_above_or_along_them() -> None:
    order = order_of(*chosen(corner(0), {"ground-cube": X}))
    assert order.stuck == ()
    (step,) = order.steps
    assert step.along[1] == 0.0  # not across the locks
    assert step.along[2] < 0.0


def test_locks_at_right_angles_in_two_faces_leave_one_way_and_in_three_none() -> None:
    # Along x or upwards for the ground, not towards the wall, upwards or along x for the wall.
    assert order_of(*chosen(corner(1), {"ground-cube": X, "cube-east": Z})).stuck == ()
    walled = corner(2)
    cube = [piece.name for piece in walled.pieces].index("cube")
    assert order_of(*chosen(walled, {"ground-cube": X, "cube-east": Y})).stuck == (cube,)


def test_of_the_locks_that_block_only_those_needed_for_it_are_named() -> None:
    names = {"ground-cube": X, "cube-east": Y, "cube-north": Z}
    assembly, here, locks = chosen(corner(3), names)
    found = conflict(assembly, here, locks)
    faces = {assembly.faces[here[site].face].name for site, _ in found}
    assert len(found) <= 2
    assert "cube-east" in faces
    blocking = {site for site, _ in found}
    choice = [None if k in blocking else each for k, each in enumerate(locks)]
    assert conflict(assembly, here, choice) is None


def test_voussoirs_with_radial_locks_come_from_outside_unless_the_next_joint_has_others() -> None:
    arch = structure(voussoirs(5, 0.2), dry(0.7))
    radial: dict[str, Vector] = {
        face.name: (face.middle[0], 0.0, face.middle[2]) for face in arch.faces
    }
    order = order_of(*chosen(arch, radial))
    assert order.stuck == ()
    crown = arch.pieces[order.steps[-1].block].centre
    assert np.dot(order.steps[-1].along, crown) < 0.0
    # In turn along the depth and radial: whichever comes last is blocked, and every joint is why.
    ordered = sorted(arch.faces, key=lambda face: face.middle[0])
    for number, face in enumerate(ordered):
        if number % 2:
            radial[face.name] = Y
    mixed = chosen(arch, radial)
    assert len(order_of(*mixed).stuck) == 5
    assert len(conflict(*mixed)) == len(arch.faces) == 6
