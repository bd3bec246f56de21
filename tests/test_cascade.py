"""Which bonds fail, one after the other: blocks whose cascade is known by hand."""

import numpy as np
import pytest

from sidmacib.joint.pieces import shared_face
from sidmacib.mechanics.assembly import (
    Assembly,
    Cuboid,
    FaceMaterial,
    Kind,
    Loads,
    NodeLayout,
)
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.contact_law.kernels import utilisation
from sidmacib.mechanics.contact_nodes import contact_nodes
from sidmacib.mechanics.static import StaticSolution, static_peak


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


@pytest.mark.parametrize("second", [1.01, 1.5, 1.97, 1.995])
def test_a_bond_that_cannot_take_over_fails_at_once(second: float) -> None:
    found = pushed(on_supports((1.0, second), (1e9, 1e9)))
    assert found.first_failure_load == pytest.approx(2.0, rel=1e-5)
    assert found.peak.load == pytest.approx(2.0, rel=1e-5)


@pytest.mark.parametrize("second", [2.005, 2.03, 3.0])
def test_a_bond_that_can_take_over_holds_to_its_own_strength(second: float) -> None:
    found = pushed(on_supports((1.0, second), (1e9, 1e9)))
    assert found.first_failure_load == pytest.approx(2.0, rel=1e-5)
    assert found.peak.load == pytest.approx(second, rel=1e-5)


@pytest.mark.parametrize("second", [1.02, 1.45, 1.48])
def test_a_bond_that_fails_in_turn_does_so_before_the_load_goes_on(second: float) -> None:
    # A third of 3 N each; when the first has failed a half each; the strong one takes it all.
    model = on_supports((1.0, second, 10.0), (1e9, 1e9, 1e9))
    found = pushed(model)
    assert found.first_failure_load == pytest.approx(3.0, rel=1e-5)
    assert found.peak.load == pytest.approx(10.0, rel=1e-5)
    contact_law = ContactLaw.of(model)
    used = [utilisation(contact_law, point.state, point.force).max() for point in found.path]
    assert max(used) <= 1.0 + 1e-9
    assert {int(point.state.bonded.sum()) for point in found.path} == {12, 4}  # never two bonds


@pytest.mark.parametrize("used", [0.91, 0.95, 0.97])
def test_a_bond_that_is_nearly_used_up_does_not_fail_with_its_neighbour(used: float) -> None:
    # The weak bond is soft and takes a hundredth of what the other does.
    found = pushed(on_supports((0.01 * used, 1.0), (1e7, 1e9)))
    assert found.first_failure_load == pytest.approx(1.01 * used, rel=1e-5)
    assert found.peak.load == pytest.approx(1.0, rel=1e-5)
