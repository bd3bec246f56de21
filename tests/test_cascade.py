"""Which bonds fail, one after the other, up to the peak and behind it."""

import numpy as np
import pytest

from sidmacib import Assembly, Direction, FaceMaterial, Joint, Loads, NodeLayout
from sidmacib.joint.loading import Loading, posed
from sidmacib.joint.pieces import shared_face
from sidmacib.mechanics.assembly import Cuboid, Failure, Kind
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.contact_law.kernels import utilisation
from sidmacib.mechanics.contact_nodes import contact_nodes
from sidmacib.mechanics.solution import Equilibrium
from sidmacib.mechanics.static import StaticSolution, solver_of, static_peak
from sidmacib.mechanics.static.peaks import LEAST_LOAD_LEFT, after_peak
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
    return posed(Joint(locks, dry=SMOOTH), Loading(Direction(ratio)), MESH)


def followed(problem: Problem) -> tuple[Equilibrium, list[Equilibrium]]:
    peak = static_peak(*problem).peak
    return peak, [*after_peak(*problem, peak)]


@pytest.mark.parametrize("locks", [3, 5, 7])
def test_one_lower_lock_after_the_other_fails_in_pure_shear(locks: int) -> None:
    peak, points = followed(smooth(locks))
    assert len(points) == (locks - 1) / 2 - 1
    if points:  # the last one carries the whole load alone: its strength
        assert points[-1].load == pytest.approx(Joint(locks).T0, rel=2e-3)
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
    problem = posed(Joint(5, failure=Failure.DUCTILE), Loading(Direction(0.0)), MESH)
    assert followed(problem)[1] == []
