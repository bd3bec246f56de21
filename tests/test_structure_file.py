"""Structures from a file, and the command that analyses them."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_runner import answers, assembly, by_model
from conftest import ROOT
from structures import PUSH, read_structure

from sidmacib import limit_load, static_peak
from sidmacib.mechanics.assembly import GRAVITY
from sidmacib.structure.files.sections import ShapeSection
from sidmacib.structure.files.structure_file import structure_of
from sidmacib.yaml_text import read_yaml
from workflow.schema import with_changes

GROUND = {"low": [-2, -2, -1], "high": [2, 2, 0], "fixed": True}
BLOCK = {"low": [0, 0, 0], "high": [0.4, 0.6, 1.0], "density": 2000}
ON_GROUND: dict[str, Any] = {
    "blocks": {"ground": GROUND, "block": BLOCK},
    "interfaces": {"friction": 0.2},
    "load": {"acceleration": [1, 0, 0]},
}


def locked(**more: Any) -> dict[str, Any]:
    """The structure with three locks below its block, with ``more`` of their keys."""
    locks = {"between": "all", "count": 3, "height": 0.02, "row": [0, 1, 0], **more}
    return {**ON_GROUND, "locks": [locks]}


def test_the_command_prints_the_capacity_of_a_structure(path: Path) -> None:
    rows = by_model(path, ON_GROUND)
    assert rows["limit"]["load_over_weight"] == pytest.approx(0.2, rel=1e-6)
    assert rows["static"]["load_over_weight"] == pytest.approx(0.2, rel=1e-3)
    assert rows["static"]["peak_N"] == rows["static"]["load_N"]
    note = "the peak counts: no bond fails before the peak; failure mode: mechanism"
    assert rows["static"]["note"] == note


@pytest.mark.long
@pytest.mark.parametrize("friction", [0.0, 0.6])
def test_mesh_errors_of_twisted_bonds_cover_a_finer_mesh(path: Path, friction: float) -> None:
    bonded = {"cohesion": 2e4, "tensile_strength": 1e4, "friction": friction, "bond_friction": 0}
    twist = {"force": {"block": "block", "at": [0.4, 0.0, 0.0], "direction": [0, 1, 0]}}
    found = {}
    for mesh in (0.2, 0.05):
        given = ON_GROUND | {"interfaces": bonded, "load": twist, "mesh": mesh}
        found[mesh] = by_model(path, given)["limit"]
    change = abs(found[0.2]["load_N"] / found[0.05]["load_N"] - 1.0)
    assert 1e-5 < change <= found[0.2]["mesh_error_over_load"] < 0.05


def test_the_command_prints_the_angle_at_which_a_structure_slides(path: Path) -> None:
    rows = by_model(path, {**ON_GROUND, "load": {"tilt": {"axis": [0, 1, 0]}}})
    slides = math.degrees(math.atan(0.2))
    assert rows["limit"]["tilt_degrees"] == pytest.approx(slides, rel=1e-6)
    assert rows["static"]["tilt_degrees"] == pytest.approx(slides, rel=2e-4)
    assert str(rows["static"]["note"]).endswith(
        "failure mode: sliding; largest displacement: block"
    )
    (row,) = answers("assembly", str(path), "--interfaces")
    assert row["compression_N"] == pytest.approx(
        480.0 * GRAVITY * math.cos(math.radians(slides)), rel=1e-4
    )


def test_models_of_loads_in_proportion_refuse_gravity_that_turns() -> None:
    for model in (static_peak, limit_load):
        with pytest.raises(ValueError, match="gravity turns; use static_tilt or limit_tilt"):
            model(*structure_of({**ON_GROUND, "load": {"tilt": {"axis": [0, 1, 0]}}}))


def test_what_stands_only_under_its_load_has_no_limit(path: Path) -> None:
    slope = [[0, 0, 0], [1, 0, 0], [1, 0, 1]]  # of 45 degrees, up along x
    block = [[0.5, 0.2, 0.5], [1, 0.2, 1], [0.75, 0.2, 1.25], [0.25, 0.2, 0.75]]
    held_up = {
        "blocks": {
            "slope": {"outline": slope, "along": [0, 1, 0], "fixed": True},
            "block": {"outline": block, "along": [0, 0.4, 0]},
        },
        "interfaces": {"friction": 0.3},
        "load": {"acceleration": [1, 0, 0]},
    }
    assert limit_load(*structure_of(held_up), friction=True).load > 0.0
    found = assembly(path, held_up, "--format", "json")
    assert found.exit_code == 1  # for scripts
    rows = json.loads(found.stdout)["rows"]
    assert {row["load_N"] for row in rows} == {None}
    assert rows[-1]["note"] == "The structure does not stand under its own weight"


def test_the_interfaces_carry_the_weight_and_slip_where_the_block_slides(path: Path) -> None:
    (row,) = json.loads(assembly(path, ON_GROUND, "--interfaces", "--format", "json").stdout)[
        "rows"
    ]
    assert row["interface"] == "ground-block"
    assert row["compression_N"] == pytest.approx(480.0 * GRAVITY, rel=1e-6)
    assert row["shear_N"] == pytest.approx(0.2 * 480.0 * GRAVITY, rel=1e-3)
    assert row["utilisation"] == pytest.approx(1.0, abs=1e-6)
    assert row["bonded"] == 0


@pytest.mark.parametrize(
    "shape",
    [
        {"outline": [[0, 0, 0], [0.4, 0, 0], [0.4, 0.6, 0], [0, 0.6, 0]], "along": [0, 0, 1]},
        {
            "vertices": [
                *([0, 0, 0], [0.4, 0, 0], [0.4, 0.6, 0], [0, 0.6, 0]),
                *([0, 0, 1], [0.4, 0, 1], [0.4, 0.6, 1], [0, 0.6, 1]),
            ],
            "faces": [
                *([3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4]),
                *([1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]),
            ],
        },
    ],
)
def test_a_block_has_the_same_mass_however_it_is_given(shape: dict[str, Any]) -> None:
    model = structure_of({**ON_GROUND, "blocks": {"ground": GROUND, "block": shape}}).assembly
    assert model.pieces[1].mass == pytest.approx(480.0)


def test_a_force_at_a_point_of_a_block() -> None:
    force = {"block": "block", "at": [0.2, 0.3, 1.0], "direction": [2, 0, 0]}
    _, loads = structure_of({**ON_GROUND, "load": {"force": force}})
    assert loads.variable[1] == pytest.approx([1, 0, 0, 0, 0.5, 0])


def test_locks_are_pieces_and_condensed_ones_refused_by_the_static_model(path: Path) -> None:
    pieces = [piece.name for piece in structure_of(locked()).assembly.pieces]
    assert pieces == ["ground", "block", *(f"ground-block-lock{k}" for k in (1, 2, 3))]
    rows = by_model(path, locked(condensed={"working": 1}))
    assert rows["limit"]["load_N"] > 0
    assert "has condensed locks, which have no stiffness" in rows["static"]["note"]


REFUSED = read_yaml(ROOT / "tests/cases/refused_structures.yaml")


@pytest.mark.parametrize("refused", REFUSED, ids=lambda each: each["says"][:60])
def test_a_fault_is_one_line_with_its_key(path: Path, refused: dict[str, Any]) -> None:
    found = assembly(path, ON_GROUND | refused["change"])
    assert found.exit_code == 2
    assert found.output.startswith("Error: ")
    assert found.output.count("\n") == 1
    with pytest.raises(ValueError, match=refused["says"]):
        read_structure(path)


@pytest.mark.parametrize(
    ("changes", "note"),
    [
        ({"interfaces": {"friction": 30.0}}, "friction: 30 is very large; is it an angle in degr"),
        ({"blocks": {"block": {"density": 2.4}}}, "block: density: 2.4 kg/m3 is very small"),
    ],
)
def test_numbers_of_another_unit_are_noted(path: Path, changes: dict[str, Any], note: str) -> None:
    assert note in assembly(path, with_changes(ON_GROUND, changes)).stderr


def test_blocks_in_millimetres_say_so(path: Path) -> None:
    mm = {"blocks": {"block": {"high": [240.0, 115.0, 71.0]}}}
    ended = assembly(path, with_changes(ON_GROUND, mm))
    words = "blocks.block: it would be 275.4 m across; say unit: mm, or m, cm, in, ft"
    assert (ended.exit_code, ended.output) == (2, f"Error: {words}\n")
    told = {"high": [240, "11.5cm", "71"], "unit": "mm"}
    (block,) = ShapeSection.model_validate({"low": [0, 0, 0], **told}).blocks("block", path)
    assert block.volume == pytest.approx(0.24 * 0.115 * 0.071)


def test_interfaces_are_told_at_the_load_that_counts(path: Path) -> None:
    given = {**ON_GROUND, "interfaces": {"friction": 0.2, "cohesion": 2e4, "tensile_strength": 2e4}}
    static = by_model(path, given)["static"]
    (shown,) = answers("assembly", str(path), "--interfaces")
    assert static["first_failure_N"] == static["load_N"] < static["peak_N"]
    assert shown["shear_N"] == pytest.approx(static["load_N"], rel=1e-6)
    assert shown["utilisation"] == pytest.approx(1.0, abs=1e-4)


# --- what finite rotation changes of a load of the static model ----------------------------------
WIDTH, HEIGHT = 0.4, 2.0
TILT = {"tilt": {"axis": [0, 1, 0]}}


def static_note(path: Path, stiffness: float, load: dict[str, Any]) -> str:
    law = {f"{way}_stiffness": stiffness for way in ("normal", "shear")} | {"friction": 0.7}
    tower = {"blocks": {"block": {"high": [WIDTH, 0.6, HEIGHT]}}, "interfaces": law}
    given = with_changes(ON_GROUND, tower) | {"load": load}
    return str(by_model(path, given)["static"]["note"])


def loss_of_a_tower(stiffness: float) -> float:
    """The part of its load that a tower does not carry as it turns on its foot.

    The foot is pressed by a part of its width beyond the eccentricity b / 6. The load is largest
    before its weight is on an edge, which gives way without end.
    """
    weight = 2000 * GRAVITY * WIDTH * HEIGHT  # per metre of depth
    eccentricity = np.linspace(WIDTH / 6, WIDTH / 2, 10_000)[:-1]
    turn = 2 * weight / (9 * stiffness * (WIDTH / 2 - eccentricity) ** 2)
    turn = np.minimum(turn, 1.0)
    load = (2 * eccentricity / HEIGHT - np.sin(turn)) / np.cos(turn)
    return 1.0 - float(load.max()) * HEIGHT / WIDTH


@pytest.mark.parametrize(("stiffness", "load"), [(2e7, PUSH), (1e9, PUSH), (1e11, PUSH)])
def test_soft_joints_let_a_tower_lean_and_carry_less(
    path: Path, stiffness: float, load: dict[str, Any]
) -> None:
    law = {"normal_stiffness": stiffness, "shear_stiffness": stiffness, "friction": 0.7}
    tower = {"blocks": {"block": {"high": [WIDTH, 0.6, HEIGHT]}}, "interfaces": law}
    rows = by_model(path, with_changes(ON_GROUND, tower) | {"load": load})
    left = rows["static"]["load_N"] / rows["limit"]["load_N"]
    assert left == pytest.approx(1.0 - loss_of_a_tower(stiffness), rel=5e-3)


def test_a_tower_that_turns_over_under_the_load_does_not_carry_it(path: Path) -> None:
    law = {"normal_stiffness": 1e8, "shear_stiffness": 1e8, "friction": 0.7}
    tower = {"blocks": {"block": {"high": [WIDTH, 0.6, HEIGHT]}}, "interfaces": law}
    weight = 2000 * GRAVITY * WIDTH * 0.6 * HEIGHT
    load = {"acceleration": [1, 0, 0], "newtons": 0.8 * weight * WIDTH / HEIGHT}
    found = assembly(path, with_changes(ON_GROUND, tower) | {"load": load})
    left = (1.0 - loss_of_a_tower(1e8)) / 0.8
    assert left < 0.9 and found.exit_code == 1
    words = found.stdout.splitlines()[0]
    assert words.startswith("No: it does not carry")
    assert float(words.rsplit(maxsplit=1)[1]) == pytest.approx(left, rel=5e-3)
