"""Bodies of files: flat grounds, glTF, layers of Rhino, bodies that touch themselves."""

import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh

from sidmacib.structure.blocks import box
from sidmacib.structure.files.block_files import FileSection, surfaces_in
from sidmacib.structure.files.repair import repaired
from sidmacib.structure.interfaces import interfaces
from sidmacib.structure.overlaps import shared_volume

CUBE = box("cube", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), 2e3)


def cube_at(height: float) -> trimesh.Trimesh:
    return trimesh.creation.box(bounds=[(0, 0, height), (1, 1, height + 1)])


@pytest.mark.parametrize("suffix", [".obj", ".stl", ".ply", ".glb"])
def test_the_ground_may_be_one_face_in_every_format(suffix: str, tmp_path: Path) -> None:
    corners = [(-1.0, -1.0, 0.0), (2.0, -1.0, 0.0), (2.0, 2.0, 0.0), (-1.0, 2.0, 0.0)]
    ground = trimesh.Trimesh(corners, [(0, 1, 2), (0, 2, 3)], process=False)
    parts = {"low": cube_at(0), "ground": ground, "high": cube_at(1)}
    path = tmp_path / f"wall{suffix}"
    if suffix in (".stl", ".ply"):
        trimesh.util.concatenate([*parts.values()]).export(path)
        held = "2"
    else:
        scene = trimesh.Scene()
        for name, part in parts.items():
            scene.add_geometry(part, geom_name=name, node_name=name)
        scene.export(path)
        held = "ground"
    up = {} if suffix != ".glb" else {"up": "z"}  # trimesh turns nothing
    given = {"file": path.name, "fixed": [f"wall-{held}"], **up}
    blocks = FileSection.read(given, "blocks", "wall").blocks("wall", tmp_path)
    assert [b.name for b in blocks if b.fixed] == [f"wall-{held}"]
    assert len(blocks) == 3
    assert sum(each.outline.area for each in interfaces(blocks)) == pytest.approx(2.0)
    with pytest.raises(ValueError, match="only a block that cannot move may be flat"):
        FileSection.read({**given, "fixed": False}, "blocks", "wall").blocks("wall", tmp_path)


def test_a_gltf_is_turned_upright_and_its_nodes_are_placed(tmp_path: Path) -> None:
    scene, up = trimesh.Scene(), trimesh.transformations.translation_matrix((0.0, 1.0, 0.0))
    cube = cube_at(0)
    scene.add_geometry(cube, geom_name="brick", node_name="low")
    scene.add_geometry(cube, geom_name="brick", node_name="high", transform=up)
    scene.export(tmp_path / "two.glb")
    high, low = FileSection(file="two.glb").blocks("two", tmp_path)
    assert (high.name, low.name) == ("two-high", "two-low")
    assert high.centre - low.centre == pytest.approx([0.0, 0.0, 1.0])


def test_drafts_on_other_layers_of_rhino_do_not_stop_the_reading(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    class Faces(list[tuple[int, ...]]):
        Count = len(CUBE.faces)

    kinds = {
        name: type(name, (), {}) for name in ("Brep", "Extrusion", "SubD", "InstanceReference")
    }
    corners = [SimpleNamespace(X=x, Y=y, Z=z) for x, y, z in CUBE.vertices]
    mesh = type("Mesh", (), {"Vertices": corners, "Faces": Faces(CUBE.faces)})
    draft = type("Draft", (kinds["Brep"],), {"Faces": []})
    objects = [
        SimpleNamespace(
            Geometry=of(),
            Attributes=SimpleNamespace(Name="", LayerIndex=layer, IsInstanceDefinitionObject=False),
        )
        for of, layer in ((draft, 0), (mesh, 1))
    ]
    model = SimpleNamespace(
        Objects=objects,
        Layers=[SimpleNamespace(FullPath="drafts"), SimpleNamespace(FullPath="stones")],
        Settings=SimpleNamespace(ModelUnitSystem="UnitSystem.Meters"),
    )
    file = SimpleNamespace(Read=lambda path: model)
    stub = SimpleNamespace(File3dm=file, Mesh=mesh, MeshType=SimpleNamespace(Any=0), **kinds)
    monkeypatch.setitem(sys.modules, "rhino3dm", stub)
    with pytest.raises(ValueError, match=r"drafts-1 on layer drafts: has no mesh; .* other layers"):
        surfaces_in(tmp_path / "a.3dm")
    assert len(surfaces_in(tmp_path / "a.3dm", layers=["st*"])) == 1
    with pytest.raises(ValueError, match="on layers stone; it has drafts, stones"):
        surfaces_in(tmp_path / "a.3dm", layers=["stone"])


def test_a_body_may_touch_itself_along_an_edge() -> None:
    voxels = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 0, 1), (1, 1, 1)]  # the last two by an edge
    quads = [CUBE.places[list(face)] + low for low in voxels for face in CUBE.faces]
    middles = [tuple(quad.mean(axis=0)) for quad in quads]
    outer = [quad for quad, at in zip(quads, middles, strict=True) if middles.count(at) == 1]
    faces = np.arange(4 * len(outer)).reshape(-1, 4).tolist()
    found = repaired("voxels", np.concatenate(outer), faces, 2e3)
    assert found.volume == pytest.approx(5.0)
    assert found.centre == pytest.approx(np.mean(voxels, axis=0) + 0.5)
    assert shared_volume(found, CUBE) == pytest.approx(1.0)
