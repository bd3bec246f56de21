"""Assemblies of COMPAS, read without it, and results for it."""

import json
import math
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_runner import answers, run
from scipy.spatial.transform import Rotation
from structures import dry, moved, read_structure

from sidmacib.mechanics.assembly import GRAVITY, NodeLayout
from sidmacib.mechanics.polygons import Polygon
from sidmacib.structure.blocks import Block, box, prism
from sidmacib.structure.files.compas import read_compas, read_compas_interfaces
from sidmacib.structure.files.compas_results import at_corners
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
    assert limit["load_over_weight"] == pytest.approx(0.4)  # it overturns
    laws = "interfaces: {friction: 0.3}\nload: {tilt: {axis: [0, 1, 0]}}"
    path.with_suffix(".yaml").write_text(laws)
    limit = answers("assembly", str(path))[0]
    assert limit["tilt_degrees"] == pytest.approx(math.degrees(math.atan(0.3)))
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
    with pytest.raises(ValueError, match=r"blocks\.vault\.fixed: '7' is .* a list of 0, 3"):
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


# --- results: forces that balance, a mechanism, and files that its package reads -----------------
CENTRE = np.array([0.2, 0.3, 0.5])


def written(folder: Path, content: dict[str, Any], laws: str = "") -> dict[str, Any]:
    """The results of the command for a model, and laws beside it."""
    path, results = folder / "model.json", folder / "results.json"
    path.write_text(json.dumps(content))
    path.with_suffix(".yaml").write_text(laws or "interfaces: {friction: 0.7}")
    found = run("assembly", str(path), "--compas", str(results))
    assert found.exit_code == 0, found.output
    return dict(json.loads(results.read_text())["data"])


def named() -> dict[str, Any]:
    return model() | {"guid": "12345678-1234-5678-1234-567812345678"}


def test_forces_balance_weight_and_load_and_the_mechanism_overturns(tmp_path: Path) -> None:
    data = written(tmp_path, named())
    assert data["model_id"] == named()["guid"]
    assert written(tmp_path, named()) == data
    (edge,) = data["edge_data"].values()
    weight, load = 0.24 * 2600 * GRAVITY, data["metadata"]["load_N"]
    assert edge["resultant_global"] == pytest.approx([-load, 0.0, weight], abs=1e-6 * weight)
    places, forces = np.array(edge["contact_points"]), np.array(edge["force_vector"])
    moment = np.cross(places - CENTRE, forces).sum(axis=0)
    assert moment == pytest.approx(np.zeros(3), abs=1e-6 * weight)
    local = [sum(edge[f"force_{k}"]) for k in ("tangent1", "tangent2", "normal")]
    assert edge["resultant_local"] == pytest.approx(local)
    nodes = (data["node_data"][node]["transformation"] for node in "03")
    still, moves = (np.array(each["data"]["matrix"]) for each in nodes)
    assert still == pytest.approx(np.eye(4))
    edge_of_block = np.array([0.4, 0.3, 0.0, 1.0])
    assert moves @ edge_of_block == pytest.approx(edge_of_block, abs=1e-6)  # it turns about it
    shift = (moves @ [*CENTRE, 1.0])[:3] - CENTRE
    assert 0.05 < shift[0] < 0.2


def test_an_assembly_of_compas_cra_has_forces_at_its_interfaces(tmp_path: Path) -> None:
    path, results = tmp_path / "model.json", tmp_path / "results.json"
    given = assembly()
    corners = [[0.0, 0.0, 0.0], [0.4, 0.0, 0.0], [0.4, 0.6, 0.0]]
    one = {"dtype": "compas_assembly.datastructures/Interface", "data": {"points": corners}}
    given["data"]["graph"]["data"]["edge"] = {"3": {"0": {"interfaces": [one], "kept": 7}}}
    path.write_text(json.dumps(given))
    assert run("assembly", str(path), "--compas", str(results)).exit_code == 0
    content = json.loads(results.read_text())
    assert content["dtype"] == given["dtype"]
    graph = content["data"]["graph"]["data"]
    assert graph["node"] == given["data"]["graph"]["data"]["node"]
    assert graph["edge"]["3"] == {}  # forces are those on the second block
    (interface,) = graph["edge"]["0"]["3"]["interfaces"]
    data = interface["data"]
    weight = 0.24 * 2000 * GRAVITY
    assert sum(each["c_np"] for each in data["forces"]) == pytest.approx(weight)
    assert (data["size"], len(data["points"]), len(data["forces"])) == (pytest.approx(0.24), 4, 4)
    # What is written is read as it was found.
    again = [block.name for block in read_compas(results, 2e3)]
    assert again == ["block-0", "block-3"]
    (region,) = read_compas_interfaces(results, read_compas(results, 2e3))
    assert region.middle == pytest.approx((0.2, 0.3, 0.0))
    assert region.outline.area == pytest.approx(0.24)


def in_millimetres(content: dict[str, Any]) -> dict[str, Any]:
    """An object of `named` in mm, with y upwards."""
    if "matrix" in content:
        return {"matrix": [[1, 0, 0, 0], [0, 1, 0, 5e3], [0, 0, 1, 0], [0, 0, 0, 1]]}
    if "z" in content:
        return {"x": 1e3 * content["x"], "y": 1e3 * content["z"], "z": -1e3 * content["y"]}
    return content


def test_results_are_in_the_unit_and_the_axes_of_the_file(tmp_path: Path) -> None:
    path, results = tmp_path / "own.yaml", tmp_path / "results.json"
    model = json.loads(json.dumps(named()), object_hook=in_millimetres)
    (tmp_path / "model.json").write_text(json.dumps(model))
    entry = "{file: model.json, unit: mm, up: y}"
    path.write_text(f"blocks: {{vault: {entry}}}\nload: {{acceleration: [1, 0, 0]}}\n")
    assert run("assembly", str(path), "--compas", str(results)).exit_code == 0
    data = json.loads(results.read_text())["data"]
    (edge,) = data["edge_data"].values()
    points = np.round(edge["contact_polygon"]["data"]["points"], 6).tolist()
    assert sorted(points) == [[x, 0.0, z] for x in (0.0, 400.0) for z in (-600.0, 0.0)]
    weight = 0.24 * 2600 * GRAVITY
    assert edge["resultant_global"][1:] == pytest.approx([weight, 0.0], abs=1e-6 * weight)
    moves = np.array(data["node_data"]["3"]["transformation"]["data"]["matrix"])
    toe = np.array([400.0, 0.0, -300.0, 1.0])
    assert moves @ toe == pytest.approx(toe, abs=1e-3)
    assert 50.0 < (moves @ [200.0, 500.0, -300.0, 1.0])[0] - 200.0 < 200.0


@pytest.mark.parametrize(
    ("content", "laws", "target", "words"),
    [
        (model, "", "results.json", "lacks the key guid"),
        (named, "load: {tilt: {axis: [0, 1, 0]}}", "results.json", "not a tilt"),
    ],
)
def test_results_that_cannot_be_written_are_reported_under_the_table(
    tmp_path: Path, content: Callable[[], dict[str, Any]], laws: str, target: str, words: str
) -> None:
    path = tmp_path / "model.json"
    path.write_text(json.dumps(content()))
    if laws:
        path.with_suffix(".yaml").write_text(laws)
    found = run("assembly", str(path), "--compas", str(tmp_path / target))
    assert found.exit_code == 2
    assert words in found.stderr
    assert "static" in found.stdout


LOCKS = "locks: [{between: all, count: 4, height: 0.1, row: [1, 0, 0]}]"


@pytest.mark.long
def test_locks_that_are_cut_out_count_as_parts_of_their_blocks(tmp_path: Path) -> None:
    data = written(tmp_path, named(), f"interfaces: {{friction: 0.7}}\n{LOCKS}")
    assert set(data["node_data"]) == {"0", "3"}
    (edge,) = data["edge_data"].values()
    # As much lies above the plane as below it, and what the support's locks weigh it holds itself.
    weight, load = 0.24 * 2600 * GRAVITY, data["metadata"]["load_N"]
    resultant = np.array(edge["resultant_global"])
    assert resultant[1:] == pytest.approx([0.0, weight], abs=1e-6 * weight)
    assert -load < resultant[0] < -0.9 * load
    total = np.zeros(3)
    for each in edge["contacts"]:
        frame = each["data"]["frame"]["data"]
        x, y = np.array(frame["xaxis"]), np.array(frame["yaxis"])
        for corner in each["data"]["forces"]:
            pressed = corner["c_np"] - corner["c_nn"]
            total += pressed * np.cross(x, y) + corner["c_u"] * x + corner["c_v"] * y
    assert total == pytest.approx(resultant, abs=1e-9 * weight)


@pytest.mark.parametrize("nodes", NodeLayout)
def test_forces_at_corners_do_what_those_at_nodes_do(nodes: NodeLayout) -> None:
    hexagon = [[math.cos(k), math.sin(k), 0.0] for k in np.arange(6) * math.pi / 3]
    l_shape = [[0, 0, 0], [2, 0, 0], [2, 1, 0], [1, 1, 0], [1, 2, 0], [0, 2, 0]]
    for outline in (hexagon, l_shape):
        below = prism("below", outline, (0.0, 0.0, -1.0), 2e3, fixed=True)
        above = prism("above", outline, (0.0, 0.0, 1.0), 2e3)
        assembly = structure([below, above], dry(0.5), mesh=0.5, nodes=nodes)
        (face,) = assembly.faces
        assert isinstance(face, Polygon)
        places = assembly.nodes.position
        force = np.random.default_rng(1).normal(size=(len(places), 3))
        found = at_corners(face, places, force)
        assert found.sum(axis=0) == pytest.approx(force.sum(axis=0))
        moments = (
            np.cross(each - face.middle, given @ face.axes).sum(axis=0)
            for each, given in ((face.corners, found), (places, force))
        )
        assert next(moments) == pytest.approx(next(moments))
        assert (at_corners(face, places, np.abs(force)) >= 0.0).all()


def test_compas_dem_reads_what_is_written(tmp_path: Path) -> None:
    compas = pytest.importorskip("compas")
    pytest.importorskip("compas_dem")
    data = written(tmp_path, named())
    found = compas.json_load(tmp_path / "results.json")
    ((one, other),) = found.edges()
    assert {one, other} == {0, 3}
    (edge,) = data["edge_data"].values()
    assert found.resultant_global((0, 3)) == edge["resultant_global"]
    points = found.contact_data((0, 3)).forces
    assert sum(each["c_np"] for each in points) == pytest.approx(sum(edge["force_normal"]))


# --- files of the real packages: every sample of compas_cra --------------------------------------
CRA = find_spec("compas_cra")
SAMPLES = sorted(Path(CRA.origin).parent.glob("data/samples/*.json")) if CRA else []
SLOW = 100_000  # bytes; longer files have hundreds of curved interfaces, and take seconds


@pytest.mark.skipif(CRA is None, reason="compas_cra is not installed")
def test_all_samples_are_here() -> None:
    assert len(SAMPLES) == 21


@pytest.mark.parametrize("path", SAMPLES, ids=[path.stem for path in SAMPLES])
def test_a_sample_is_read_and_has_the_blocks_of_its_graph(path: Path) -> None:
    content = json.loads(path.read_text())
    graph = content["data"]["graph"]
    nodes = graph.get("data", graph)["node"]
    held = [int(node) for node in nodes][:1]
    blocks = read_compas(path, 2400.0, held)
    assert {block.name for block in blocks} == {f"block-{node}" for node in nodes}
    assert all(block.volume > 0.0 for block in blocks)
    if path.stat().st_size < SLOW:
        edges = graph.get("data", graph).get("edge", {})
        given = [
            each
            for others in edges.values()
            for edge in others.values()
            for each in edge.get("interfaces") or ()
        ]
        assert len(read_compas_interfaces(path, blocks)) == len(given)


def test_a_sample_is_the_same_after_compas_wrote_it_again(tmp_path: Path) -> None:
    compas = pytest.importorskip("compas")
    path = next(path for path in SAMPLES if path.stem == "type-a")
    again = tmp_path / "again.json"
    compas.json_dump(compas.json_load(path), again)
    assert read_compas(again, 2400.0, [0]) == read_compas(path, 2400.0, [0])
