"""The joint's nodes as springs between its pieces."""

import numpy as np
import pytest

from sidmacib.joint import Joint
from sidmacib.mechanics.contact_law import NodeLaw
from sidmacib.mechanics.equilibrium import equilibrium_matrix, free_rows
from sidmacib.mechanics.springs import Springs


@pytest.fixture
def springs(joint: Joint) -> Springs:
    return Springs.of(assemble(joint, 0.03))


def test_the_stiffness_is_that_of_the_equilibrium_matrix(joint: Joint, springs: Springs) -> None:
    model = assemble(joint, 0.03)
    balance, law = equilibrium_matrix(model)[free_rows(model)], NodeLaw.of(model)
    stiffness = np.column_stack([law.normal_stiffness, law.shear_stiffness, law.shear_stiffness])
    expected = (balance * stiffness.ravel()) @ balance.T
    assert springs.elastic_stiffness() == pytest.approx(expected, rel=1e-9, abs=1e-6)


def test_parts_of_the_nodes_add_up_to_all(springs: Springs) -> None:
    own = springs.law.cohesive
    parts = springs.part(own).elastic_stiffness() + springs.part(~own).elastic_stiffness()
    assert parts == pytest.approx(springs.elastic_stiffness(), rel=1e-12, abs=1e-6)


def test_forces_do_the_work_of_the_displacements(springs: Springs) -> None:
    random = np.random.default_rng(1)
    displacement = random.normal(size=springs.faces.shape[2])
    force = random.normal(size=(len(springs.motion), 3))
    inside = springs.piece_forces(force) @ displacement
    assert inside == pytest.approx(np.sum(force * springs.node_displacements(displacement)))
