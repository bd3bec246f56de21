"""What a structure has in reserve without a load, and the utilisation of its interfaces."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from command_runner import assembly, run
from conftest import ROOT
from structures import CUBE, GROUND, PUSH, dry, example, study

from sidmacib import limit_load, static_peak
from sidmacib.mechanics.assembly import Assembly, FaceMaterial, Vector
from sidmacib.mechanics.loads import Loads
from sidmacib.structure.analysis.forces import InterfaceRow, interface_forces
from sidmacib.structure.analysis.reserve import geometrical_factor, least_push, pushes
from sidmacib.structure.blocks import box, prism
from sidmacib.structure.loads import acceleration, force_at, permanent_only
from sidmacib.structure.structure import structure
from studies.structures.shapes import arch
from workflow.schema import with_changes

MILANKOVITCH = 0.10746  # least thickness over the mean radius of a semicircular arch, 100 voussoirs


@pytest.mark.long
@pytest.mark.parametrize("thickness", [0.115, 0.15, 0.2])
def test_the_factor_of_an_arch_is_its_thickness_over_the_least(thickness: float) -> None:
    """To 0.2 %: what is thinned are the joints, not the blocks and their weights."""
    model = structure(arch(100, thickness), dry(3.0))
    factor = geometrical_factor(model, permanent_only(model))
    assert factor == pytest.approx(thickness / MILANKOVITCH, rel=2e-3)


def test_a_stack_that_leans_has_the_factor_of_its_eccentricity() -> None:
    """A leaning prism, 0.6 m wide: its centroid is 0.2 m off the middle of its base."""
    base = [(0.0, 0.0, 0.0), (0.6, 0.0, 0.0), (0.6, 0.6, 0.0), (0.0, 0.6, 0.0)]
    model = structure([GROUND, prism("leaning", base, (0.4, 0.0, 1.0), 2e3)], dry(0.7))
    assert geometrical_factor(model, permanent_only(model)) == pytest.approx(0.3 / 0.2, rel=1e-4)
    upright = structure([GROUND, box("upright", (0, 0, 0), (1, 1, 1), 2e3)], dry(0.7))
    assert geometrical_factor(upright, permanent_only(upright)) is None  # a point would do


def test_the_least_acceleration_is_found_between_the_directions_that_are_tried() -> None:
    """A triangular prism overturns about its nearest edge, which no direction of 45 degrees has."""
    turn = math.radians(20.0)
    turns = [turn + k * 2 * math.pi / 3 for k in range(3)]
    corners = [(math.cos(each), math.sin(each), 0.0) for each in turns]
    model = structure([GROUND, prism("block", corners, (0.0, 0.0, 4.0), 2e3)], dry(0.7))
    loads = permanent_only(model)
    tried = pushes(model, loads)
    push = least_push(model, loads, tried)
    assert min(each.acceleration for each in tried) > 0.2505
    assert push.acceleration == pytest.approx(0.5 / 2.0, rel=1e-5)
    assert push.tilt == pytest.approx(math.degrees(math.atan(0.25)), rel=1e-5)
    edge = math.degrees(math.atan2(push.direction[1], push.direction[0])) % 120.0
    assert edge == pytest.approx(80.0, abs=0.1)


def test_the_least_acceleration_is_about_an_edge_that_is_not_of_the_weakest_direction() -> None:
    corners = np.array([(-0.478, 0.462), (-0.416, -0.323), (0.502, -0.387), (0.283, 0.171)])
    model = structure(
        [GROUND, prism("block", np.pad(corners, ((0, 0), (0, 1))), (0.0, 0.0, 1.4), 2e3)], dry(1.5)
    )
    loads = permanent_only(model)
    push = least_push(model, loads, pushes(model, loads))
    plan = shapely.Polygon(corners)
    assert push.acceleration == pytest.approx(plan.centroid.distance(plan.exterior) / 0.7, rel=1e-5)


def said(path: Path, given: dict[str, Any], *more: str) -> tuple[int, str, list[dict[str, Any]]]:
    """The exit status, the verdict and the rows of the command."""
    found = assembly(path, given, "--format", "json", *more)
    return found.exit_code, found.stderr.splitlines()[-1], json.loads(found.stdout)["rows"]


@pytest.mark.long
def test_the_command_says_whether_a_structure_stands_and_with_what_reserve(tmp_path: Path) -> None:
    path, law = tmp_path / "stack.yaml", {"friction": 0.7, "compressive_strength": "1MPa"}
    half = {"blocks": {"cube": {"high": [0.5, 1, 1]}}, "interfaces": law}
    given = with_changes(CUBE, half)
    code, verdict, rows = said(path, given)
    assert code == 0
    # Smaller faces are pressed more.
    factor = f"{math.sqrt(1e6 / (2000 * 9.81)):.3g}"
    assert verdict.startswith(f"Yes: it stands, with a geometrical safety factor of {factor}; it ")
    values = {row["reserve"]: row["value"] for row in rows}
    used = 2000 * 9.81 / 1e6
    assert values["factor of compressive strengths"] == pytest.approx(1 / used, rel=1e-3)
    falls = {"pressure": {"side": [-1, 0, 0], "pascals": "20kPa"}}
    fallen = "No: the structure does not stand under its own weight and the other permanent loads"
    assert said(path, {**given, "permanent": [falls]})[:2] == (1, fallen)


@pytest.mark.long
def test_it_is_drawn_under_the_acceleration_that_fells_it_first(tmp_path: Path) -> None:
    path, picture, note = (tmp_path / f"arch.{each}" for each in ("yaml", "svg", "html"))
    written = ("--picture", str(picture), "--note", str(note))
    _, _, rows = said(path, study("arch/arch"), "--reserve", *written)
    limit, static = (row for row in rows if row["reserve"].startswith("least"))
    assert (limit["model"], static["model"]) == ("limit", "static")
    assert 0.9 * limit["value"] < static["value"] <= limit["value"]
    words = " ".join(note.read_text().split())
    assert f"along ({static['reserve'].split('(')[-1].removesuffix(')')}, 0)" in words
    assert "<svg" in picture.read_text()
    falls = study("arch/arch", friction=0.1)
    assert said(path, falls, "--reserve", *written)[0] == 1
    assert "does not stand" in note.read_text()


@pytest.mark.long
def test_a_load_in_the_file_may_be_left_out(tmp_path: Path) -> None:
    code, verdict, rows = said(tmp_path / "stack.yaml", example("trilith"), "--reserve")
    assert code == 0
    assert verdict.startswith("Yes: it stands; it falls at ")
    assert rows[0]["note"] == "for dry interfaces only"
    found = run("assembly", str(tmp_path / "stack.yaml"), "--reserve", "--interfaces")
    assert "--interfaces: needs a load" in found.output
    assert "must be a mapping" in assembly(tmp_path / "list.yaml", [1], "--reserve").output
    cases = str(ROOT / "studies/structures/retaining.yaml")
    found = run("assembly", cases, "--reserve", "--case", "crowd")
    assert "--case: must not be given beside --reserve" in found.output


def test_the_static_model_has_the_last_word(tmp_path: Path) -> None:
    """A beam bonded to a wall, whose bond is too weak for brittle, strong enough for ductile."""
    given = {
        "blocks": {
            "wall": {"low": [-1, 0, -1], "high": [0, 1, 2], "fixed": True},
            "beam": {"low": [0, 0, 0], "high": [1, 1, 1], "density": 2000},
        },
        "interfaces": {"cohesion": "1MPa", "tensile_strength": "50kPa"},
    }
    code, verdict, rows = said(tmp_path / "beam.yaml", given)
    assert code == 1
    assert verdict == "No: the bond of wall-beam fails under its own weight in the static model"
    assert rows[1]["value"] > 1.0


# --- utilisation of interfaces: hinges, sliding and turning faces, bonds -------------------------
def on_ground(sizes: Vector, material: FaceMaterial) -> Assembly:
    return structure([GROUND, box("block", (0.0, 0.0, 0.0), sizes, 2e3)], material)


def at_peak(assembly: Assembly, loads: Loads) -> tuple[InterfaceRow, ...]:
    peak = static_peak(assembly, loads).peak
    return interface_forces(assembly, peak.force, peak.state)


@pytest.mark.parametrize("model", ["static", "limit"])
def test_hinges_of_an_arch_are_used_up(model: str) -> None:
    """The resultant acts at the edge of the four that turn; no other is used as much."""
    assembly = structure(arch(11, 0.2 / 1.5, 1.5), dry(0.7))
    loads = acceleration(assembly, (1.0, 0.0, 0.0))
    if model == "static":
        found = at_peak(assembly, loads)
    else:
        state = limit_load(assembly, loads, friction=True)
        found = interface_forces(assembly, state.force)
    used = sorted((each.utilisation for each in found), reverse=True)
    edges = sorted((each.eccentricity or 0.0 for each in found), reverse=True)
    assert edges[:4] == pytest.approx([1.0] * 4, abs=2e-3)
    assert used[:4] == pytest.approx([1.0] * 4, abs=2e-3)
    assert used[4] < 0.99
    assert sum("hinge" in each.mode for each in found) >= 4
    assert not any("slides" in each.mode for each in found)


@pytest.mark.parametrize(
    ("sizes", "friction", "edge", "slope"),
    [((0.2, 0.3, 0.8), 0.9, 1.0, 0.25), ((0.6, 0.6, 0.2), 0.3, 0.3 * 0.1 / 0.3, 0.3)],
)
def test_a_block_that_overturns_or_slides_uses_its_face_up(
    sizes: Vector, friction: float, edge: float, slope: float
) -> None:
    assembly = on_ground(sizes, dry(friction))
    (face,) = at_peak(assembly, acceleration(assembly, (1.0, 0.0, 0.0)))
    assert face.utilisation == pytest.approx(1.0, abs=1e-3)
    assert face.eccentricity == pytest.approx(edge, abs=1e-3)
    assert face.mode == ("hinge" if edge == 1.0 else "slides")
    assert face.shear_N / face.normal_N == pytest.approx(slope, rel=1e-3)


@pytest.mark.parametrize("share", [0.25, 0.5, 0.9])
@pytest.mark.parametrize("degrees", [0.0, 30.0, 45.0, 90.0])
def test_eccentricity_is_over_the_distance_to_the_edge_there(share: float, degrees: float) -> None:
    """A weightless plate of 0.4 by 0.6 m is pressed at a point on a line from its middle."""
    assembly = on_ground((0.4, 0.6, 0.1), dry(0.5))
    nodes, middle = assembly.nodes, np.array([0.2, 0.3])
    along = np.array([math.cos(math.radians(degrees)), math.sin(math.radians(degrees))])
    edge = min(0.2 / along[0] if along[0] > 1e-9 else 9.0, 0.3 / along[1] if along[1] > 0 else 9.0)
    target = middle + share * edge * along
    flat = nodes.position[:, :2]
    weights = np.linalg.lstsq(np.vstack([np.ones(len(flat)), flat.T]), np.r_[1, target], None)[0]
    force = np.zeros((len(flat), 3))
    force[:, 0] = weights
    (face,) = interface_forces(assembly, force)
    assert face.eccentricity == pytest.approx(share, abs=1e-9)
    assert face.utilisation == pytest.approx(share, abs=1e-9)


def test_a_face_that_turns_about_its_normal_is_used_up_by_torsion() -> None:
    assembly = on_ground((0.4, 0.4, 0.2), dry(0.3))
    loads = force_at(assembly, "block", (0.0, 0.2, 0.1), (0.0, 1.0, 0.0))
    (face,) = at_peak(assembly, loads)
    assert face.utilisation == pytest.approx(1.0, abs=0.1)  # shear and torsion on an ellipse
    assert face.shear_N / (0.3 * face.normal_N) < 0.95  # it does not slide as a whole


def test_opposed_shear_of_nodes_uses_no_friction() -> None:
    """Nodes of a dry face share what it carries in many ways; it is no nearer to sliding."""
    assembly = on_ground((0.4, 0.4, 0.2), dry(0.3))
    force = np.zeros((len(assembly.nodes.area), 3))
    force[:, 0] = assembly.nodes.area / assembly.nodes.area.sum()
    (rest,) = interface_forces(assembly, force)
    inwards = np.array([0.2, 0.2]) - assembly.nodes.position[:, :2]
    face = assembly.faces[0]
    force[:, 1:] = 0.3 * force[:, :1] * inwards / 0.3 @ face.axes[1:, :2].T
    (found,) = interface_forces(assembly, force)
    assert found.utilisation == pytest.approx(rest.utilisation, abs=1e-9)


def test_a_bonded_face_is_used_as_its_most_used_node() -> None:
    glue = FaceMaterial(1e10, 1e10, 0.5, 5e4, 5e4, bond_friction=0.0)
    assembly = on_ground((0.4, 0.4, 0.8), glue)
    path = static_peak(assembly, acceleration(assembly, (1.0, 0.0, 0.0))).path
    first = next(point for point in path if point.state.bonded.all() and point.load > 0.0)
    (face,) = interface_forces(assembly, first.force, first.state)
    tension = -first.force[:, 0] / assembly.nodes.area / 5e4
    shear = np.hypot(first.force[:, 1], first.force[:, 2]) / assembly.nodes.area / 5e4
    assert face.bonded_share == 1.0
    assert face.utilisation == pytest.approx(max(tension.max(), shear.max()), rel=1e-9)


def tower(height: float, **more: Any) -> dict[str, Any]:
    """A tower of 0.4 m on the ground."""
    low, high = [-0.2, -0.2, 0], [0.2, 0.2, height]
    ground = {"low": [-2, -2, -1], "high": [2, 2, 0], "fixed": True}
    law = {"friction": 0.7, **more.pop("interfaces", {})}
    return {"blocks": {"g": ground, "t": {"low": low, "high": high}}, "interfaces": law, **more}


@pytest.mark.parametrize(
    ("strength", "words"),
    [
        (1e6, "Yes: it stands; its first bond fails at "),
        (1e3, "Yes: it stands; it falls at 0.6 g towards ("),
    ],
)
def test_bonds_count_in_the_reserve_where_they_carry_more_than_dry_joints(
    path: Path, strength: float, words: str
) -> None:
    bond = {"friction": 0.6, "cohesion": strength, "tensile_strength": strength}
    code, verdict, rows = said(path, {**CUBE, "interfaces": bond}, "--reserve")
    assert code == 0
    assert verdict.startswith(words)
    assert rows[-1]["note"] == ("the peak" if strength < 1e6 else "first failure of a bond")


@pytest.mark.long
def test_blocks_whose_bonds_fail_under_their_weight_may_stand_with_dry_joints(path: Path) -> None:
    """A stack whose upper block hangs over: the same answer as without bonds."""
    blocks = {
        "ground": {"low": [-1, -1, -0.5], "high": [2, 2, 0], "fixed": True},
        "a": {"low": [0, 0, 0], "high": [0.5, 0.5, 0.8]},
        "b": {"low": [0.22, 0, 0.8], "high": [0.72, 0.5, 1.4]},
    }
    bond = {"friction": 0.6, "cohesion": 3e3, "tensile_strength": 500.0}
    _, of_dry, dry = said(path, {"blocks": blocks, "interfaces": {"friction": 0.6}}, "--reserve")
    code, of_bonds, bonded = said(path, {"blocks": blocks, "interfaces": bond}, "--reserve")
    assert code == 0
    assert of_bonds.endswith("; with bonds, the bond of ground-a fails under its own weight")
    assert of_bonds.replace(" with dry joints", "").startswith(of_dry)
    assert bonded[-1]["value"] == pytest.approx(dry[-1]["value"], rel=1e-3)


SOFT = {"normal_stiffness": 2e7, "shear_stiffness": 2e7}


@pytest.mark.long
def test_a_tower_on_soft_ground_falls_at_what_its_weight_leaves(path: Path) -> None:
    """Of rigid blocks at 0.1 g along a side; where the ground gives way least along a diagonal.

    Both by the ground's springs, integrated over what is pressed as the tower turns; along a side
    see `test_finite_motion`.
    """
    code, verdict, rows = said(path, tower(4.0, interfaces=SOFT), "--reserve")
    assert code == 0
    assert "it falls at 0.0144 g towards" in verdict
    assert rows[-1]["value"] == pytest.approx(180.69 / (2000 * 9.81 * 0.16 * 4.0), rel=3e-3)
    assert abs(rows[-1]["value"] / (203.35 / (2000 * 9.81 * 0.16 * 4.0)) - 1.0) > 0.1


@pytest.mark.long
@pytest.mark.parametrize("bonds", [{}, {"cohesion": 2e4, "tensile_strength": 1e4}])
def test_the_least_acceleration_is_that_of_the_same_load(
    path: Path, bonds: dict[str, float]
) -> None:
    """With bonds one fails under the weight, and dry joints carry 0.227 g, less than the bonded."""
    given = study("arch/arch", **bonds)
    (static,) = (
        row
        for row in said(path, given, "--reserve")[2]
        if row["reserve"].startswith("least") and row["model"] == "static"
    )
    x, y = map(float, static["reserve"].split("(")[-1].removesuffix(")").split(","))
    load = {"acceleration": [x, y, 0.0]}
    rows = {row["model"]: row for row in said(path, {**given, "load": load})[2]}
    assert static["value"] == pytest.approx(rows["static"]["load_over_weight"], rel=1e-6)


@pytest.mark.parametrize("pascals", [1522.5, 1553.9])
def test_permanent_wind_fells_a_tower_whose_foot_gives_way(path: Path, pascals: float) -> None:
    """Of rigid blocks it is 0.97 and 0.99 of the limit; with what gives way it falls at 0.933."""
    wind = {"pressure": {"blocks": "t", "side": [-1, 0, 0], "pascals": pascals}}
    code, verdict, _ = said(path, tower(2.0, permanent=[wind]))
    assert code == 1
    assert verdict.startswith("No: the structure does not stand under its own weight and the other")
    code, verdict, _ = said(path, tower(2.0, permanent=[wind], load={**PUSH, "newtons": 1}))
    assert code == 1 and verdict.startswith("No: the structure does not stand")
