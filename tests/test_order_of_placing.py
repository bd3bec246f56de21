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


def all_locked(given: tuple[Site, ...]) -> list:
    return [site.layouts[0] for site in given]


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
    assembly = corner(0)
    here = sites(assembly, {"ground-cube": X})
    order = order_of(assembly, here, all_locked(here))
    assert order.stuck == ()
    (step,) = order.steps
    assert step.along[1] == 0.0  # not across the locks
    assert step.along[2] < 0.0


def test_locks_at_right_angles_in_two_faces_leave_one_way_and_in_three_none() -> None:
    assembly = corner(1)
    here = sites(assembly, {"ground-cube": X, "cube-east": Z})
    # Along x or upwards for the ground, not towards the wall, upwards or along x for the wall.
    assert order_of(assembly, here, all_locked(here)).stuck == ()
    assembly = corner(2)
    here = sites(assembly, {"ground-cube": X, "cube-east": Y})
    cube = [piece.name for piece in assembly.pieces].index("cube")
    assert order_of(assembly, here, all_locked(here)).stuck == (cube,)


def test_of_the_locks_that_block_only_those_needed_for_it_are_named() -> None:
    assembly = corner(3)
    names = {"ground-cube": X, "cube-east": Y, "cube-north": Z}
    here = sites(assembly, names)
    found = conflict(assembly, here, all_locked(here))
    faces = {assembly.faces[here[site].face].name for site, _ in found}
    assert len(found) <= 2
    assert "cube-east" in faces
    blocking = {site for site, _ in found}
    choice = [None if k in blocking else each for k, each in enumerate(all_locked(here))]
    assert conflict(assembly, here, choice) is None


def test_voussoirs_with_radial_locks_come_from_outside_unless_the_next_joint_has_others() -> None:
    arch = structure(voussoirs(5, 0.2), dry(0.7))
    radial: dict[str, Vector] = {
        face.name: (face.middle[0], 0.0, face.middle[2]) for face in arch.faces
    }
    here = sites(arch, radial)
    order = order_of(arch, here, all_locked(here))
    assert order.stuck == ()
    crown = arch.pieces[order.steps[-1].block].centre
    assert np.dot(order.steps[-1].along, crown) < 0.0
    # In turn along the depth and radial: whichever comes last is blocked, and every joint is why.
    ordered = sorted(arch.faces, key=lambda face: face.middle[0])
    for number, face in enumerate(ordered):
        if number % 2:
            radial[face.name] = Y
    mixed = sites(arch, radial)
    assert len(order_of(arch, mixed, all_locked(mixed)).stuck) == 5
    found = conflict(arch, mixed, all_locked(mixed))
    assert len(found) == len(arch.faces) == 6
