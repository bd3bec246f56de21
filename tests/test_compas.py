"""Assemblies of COMPAS, read without it."""

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_runner import answers
from scipy.spatial.transform import Rotation
from structures import dry, moved, read_structure

from sidmacib.structure.blocks import Block, box
from sidmacib.structure.files.compas import read_compas, read_compas_interfaces
from sidmacib.structure.files.structure_file import structure_of
from sidmacib.structure.interfaces import interfaces
from sidmacib.structure.structure import structure

GROUND = box("block-0", (-2.0, -2.0, -1.0), (2.0, 2.0, 0.0), 2e3, fixed=True)
CUBE = box("block-3", (0.0, 0.0, 0.0), (0.4, 0.6, 1.0), 2e3)
KIND = "compas_cra.datastructures/CRA_Assembly"


def mesh(block: Block) -> dict[str, Any]:
    """As COMPAS writes it: keys of vertices are texts, and need not begin at 0."""
    vertex = {str(7 + k): dict(zip("xyz", v, strict=True)) for k, v in enumerate(block.vertices)}
    face = {str(k): [7 + v for v in outline] for k, outline in enumerate(block.faces)}
    return {
        "dtype": "compas_assembly.datastructures/Block",
        "data": {"vertex": vertex, "face": face},
    }


def assembly() -> dict[str, Any]:
    nodes = {"3": {"block": mesh(CUBE)}, "0": {"block": mesh(GROUND), "is_support": True}}
    graph = {"dtype": "compas.datastructures/Graph", "data": {"node": nodes, "edge": {}}}
    return {"dtype": KIND, "data": {"graph": graph}}


def model() -> dict[str, Any]:
    """The same as compas_dem writes it: elements by an identity, to which nodes refer."""

    def element(block: Block, **more: Any) -> dict[str, Any]:
        geometry = mesh(block) | {"dtype": "compas.datastructures/Mesh"}
        data = {"geometry": geometry, "is_support": block.fixed, "material": None}
        return {"dtype": "compas_dem.elements/Block", "data": data | more}

    shifted = moved(CUBE, Rotation.identity(), (0.0, 0.0, -5.0))
    up = {"matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 5], [0, 0, 0, 1]]}
    up = {"dtype": "compas.geometry/Transformation", "data": up}
    elements = {"g": element(GROUND), "c": element(shifted, transformation=up, material="stone")}
    stone = {"dtype": "compas_dem.material/Stone", "data": {"density": 2600.0}}
    graph = {"node": {"3": {"element": "c"}, "0": {"element": "g"}}, "edge": {}}
    tree = {"root": {"children": [{"element": "g"}, {"element": "c"}]}}
    return {
        "dtype": "compas_dem.models/BlockModel",
        "data": {
            "elements": elements,
            "graph": graph,
            "materials": {"stone": stone},
            "transformation": None,
            "tree": tree,
        },
    }


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "assembly.json"


def read(path: Path, content: Any, **more: Any) -> tuple[Block, ...]:
    """The blocks in a file of this ``content``."""
    path.write_text(json.dumps(content))
    return read_compas(path, 2e3, **more)


def test_blocks_are_in_order_of_nodes_and_supports_those_of_the_file_or_given(path: Path) -> None:
    assert read(path, assembly()) == (GROUND, CUBE)
    assert [block.fixed for block in read(path, assembly(), fixed=[3])] == [False, True]


ANALYSIS = {"dtype": "compas_dem.models/Analysis", "data": {"model": model(), "problems": []}}


@pytest.mark.parametrize("content", [model(), ANALYSIS])
def test_a_model_of_compas_dem_has_moves_and_materials(path: Path, content: dict[str, Any]) -> None:
    ground, cube = read(path, content)
    assert (ground, cube.density) == (GROUND, 2600.0)
    assert np.array(cube.vertices) == pytest.approx(np.array(CUBE.vertices))


def test_blocks_of_a_group_are_where_it_is(path: Path) -> None:
    given = model()
    matrix = [[1, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    along = {"dtype": "compas.geometry/Transformation", "data": {"matrix": matrix}}
    before = read(path, given)[1].centre
    group = {"dtype": "compas_model.elements/Group", "data": {"transformation": along}}
    given["data"]["elements"]["group"] = group
    root = given["data"]["tree"]["root"]
    root["children"] = [{"element": "g"}, {"element": "group", "children": [{"element": "c"}]}]
    assert read(path, given)[1].centre - before == pytest.approx([5.0, 0.0, 0.0])


@pytest.mark.parametrize("content", [assembly, model])
def test_a_model_has_laws_beside_it(path: Path, content: Callable[[], dict[str, Any]]) -> None:
    path.write_text(json.dumps(content()))
    limit = answers("assembly", str(path))[0]
    assert limit["load / weight"] == pytest.approx(0.4)  # it overturns
    laws = "interfaces: {friction: 0.3}\nload: {tilt: {axis: [0, 1, 0]}}"
    path.with_suffix(".yaml").write_text(laws)
    limit = answers("assembly", str(path))[0]
    assert limit["tilt (degrees)"] == pytest.approx(math.degrees(math.atan(0.3)))
    path.with_suffix(".yaml").write_text("blocks: {}")
    with pytest.raises(ValueError, match=r"assembly\.yaml: blocks: must not be there"):
        read_structure(path)


def test_blocks_of_a_structure_come_from_a_model_in_other_units(path: Path) -> None:
    given, content = {"file": path.name, "scale": 0.1, "fixed": [0], "density": 2500}, assembly()
    path.write_text(json.dumps(content))
    described = {"blocks": {"vault": given}, "load": {"acceleration": [1, 0, 0]}}
    ground, cube = structure_of(described, folder=path.parent).assembly.pieces
    assert (ground.name, cube.name, ground.fixed) == ("vault-0", "vault-3", True)
    assert cube.mass == pytest.approx(1e-3 * 2500 * CUBE.volume)
    given["fixed"] = [7]
    with pytest.raises(
        ValueError, match=r"blocks\.vault\.fixed: '7' is not allowed; it must be a node"
    ):
        structure_of(described, folder=path.parent)
    content["data"]["graph"]["data"]["node"]["3"]["block"]["data"]["face"]["0"] = [1, 2, 3]
    path.write_text(json.dumps(content))
    with pytest.raises(ValueError, match=r"blocks\.vault\.vault-3: a vertex or face is not"):
        structure_of(described, folder=path.parent)


@pytest.mark.parametrize("turned", [1, -1])
def test_interfaces_of_the_file_are_those_that_are_found(path: Path, turned: int) -> None:
    corners = [[0.0, 0.0, 0.0], [0.4, 0.0, 0.0], [0.4, 0.6, 0.0], [0.0, 0.6, 0.0]][::turned]
    given = assembly()
    one = {"dtype": "compas_assembly.datastructures/Interface", "data": {"points": corners}}
    given["data"]["graph"]["data"]["edge"] = {"3": {"0": {"interfaces": [one]}}}
    blocks = read(path, given)
    (region,), (found,) = read_compas_interfaces(path, blocks), interfaces(blocks)
    assert (region.below, region.above, region.middle) == (0, 1, pytest.approx(found.middle))
    assert region.axes == pytest.approx(found.axes)
    assert region.outline.equals_exact(found.outline, 1e-9)
    assert structure(blocks, dry(0.7), regions=[region]).faces[0].area == pytest.approx(0.24)


@pytest.mark.parametrize(
    ("content", "keys", "value", "words"),
    [
        (assembly, "dtype", "compas_fea2.model/Model", "assembly.json: .*dtype 'compas_fea2"),
        (assembly, "data graph", 3, "assembly.json: is not understood"),
        (assembly, "data graph data node 3", {}, "assembly.json: lacks the key 'block'"),
        (
            assembly,
            "data graph data node 3 block data face 0",
            [1, 2, 3],
            "block-3: a vertex or face is not understood",
        ),
        (assembly, "data graph data node 0 is_support", False, "calls no node a support"),
        (model, "data graph node 3 element", "x", "assembly.json: lacks the key 'x'"),
        (
            model,
            "data elements c data transformation data matrix",
            np.diag([-1, 1, 1, 1]).tolist(),
            "assembly.json: .*not mirror the blocks",
        ),
        (model, "data materials stone data density", 0, r"block-3, density \(kg/m3\): 0"),
    ],
)
def test_what_is_not_understood_is_named_in_one_line(
    path: Path, content: Callable[[], dict[str, Any]], keys: str, value: Any, words: str
) -> None:
    given = inside = content()
    *outer, last = keys.split()
    for key in outer:
        inside = inside[key]
    inside[last] = value
    with pytest.raises(ValueError, match=words) as caught:
        read(path, given)
    assert "\n" not in str(caught.value)
