"""Results for COMPAS: forces that balance, a mechanism, and files that its package reads."""

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_runner import run
from test_compas import assembly, model

from sidmacib.mechanics.assembly import GRAVITY
from sidmacib.mechanics.polygons import Polygon
from sidmacib.structure.files.compas import read_compas, read_compas_interfaces
from sidmacib.structure.files.compas_results import at_corners
from sidmacib.structure.files.structure_file import structure_of

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


@pytest.mark.parametrize(
    ("content", "laws", "target", "words"),
    [
        (named, "", "nowhere/results.json", "No such file or directory"),
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


@pytest.mark.parametrize("nodes", ["vertices", "centres", "lobatto"])
def test_forces_at_corners_do_what_those_at_nodes_do(nodes: str) -> None:
    hexagon = [[math.cos(k), math.sin(k), 0.0] for k in np.arange(6) * math.pi / 3]
    l_shape = [[0, 0, 0], [2, 0, 0], [2, 1, 0], [1, 1, 0], [1, 2, 0], [0, 2, 0]]
    for outline in (hexagon, l_shape):
        described = {
            "blocks": {
                "below": {"outline": outline, "along": [0, 0, -1], "fixed": True},
                "above": {"outline": outline, "along": [0, 0, 1]},
            },
            "interfaces": {"cohesion": 1e4, "tensile_strength": 1e4},
            "load": {"acceleration": [1, 0, 0]},
            "nodes": nodes,
            "mesh": 0.5,
        }
        assembly = structure_of(described).assembly
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
