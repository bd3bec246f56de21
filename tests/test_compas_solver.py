"""multilock as a solver of compas_dem: five lines of a script, with the real packages."""

from typing import Any

import numpy as np
import pytest
from structures import FILES

from sidmacib.compas import multilock_solve, show_forces
from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import GRAVITY
from sidmacib.structure.analysis.limit import limit_state
from sidmacib.structure.files.structure_file import structure_of
from sidmacib.structure.loads import free_weight

compas = pytest.importorskip("compas")
pytest.importorskip("compas_dem")

from compas.datastructures import Mesh  # noqa: E402
from compas.geometry import Box  # noqa: E402
from compas_dem.material import Stone  # noqa: E402
from compas_dem.models import BlockModel  # noqa: E402
from compas_dem.problem import Problem  # noqa: E402

WEIGHT = 2400 * GRAVITY  # of a cube of 1 m


def stack(blocks: int = 2) -> BlockModel:
    """Cubes of 1 m, the lowest of which is a support."""
    model = BlockModel.from_boxes([Box(1, 1, 1).translated([0, 0, z]) for z in range(blocks)])
    model.add_support(0)
    stone = Stone(fck=20, density=2400, name="granite")
    model.add_material(stone)
    model.assign_material(stone, elements=list(model.elements()))
    return model


def asked(model: BlockModel, force: float = 0.0, **law: float) -> Problem:
    """The problem of a horizontal force on the top block's centroid."""
    problem = Problem(model)
    problem.set_contact_model("MohrCoulomb", **(law or {"mu": 0.3}))
    if force:
        live = problem.add_boundary_condition("live")
        top = max(block.graphnode for block in model.elements())
        live.add_point_load(top, [force, 0.0, 0.0])
    return problem


def test_five_lines_give_the_forces_under_weight() -> None:
    model = stack()
    problem = asked(model)
    results = multilock_solve(problem, model)
    assert results.resultant_global((0, 1)) == pytest.approx([0, 0, WEIGHT], abs=1e-5 * WEIGHT)
    assert results.metadata["load_factor"] is None
    assert results.model_id == str(model.guid) and results.problem_id == str(problem.guid)
    assert np.array(results.transformation(1).matrix) == pytest.approx(np.eye(4))


def test_loads_as_they_are_and_at_their_limit() -> None:
    model = stack()
    problem = asked(model, 0.2 * WEIGHT)
    results = multilock_solve(problem, model)
    force = results.resultant_global((0, 1))
    assert force == pytest.approx([-0.2 * WEIGHT, 0, WEIGHT], abs=1e-5 * WEIGHT)
    assert results.metadata["load_factor"] == pytest.approx(0.3 / 0.2)  # it slides
    limit = multilock_solve(problem, model, limit=True)
    assert limit.resultant_global((0, 1))[0] == pytest.approx(-0.3 * WEIGHT)
    assert limit.transformation(1).matrix[0][3] > 0.01
    model = stack()
    with pytest.raises(CapacityError, match=r"carries 0\.75 of its loads"):
        multilock_solve(asked(model, 0.4 * WEIGHT), model)


def test_laws_beside_say_what_compas_cannot() -> None:
    model = stack(3)
    problem = asked(model, 0.4 * WEIGHT, mu=0.2)
    rough = {"special": [{"between": ["block-1", "block-2"], "friction": 0.8}]}
    with pytest.raises(CapacityError, match="carries"):
        multilock_solve(problem, model)
    factor = multilock_solve(problem, model, laws=rough).metadata["load_factor"]
    assert factor == pytest.approx(1.0)  # now the lower interface slides: 0.2 * 2 W / 0.4 W


def test_permanent_loads_beside_press_and_crush() -> None:
    """On 1 m2; the strength leaves a strip of (W + 10 kN) / f_c, about whose middle it turns."""
    model = stack()
    laws = {"permanent": [{"surcharge": {"pascals": 10_000}}]}
    heavy = multilock_solve(asked(model, 0.2 * WEIGHT), model, laws=laws)
    factor = 0.3 * (WEIGHT + 10_000) / (0.2 * WEIGHT)
    assert heavy.metadata["load_factor"] == pytest.approx(factor, rel=1e-6)
    weak = {"interfaces": {"friction": 2.0, "compressive_strength": 1e5}} | laws
    found = multilock_solve(asked(model, 0.2 * WEIGHT), model, laws=weak)
    normal = WEIGHT + 10_000
    exact = normal * (1.0 - normal / 1e5) / (0.2 * WEIGHT)
    assert 0.985 <= found.metadata["load_factor"] / exact <= 1.0


def test_contacts_of_the_model_have_forces_at_their_corners() -> None:
    model = stack()
    results = multilock_solve(asked(model, 0.2 * WEIGHT), model)
    show_forces(model, results)
    (contact,) = model.contacts()
    assert len(contact.forces) == len(contact.points) == 4
    assert contact.polygon.area == pytest.approx(1.0)
    assert sum(each["c_np"] for each in contact.forces) == pytest.approx(WEIGHT)
    again = compas.json_loads(compas.json_dumps(model))
    (same,) = again.contacts()
    assert same.forces == contact.forces


@pytest.mark.parametrize(
    ("condition", "parameters", "words"),
    [
        (lambda it: it.add_displacement(1, dx=0.1), {}, "displacements: must not be prescribed"),
        (lambda it: it.add_gravity(1.6), {}, "g: 1.6 is not allowed"),
        (lambda it: it.add_point_load(7, [1.0, 0.0, 0.0]), {}, "block_index: 7 is not allowed"),
        (None, {"limit": True}, "limit: the problem must have loads"),
        (None, {"laws": {"load": {}}}, "laws: 'load' is not allowed"),
        (None, {"laws": {"interface": {}}}, "interface: unknown key; did you mean interfaces"),
    ],
)
def test_what_is_not_understood_is_named(condition: Any, parameters: Any, words: str) -> None:
    model = stack()
    problem = asked(model)
    if condition:
        condition(problem.add_boundary_condition("more"))
    with pytest.raises(ValueError, match=words):
        multilock_solve(problem, model, **parameters)


def test_blocks_without_a_density_are_refused_unless_it_is_given() -> None:
    model = BlockModel.from_boxes([Box(1, 1, 1), Box(1, 1, 1).translated([0, 0, 1])])
    model.add_support(0)
    with pytest.raises(ValueError, match="block 0: its material must have a density"):
        multilock_solve(asked(model), model)
    results = multilock_solve(asked(model), model, density=1000.0)
    assert results.resultant_global((0, 1))[2] == pytest.approx(1000 * GRAVITY)


# --- the same answer as at other doors ------------------------------------------------------------
@pytest.mark.parametrize("name", FILES)
def test_a_model_of_compas_has_the_limit_load_of_every_other_door(name: str) -> None:
    description = FILES[name]
    structure = structure_of(description)
    model, names = BlockModel(), {}
    for piece in structure.assembly.pieces:
        mesh = Mesh.from_vertices_and_faces(piece.vertices, piece.faces)
        node = model.add_block_from_mesh(mesh)
        names[piece.name] = f"block-{node}"
        if piece.fixed:
            model.add_support(node)
        stone = Stone(fck=20, density=piece.density, name=piece.name)
        model.add_material(stone)
        model.assign_material(stone, element=model.graph.node_element(node))
    problem = Problem(model)
    problem.set_contact_model("MohrCoulomb", mu=0.1)  # laws say more
    live = problem.add_boundary_condition("live")
    live.add_global_body_force(*(GRAVITY * part for part in description["load"]["acceleration"]))
    special = [
        {**each, "between": [names[block] for block in each["between"]]}
        for each in description.get("special", [])
    ]
    laws = {"interfaces": description["interfaces"], "special": special}
    found = multilock_solve(problem, model, laws=laws, limit=True).metadata["load_factor"]
    limit = limit_state(*structure)
    assert found * free_weight(structure.assembly) == pytest.approx(limit.load, rel=1e-6)
