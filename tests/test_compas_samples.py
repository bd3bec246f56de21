"""Files of the real packages: every sample of compas_cra is read, as are models of compas_dem."""

import json
from pathlib import Path

import pytest

from sidmacib.structure.files.compas import read_compas, read_compas_interfaces

compas = pytest.importorskip("compas")
compas_cra = pytest.importorskip("compas_cra")
SAMPLES = sorted(Path(compas_cra.__file__).parent.glob("data/samples/*.json"))
SLOW = 100_000  # bytes; longer files have hundreds of curved interfaces, and take seconds


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
    path = next(path for path in SAMPLES if path.stem == "type-a")
    again = tmp_path / "again.json"
    compas.json_dump(compas.json_load(path), again)
    assert read_compas(again, 2400.0, [0]) == read_compas(path, 2400.0, [0])
