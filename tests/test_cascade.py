"""Which bonds fail, one after the other, up to the peak and behind it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import block_on_ground, load_on_block
from hypothesis import given, settings
from hypothesis import strategies as st
from joints import loaded, sawn

from sidmacib import Direction, Loads, limit_load
from sidmacib.joint import INNER, Joint
from sidmacib.joint.loading import Loading, posed
from sidmacib.joint.pieces import shared_face
from sidmacib.mechanics.assembly import Assembly, Cuboid, FaceMaterial, Failure, Kind, NodeLayout
from sidmacib.mechanics.contact_law import ContactLaw, NodeState
from sidmacib.mechanics.contact_law.kernels import utilisation
from sidmacib.mechanics.contact_nodes import contact_nodes
from sidmacib.mechanics.solution import Equilibrium
from sidmacib.mechanics.static import StaticSolution, solver_of, static_peak
from sidmacib.mechanics.static.peaks import LEAST_LOAD_LEFT, after_peak
from sidmacib.mechanics.static.softening import Softening
from sidmacib.problem import Problem


def on_supports(strength: tuple[float, ...], stiffness: tuple[float, ...]) -> Assembly:
    """A block glued to supports in a row, pushed along it: all slide by the same, without twist.

    ``strength`` (Pa) and ``stiffness`` (Pa/m) of the bonds along the face, of 1 m2 each.
    """
    count = len(strength)
    pieces = (
        *(
            Cuboid(f"support{i}", (i, 0.0, -1.0), (i + 1, 1.0, 0.0), 1.0, fixed=True)
            for i in range(count)
        ),
        Cuboid("block", (0.0, 0.0, 0.0), (count, 1.0, 1.0), 1.0),
    )
    faces = tuple(
        shared_face(f"bond{i}", Kind.INNER, FaceMaterial(1e9, k, 0.0, s, 1e12), pieces, (i, count))
        for i, (s, k) in enumerate(zip(strength, stiffness, strict=True))
    )
    return Assembly(pieces, faces, contact_nodes(faces, 0.5, NodeLayout.CENTRES), 1.0)


def pushed(model: Assembly) -> StaticSolution:
    none = np.zeros((len(model.pieces), 6))
    variable = none.copy()
    variable[-1, 0] = 1.0
    return static_peak(model, Loads(none, variable, 1.0))


@pytest.mark.parametrize(
    ("strength", "stiffness", "first", "peak"),
    [
        # A half of 2 N each, and then the second one alone, or it fails at once.
        *(
            ((1.0, second), (1e9, 1e9), 2.0, max(2.0, second))
            for second in (1.01, 1.5, 1.97, 1.995, 2.005, 2.03, 3.0)
        ),
        # A third of 3 N each; when the first has failed a half each; the strong one takes it all.
        *(((1.0, second, 10.0), (1e9,) * 3, 3.0, 10.0) for second in (1.02, 1.45, 1.48)),
        # The weak bond, nearly used up, is soft and takes a hundredth of what the other does.
        *(((0.01 * used, 1.0), (1e7, 1e9), 1.01 * used, 1.0) for used in (0.91, 0.95, 0.97)),
    ],
)
def test_bonds_fail_in_turn_before_the_load_goes_on_and_no_other_with_them(
    strength: tuple[float, ...], stiffness: tuple[float, ...], first: float, peak: float
) -> None:
    model = on_supports(strength, stiffness)
    found = pushed(model)
    assert found.first_failure_load == pytest.approx(first, rel=1e-5)
    assert found.peak.load == pytest.approx(peak, rel=1e-5)
    contact_law = ContactLaw.of(model)
    used = [utilisation(contact_law, point.state, point.force).max() for point in found.path]
    assert max(used) <= 1.0 + 1e-9
    if len(strength) == 3:
        bonds = {int(point.state.bonded.sum()) for point in found.path}
        assert bonds == {12, 4}  # never two bonds, of four nodes each


MESH = 0.03  # m
SMOOTH = FaceMaterial(1e10, 1e10, friction=0.0, cohesion=0.0, tensile_strength=0.0)


def smooth(locks: int, ratio: float = 0.0) -> Problem:
    return posed(sawn(locks, dry=SMOOTH), Loading(Direction(ratio)), MESH)


def followed(problem: Problem) -> tuple[Equilibrium, list[Equilibrium]]:
    peak = static_peak(*problem).peak
    return peak, [*after_peak(*problem, peak)]


@pytest.mark.parametrize("locks", [3, 5, 7])
def test_one_lower_lock_after_the_other_fails_in_pure_shear(locks: int) -> None:
    peak, points = followed(smooth(locks))
    assert len(points) == (locks - 1) / 2 - 1
    if points:  # the last one carries the whole load alone: its strength
        assert points[-1].load == pytest.approx(sawn(locks).T0, rel=2e-3)
        assert peak.load > points[0].load


def test_each_point_is_at_the_strength_of_a_bond_and_has_fewer_of_them() -> None:
    problem = smooth(5, 0.5)
    law = solver_of(*problem).contact_law
    peak, points = followed(problem)
    assert len(points) > 3
    bonded = int(peak.state.bonded.sum())
    for point in points:
        assert utilisation(law, point.state, point.force).max() == pytest.approx(1.0, abs=1e-2)
        assert int(point.state.bonded.sum()) < bonded
        assert point.load >= LEAST_LOAD_LEFT * peak.load
        bonded = int(point.state.bonded.sum())


def test_ductile_bonds_are_not_followed() -> None:
    problem = posed(sawn(5, failure=Failure.DUCTILE), Loading(Direction(0.0)), MESH)
    assert followed(problem)[1] == []


# --- bonds that soften: between brittle and ductile ----------------------------------------------
STORED = INNER.cohesion**2 / (2 * INNER.shear_stiffness)  # J/m2, elastically, at failure


def fading(energy: float, residual: float = 0.0) -> FaceMaterial:
    return replace(INNER, fracture_energy=energy, residual=residual)


def peak(joint: Joint, eccentricity: float, mesh: float = 0.03) -> StaticSolution:
    return static_peak(*loaded(joint, eccentricity, mesh, NodeLayout.VERTICES))


def softening(locks: int, energy: float, residual: float = 0.0) -> Joint:
    return sawn(locks, failure=Failure.SOFTENING, inner=fading(energy, residual))


def one_lock(material: FaceMaterial, failure: Failure, mesh: float = 0.01) -> Assembly:
    joint = sawn(3, inner=material)
    return replace(block_on_ground(joint, Kind.INNER, mesh), failure=failure)


@pytest.mark.long
@pytest.mark.parametrize("failure", [Failure.SOFTENING, Failure.DUCTILE])
def test_next_to_no_tensile_strength_carries_as_much_as_none(failure: Failure) -> None:
    """The first failure is then at next to no load, or before the load is raised."""
    none, little = (
        static_peak(*loaded(sawn(3, failure=failure, inner=inner), math.inf, 0.025))
        for inner in (replace(fading(2.0), tensile_strength=strength) for strength in (0.0, 1.0))
    )
    assert none.first_failure_load == 0.0 < little.first_failure_load < 0.01
    assert little.peak.load == pytest.approx(none.peak.load, rel=0.01)


# --- how a bond softens --------------------------------------------------------------------------
@settings(max_examples=15)
@given(st.floats(0.5, 200.0), st.floats(0.0, 1.0))
def test_the_work_of_a_node_is_the_fracture_energy(energy: float, residual: float) -> None:
    model = one_lock(fading(energy, residual), Failure.SOFTENING, 0.03)
    contact_law, fade = ContactLaw.of(model), Softening.of(model)
    state = NodeState.initial(contact_law.cohesive)
    last = 2 * energy / INNER.cohesion
    rise = 2.0 * INNER.cohesion / INNER.shear_stiffness
    moves = np.union1d(np.linspace(0.0, rise, 40), np.linspace(0.0, 1.2 * last, 200))
    stress = []
    for moved in moves:
        force = np.zeros((len(contact_law.friction), 3))
        force[:, 1] = state.whole * contact_law.shear_stiffness * moved
        state = replace(state, whole=fade.left(contact_law, state, force))
        stiffness = state.whole[0] * contact_law.shear_stiffness[0]
        stress.append(float(stiffness * moved / model.nodes.area[0]))
    kept = residual * INNER.cohesion
    # Two triangles less what the residual strength cuts off, and a rectangle beyond.
    fallen = last * (1 - residual) + residual * INNER.cohesion / INNER.shear_stiffness
    work = np.trapezoid(stress, moves)
    start = INNER.cohesion / INNER.shear_stiffness
    exact = INNER.cohesion * start / 2 + (INNER.cohesion + kept) / 2 * (fallen - start)
    exact += kept * (moves[-1] - fallen)
    assert work == pytest.approx(exact, rel=0.02)
    if residual == 0.0:
        assert work == pytest.approx(energy, rel=0.02)
    assert max(stress) <= INNER.cohesion * (1 + 1e-9)


@pytest.mark.parametrize("way", ["shear", "tension"])
@pytest.mark.parametrize("tougher", ["shear", "tension"])
def test_each_way_of_failing_fades_by_its_own_strength(way: str, tougher: str) -> None:
    """Over a displacement of 2 G / strength, from where the strength is reached."""
    energy, strong, weak = 20.0, 4e5, 1e5
    law_of = {"shear": weak, "tension": weak} | {tougher: strong}
    material = replace(fading(energy), cohesion=law_of["shear"], tensile_strength=law_of["tension"])
    model = one_lock(material, Failure.SOFTENING, 0.03)
    contact_law, fade = ContactLaw.of(model), Softening.of(model)
    strength, last = law_of[way], 2.0 * energy / law_of[way]
    stiffness = contact_law.shear_stiffness if way == "shear" else contact_law.normal_stiffness
    moved = 0.6 * last
    force = np.zeros((len(contact_law.friction), 3))
    force[:, 1 if way == "shear" else 0] = stiffness * moved * (1.0 if way == "shear" else -1.0)
    found = fade.left(contact_law, NodeState.initial(contact_law.cohesive), force)
    start = strength / material.shear_stiffness
    carried = strength * (last - moved) / (last - start)
    assert found == pytest.approx(carried / (material.shear_stiffness * moved))


def test_what_is_left_never_grows() -> None:
    model = one_lock(fading(10.0), Failure.SOFTENING, 0.03)
    contact_law, fade = ContactLaw.of(model), Softening.of(model)
    state = replace(
        NodeState.initial(contact_law.cohesive), whole=np.full(len(contact_law.friction), 0.3)
    )
    none = np.zeros((len(contact_law.friction), 3))
    assert fade.left(contact_law, state, none) == pytest.approx(0.3)


@pytest.mark.long
# --- between the ends ----------------------------------------------------------------------------
@pytest.mark.parametrize("eccentricity", [0.0, 0.5, math.inf])
def test_without_energy_it_is_brittle_and_with_all_residual_ductile(eccentricity: float) -> None:
    """Without energy: no more than is stored."""
    brittle = peak(sawn(3), eccentricity)
    found = peak(softening(3, 0.99 * STORED), eccentricity)
    assert found.first_failure_load == pytest.approx(brittle.first_failure_load, rel=1e-9)
    assert found.peak.load == pytest.approx(brittle.peak.load, rel=1e-3)
    ductile = peak(sawn(3, failure=Failure.DUCTILE), eccentricity)
    assert peak(softening(3, 0.0, residual=1.0), eccentricity).peak.load == ductile.peak.load


@pytest.mark.parametrize("moment", [0.0, 1.0])
def test_a_ductile_lock_alone_reaches_its_plastic_limit(moment: float) -> None:
    model = one_lock(replace(INNER, residual=1.0), Failure.SOFTENING)
    loads = load_on_block(model, (0.0, 1.0 - moment, 0.0), 0.06 * moment)
    limit = limit_load(model, loads).load
    assert static_peak(model, loads).peak.load == pytest.approx(limit, rel=5e-3)
