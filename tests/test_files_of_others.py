"""Blocks from files as other programs write them."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from command_runner import answers, run
from structures import blocks_from_mesh, dry

from sidmacib.structure.blocks import box, prism
from sidmacib.structure.files.bodies import bodies_in
from sidmacib.structure.files.compas import read_compas
from sidmacib.structure.files.repair import repaired
from sidmacib.structure.files.structure_file import (
    blocks_and_rows,
    structure_of,
)
from sidmacib.structure.interfaces import interfaces
from sidmacib.structure.structure import structure
from sidmacib.structure.warnings import structure_warnings

CASES = Path(__file__).parent / "cases" / "geometry"
CUBE = box("cube", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), 2e3)
GROUND = {"low": [-1, -1, -0.2], "high": [2, 2, 0], "fixed": True}
LINTEL: dict[str, Any] = {
    "ground": {"low": [-1, -1, -0.2], "high": [3, 2, 0], "fixed": True},
    "left": {"low": [0, 0, 0], "high": [0.4, 0.4, 1]},
    "lintel": {"low": [0, 0, 1], "high": [2, 0.4, 1.4]},
}


def limit(*command: str) -> float:
    rows = answers("assembly", *command)
    return float(rows[0]["load_N"])


@pytest.mark.parametrize("name", ["face_centre", "subdivided", "double_faces"])
def test_a_cube_slides_at_friction_times_weight_however_its_faces_are_cut(name: str) -> None:
    (cube,) = blocks_from_mesh(CASES / f"{name}.obj", 2e3).values()
    assert (len(cube.vertices), len(cube.faces)) == (8, 6)
    blocks = {"ground": GROUND, "cube": {"file": f"{name}.obj"}}
    text = {"blocks": blocks, "load": {"acceleration": [1, 0, 0]}}
    (face,) = structure_of(text, CASES).assembly.faces
    assert face.outline.area == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("file", "options", "friction"),
    [
        *((f"{name}.json", "", 0.7) for name in ("cra_plain", "cra_flipped", "cra_unwelded")),
        ("dem_group.json", "", 0.7),
        ("mesh_list.json", "--fixed 0 --friction 0.4", 0.4),
        ("mesh_list.json", "--fixed-below -10mm --friction 0.4", 0.4),
        ("yup.obj", "--up y --fixed gr* --friction 0.4", 0.4),
        ("mm.obj", "--fixed ground --unit mm --friction 0.4", 0.4),
        ("mm.obj", "--fixed-below -10mm --unit mm --friction 0.4", 0.4),
    ],
)
def test_the_load_is_the_same_in_every_format(file: str, options: str, friction: float) -> None:
    found = limit(str(CASES / file), *options.split())
    assert found == pytest.approx(friction * 2e3 * 9.81, rel=1e-3)


def test_blocks_that_would_stand_if_turned_are_told_how() -> None:
    for more in ("--friction", "0.4"), ("--friction", "0.4", "--reserve"):
        found = run("assembly", str(CASES / "yup.obj"), "--fixed", "ground", *more)
        assert found.exit_code == 1
        assert "Note: it stands with up: y (on the command line --up y)" in found.stderr
    given = run("assembly", str(CASES / "yup.obj"), "--fixed", "ground", "--up", "z")
    assert "it stands with" not in given.stderr


def test_a_mesh_is_read_without_a_file_of_other_blocks_beside_it(tmp_path: Path) -> None:
    mesh = tmp_path / "yup.obj"
    mesh.write_text((CASES / "yup.obj").read_text())
    mesh.with_suffix(".yaml").write_text("blocks: {a: {file: yup.obj, fixed: [ground]}}\n")
    found = run("assembly", str(mesh), "--up", "y", "--fixed", "ground", "--friction", "0.4")
    assert found.exit_code == 0
    assert "Note: yup.yaml is not read, as it has blocks itself" in found.stderr
    assert run("build", str(mesh), "-o", str(tmp_path / "out")).exit_code != 0


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("mm.obj --fixed ground", "would be 1732 m across; say unit: mm"),
        (
            "yup.obj --up y",
            "use --fixed NAMES or --fixed-below HEIGHT, or fixed: true in a YAML file",
        ),
        ("cra_plain.json --tolerance 0", "tolerance: '0' is not allowed"),
        ("cra_plain.json --tolerance 1mm", "1mm is a length; it must be a number without a unit"),
        ("cra_plain.json --friction 17deg", "(friction is the tangent of its angle)"),
    ],
)
def test_what_a_file_does_not_say_is_asked_for_and_not_guessed(words: str, line: str) -> None:
    file, *options = words.split()
    ended = run("assembly", str(CASES / file), *options)
    assert ended.exit_code == 2
    assert line in ended.output.splitlines()[-1]


@pytest.mark.parametrize("gap", [0.0005, 0.005, -0.005])
def test_a_lintel_with_a_gap_or_an_overlap_below_it_stands_by_the_tolerance(gap: float) -> None:
    right = {"low": [1.6, 0, 0], "high": [2, 0.4, 1 - gap]}
    text = {"blocks": LINTEL | {"right": right}, "load": {"acceleration": [1, 0, 0]}}
    faces = structure_of(text | {"tolerance": 0.01}).assembly.faces
    assert len(faces) == 4
    if gap < 0.0:
        with pytest.raises(
            ValueError, match=r"overlap by 0\.005 m; to accept this, set tolerance: 0\.004"
        ):
            structure_of(text)
        return
    (note,) = structure_warnings(structure_of(text).assembly)
    assert note.startswith("3 pairs of blocks touch (0.48 m2); faces of 1 more (0.16 m2)")
    assert note.endswith(f"set tolerance: {0.0004 if gap < 0.001 else 0.004}")
    assert structure_warnings(structure_of(text | {"tolerance": 0.01}).assembly, 0.01) == []


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_one_tolerance_takes_all_gaps_of_a_kind_and_none_of_another(sign: float) -> None:
    """Joints of a scan are apart by one to three millimetres, those that are meant by 50."""
    low, blocks = 0.0, [CUBE]
    for number, gap in enumerate((0.001, 0.002, 0.003)):
        low += 1.0 + sign * gap
        blocks.append(box(f"stone{number}", (0.0, 0.0, low), (1.0, 1.0, low + 1.0), 2e3))
    blocks.append(box("beside", (1.05, 0.0, 0.0), (2.05, 1.0, 1.0), 2e3, fixed=True))
    words = "touches no other" if sign > 0.0 else "by 0.003 m, the most of 3 pairs"
    with pytest.raises(ValueError, match=f"{words}.*, set tolerance: 0.002$"):
        interfaces(blocks)
    assert len(interfaces(blocks, 0.002)) == 3


def test_a_proposed_tolerance_is_allowed_and_none_that_reaches_through_a_block() -> None:
    """Where gaps go on to the largest tolerance, half the thinnest block, it is not rounded up."""
    plate = box("plate", (0.0, 0.0, 1.1), (1.0, 1.0, 1.31), 2e3)
    with pytest.raises(
        ValueError, match=r" 0\.1 m away; to accept the gap, set tolerance: 0\.066$"
    ) as refused:
        interfaces([CUBE, plate])
    near = float(str(refused.value).rpartition("tolerance: ")[2].split()[0])
    assert len(interfaces([CUBE, plate], near)) == 1
    with pytest.raises(ValueError, match=r"tolerance: 0\.11 is not allowed; .*thinnest block"):
        structure([CUBE, plate], dry(0.5), near=0.11)


def test_what_shares_most_of_its_volume_does_not_touch_whatever_the_tolerance() -> None:
    """Where blocks are not convex: two angles in nearly one place, as in a file of two variants."""
    outline = [(0, 0, 0), (1, 0, 0), (1, 0, 0.5), (0.5, 0, 0.5), (0.5, 0, 1), (0, 0, 1)]
    one = prism("one", outline, (0, 1, 0), 2e3)
    other = prism("other", [(x + 0.1, y, z) for x, y, z in outline], (0, 1, 0), 2e3)
    for near in (1e-6, 0.1):
        with pytest.raises(ValueError, match=r"^blocks: one and other overlap by 0\.65 m3$"):
            interfaces([one, other], near)


def test_a_cavity_is_told_by_its_place_and_not_by_the_sense_of_its_faces() -> None:
    outer, inner = trimesh.creation.box((2, 2, 2)), trimesh.creation.box((1, 1, 1))
    both = trimesh.util.concatenate([outer, inner])
    faces = [tuple(face) for face in both.faces.tolist()]
    places, (body,) = bodies_in(np.asarray(both.vertices), faces)
    assert repaired("hollow", places, body, 2e3).volume == pytest.approx(7.0)


def test_a_vertex_on_an_edge_divides_it() -> None:
    """As at a T-junction of polysurfaces: the face beside it has one edge for two."""
    middle = (*CUBE.vertices, (0.5, 0.0, 0.0))
    ends = {0, 1}
    low = next(face for face in CUBE.faces if {v for v in face if CUBE.vertices[v][2] == 0} >= ends)
    one, other = next(
        (a, b)
        for a, b in zip(low, (*low[1:], low[0]), strict=True)
        if {CUBE.vertices[a], CUBE.vertices[b]} == {(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)}
    )
    cut = tuple(v for a in low for v in ((a, 8) if a == one else (a,)))
    faces = [cut if face == low else face for face in CUBE.faces]
    assert other in cut
    assert repaired("cube", np.array(middle), faces, 2e3).volume == pytest.approx(1.0)


def test_a_folded_face_is_cut_at_its_fold_whichever_vertex_is_first(tmp_path: Path) -> None:
    """As where two bricks of a dome were joined: a roof of 2 m by 1 m, 0.2 m thick upright."""
    plan = [(0, 0, 0), (1, 0, 0.5), (2, 0, 0), (2, 1, 0), (1, 1, 0.5), (0, 1, 0)]
    places = np.array([*plan, *((x, y, z - 0.2) for x, y, z in plan)], float)
    sides = [(k, (k + 1) % 6, (k + 1) % 6 + 6, k + 6) for k in range(6)]
    for start in range(6):
        top = tuple((start + k) % 6 for k in range(6))
        faces = [top, tuple(6 + k for k in reversed(top)), *sides]
        roof = repaired("roof", places, faces, 2e3)
        assert roof.volume == pytest.approx(0.4)
        lines = [f"v {x} {y} {z}" for x, y, z in places]
        lines += ["f\t" + " ".join(f"{k + 1}//1" for k in face) for face in faces]
        (tmp_path / "roof.obj").write_text("\n".join(lines))
        (found,) = blocks_from_mesh(tmp_path / "roof.obj", 2e3).values()
        assert found.volume == pytest.approx(0.4)


def test_two_blocks_are_cut_alike_where_they_share_a_warped_face() -> None:
    """Each writes it from another vertex."""
    lifted = 0.2 * (CUBE.places[:, :2] == 1.0).all(axis=1)[:, None] * np.array([0.0, 0.0, 1.0])
    below = repaired("below", CUBE.places + CUBE.places[:, 2:] * lifted, CUBE.faces, 2e3)
    from_next = [(*face[1:], face[0]) for face in CUBE.faces]
    above = repaired("above", CUBE.places + np.array([0.0, 0.0, 1.0]) + lifted, from_next, 2e3)
    for start in (CUBE.faces, from_next):
        again = repaired("below", CUBE.places + CUBE.places[:, 2:] * lifted, start, 2e3)
        assert again.volume == below.volume
        assert len(interfaces([again, above])) == 2


def test_an_open_body_is_named_with_the_place_and_a_remedy() -> None:
    with pytest.raises(ValueError, match=r"^cube: .*between \(.*\) and \(.*\) .*close the hole"):
        repaired("cube", CUBE.places, CUBE.faces[1:], 2e3)


def test_a_body_is_flat_by_its_own_size_not_by_that_of_all_in_its_file() -> None:
    small = 0.1 * CUBE.places
    small[6] += (0.0, 0.0, 1e-6)  # rounding, beyond a millionth of this body alone
    both = np.vstack([small, CUBE.places + 10.0])
    assert repaired("stone", both, CUBE.faces, 2e3).volume == pytest.approx(1e-3, rel=1e-5)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("slope", [0.0, 0.5])
def test_only_a_support_may_be_a_flat_face(slope: float, turned: bool, tmp_path: Path) -> None:
    given = json.loads((CASES / "cra_plain.json").read_text())
    node = given["data"]["graph"]["data"]["node"]
    corners = [(-1, -1, 0), (2, -1, 0), (2, 2, 3 * slope), (-1, 2, 3 * slope)]
    top = {str(k): dict(zip("xyz", at, strict=True)) for k, at in enumerate(corners)}
    ends = [0, 3, 2, 1] if turned else [0, 1, 2, 3]
    node["0"]["block"]["data"] |= {"vertex": top, "face": {"0": ends}}
    for vertex in node["1"]["block"]["data"]["vertex"].values():
        vertex["z"] += slope * (vertex["y"] + 1.0)
    path = tmp_path / "flat.json"
    path.write_text(json.dumps(given))
    ground, block = read_compas(path, 2e3)
    (face,) = interfaces([ground, block])
    assert face.outline.area == pytest.approx(math.hypot(1.0, slope))
    with pytest.raises(ValueError, match=r"block-0: its faces must close a volume"):
        read_compas(path, 2e3, fixed=["1"])


def test_lists_of_meshes_may_be_in_lists(tmp_path: Path) -> None:
    meshes = json.loads((CASES / "mesh_list.json").read_text())
    (tmp_path / "lists.json").write_text(json.dumps([[each] for each in meshes]))
    assert len(read_compas(tmp_path / "lists.json", 2e3, fixed=["0"])) == len(meshes)


def test_interfaces_of_a_file_count_where_blocks_have_gaps(tmp_path: Path) -> None:
    given = json.loads((CASES / "cra_plain.json").read_text())
    graph = given["data"]["graph"]["data"]
    for vertex in graph["node"]["1"]["block"]["data"]["vertex"].values():
        vertex["z"] += 0.05
    corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    contact = {"dtype": "compas_assembly.datastructures/Interface", "data": {"points": corners}}
    graph["edge"] = {"0": {"1": {"interfaces": [contact]}}, "1": {}}
    path = tmp_path / "gap.json"
    path.write_text(json.dumps(given))
    assert run("assembly", str(path)).exit_code == 2
    assert limit(str(path), "--from-file") == pytest.approx(0.7 * 2e3 * 9.81, rel=1e-3)
    described = {
        "blocks": {"stone": {"file": path.name, "density": 2e3}},
        "interfaces": {"friction": 0.7, "from_file": True},
        "locks": [{"between": "all", "count": 3, "height": 0.1, "row": [1, 0, 0]}],
    }
    _, rows, _ = blocks_and_rows(described, tmp_path)  # what is built and drawn
    assert len(rows) == 1


def test_solids_are_made_of_a_file_that_is_read_with_the_same_options(tmp_path: Path) -> None:
    """A file in mm: its blocks were 1000 times as large, as the unit was that of the output."""
    mm = str(CASES / "mm.obj")
    for_both = ("--unit", "mm", "--fixed-below", "-10mm")
    found = run("build", mm, *for_both, "-o", str(tmp_path / "made"), "--format", "json")
    assert found.exit_code == 0, found.output
    rows = json.loads(found.stdout)["rows"]
    (ground, stone) = rows
    assert (ground["step"], stone["step"]) == (0, 1)
    assert stone["x_mm"] == pytest.approx(stone["volume_m3"] ** (1 / 3) * 1e3)  # a cube of 1 m
    refused = run("build", "-n", "3", "--unit", "mm", "-o", str(tmp_path / "made"))
    assert refused.exit_code == 2 and "--unit: is for a file of blocks" in refused.output
