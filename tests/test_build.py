"""Blocks as solids: closed, of the model's volume, apart by the clearance, and their files."""

import io
import json
import math
import re
import sys
import zipfile
from itertools import combinations
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import trimesh
from command_runner import run
from conftest import ROOT
from scipy.spatial.transform import Rotation
from structures import study

from sidmacib.build import (
    Found,
    Solid,
    blocks_of_file,
    joint_blocks,
    kinds,
    laid,
    letters,
    own_axes,
    solids,
)
from sidmacib.build.clearance import NO_GAPS, Clearance
from sidmacib.build.files import obj_text, step, stl, threemf
from sidmacib.build.placing import order_of
from sidmacib.build.sheet import draw_sheet, spelled
from sidmacib.build.views import cut_place, section, view
from sidmacib.joint import Joint, OwnLock, Side
from sidmacib.joint.pieces import cut_pieces
from sidmacib.structure.blocks import Block, prism
from sidmacib.structure.files.structure_file import assembly_of, blocks_and_rows
from sidmacib.structure.overlaps import common_volume
from sidmacib.structure.structure import owners_of
from sidmacib.yaml_text import read_yaml

ARCH = ROOT / "studies" / "arch" / "arch_with_locks.yaml"
GAPS = Clearance(5e-4, 1e-4)
LARGER_BASE = {
    "blocks": {
        "base": {"low": [-0.1, -0.2, -0.3], "high": [0.5, 0.8, 0], "fixed": True},
        "block": {"low": [0, 0, 0], "high": [0.4, 0.6, 0.3]},
    },
    "locks": [{"between": "all", "count": 3, "height": 0.02, "row": [0, 1, 0], "first": "block"}],
}


def made(found: Found, clearance: Clearance = NO_GAPS) -> tuple[Solid, ...]:
    blocks, rows, near = found
    return solids(blocks, rows, clearance, near)


def arch() -> Found:
    return blocks_of_file(ARCH)


def turned(joint: Joint) -> Found:
    """The blocks of a joint as a structure that is turned in space, described by its corners."""
    blocks, _, _ = joint_blocks(joint)
    turn = Rotation.from_euler("ZX", (0.4, 0.3)).as_matrix()
    described = {
        block.name: {
            "vertices": (block.places @ turn.T + (3.0, -2.0, 1.0)).tolist(),
            "faces": [list(face) for face in block.faces],
            "density": joint.density,
        }
        for block in blocks
    }
    row = (turn @ (0.0, 1.0, 0.0)).tolist()
    locks = {"between": "all", "count": joint.locks, "height": joint.h, "row": row}
    return blocks_and_rows({"blocks": described, "locks": [{**locks, "first": "upper"}]})


def model_volumes(joint: Joint) -> list[float]:
    """Of the pieces of the lower and of the upper block."""
    pieces = {each.name: math.prod(each.size) for each in cut_pieces(joint) if each.name != "plate"}
    lower = pieces["lower"] + sum(pieces[f"lock{lock}"] for lock in joint.lower_locks)
    return [lower, sum(pieces.values()) - lower]


DIFFERENT = Joint(4, different={2: OwnLock(width=0.02)})


@pytest.mark.parametrize(
    "joint", [Joint(1), Joint(2, first=Side.LOWER), Joint(5), Joint(9, a=0.08, h=0.012), DIFFERENT]
)
def test_the_blocks_of_a_joint_have_the_volumes_of_its_pieces(joint: Joint) -> None:
    found = made(joint_blocks(joint))
    assert [each.volume for each in found] == pytest.approx(model_volumes(joint), rel=1e-9)
    assert [each.name for each in found] == ["lower", "upper"]


def test_the_voussoirs_of_an_arch_have_the_volumes_of_its_pieces() -> None:
    blocks, rows, near = arch()
    assembly = assembly_of(read_yaml(ARCH))
    volumes = dict.fromkeys((block.name for block in blocks), 0.0)
    for piece, owner in zip(assembly.pieces, owners_of(assembly), strict=True):
        volumes[assembly.pieces[owner].name] += piece.mass / 2000.0
    for each in solids(blocks, rows, near=near):
        assert each.volume == pytest.approx(volumes[each.name], rel=1e-6)
        assert each.mass == pytest.approx(2000.0 * each.volume)


@pytest.mark.parametrize("clearance", [NO_GAPS, GAPS])
@pytest.mark.parametrize(
    "source",
    [
        lambda: joint_blocks(Joint(5)),
        lambda: turned(Joint(5)),
        arch,
        lambda: blocks_and_rows(LARGER_BASE),
        lambda: blocks_and_rows(read_yaml(ROOT / "studies/designed_vault/designed_stack.yaml")),
    ],
    ids=["joint", "turned", "arch", "larger base", "designed"],
)
def test_solids_are_closed_and_share_nothing_in_every_file(source, clearance) -> None:
    found = made(source(), clearance)
    for each in found:
        mesh = trimesh.Trimesh(each.places, each.triangles, process=False)
        assert mesh.is_volume and mesh.body_count == 1
        read = trimesh.load(io.BytesIO(stl(each, "mm")), file_type="stl")
        assert read.is_volume
        assert read.volume == pytest.approx(1e9 * each.volume, rel=1e-5)  # of 32-bit numbers
    read = trimesh.load_scene(io.BytesIO(obj_text(found, "m").encode()), file_type="obj")
    volume = sum(mesh.volume for mesh in read.geometry.values())  # its reader joins objects
    assert volume == pytest.approx(sum(each.volume for each in found), rel=1e-6)
    for one, other in combinations(found, 2):
        shared = common_volume(one.manifold, other.manifold)
        assert shared <= 1e-9 * min(one.volume, other.volume)


@pytest.mark.parametrize("source", [lambda: joint_blocks(Joint(5)), lambda: turned(Joint(5))])
def test_the_gap_is_the_clearance(source) -> None:
    def gap(clearance: Clearance) -> float:
        one, other = made(source(), clearance)
        return float(one.manifold.min_gap(other.manifold, 1.0))

    assert gap(Clearance(5e-4, 2e-3)) == pytest.approx(5e-4, rel=1e-6)  # at the flanks
    assert gap(Clearance(2e-3, 3e-4)) == pytest.approx(3e-4, rel=1e-6)  # at the heads
    assert gap(Clearance(5e-4)) == pytest.approx(0.0, abs=1e-9)  # heads bear


def test_a_lock_in_a_pocket_of_a_larger_block_has_the_gap_all_around() -> None:
    base, block = made(blocks_and_rows(LARGER_BASE), Clearance(1e-3, 2e-3))
    assert base.manifold.min_gap(block.manifold, 1.0) == pytest.approx(1e-3, rel=1e-6)


@pytest.mark.parametrize(
    ("joint", "clearance", "words"),
    [
        (
            Joint(5),
            Clearance(0.06),
            "lock 2 of lower and upper: a clearance of 0.06 m leaves nothing of it",
        ),
        (Joint(5), Clearance(0.0, 0.01), "leaves nothing of it"),
        (Joint(3, different={2: OwnLock(density=1e3)}), NO_GAPS, "lock 2: density: 1000"),
    ],
)
def test_what_cannot_be_built_is_refused(joint: Joint, clearance: Clearance, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        made(joint_blocks(joint), clearance)


def test_blocks_that_differ_only_in_place_are_one_kind() -> None:
    names = [[each.name for each in kind.solids] for kind in kinds(made(arch()))]
    four = [f"voussoir{number}" for number in (1, 2, 3, 4)]
    assert names == [["left", "right"], four, ["voussoir5"]]


def test_a_turned_block_is_of_the_same_kind_and_a_mirror_image_of_another() -> None:
    corners = [(0, 0, 0), (3, 0, 0), (3, 1, 0), (1, 1, 0), (1, 2, 0), (0, 2, 0)]
    leaning = prism("one", corners, (0.3, 0.1, 0.5), 2000.0)
    turned_by = {"turned": lambda x, y, z: (-y, z, -x), "mirrored": lambda x, y, z: (10 - x, y, z)}
    blocks = [leaning]
    for name, move in turned_by.items():
        faces = [f[::-1] if name == "mirrored" else f for f in leaning.faces]
        places = tuple(move(*place) for place in leaning.vertices)
        blocks.append(Block(name, places, tuple(faces), 2000.0))
    names = [[each.name for each in kind.solids] for kind in kinds(solids(blocks, {}))]
    assert names == [["one", "turned"], ["mirrored"]]


def test_a_package_of_3mf_has_the_unit_the_names_and_the_same_bytes_each_time() -> None:
    found = made(joint_blocks(Joint(5)))
    data = threemf(found, "mm")
    assert data == threemf(found, "mm")
    text = zipfile.ZipFile(io.BytesIO(data)).read("3D/3dmodel.model").decode()
    assert 'unit="millimeter"' in text and 'name="2 upper"' in text
    assert text.count("<triangle ") == sum(len(each.triangles) for each in found)


def drawn_upper(joint: Joint) -> Solid:
    upper = made(joint_blocks(joint))[1]
    return laid(upper, own_axes(upper))


def test_the_section_has_the_area_of_the_profile() -> None:
    joint = Joint(5)
    drawn = drawn_upper(joint)
    cut = section(drawn, cut_place(drawn)).cut
    x, y = cut[0].T
    area = abs(x @ np.roll(y, 1) - y @ np.roll(x, 1)) / 2
    assert area == pytest.approx(joint.total_width * joint.H + 3 * joint.b * joint.h)


def test_edges_behind_a_block_are_hidden() -> None:
    above = view(drawn_upper(Joint(5)), np.eye(3))  # locks are on its lower side
    length = np.linalg.norm(above.visible[:, 1] - above.visible[:, 0], axis=1).sum()
    assert length == pytest.approx(2 * (0.06 + 0.25))
    flanks = [line for line in above.hidden if abs(line[0, 1] - line[1, 1]) < 1e-9]
    assert {round(float(line[0, 1]), 6) for line in flanks} >= {0.05, 0.1, 0.15, 0.2}


def test_a_sheet_has_every_size_of_the_joint() -> None:
    blocks, rows, near = joint_blocks(Joint(5))
    lower, _ = kinds(solids(blocks, rows, GAPS, near))
    (axes, *_) = draw_sheet(lower, rows, 2, "mm", "clearance").axes
    words = {text.get_text() for text in axes.texts}
    assert {"60", "250", "49.5", "50.5"} <= words
    assert {"Kind A", "clearance", "joint to upper: 5 locks"} <= words


def test_kinds_have_letters_and_dimensions_short_numbers() -> None:
    assert [letters(number) for number in (0, 25, 26, 701, 702)] == ["A", "Z", "AA", "ZZ", "AAA"]
    found = [spelled(x) for x in (250.0, 49.75, 7.9, 1.23456, 60.000001)]
    assert found == ["250", "49.75", "7.9", "1.235", "60"]


def test_a_sheet_tells_the_taper_of_a_voussoir_by_its_chords_and_its_inclination() -> None:
    (kind,) = kinds(made(blocks_and_rows(study("arch/arch")))[2:3])
    (axes, *_) = draw_sheet(kind, {}, 1, "mm", "").axes
    words = {text.get_text() for text in axes.texts}
    inner, outer = (spelled(2e3 * radius * math.sin(math.pi / 10)) for radius in (0.875, 1.125))
    assert {inner, outer} <= words
    assert any(text.endswith("18\N{DEGREE SIGN}") for text in words)


def test_the_command_writes_files_table_and_drawings(tmp_path: Path) -> None:
    refused = run("build", "--clearance", "5kN", "-o", str(tmp_path / "none"))
    assert refused.exit_code == 2 and not (tmp_path / "none").exists()
    found = run("build", "-n", "3", "-a", "80mm", "--clearance", "0.5mm", "-o", str(tmp_path))
    assert found.exit_code == 0, found.output
    assert "Note: the clearance takes 1 % of the width of the narrowest lock" in found.stderr
    files = {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*.*")}
    assert files == {
        *("blocks.3mf", "blocks.obj", "blocks.csv", "stl/1-lower.stl", "stl/2-upper.stl"),
        *("drawings/A.svg", "drawings/B.svg"),
    }
    rows = pd.read_csv(tmp_path / "blocks.csv")
    assert rows["block"].tolist() == ["lower", "upper"]
    assert 150.0 in rows.loc[0, ["x_mm", "y_mm"]].tolist()
    joint = Joint(3, a=0.08)
    lost = 2 * joint.a * joint.h * 5e-4 / 2
    assert rows.loc[0, "volume_m3"] == pytest.approx(model_volumes(joint)[0] - lost)


def test_a_file_of_a_joint_is_taken_as_its_flags_are(tmp_path: Path) -> None:
    file = tmp_path / "joint.yaml"
    file.write_text("locks: 3\na: 80mm\n")
    printed = [
        run("build", *words, "--format", "csv", "-o", str(tmp_path / "out"))
        for words in ([str(file)], ["-n", "3", "-a", "0.08"], ["--file", str(file)])
    ]
    assert {found.exit_code for found in printed} == {0}
    assert len({found.output for found in printed}) == 1


def test_step_has_the_volume_and_the_names_of_the_solids(tmp_path: Path) -> None:
    of_shapes, of_volumes, files = (
        pytest.importorskip(f"OCP.{name}") for name in ("BRepGProp", "GProp", "STEPControl")
    )
    found = made(joint_blocks(Joint(5)), GAPS)
    for unit in ("mm", "m"):
        path = tmp_path / f"{unit}.step"
        path.write_bytes(step(found, unit))
        assert re.findall(r"= PRODUCT\('([^']+)'", path.read_text()) == ["1 lower", "2 upper"]
        reader, volume = files.STEPControl_Reader(), of_volumes.GProp_GProps()
        reader.ReadFile(str(path))
        reader.TransferRoots()
        of_shapes.BRepGProp.VolumeProperties_s(reader.OneShape(), volume)  # in mm3
        assert volume.Mass() == pytest.approx(1e9 * sum(each.volume for each in found), rel=1e-9)


def test_step_says_which_package_it_needs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "OCP.Message", None)
    done = run("build", "-n", "3", "-o", str(tmp_path), "--step")
    assert done.exit_code == 2
    assert (
        "--step: needs the package cadquery-ocp-novtk: pip install '.[step]' in the clone"
        in done.output
    )


def test_voussoirs_of_rounded_corners_are_of_one_kind_if_asked() -> None:
    blocks = []
    for k in range(9):
        around = [(1.0, k), (1.2, k), (1.2, k + 1), (1.0, k + 1)]
        turns = [(r * np.cos(np.pi * j / 9), r * np.sin(np.pi * j / 9)) for r, j in around]
        outline = [(round(x, 3), 0.0, round(z, 3)) for x, z in turns]
        blocks.append(prism(f"b{k}", outline, (0.0, 0.5, 0.0), 2e3))
    plain = solids([*blocks, prism("cut", [(3, 0, 0), (4, 0, 0), (3, 0, 1)], (0, 1, 0), 2e3)], {})
    assert len(kinds(plain)) > 2
    assert len(kinds(plain, 2e-3)) == 2


def held(**more: object) -> dict[str, object]:
    """A block between two fixed ones; ``more``: as of the file."""
    blocks = {
        "base": {"low": [0, 0, -0.3], "high": [3, 0.5, 0], "fixed": True},
        "left": {"low": [0, 0, 0], "high": [1, 0.5, 0.5], "fixed": True},
        "mid": {"low": [1, 0, 0], "high": [2, 0.5, 0.5]},
        "right": {"low": [2, 0, 0], "high": [3, 0.5, 0.5], "fixed": True},
    }
    return {"blocks": blocks, **more}


def locks(*pair: str, row: list[int]) -> dict[str, object]:
    return {"between": list(pair), "count": 3, "height": 0.03, "row": row}


ALONG_Y = [locks("left", "mid", row=[0, 0, 1]), locks("mid", "right", row=[0, 0, 1])]


@pytest.mark.parametrize("condensed", [False, True])
def test_a_block_goes_in_where_its_locks_run(condensed: bool) -> None:
    rows = [{**each, **({"condensed": {"working": 2}} if condensed else {})} for each in ALONG_Y]
    order = order_of(*blocks_and_rows(held()))
    assert order.steps == {2: (0.0, 0.0, -1.0)}
    order = order_of(*blocks_and_rows(held(locks=rows)))
    assert np.abs(order.steps[2]) == pytest.approx([0.0, 1.0, 0.0])


def test_blocks_are_written_that_cannot_be_put_in_but_with_a_word(tmp_path: Path) -> None:
    text = held(locks=[*ALONG_Y, locks("base", "mid", row=[0, 1, 0])])
    (tmp_path / "a.yaml").write_text(json.dumps(text))
    found = run("build", str(tmp_path / "a.yaml"), "-o", str(tmp_path / "out"))
    assert found.exit_code == 1
    assert "mid cannot be put in" in found.stderr
    rows = pd.read_csv(tmp_path / "out" / "blocks.csv")
    assert rows["step"].fillna(-1).tolist() == [0, 0, -1, 0]


def test_blocks_move_into_place_in_order_through_nothing_that_is_there() -> None:
    blocks, rows, near = arch()
    found = solids(blocks, rows, near=near)
    order = order_of(blocks, rows, near)
    there = [each for each, block in zip(found, blocks, strict=True) if block.fixed]
    assert sorted([*order.steps, *(each.number - 1 for each in there)]) == [*range(len(found))]
    by = 0.01
    for number, way in order.steps.items():
        before = found[number].manifold.translate(tuple(-by * x for x in way))
        for other in there:
            area = min(found[number].manifold.surface_area(), other.manifold.surface_area())
            assert common_volume(before, other.manifold) <= 1e-3 * by * area
        there.append(found[number])


@pytest.mark.long
def test_a_pose_takes_the_stl_file_to_its_place_and_the_centre_is_that_of_mass(
    tmp_path: Path,
) -> None:
    assert run("build", str(ARCH), "-o", str(tmp_path)).exit_code == 0
    blocks, rows, near = arch()
    found = solids(blocks, rows, near=near)
    table = pd.read_csv(tmp_path / "blocks.csv")
    for solid, row in zip(found, table.to_dict("records"), strict=True):
        (path,) = (tmp_path / "stl").glob(f"{solid.number}-*")
        mesh = trimesh.load(path)
        mesh.apply_transform(np.reshape(row["pose"].split(), (4, 4)).astype(float))
        assert mesh.bounds == pytest.approx(
            1e3 * np.array([solid.places.min(axis=0), solid.places.max(axis=0)]), abs=1e-3
        )
        centre = [row[f"centre_{axis}_mm"] for axis in "xyz"]
        assert centre == pytest.approx(mesh.center_mass, abs=1e-3)


@pytest.mark.parametrize(("off", "told"), [(3e-7, False), (9e-5, True)])
def test_what_the_tolerance_takes_as_touching_is_built(
    off: float, told: bool, tmp_path: Path
) -> None:
    text = held(tolerance=1e-4)
    text["blocks"]["mid"]["high"][0] += off  # type: ignore[index]
    (tmp_path / "a.yaml").write_text(json.dumps(text))
    found = run("build", str(tmp_path / "a.yaml"), "-o", str(tmp_path / "out"))
    assert found.exit_code == 0
    assert ("overlap by" in found.stderr) == told
