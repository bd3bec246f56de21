"""Joints at which Newton's method gives up or increments stepped over the first failure."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import DISTINCT, block_on_ground, load_on_block, run_guided
from hypothesis import given, settings
from hypothesis import strategies as st
from joints import loaded, sawn

from sidmacib import Side, UpperBody
from sidmacib.engines import Numerics
from sidmacib.engines.results import read_outcome
from sidmacib.errors import CapacityError, NoEquilibriumError
from sidmacib.joint import Direction, HoldDown, Joint
from sidmacib.joint.loading import Loading, Push, posed
from sidmacib.mechanics.assembly import Assembly, FaceMaterial, Kind, NodeLayout
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.contact_law.kernels import utilisation
from sidmacib.mechanics.equilibrium import compliance, placed, unbalanced_share
from sidmacib.mechanics.loads import Loads
from sidmacib.mechanics.newton import friction_rounds
from sidmacib.mechanics.newton.friction_rounds import EquilibriumSearch
from sidmacib.mechanics.rigid import RigidSolver
from sidmacib.mechanics.solution import Equilibrium, FirstFailure
from sidmacib.mechanics.static import Mode, static_first_failure, static_peak
from sidmacib.problem import Problem
from sidmacib.rule import law, safe
from sidmacib.rule.reliability import scatter
from sidmacib.rule.spans import SPANS, spans_of
from studies.attack import search as attack
from studies.attack.search import (
    DIMENSIONS,
    MORE,
    MORE_LOCKS,
    SPACES,
    Space,
    Target,
    ratio_at,
    search,
    target_at,
    with_more_locks,
)

# Joint 9783 of a sampling of 13,312 joints: rough locks, soft roots, stiff dry faces.
ROUGH = sawn(
    16,
    a=0.066531,
    h=0.0294074,
    H=0.0159384,
    inner=FaceMaterial(1e10, 5.1013e7, 0.0, 8e4, 3.7e5),
    dry=FaceMaterial(1.504817e11, 1.504817e11, 0.61608, 0.0, 0.0),
    upper_body=UpperBody.MONOLITHIC,
)
# Its weight opens and closes nodes in turn.
SOUND = sawn(
    12,
    a=0.31102,
    b=0.37215,
    h=0.04653,
    H=0.22903,
    density=910.3,
    inner=FaceMaterial(1e10, 4.532e8, 0.0, 8e4, 6.911e5),
    dry=FaceMaterial(4.746e10, 1.935e11, 0.01096, 0.0, 0.0),
    upper_body=UpperBody.MONOLITHIC,
)


def require_equilibrium(model: Assembly, loads: Loads, point: Equilibrium) -> None:
    """The point's forces balance the loads, and no node carries what it cannot.

    Uses nothing of the solver: the balance of moved pieces, and the contact law as inequalities.
    """
    motion = placed(model, point.unknowns)
    assert unbalanced_share(model, loads, point.load, point.force, motion) <= 1e-9
    contact_law, dry = ContactLaw.of(model), ~point.state.bonded
    normal, shear = point.force[:, 0], np.hypot(point.force[:, 1], point.force[:, 2])
    assert (normal[dry] >= 0.0).all()
    assert (shear[dry] <= contact_law.friction[dry] * normal[dry] * (1.0 + 1e-9)).all()
    assert utilisation(contact_law, point.state, point.force).max() <= 1.0 + 1e-9


def first_failure(model: Assembly, loads: Loads) -> FirstFailure:
    found = static_first_failure(model, loads, increment=0.1)  # halved, they take ten times as long
    require_equilibrium(model, loads, found.point)
    return found


@pytest.mark.long
@pytest.mark.parametrize("layout", NodeLayout)
def test_rough_locks_in_torsion_carry_until_a_bond_fails(layout: NodeLayout) -> None:
    model, loads = loaded(ROUGH, math.inf, 0.033, layout, Push.MINUS_Y)
    found = first_failure(model, loads)
    # Four nodes on a lock, at cells' centres, miss the corners: the block turns out of its place.
    corners = layout is not NodeLayout.CENTRES
    assert found.mode is (Mode.BONDS if corners else Mode.TURNED)
    assert found.point.load / ROUGH.T0 == pytest.approx(14.0 if corners else 17.3, rel=0.03)


def test_a_sound_joint_stands_under_its_own_weight() -> None:
    model, loads = loaded(SOUND, 0.4984, 0.15, NodeLayout.LOBATTO)
    found = first_failure(model, loads)
    # An independent solver has 20,094 N.
    assert found.point.load == pytest.approx(20_094.0, rel=2e-3)
    assert found.mode is Mode.BONDS


def test_a_joint_without_weight_carries_what_one_of_next_to_none_does() -> None:
    joint = sawn(3, density=0.0, hold_down=HoldDown.weight())
    found, light = (
        first_failure(*loaded(each, math.inf, 0.02, NodeLayout.VERTICES))
        for each in (joint, replace(joint, density=1e-6))
    )
    assert found.point.load == pytest.approx(light.point.load, rel=1e-6)
    assert found.mode is light.mode is Mode.BONDS


def test_where_a_block_slides_off_the_search_ends_soon(
    joint: Joint, monkeypatch: pytest.MonkeyPatch
) -> None:
    model = block_on_ground(joint, Kind.DRY, 0.02)
    plain, counted = EquilibriumSearch.with_given_limits, []

    def counting(*given: Any) -> bool:
        counted.append(given)
        return plain(*given)

    monkeypatch.setattr(EquilibriumSearch, "with_given_limits", counting)
    solver = RigidSolver(model, load_on_block(model, (0.0, 1.0, 0.0), 0.0))
    solver.drifts = False  # as where bonds keep it near
    start = solver.start()
    assert not counted  # Newton's method finds this
    with pytest.raises(NoEquilibriumError, match="no equilibrium at 100 N"):
        solver.solve(100.0, start.unknowns, start.state, thorough=True)
    assert 0 < len(counted) <= 1 + 2 * friction_rounds.IN_A_ROW


BY_WEIGHT = sawn(
    *(4, 0.03664, 0.05, 0.0115, 0.015),
    density=307728,
    inner=FaceMaterial(1e10, 3e10, 0, 8e4, 2.2219e5),
    dry=FaceMaterial(3e11, 1.5576e12, 0.28547, 0, 0),
    first=Side.LOWER,
    hold_down=HoldDown.weight(),
)
BY_FORCE = sawn(
    *(8, 0.0709, 0.05, 0.00722, 0.0205),
    density=210,
    inner=FaceMaterial(1e10, 3e10, 0, 8e4, 2.37e5),
    dry=FaceMaterial(3e11, 1.665e12, 0.3727, 0, 0),
    first=Side.LOWER,
    hold_down=HoldDown.force(2453),
)
FOUND = [(BY_WEIGHT, 2.2374), (BY_FORCE, 5.268)]


def first_failures(joint: Joint, loading: Loading, cells: int) -> tuple[float, float]:
    """As the model chooses its increments, and with increments of 0.002 T0, in N."""
    problem = posed(joint, loading, joint.least_side / cells)
    found = static_first_failure(*problem), static_first_failure(*problem, increment=0.002)
    return found[0].point.load, found[1].point.load


@pytest.mark.parametrize(("joint", "eccentricity"), FOUND)
@pytest.mark.parametrize("cells", [2, 3])
def test_no_first_failure_is_stepped_over(joint: Joint, eccentricity: float, cells: int) -> None:
    load, fine = first_failures(joint, Loading(Direction(eccentricity)), cells)
    assert load == pytest.approx(fine, rel=5e-3)


@pytest.mark.long
@pytest.mark.parametrize("space", SPACES[1:4], ids=lambda space: space.name)
def test_first_failures_of_random_joints_do_not_depend_on_increments(space: Space) -> None:
    random, answered = np.random.default_rng(20), 0
    while answered < 6:
        target = target_at(space, list(random.random(DIMENSIONS)))
        if target.joint.locks > 10:
            continue
        try:
            load, fine = first_failures(target.joint, target.loading, 2)
        except CapacityError:
            continue
        answered += 1
        assert load == pytest.approx(fine, rel=5e-3)


@pytest.mark.long
@pytest.mark.parametrize(("joint", "eccentricity"), FOUND)
def test_safe_loads_are_below_first_failures_on_plateaus(joint: Joint, eccentricity: float) -> None:
    """A margin on the load alone made it 41.2 for 29.5 N, and 105.8 for 98.4 N."""
    direction = Direction(eccentricity)
    load, fine = first_failures(joint, Loading(direction), 5)
    assert safe(joint, direction).load < min(load, fine)


def test_a_joint_that_rocks_first_has_the_load_at_which_it_does_and_no_scatter() -> None:
    """Two strong, smooth locks held down by their weight: strengths do not decide."""
    inner, dry = FaceMaterial(1e10, 1e10, 0, 1e7, 1e8), FaceMaterial(1e10, 1e10, 0, 0, 0)
    joint = sawn(2, H=0.1, density=200, inner=inner, dry=dry, hold_down=HoldDown.weight())
    direction = Direction(0.0)
    found = law(joint, direction)
    assert found.mode is Mode.ROCKING
    assert found.moves == "rocks before a bond fails"
    stronger = replace(joint, inner=replace(inner, cohesion=2e7, tensile_strength=2e8))
    assert law(stronger, direction).load == pytest.approx(found.load, rel=1e-3)
    with pytest.raises(CapacityError, match="before a bond fails; their strengths do not decide"):
        scatter(joint, direction, 0.2)


def test_a_path_of_two_increments_does_not_agree_with_itself_by_chance() -> None:
    """A search found it: 168.5 N on the coarsest two paths, 160.2 N on fine ones."""
    joint = sawn(
        2,
        a=0.242729,
        b=0.05,
        h=0.0391252,
        H=0.159497,
        density=3830.22,
        inner=FaceMaterial(1e13, 4.31253e11, 0.0, 8e4 / 1.06, 48381.5 / 1.06),
        dry=FaceMaterial(5.20322e10, 1.85253e11, 0.305595, 0.0, 0.0),
        upper_body=UpperBody.MONOLITHIC,
        hold_down=HoldDown.pressure(4439.52),
    )
    problem = posed(joint, Loading(Direction(0.696345)), joint.least_side / 4)
    assert static_first_failure(*problem).point.load == pytest.approx(160.2, rel=5e-3)


# --- dry faces that are far stiffer than the inner ones ------------------------------------------
SOFT = 1e9  # Pa/m, of inner faces
RIGID_DRY = 394.24  # N, peak


def problem(ratio: float, e_over_a: float, locks: int = 9) -> Problem:
    """A joint whose dry faces are ``ratio`` times as stiff as the inner ones."""
    inner = FaceMaterial(SOFT, SOFT, 0.0, 8e4, 3.7e5)
    dry = FaceMaterial(ratio * SOFT, ratio * SOFT, 0.3, 0.0, 0.0)
    return posed(sawn(locks, inner=inner, dry=dry), Loading(Direction(e_over_a)), 0.025)


@pytest.mark.parametrize("ratio", [1e5, 1e6])
def test_beyond_some_stiffness_dry_faces_are_rigid(ratio: float) -> None:
    found = static_peak(*problem(ratio, 0.0))
    assert found.mode is Mode.BONDS
    assert found.peak.load == pytest.approx(RIGID_DRY, rel=1e-4)


@pytest.mark.long
@pytest.mark.parametrize(("locks", "e_over_a"), [(3, math.inf), (9, 0.3)])
def test_the_first_failure_no_longer_depends_on_the_stiffness(locks: int, e_over_a: float) -> None:
    problems = (problem(ratio, e_over_a, locks) for ratio in (1e5, 1e6))
    loads = [static_first_failure(*each).point.load for each in problems]
    assert loads[1] == pytest.approx(loads[0], rel=1e-3)


def test_a_stiffness_that_rounding_would_decide_on_is_refused() -> None:
    words = r"3e\+06 times as stiff as the softest; at most 1e\+06 times are computed"
    with pytest.raises(CapacityError, match=words):
        static_peak(*problem(3e6, 0.0))


@pytest.mark.parametrize("ratio", [1e2, 1e5])
def test_the_reference_displacement_does_not_shrink_with_stiff_dry_faces(ratio: float) -> None:
    assert compliance(*problem(ratio, math.inf)) == compliance(*problem(1.0, math.inf))


@pytest.mark.engine
@pytest.mark.parametrize("name", DISTINCT)
@pytest.mark.parametrize("e_over_a", [0.0, math.inf])
def test_stiff_dry_faces_are_no_collapse(name: str, e_over_a: float, tmp_path: Path) -> None:
    dry = FaceMaterial(1e12, 1e12, 0.3, 0.0, 0.0)
    given = posed(sawn(3, dry=dry), Loading(Direction(e_over_a)), 0.02, NodeLayout.VERTICES)
    run_guided(name, given, Numerics(), tmp_path, 300.0)
    found = read_outcome(tmp_path, given.assembly)
    assert found.path[-1].load == pytest.approx(static_peak(*given).peak.load, rel=0.01)


@pytest.mark.engine
def test_drag_does_not_hold_up_what_slides_early(tmp_path: Path) -> None:
    dry = FaceMaterial(1e13, 1e13, 0.3, 0.0, 0.0)
    given = posed(sawn(5, dry=dry), Loading(Direction(math.inf)), 0.02, NodeLayout.VERTICES)
    run_guided("liggghts", given, Numerics(), tmp_path, 300.0)
    found = read_outcome(tmp_path, given.assembly).path[-1].load
    assert found == pytest.approx(static_peak(*given).peak.load, rel=0.012)


# --- the search for joints whose safe load is above what they carry, in small --------------------
RIGID = [space for space in SPACES if not space.elastic]
ELASTIC = next(space for space in SPACES if space.elastic)
PLACE = st.lists(st.floats(0.0, 1.0), min_size=DIMENSIONS, max_size=DIMENSIONS)


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Generations of a sixth of the size: the first one fills the space."""
    monkeypatch.setattr(attack, "POPULATION", 1)


@given(place=PLACE, space=st.sampled_from(SPACES))
def test_every_place_is_a_joint_inside_the_spans(place: list[float], space: Space) -> None:
    for name, value in spans_of(target_at(space, place).joint).items():
        if "Kd h" in name:  # it follows from others: the rule refuses what is beyond
            continue
        low, high = SPANS[name]
        assert low * (1.0 - 1e-9) <= value <= high * (1.0 + 1e-9), name


@pytest.mark.parametrize("end", [0.0, 1.0])
def test_the_ends_of_every_span_are_reached(end: float) -> None:
    found: dict[str, set[float]] = {}
    for space in SPACES:
        for name, value in spans_of(target_at(space, [end] * DIMENSIONS).joint).items():
            found.setdefault(name, set()).add(value)
    for name, span in SPANS.items():
        bound = span[0] if end == 0.0 else span[1]
        sampled = name.startswith("locks of") or "Kd h" in name or math.isinf(bound)
        assert sampled or any(value == pytest.approx(bound, abs=1e-3) for value in found[name])


@pytest.mark.long
@settings(max_examples=20, deadline=None)
@given(place=PLACE, space=st.sampled_from(RIGID))
def test_the_safe_load_is_below_the_first_failure(place: list[float], space: Space) -> None:
    found = ratio_at(space, place)
    assert found is not None and found <= 1.0


def test_the_worst_joint_is_solved_with_more_locks(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple[int, float]] = []

    def ratio(target: Target) -> float:
        asked.append((target.joint.locks, target.joint.a))
        return 1.0 / target.joint.locks

    monkeypatch.setattr(attack, "ratio_of", ratio)
    target = target_at(ELASTIC, [0.5] * DIMENSIONS)
    assert with_more_locks(target) == {MORE.format(n): 1.0 / n for n in MORE_LOCKS}
    assert asked == [(n, target.joint.a) for n in MORE_LOCKS]


@pytest.mark.study
@pytest.mark.usefixtures("small")
def test_an_attack_finds_a_rule_that_is_not_safe(monkeypatch: pytest.MonkeyPatch) -> None:
    honest = attack.safe_load
    monkeypatch.setattr(attack, "safe_load", lambda target: 1.2 * (honest(target) or 0.0) or None)
    row = search(RIGID[1], seed=1, evaluations=1)
    assert row["safe_over_first_failure"] > 1.0
    assert float(str(row["safe_over_peak_1"])) > 1.0
