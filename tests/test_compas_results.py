"""Results for COMPAS: forces that balance, a mechanism, and files that its package reads."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_runner import run
from test_compas import assembly, model

from sidmacib.mechanics.assembly import GRAVITY

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
    (edge,) = data["edge_data"].values()
    weight, load = 0.24 * 2600 * GRAVITY, data["metadata"]["load_N"]
    assert edge["resultant_global"] == pytest.approx([-load, 0.0, weight], abs=1e-6 * weight)
    places, forces = np.array(edge["contact_points"]), np.array(edge["force_vector"])
    moment = np.cross(places - CENTRE, forces).sum(axis=0)
    assert moment == pytest.approx(np.zeros(3), abs=1e-6 * weight)
    local = [sum(edge[f"force_{k}"]) for k in ("tangent1", "tangent2", "normal")]
    assert edge["resultant_local"] == pytest.approx(local)
    still, moves = (
        np.array(data["node_data"][n]["transformation"]["data"]["matrix"]) for n in "03"
    )
    assert still == pytest.approx(np.eye(4))
    edge_of_block = np.array([0.4, 0.3, 0.0, 1.0])
    assert moves @ edge_of_block == pytest.approx(edge_of_block, abs=1e-6)  # it turns about it
    shift = (moves @ [*CENTRE, 1.0])[:3] - CENTRE
    assert 0.05 < shift[0] < 0.2


def test_results_name_the_model_and_are_the_same_bytes_again(tmp_path: Path) -> None:
    once = written(tmp_path, named())
    assert once["model_id"] == named()["guid"]
    assert written(tmp_path, named()) == once


def test_an_assembly_of_another_package_has_no_such_results(tmp_path: Path) -> None:
    path = tmp_path / "model.json"
    path.write_text(json.dumps(assembly()))
    found = run("assembly", str(path), "--compas", str(tmp_path / "results.json"))
    assert found.exit_code == 1
    assert "for a compas_dem.models/BlockModel" in found.output


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
    assert found.exit_code == 1
    assert words in found.stderr
    assert "static" in found.stdout


def test_locks_that_are_cut_out_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "model.json"
    path.write_text(json.dumps(named()))
    locks = "{between: all, count: 2, height: 0.1, row: [1, 0, 0]}"
    path.with_suffix(".yaml").write_text(f"locks: [{locks}]")
    found = run("assembly", str(path), "--compas", str(tmp_path / "results.json"))
    assert "must be a block of the model" in found.output


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
