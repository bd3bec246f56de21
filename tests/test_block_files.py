"""Blocks from OBJ, PLY and STL files, against the same blocks by their corners."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
import trimesh
from command_runner import answers, run
from scipy.spatial.transform import Rotation
from structures import blocks_from_mesh, dry, moved, read_structure

from sidmacib.mechanics.limit import limit_load
from sidmacib.structure.blocks import Block, box
from sidmacib.structure.files.block_files import FileSection
from sidmacib.structure.files.structure_file import (
    assembly_of,
    notes_on,
    structure_of,
    with_bodies,
)
from sidmacib.structure.loads import acceleration
from sidmacib.structure.structure import structure
from studies.structures.shapes import arch

LOW = box("low", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), 2e3)
HIGH = box("high", (0.0, 0.0, 1.0), (1.0, 1.0, 2.0), 2e3)


def mesh_of(block: Block) -> trimesh.Trimesh:
    """A convex block's faces, cut into triangles."""
    fans = [(f[0], f[k], f[k + 1]) for f in block.faces for k in range(1, len(f) - 1)]
    return trimesh.Trimesh(block.places, fans, process=False)


def write(path: Path, blocks: list[Block]) -> Path:
    if path.suffix == ".obj":
        scene = trimesh.Scene()
        for block in blocks:
            scene.add_geometry(mesh_of(block), geom_name=block.name)
        scene.export(path)
    else:
        trimesh.util.concatenate([mesh_of(block) for block in blocks]).export(path)
    return path


@pytest.mark.parametrize("suffix", [".obj", ".ply", ".stl"])
def test_turned_blocks_that_touch_stay_apart_with_their_faces(suffix: str, tmp_path: Path) -> None:
    turn = Rotation.from_euler("xyz", (20, 30, 40), degrees=True)
    pair = {each.name: moved(each, turn, (1.0, 2.0, 3.0)) for each in (LOW, HIGH)}
    found = blocks_from_mesh(write(tmp_path / f"b{suffix}", [*pair.values()]), 2e3)
    names = {"high": "high", "low": "low"} if suffix == ".obj" else {"1": "low", "2": "high"}
    assert [*found] == [*names]
    for name, block in found.items():
        assert len(block.faces) == 6
        assert block.volume == pytest.approx(1.0, rel=1e-6)
        assert block.centre == pytest.approx(pair[names[name]].centre, rel=1e-6)


@pytest.mark.parametrize("vertex", [8, 57, -1])
def test_a_face_whose_vertex_is_missing_is_refused(vertex: int, tmp_path: Path) -> None:
    path = tmp_path / "b.ply"
    mesh_of(LOW).export(path, encoding="ascii")
    assert blocks_from_mesh(path, 2e3)
    path.write_text(f"{path.read_text().rpartition(' ')[0]} {vertex}\n")
    with pytest.raises(ValueError, match=r"^file: b.ply: ") as error:
        blocks_from_mesh(path, 2e3)
    assert "\n" not in str(error.value)
    if vertex > 0:
        words = f"has a face with vertex {vertex}; it has 0 to 7; export the mesh again"
        assert str(error.value).endswith(words)


@pytest.mark.long
def test_a_block_of_too_many_faces_is_refused_before_they_are_checked(tmp_path: Path) -> None:
    path = tmp_path / "ball.ply"
    trimesh.creation.icosphere(subdivisions=5).export(path)
    with pytest.raises(ValueError, match=r"has 20480 plane faces; at most 5000 are allowed"):
        blocks_from_mesh(path, 2e3)


def test_a_body_with_a_groove_keeps_its_faces_one_with_a_hole_its_volume(tmp_path: Path) -> None:
    corners = np.array([(0, 0), (3, 0), (3, 1), (2, 1), (2, 0.5), (1, 0.5), (1, 1), (0, 1)])
    triangles = [(0, 1, 4), (0, 4, 5), (0, 5, 7), (5, 6, 7), (1, 2, 4), (2, 3, 4)]
    groove = trimesh.creation.extrude_triangulation(corners, np.array(triangles), height=1.0)
    groove.export(tmp_path / "groove.ply")
    (block,) = blocks_from_mesh(tmp_path / "groove.ply", 2e3).values()
    assert len(block.faces) == 10
    assert block.volume == pytest.approx(2.5)
    ring = trimesh.creation.annulus(0.5, 1.0, 1.0, sections=8)
    ring.export(tmp_path / "ring.stl")
    (block,) = blocks_from_mesh(tmp_path / "ring.stl", 2e3).values()
    assert block.volume == pytest.approx(ring.volume, rel=1e-6)


def test_all_files_that_fit_a_pattern_are_blocks(tmp_path: Path) -> None:
    write(tmp_path / "low.obj", [LOW])
    for file in ("low.obj", "*.obj"):
        (block,) = FileSection(file=file, fixed=True).blocks("b", tmp_path)
        assert (block.name, block.fixed) == ("b", True)
    write(tmp_path / "high.obj", [HIGH])
    blocks = FileSection(file="*.obj", fixed=["low"]).blocks("b", tmp_path)
    assert [(block.name, block.fixed) for block in blocks] == [("b-high", False), ("b-low", True)]
    assert len(FileSection(file=f"{tmp_path}/*.obj").blocks("b", Path("elsewhere"))) == 2


def test_an_arch_from_a_file_has_the_load_of_the_arch_from_corners(tmp_path: Path) -> None:
    blocks = arch(7, 0.3)
    write(tmp_path / "arch.obj", blocks)
    text = {
        "blocks": {"arch": {"file": "arch.obj", "density": 2000, "fixed": ["left", "right"]}},
        "interfaces": {"friction": 0.7},
        "load": {"acceleration": [1, 0, 0]},
    }
    (tmp_path / "arch.yaml").write_text(json.dumps(text))
    model = structure(blocks, dry(0.7))
    expected = limit_load(model, acceleration(model, (1.0, 0.0, 0.0)), friction=True).load
    found = limit_load(*read_structure(tmp_path / "arch.yaml"), friction=True).load
    assert found == pytest.approx(expected, rel=1e-6)
    rows = answers("assembly", str(tmp_path / "arch.yaml"))
    assert rows[0]["load_N"] == pytest.approx(expected, rel=1e-3)
    whole = with_bodies(text, tmp_path)  # as in a study, whose cases are whole
    embedded = structure_of(whole)
    assert "assumed: unit m" in notes_on(whole, embedded.assembly)
    assert limit_load(*embedded, friction=True).load == pytest.approx(expected, rel=1e-6)


def test_a_mesh_with_a_unit_may_be_large_in_a_study_too(tmp_path: Path) -> None:
    write(tmp_path / "dam.obj", [box("dam", (0.1, 0, 0), (80.3, 10, 60), 2e3)])
    rock = {"low": [-10, -10, -10], "high": [90, 20, 0], "fixed": True}
    text = {"blocks": {"dam": {"file": "dam.obj", "unit": "m"}, "rock": rock}}
    of_study = assembly_of(with_bodies(text, tmp_path))
    assert of_study.pieces == assembly_of(text, tmp_path).pieces
    with pytest.raises(ValueError, match=r"would be .* say unit"):
        with_bodies({"blocks": {"dam": {"file": "dam.obj"}}}, tmp_path)


@pytest.mark.parametrize(
    ("block", "line"),
    [
        ({"file": "none.obj"}, "blocks.b.file: .*none.obj' is not allowed; it must be a file that"),
        ({"file": "b.txt"}, "blocks.b.file: 'b.txt' is not allowed; .* ends in .obj, .ply, .stl"),
        ({"file": "empty.obj"}, "blocks.b.file: empty.obj: has no triangles"),
        ({"file": "point.obj"}, "its faces must close a volume; the edge .* is of one face"),
        ({"file": "misspelt.ply"}, "blocks.b.file: misspelt.ply: is no mesh that can be read"),
        ({"file": "b.obj", "fixed": ["x"]}, "blocks.b.fixed: .* a list of high, low"),
        ({"file": "b.obj", "scale": 0}, "blocks.b.scale: 0 is not allowed"),
    ],
)
def test_a_fault_names_its_key(block: dict[str, object], line: str, tmp_path: Path) -> None:
    write(tmp_path / "b.obj", [LOW, HIGH])
    (tmp_path / "b.txt").write_text("")
    (tmp_path / "empty.obj").write_text("# nothing\n")
    (tmp_path / "point.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1\n")
    text = mesh_of(LOW).export(file_type="ply", encoding="ascii").decode()
    (tmp_path / "misspelt.ply").write_text(text.replace("property list", "propert0 list"))
    path = tmp_path / "structure.yaml"
    path.write_text(json.dumps({"blocks": {"b": block}, "load": {"acceleration": [1, 0, 0]}}))
    ended = run("assembly", str(path))
    assert ended.exit_code == 2
    assert re.search(line, ended.output.splitlines()[-1])
