"""The design of locks of a structure, against closed forms, symmetry and all layouts."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from designs import FRICTION, KIND, T1, design_on, pushed, stack, two_blocks, working
from structures import dry

from sidmacib.design.direction import SHORT, RowSearch, choice_of, rounded_up
from sidmacib.design.layouts import Weights, directions_of, layouts_of
from sidmacib.design.model import DesignProblem, LoadCase
from sidmacib.design.sizing import carried, largest_factor, least_cost, needed
from sidmacib.errors import InfeasibleError
from sidmacib.structure.blocks import box
from sidmacib.structure.loads import force_at, free_weight
from sidmacib.structure.structure import structure
from studies.designed_vault.all_layouts import row

LOAD = 3000.0  # N


def test_two_blocks_need_what_friction_leaves() -> None:
    blocks = two_blocks()
    given = design_on(blocks, [pushed(blocks, LOAD)])
    by_friction = FRICTION * free_weight(blocks)
    for factor in (1.0, 1.5):
        needs = (factor * LOAD - by_friction) / T1
        assert least_cost(given, factor).cost == pytest.approx(needs, rel=1e-6)
    assert least_cost(given, 0.9 * by_friction / LOAD).cost == pytest.approx(0.0, abs=1e-6)


def test_a_whole_number_of_locks_is_the_least_that_is_enough() -> None:
    blocks = two_blocks()
    given = design_on(blocks, [pushed(blocks, LOAD)])
    found = RowSearch(given, 1.0).cheapest()
    needs = (LOAD - FRICTION * free_weight(blocks)) / T1
    assert found.cost == np.ceil(needs) == 2.0
    (layout,) = choice_of(given, found.parts)
    assert layout is not None
    assert layout.run == (1.0, 0.0, 0.0)  # across the push
    (state,) = carried(given, [layout])
    assert state.factor == pytest.approx((2 * T1 + FRICTION * free_weight(blocks)) / LOAD, rel=1e-7)


def test_weights_change_what_is_least_and_scale_the_cost() -> None:
    blocks = two_blocks()
    kind = replace(KIND, widths=(0.05, 0.1))
    number, area = (
        design_on(blocks, [pushed(blocks, LOAD)], weights=each, kind=kind)
        for each in (Weights(number=1.0), Weights(number=0.0, area=1.0))
    )
    few, small = (RowSearch(each, 1.0).cheapest() for each in (number, area))
    assert few.cost == 1.0  # one wide lock
    assert small.cost == pytest.approx(2 * 0.05 * 0.4)
    twice = design_on(
        blocks, [pushed(blocks, LOAD)], weights=Weights(number=0.0, area=2.0), kind=kind
    )
    assert least_cost(twice, 1.0).cost == pytest.approx(2 * least_cost(area, 1.0).cost, rel=1e-6)


def test_locks_of_half_the_strength_are_needed_twice() -> None:
    blocks = two_blocks()
    given = design_on(blocks, [pushed(blocks, LOAD)])
    inner = replace(KIND.inner, cohesion=0.5 * KIND.inner.cohesion)
    half = design_on(blocks, [pushed(blocks, LOAD)], kind=replace(KIND, inner=inner))
    assert least_cost(half, 1.0).cost == pytest.approx(2 * least_cost(given, 1.0).cost, rel=1e-6)


def test_scaling_all_forces_leaves_the_design() -> None:
    blocks = two_blocks()
    heavy = structure([replace(b, density=1e3 * b.density) for b in blocks.pieces], dry(FRICTION))
    inner = replace(KIND.inner, cohesion=1e3 * KIND.inner.cohesion)
    given = design_on(blocks, [pushed(blocks, LOAD)])
    strong = design_on(heavy, [pushed(heavy, 1e3 * LOAD)], kind=replace(KIND, inner=inner))
    assert least_cost(strong, 1.0).cost == pytest.approx(least_cost(given, 1.0).cost, rel=1e-6)


def test_rows_have_room_and_are_as_strong_as_their_roots() -> None:
    face = two_blocks().faces[0]
    for layout in layouts_of(face, KIND, directions_of(face, angles=(0.0, 90.0)), 10):
        across, along = (0.6, 0.4) if layout.direction == 0 else (0.4, 0.6)
        assert sum(layout.widths) == pytest.approx(across)
        assert layout.widths[0] == layout.widths[-1] >= layout.width * (1 - 1e-9)
        assert layout.strength == pytest.approx(8e4 * 0.05 * along * layout.working)


@pytest.fixture(scope="module")
def pushed_both_ways() -> DesignProblem:
    """Two blocks on a base, pushed along x, along y and between these, beside their middle."""
    assembly = structure(stack(), dry(0.3))
    pushes = (
        ("x", "upper", (1.0, 0.0, 0.0), 550.0),
        ("y", "lower", (0.0, 1.0, 0.0), 1100.0),
        ("between", "upper", (1.0, 2.0, 0.0), 560.0),
    )
    cases = [
        LoadCase(name, force_at(assembly, block, (0.25, 0.3, 0.3), along), load)
        for name, block, along, load in pushes
    ]
    kind = replace(KIND, inner=replace(KIND.inner, cohesion=1e4))
    return design_on(assembly, cases, angles=(0.0, 45.0, 90.0, 135.0), most=3, kind=kind)


def test_without_friction_two_directions_are_needed_and_one_is_not_enough() -> None:
    assembly = structure(row(2), dry(0.0))
    loads = force_at(assembly, "cube0", (0.2, 0.2, 0.2), (0.0, 1.0, 0.0))
    given = design_on(assembly, [LoadCase("side", loads, 300.0)], angles=(0.0,))
    with pytest.raises(InfeasibleError, match="no locks carry 1 times"):
        least_cost(given, 1.0)


def test_a_search_ends_with_the_cheapest_of_all_layouts(pushed_both_ways: DesignProblem) -> None:
    given, best, tried = pushed_both_ways, np.inf, 0
    search = RowSearch(given, 1.0)
    options = [np.flatnonzero(given.site_of == site) for site in range(len(given.sites))]
    for chosen in product(*[[None, *each] for each in options]):
        numbers = [k for k in chosen if k is not None]
        cost = float(given.costs[numbers].sum())
        if cost < best:
            tried += 1
            taken = np.zeros(len(given.layouts))
            taken[numbers] = 1.0
            best = cost if search.carries(taken) else best
    found = search.cheapest(gap=1e-4)
    assert tried > 30
    assert found.cost == best < np.inf
    assert found.gap <= 1e-4
    mixed = search.cheapest(whole=False, gap=1e-4)
    assert search.relaxed.cost <= mixed.cost * (1 + 1e-6)
    assert mixed.bound <= found.cost * (1 + 1e-6)
    assert search.carries(mixed.parts * (1.0 + 1e-4))


def test_every_design_that_carries_costs_more_than_the_bound(
    pushed_both_ways: DesignProblem,
) -> None:
    given = pushed_both_ways
    bound = least_cost(given, 1.0).cost
    search, generator = RowSearch(given, 1.0), np.random.default_rng(3)
    carrying = 0
    for _ in range(20):
        taken = np.zeros(len(given.layouts))
        for site in range(len(given.sites)):
            taken[generator.choice(np.flatnonzero(given.site_of == site))] = 1.0
        if search.carries(taken):
            carrying += 1
            assert given.costs @ taken >= bound * (1 - 1e-6)
    assert carrying > 0


def test_what_is_barred_is_not_chosen(pushed_both_ways: DesignProblem) -> None:
    search = RowSearch(pushed_both_ways, 1.0)
    free = search.cheapest(gap=1e-4)
    taken = frozenset(pushed_both_ways.rows[k] for k in pushed_both_ways.row_of[free.parts > 0])
    other = search.cheapest(barred=[taken], gap=1e-4)
    assert not taken <= {pushed_both_ways.rows[k] for k in pushed_both_ways.row_of[other.parts > 0]}
    assert other.cost >= free.cost
    assert search.carries(other.parts)


def test_the_mirror_image_of_a_mixture_for_a_symmetric_structure_carries_as_much() -> None:
    assembly = structure(row(3), dry(0.0))
    loads = force_at(assembly, "cube1", (0.6, 0.2, 0.2), (0.0, 0.0, -1.0))
    given = design_on(assembly, [LoadCase("down", loads, 500.0)])
    search = RowSearch(given, 1.0)
    strength = search.strengths @ search.relaxed.parts
    names = [assembly.faces[site.face].name for site in given.sites]
    image = {"left-cube0": "right-cube2", "cube0-cube1": "cube1-cube2"}
    image |= {there: here for here, there in image.items()}
    places = {(names[site], way): k for k, (site, way) in enumerate(given.rows)}
    mirrored = [strength[places[image[names[site]], way]] for site, way in given.rows]
    assert all(lack.of(np.array(mirrored))[0] <= 1e-4 for lack in search.lacks)
    less = 0.99 * np.array(mirrored)
    assert any(lack.of(less)[0] > 1e-4 for lack in search.lacks)
    # What stands on nothing hangs on the walls.
    by_name = dict.fromkeys(names, 0.0)
    for (site, _), value in zip(given.rows, strength, strict=True):
        by_name[names[site]] += given.unit * value
    weight = free_weight(assembly) + 500.0
    assert by_name["left-cube0"] + by_name["right-cube2"] == pytest.approx(weight, rel=1e-5)


def test_factors_grow_with_strength_as_the_multipliers_say() -> None:
    """By differences of the factor of designs whose locks are a little stronger and weaker."""
    assembly = structure(stack(), dry(0.2))
    loads = force_at(assembly, "upper", (0.25, 0.3, 0.3), (-0.25, 1.0, 0.0))
    given = design_on(assembly, [LoadCase("push", loads, 1000.0)], angles=(20.0,), most=2)
    sizes = (1, 2)
    choice = [
        next(each for each in site.layouts if each.working == size)
        for site, size in zip(given.sites, sizes, strict=True)
    ]
    (state,) = carried(given, choice)
    step = 1e-3

    def factor(number: int, times: float) -> float:
        """With the locks of a site so many times as strong."""
        changed = replace(choice[number], area=choice[number].area * times)
        sites = list(given.sites)
        sites[number] = replace(sites[number], layouts=(changed,))
        varied = [changed if k == number else each for k, each in enumerate(choice)]
        return carried(replace(given, sites=tuple(sites)), varied)[0].factor

    for number, layout in enumerate(choice):
        rise = factor(number, 1.0 + step) - factor(number, 1.0 - step)
        slope = rise / (2 * step * layout.strength)
        # Over what one N of strength could do at most.
        assert state.by_strength[number] == pytest.approx(slope, abs=1e-6 / 1000.0)
    assert max(state.by_strength) > 1e-5


def test_what_locks_need_is_within_their_strength_and_balances_the_push() -> None:
    blocks = two_blocks()
    given = design_on(blocks, [pushed(blocks, LOAD)])
    choice = choice_of(given, RowSearch(given, 1.0).cheapest().parts)
    (found,) = needed(given, choice, 1.0)
    held = LOAD - FRICTION * free_weight(blocks)
    assert abs(found.across[0]) == pytest.approx(held, rel=1e-5)  # friction does what it can
    assert abs(found.across[0]) <= choice[0].strength
    assert found.torque[0] == pytest.approx(0.0, abs=1e-3)


def test_more_than_all_locks_carry_is_refused_with_the_largest_factor() -> None:
    blocks = two_blocks()
    given = design_on(blocks, [pushed(blocks, LOAD)], most=3)
    most = (3 * T1 + FRICTION * free_weight(blocks)) / LOAD
    assert largest_factor(given) == pytest.approx(most, rel=1e-6)
    assert least_cost(given, 0.999 * most).cost <= 3.0
    with pytest.raises(InfeasibleError):
        least_cost(given, 1.001 * most)


def test_mixtures_are_rounded_up_to_whole_rows_that_are_as_strong(
    pushed_both_ways: DesignProblem,
) -> None:
    parts = least_cost(pushed_both_ways, 1.0).parts
    taken = rounded_up(pushed_both_ways, parts)
    strength = np.array([layout.strength for layout in pushed_both_ways.layouts])
    for number in range(len(pushed_both_ways.rows)):
        here = pushed_both_ways.row_of == number
        if taken[here].any():
            assert taken[here].sum() == 1.0
            assert strength @ (taken * here) >= strength @ (parts * here) * (1 - SHORT)
    assert max(working(pushed_both_ways, taken)) <= 3


def test_a_bonded_interface_needs_no_locks() -> None:
    bonded = replace(dry(0.0), cohesion=1e6, tensile_strength=1e6)
    assembly = structure(
        [
            box("base", (0.0, 0.0, -0.3), (0.4, 0.6, 0.0), 2e3, fixed=True),
            box("block", (0.0, 0.0, 0.0), (0.4, 0.6, 0.3), 2e3),
        ],
        bonded,
    )
    given = design_on(assembly, [pushed(assembly, LOAD)])
    assert least_cost(given, 1.0).cost == pytest.approx(0.0, abs=1e-6)
