"""What a structure has in reserve without a load: its geometry, an acceleration, a tilt."""

import json
import math
from pathlib import Path
from typing import Any

import pytest
from command_runner import assembly, run
from conftest import ROOT
from structures import CUBE, GROUND, dry, example, study

from sidmacib.structure.analysis.reserve import geometrical_factor, least_push, pushes
from sidmacib.structure.blocks import box, prism
from sidmacib.structure.loads import permanent_only
from sidmacib.structure.structure import structure
from studies.structures.shapes import arch
from workflow.schema import with_changes

MILANKOVITCH = 0.10746  # least thickness over the mean radius of a semicircular arch, 100 voussoirs


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


def said(path: Path, given: dict[str, Any], *more: str) -> tuple[int, str, list[dict[str, Any]]]:
    """The exit status, the verdict and the rows of the command."""
    found = assembly(path, given, "--format", "json", *more)
    return found.exit_code, found.stderr.splitlines()[-1], json.loads(found.stdout)


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


def test_it_is_drawn_under_the_acceleration_that_fells_it_first(tmp_path: Path) -> None:
    path, picture, note = (tmp_path / f"arch.{each}" for each in ("yaml", "svg", "html"))
    written = ("--picture", str(picture), "--note", str(note))
    _, _, rows = said(path, study("arch/arch"), "--reserve", *written)
    least = next(row for row in rows if row["reserve"].startswith("least"))
    assert least["reserve"].endswith("towards (0, 1)")
    words = " ".join(note.read_text().split())
    assert "along (0, 1, 0)" in words
    assert f"{least['value']:.3g} of the weight" in words
    assert "<svg" in picture.read_text()
    falls = study("arch/arch", friction=0.1)
    assert said(path, falls, "--reserve", *written)[0] == 1
    assert "does not stand" in note.read_text()


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
