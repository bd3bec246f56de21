"""Limit analysis of what is loaded in its plane: as with three forces at each node, turned too."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from structures import dry

from sidmacib import Assembly, FaceMaterial, limit_load
from sidmacib.mechanics.assembly import Floats
from sidmacib.mechanics.contact_law import Cone, ContactLaw
from sidmacib.mechanics.equilibrium import unbalanced_forces
from sidmacib.mechanics.in_plane import Reduced
from sidmacib.mechanics.loads import Loads
from sidmacib.mechanics.sliding import sliding_limit
from sidmacib.structure.blocks import Block
from sidmacib.structure.loads import acceleration
from sidmacib.structure.structure import structure
from studies.structures.shapes import arch, wall

ROUGH = dry(0.6)
MORTAR = FaceMaterial(1e10, 1e10, 0.5, 2e4, 1e4)
TURN = Rotation.from_rotvec([0.3, -0.8, 0.5])


def turned(blocks: Sequence[Block], turn: Rotation) -> list[Block]:
    def moved(block: Block) -> Block:
        return replace(block, vertices=tuple(map(tuple, turn.apply(block.vertices).tolist())))

    return [moved(block) for block in blocks]


def leaned(model: Assembly, turn: Rotation, across: float = 0.0) -> Loads:
    """Weight and a horizontal acceleration, as before the model was turned; ``across`` the wall."""
    weight = np.array([[each.weight * (not each.fixed)] for each in model.pieces])
    forces = {
        way: np.hstack([weight * turn.apply(direction), np.zeros((len(weight), 3))])
        for way, direction in (("down", (0, 0, -1)), ("along", (1.0, across, 0.0)))
    }
    total = float(weight.sum())
    return Loads(forces["down"], forces["along"] / total, total)


def cone_of(model: Assembly) -> Cone:
    return ContactLaw.of(model).cone(friction=True)


def is_reduced(model: Assembly, loads: Loads) -> bool:
    return Reduced.of(model, loads, cone_of(model)).spread is not None


@pytest.mark.parametrize("turn", [Rotation.identity(), TURN], ids=["upright", "turned"])
@pytest.mark.parametrize("law", [ROUGH, MORTAR], ids=["dry", "mortar"])
@pytest.mark.parametrize("blocks", [arch(9, 0.25), wall(3, 0.2)], ids=["arch", "wall"])
def test_the_load_and_the_forces_are_those_of_all_nodes(
    blocks: list[Block], law: FaceMaterial, turn: Rotation, monkeypatch: pytest.MonkeyPatch
) -> None:
    model = structure(turned(blocks, turn), law)
    loads = leaned(model, turn)
    assert is_reduced(model, loads)
    found = limit_load(model, loads, friction=True)
    monkeypatch.setattr(Reduced, "of", lambda model, *_: Reduced.whole(model))
    whole = limit_load(model, loads, friction=True)
    assert found.load == pytest.approx(whole.load, rel=1e-7)
    np.testing.assert_allclose(found.force, whole.force, atol=1e-3 * np.abs(whole.force).max())
    assert float(np.sum(loads.variable * found.mechanism)) == pytest.approx(1.0)


def test_forces_at_the_nodes_balance_all_six_forces_on_each_block() -> None:
    model = structure(turned(arch(9, 0.25), TURN), MORTAR)
    loads = leaned(model, TURN)
    found = limit_load(model, loads, friction=True)
    left: Floats = unbalanced_forces(model, loads, found.load, found.force)
    assert np.abs(left).max() < 1e-6 * loads.scale


def test_sliding_without_dilation_is_found_in_the_plane_too(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    model = structure(wall(4, 0.2), dry(0.3))
    loads = acceleration(model, (1.0, 0.0, 0.0))
    found = sliding_limit(model, loads).state.load
    monkeypatch.setattr(Reduced, "of", lambda model, *_: Reduced.whole(model))
    assert found == pytest.approx(sliding_limit(model, loads).state.load, rel=1e-3)


def test_what_leaves_the_plane_has_all_its_nodes() -> None:
    model = structure(wall(2, 0.2), ROUGH)
    assert not is_reduced(model, leaned(model, Rotation.identity(), across=0.01))
    aside = [
        replace(b, vertices=tuple((x, y + 0.01 * z, z) for x, y, z in b.vertices))
        for b in wall(2, 0.2)
    ]
    sheared = structure(aside, ROUGH)
    assert not is_reduced(sheared, leaned(sheared, Rotation.identity()))


def test_a_load_with_a_lever_out_of_the_plane_has_all_nodes() -> None:
    model = structure(wall(2, 0.2), ROUGH)
    loads = leaned(model, Rotation.identity())
    lever = loads.variable.copy()
    lever[3, 3] = 0.01  # N m per N about the axis along the wall
    assert is_reduced(model, loads)
    assert not is_reduced(model, replace(loads, variable=lever))


def test_nodes_behind_each_other_with_other_limits_are_not_one() -> None:
    model = structure(wall(2, 0.2), ROUGH)
    loads, cone = leaned(model, Rotation.identity()), cone_of(model)
    held = cone.held.copy()
    held[0] = 1.0
    assert Reduced.of(model, loads, replace(cone, held=held)).spread is None
