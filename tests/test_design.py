"""The design of locks of a structure, against closed forms, and the order of placing."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from structures import condensed_keys, dry, row_of_cubes

from sidmacib.design import LockKindSection, WeightsSection, directions_of, layouts_of
from sidmacib.design.blocking import conflict, order_of
from sidmacib.design.direction import RowSearch, choice_of
from sidmacib.design.model import DesignProblem, LoadCase, Site
from sidmacib.design.sizing import carried, largest_factor, least_cost, needed
from sidmacib.errors import InfeasibleError
from sidmacib.mechanics.assembly import Assembly, Vector
from sidmacib.mechanics.crushing import CrushedMaterial
from sidmacib.structure.analysis.tilt import tilting
from sidmacib.structure.blocks import box
from sidmacib.structure.files.structure_file import structure_of
from sidmacib.structure.loads import force_at, free_weight
from sidmacib.structure.structure import structure

FRICTION = 0.3
KIND = LockKindSection(width=(0.05,), height=0.02)
T1 = 8e4 * 0.05 * 0.4  # N, a lock along x in the face of `two_blocks`


BASE = box("base", (0.0, 0.0, -0.3), (0.4, 0.6, 0.0), 2e3, fixed=True)
BLOCK = box("block", (0.0, 0.0, 0.0), (0.4, 0.6, 0.3), 2e3)


def two_blocks(friction: float = FRICTION) -> Assembly:
    return structure([BASE, BLOCK], dry(friction))


def design_on(
    assembly: Assembly,
    cases: Sequence[LoadCase],
    *,
    angles: Sequence[float] = (0.0, 90.0),
    weights: WeightsSection | None = None,
    kind: LockKindSection = KIND,
    most: int = 10,
) -> DesignProblem:
    kind = kind.model_copy(update={"most": most})
    sites = tuple(
        Site(number, layouts_of(face, kind, directions_of(face, angles=angles)))
        for number, face in enumerate(assembly.faces)
    )
    return DesignProblem(assembly, sites, tuple(cases), weights or WeightsSection())


def pushed(assembly: Assembly, load: float, along: Vector = (0.0, 1.0, 0.0)) -> LoadCase:
    """A push at the foot of the block, so that nothing turns over."""
    return LoadCase("push", force_at(assembly, "block", (0.2, 0.3, 0.0), along), load)


LOAD = 3000.0  # N
BLOCKS = two_blocks()
BY_FRICTION = FRICTION * free_weight(BLOCKS)
GIVEN = design_on(BLOCKS, [pushed(BLOCKS, LOAD)])


def test_what_the_design_does_not_model_is_refused_by_name() -> None:
    crushed = CrushedMaterial(**vars(dry(FRICTION)), compressive_strength=1e6)
    locked = structure_of(condensed_keys()).assembly
    turns = LoadCase("tilt", tilting(BLOCKS, (0.0, 1.0, 0.0)), 1.0)
    changes: list[tuple[str, dict[str, Any]]] = [
        ("compressive_strength: ", {"assembly": structure([BASE, BLOCK], crushed)}),
        ("condensed locks: must not be there", {"assembly": locked}),
        ("loads: gravity turns", {"cases": (turns,)}),
    ]
    for words, change in changes:
        with pytest.raises(ValueError, match=words):
            replace(GIVEN, **change)


def test_two_blocks_need_what_friction_leaves() -> None:
    for factor in (1.0, 1.5):
        needs = (factor * LOAD - BY_FRICTION) / T1
        assert least_cost(GIVEN, factor).cost == pytest.approx(needs, rel=1e-6)
    assert least_cost(GIVEN, 0.9 * BY_FRICTION / LOAD).cost == pytest.approx(0.0, abs=1e-6)


def test_a_whole_number_of_locks_is_the_least_that_is_enough_and_balances_the_push() -> None:
    found = RowSearch(GIVEN, 1.0).cheapest()
    assert found.cost == np.ceil((LOAD - BY_FRICTION) / T1) == 2.0
    (layout,) = choice_of(GIVEN, found.parts)
    assert layout.run == (1.0, 0.0, 0.0)  # across the push
    (factor,), _ = carried(GIVEN, [layout])
    assert factor == pytest.approx((2 * T1 + BY_FRICTION) / LOAD, rel=1e-7)
    ((across,),) = needed(GIVEN, [layout], 1.0)
    assert abs(across) == pytest.approx(LOAD - BY_FRICTION, rel=1e-5)  # friction does what it can
    assert abs(across) <= layout.strength


def test_rows_have_room_and_are_as_strong_as_their_roots() -> None:
    (face,) = BLOCKS.faces
    kind = KIND.model_copy(update={"most": 10})
    for layout in layouts_of(face, kind, directions_of(face, angles=(0.0, 90.0))):
        across, along = (0.6, 0.4) if layout.direction == 0 else (0.4, 0.6)
        assert sum(layout.widths) == pytest.approx(across)
        assert layout.widths[0] == layout.widths[-1] >= layout.width * (1 - 1e-9)
        assert layout.strength == pytest.approx(8e4 * 0.05 * along * layout.working)


def test_without_friction_two_directions_are_needed_and_one_is_not_enough() -> None:
    assembly = structure(row_of_cubes(2), dry(0.0))
    loads = force_at(assembly, "cube0", (0.2, 0.2, 0.2), (0.0, 1.0, 0.0))
    given = design_on(assembly, [LoadCase("side", loads, 300.0)], angles=(0.0,))
    with pytest.raises(InfeasibleError, match="no locks carry 1 times"):
        least_cost(given, 1.0)


def test_factors_grow_with_strength_as_the_multipliers_say() -> None:
    """By differences of the factor of designs whose locks are a little stronger and weaker."""
    lower = box("lower", (0.0, 0.0, 0.0), (0.4, 0.6, 0.3), 2e3)
    upper = box("upper", (0.0, 0.0, 0.3), (0.4, 0.6, 0.6), 2e3)
    assembly = structure([BASE, lower, upper], dry(0.2))
    loads = force_at(assembly, "upper", (0.25, 0.3, 0.3), (-0.25, 1.0, 0.0))
    given = design_on(assembly, [LoadCase("push", loads, 1000.0)], angles=(20.0,), most=2)
    sites = zip(given.sites, (1, 2), strict=True)
    choice = [next(k for k in site.layouts if k.working == size) for site, size in sites]
    _, (by_strength,) = carried(given, choice)
    step = 1e-3

    def factor(number: int, times: float) -> float:
        """With the locks of a site so many times as strong."""
        changed = replace(choice[number], area=choice[number].area * times)
        sites = list(given.sites)
        sites[number] = replace(sites[number], layouts=(changed,))
        varied = [changed if k == number else each for k, each in enumerate(choice)]
        return carried(replace(given, sites=tuple(sites)), varied)[0][0]

    for number, layout in enumerate(choice):
        rise = factor(number, 1.0 + step) - factor(number, 1.0 - step)
        slope = rise / (2 * step * layout.strength)
        # Over what one N of strength could do at most.
        assert by_strength[number] == pytest.approx(slope, abs=1e-6 / 1000.0)
    assert max(by_strength) > 1e-5


def test_more_than_all_locks_carry_is_refused_with_the_largest_factor() -> None:
    given = design_on(BLOCKS, [pushed(BLOCKS, LOAD)], most=3)
    most = (3 * T1 + BY_FRICTION) / LOAD
    assert largest_factor(given) == pytest.approx(most, rel=1e-6)
    assert least_cost(given, 0.999 * most).cost <= 3.0
    with pytest.raises(InfeasibleError):
        least_cost(given, 1.001 * most)


# --- order of placing: what locks leave free -----------------------------------------------------
NARROW = LockKindSection(width=(0.04,), height=0.02, most=1)
X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


def chosen(assembly: Assembly, runs: dict[str, Vector]) -> tuple[Assembly, tuple[Site, ...], list]:
    """The assembly, its sites, and locks at all of them."""
    found = tuple(
        Site(number, layouts_of(face, NARROW, [runs[face.name]]))
        for number, face in enumerate(assembly.faces)
        if face.name in runs
    )
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
    (along,) = order.steps.values()
    assert along[1] == 0.0  # not across the locks
    assert along[2] < 0.0


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
