"""Studies of structures: their keys, their cases, and what a whole study writes."""

import shutil
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pandas as pd
import pytest
import yaml
from conftest import DISTINCT, ROOT, run_study
from processes import python
from structures import CUBE, PUSH, WEIGHT, example, solved

from analysis.report.structures import structures_verdict, supports_verdict
from analysis.summary.structures import measured_lines, summary
from analysis.tables.structures import measured_table, structures_table, write_supports
from workflow.case import StructureCase
from workflow.cases import structure_cases, support_cases
from workflow.configuration import ConfigError, read_study, read_study_file
from workflow.results.tables import (
    BLOCKS,
    INTERFACES,
    MEASURED_STRUCTURES,
    STRUCTURES,
    SUPPORTS,
    read_table,
    write_table,
)
from workflow.schema import with_changes

TRILITH = example("trilith")


def study_of(**keys: Any) -> dict[str, Any]:
    structures = {"trilith": {"description": TRILITH, **keys}}
    return {"structures": structures, "models": ["static", "limit"], "dem": {"engines": []}}


def test_a_study_may_have_structures_and_no_joint() -> None:
    study = read_study(study_of())
    assert not study.samples
    names = {(case.model, case.name) for case in structure_cases(study)}
    assert names == {("static", "trilith-load"), ("limit", "trilith-load")}


def test_loads_and_variants_multiply_and_change_the_description() -> None:
    push = {"acceleration": [0, 1, 0]}
    config = study_of(
        models=["static"],
        loads={"x": PUSH, "y": push},
        variants={"smooth": {"interfaces": {"friction": 0.1}, "special": None}},
    )
    cases = {case.name: case for case in structure_cases(read_study(config))}
    assert [*cases] == ["trilith-x", "trilith-y", "trilith-x-smooth", "trilith-y-smooth"]
    last = cases["trilith-y-smooth"].subject.description
    assert last["load"] == push
    assert last["interfaces"] == {"friction": 0.1}
    assert "special" not in last
    assert last["blocks"] == TRILITH["blocks"]
    assert len({case.digest() for case in cases.values()}) == 4


def test_a_case_reads_back_what_it_wrote_and_its_digest_knows_no_names() -> None:
    config = {**study_of(models=["yade", "static"]), "dem": {"engines": ["yade"]}}
    for case in structure_cases(read_study(config)):
        again = StructureCase.from_json(case.to_json())
        assert again == case
        other = read_study({**config, "structures": {"another": config["structures"]["trilith"]}})
        digests = {each.model: each.digest() for each in structure_cases(other)}
        assert digests[case.model] == case.digest()


def test_files_are_found_beside_the_configuration(tmp_path: Path) -> None:
    (tmp_path / "blocks.yaml").write_text(yaml.safe_dump(TRILITH))
    path = tmp_path / "study.yaml"
    path.write_text("structures: {t: {file: blocks.yaml}}\nmodels: [static]\ndem: {engines: []}")
    assert read_study_file(path).structures["t"].description == TRILITH
    path.write_text("structures: {t: {file: nowhere.yaml}}")
    with pytest.raises(ConfigError, match=r"structures\.t\.file: nowhere\.yaml: No such file"):
        read_study_file(path)


@pytest.mark.parametrize("folder", ["arch", "wall", "flat_vault"])
def test_the_studies_of_structures_can_be_read(folder: str) -> None:
    study = read_study_file(ROOT / "studies" / folder / "config.yaml")
    assert {case.model for case in structure_cases(study)} >= {"static", "limit"}


STACK = {
    "blocks": {
        "ground": {"low": [0, 0, -0.2], "high": [0.4, 0.4, 0], "fixed": True},
        "block": {"low": [0, 0, 0], "high": [0.4, 0.4, 0.2], "density": 2000},
    },
    "load": PUSH,
}


def test_measured_loads_stand_beside_those_of_each_model_and_change_none(tmp_path: Path) -> None:
    given = {
        "source": "hand, with a spring balance",
        "loads": [
            {"newtons": "0.5 kN", "specimen": "no. 1"},
            {"newtons": 400, "variant": "rough"},
        ],
        "scatter": 0.1,
    }
    rough = {"rough": {"interfaces": {"friction": 0.8}}}
    config = study_of(description=STACK, variants=rough, measured=given)
    plain = study_of(description=STACK, variants=rough)
    known, alone = ([*structure_cases(read_study(each))] for each in (config, plain))
    assert [each.digest() for each in known] == [each.digest() for each in alone]
    section = read_study(config).structures["trilith"].measured
    assert section is not None
    table = measured_table(structures_table(solved(tmp_path, **config)), {"trilith": section})
    write_table(MEASURED_STRUCTURES, table, tmp_path / "measured_structures.csv")
    ratios = table.set_index(["number", "model"])["measured_over_load"]
    weight = 2000 * 9.81 * 0.4 * 0.4 * 0.2
    friction = float(known[0].subject.problem().assembly.faces[0].material.friction)
    assert ratios[1, "static"] == pytest.approx(500 / (friction * weight), rel=2e-3)
    assert ratios[2, "limit"] == pytest.approx(400 / (0.8 * weight), rel=2e-3)
    first, second = measured_lines(table)
    assert first[0] == "trilith, load, no. 1" and second[0] == "trilith, load, rough"
    assert first[1].startswith("measured 500 N (scatter 10 %), ")
    assert f"{ratios[1, 'static']:.3g} of static model" in first[1]
    assert first[1].endswith("; hand, with a spring balance")
    findings = structures_verdict(structures_table([]), measured=table)
    assert findings[0]["text"] == f"{first[1]}."


@pytest.mark.study
def test_the_summary_and_the_report_of_a_run_tell_measured_loads(tmp_path: Path) -> None:
    measured = {"source": "a test", "loads": [{"newtons": 400}]}
    config = study_of(description=STACK, measured=measured)
    run_study(config, tmp_path, "summary.txt", "report.html")
    table = read_table(MEASURED_STRUCTURES, tmp_path / "tables/measured_structures.csv")
    ((_, words),) = measured_lines(table)
    assert f"trilith, load: {words}\n" in (tmp_path / "summary.txt").read_text()
    assert words in (tmp_path / "report.html").read_text()


SETTLING = example("settling")
SUPPORTS_MOVE = {
    "push": PUSH,
    "settles": SETTLING["load"],
    "turns": {"support": {"block": "right", "rotation": [0, 1, 0]}},
}


@pytest.mark.long
def test_supports_that_move_have_a_table_and_no_case_of_a_model(tmp_path: Path) -> None:
    bonded = {"variants": {"bonded": {"interfaces": {"cohesion": 1e5}}}}
    beams = {"description": SETTLING, "loads": SUPPORTS_MOVE, **bonded}
    study = read_study({**study_of(), "structures": {"beams": beams}})
    assert {case.subject.load for case in structure_cases(study)} == {"push"}
    cases = [
        [each.structure, each.load, each.description, *others]
        for each, *others in support_cases(study)
    ]
    write_supports({"cases": cases}, {}, {"supports": tmp_path / "supports.csv"})
    table = read_table(SUPPORTS, tmp_path / "supports.csv")
    row = table.set_index(["load", "variant", "answer"]).loc
    # By hand, see docs/howto/displacements.md: beam and wall turn about the edge of the pier.
    by_hand = (3691 * 0.955 + 3532 * 0.91) / 2
    least = row["settles", "reference", "limit, least"]
    assert least["reaction_N"] == pytest.approx(by_hand, rel=1e-3)
    assert "the structure falls" in row["settles", "reference", "kinematics"]["note"]
    assert row["turns", "reference", "kinematics"]["movement_degrees"] > 1.0
    assert "left-beam1 is not dry" in row["settles", "bonded", "none"]["note"]
    text = summary("results", STRUCTURES.frame([]), table)
    assert "beams, support that moves: settles" in text and "3369.1" in text
    first, *_, last = supports_verdict(table)
    assert first["text"].startswith("Reaction drops to 3369 N; after 0.6405 m: the structure falls")
    assert "No result: finite displacements" in last["text"]


@pytest.fixture(scope="module")
def table(structures_study: Path) -> pd.DataFrame:
    rows = read_table(STRUCTURES, structures_study / "tables/structures.csv")
    return rows.set_index(["case", "model"])


@pytest.mark.study
def test_the_table_has_angles_in_place_of_loads_where_gravity_turns(tmp_path: Path) -> None:
    loads = {"load": TRILITH["load"], "tilt": {"tilt": {"axis": [0, 1, 0]}}}
    dry = with_changes(TRILITH, {"special": None})
    records = solved(tmp_path, **study_of(description=dry, loads=loads))
    table = structures_table(records).set_index(["case", "model"])
    tilts = table.loc["trilith-tilt"]
    # Dry blocks at a tilt are blocks under an acceleration of its tangent.
    push = table.loc["trilith-load"]["load_over_weight"]
    expected = np.degrees(np.arctan(push.to_numpy()))
    assert tilts["tilt_degrees"].to_numpy() == pytest.approx(expected, rel=1e-3)
    static = tilts.loc["static"]
    assert static["first_failure_tilt_degrees"] <= static["tilt_degrees"]
    assert tilts[["load_N", "load_over_weight", "failed_load_N"]].isna().all(axis=None)
    assert "tilt (degrees)" in summary("results", table.reset_index())


@pytest.mark.study
def test_a_study_says_what_a_model_refuses(structures_study: Path, table: pd.DataFrame) -> None:
    refused = table.loc[("keyed-load", "static"), "refused"]
    words = "base-block has condensed locks, which have no stiffness; cut them out"
    assert refused == f"static: {words}"
    assert table.loc[("keyed-load", "limit"), "load_N"] > 0.0
    joints = pd.read_csv(structures_study / "tables/cases.csv")
    assert (structures_study / ".complete").read_text() == f"{len(table) + len(joints)} cases\n"
    assert f"no answer: {refused}" in (structures_study / "summary.txt").read_text()


@pytest.mark.study
def test_interfaces_carry_weight_and_load(structures_study: Path, table: pd.DataFrame) -> None:
    rows = read_table(INTERFACES, structures_study / "tables/interfaces.csv")
    whole = table.loc[("trilith-load-dry", "static")]
    interfaces = rows[(rows["case"] == "trilith-load-dry") & (rows["model"] == "static")]
    feet = interfaces[interfaces["interface"].isin(["ground-left", "ground-right"])]
    assert feet["normal_N"].sum() == pytest.approx(whole["weight_N"], rel=1e-5)
    assert feet["shear_N"].sum() == pytest.approx(whole["load_N"], rel=1e-5)
    assert interfaces["utilisation"].max() <= 1.0 + 1e-6
    assert (interfaces["kind"] == "dry").all()
    assert interfaces["fails_at"].isna().all()


@pytest.mark.study
def test_blocks_have_weights_that_add_up_and_move_along_the_load(structures_study: Path) -> None:
    rows = read_table(BLOCKS, structures_study / "tables/blocks.csv")
    blocks = rows[(rows["case"] == "trilith-load") & (rows["model"] == "limit")].set_index("block")
    free = blocks[~blocks["fixed"]]
    assert (blocks.loc["ground", ["move_x_m", "turn_y"]] == 0.0).all()
    share = free["weight_N"] / free["weight_N"].sum()
    assert float(share @ free["move_x_m"]) == pytest.approx(1.0, rel=1e-5)  # m along the load
    assert set(blocks["motion"]) == {"mechanism"}


@pytest.mark.study
def test_paraview_files_have_the_shape_and_the_motion(structures_study: Path) -> None:
    mesh = meshio.read(structures_study / "structures/vtk/trilith-load-static-blocks.vtu")
    assert np.ptp(mesh.points, axis=0) == pytest.approx([4.0, 0.5, 3.0])
    assert np.abs(mesh.point_data["displacement_m"]).max() > 0.0
    faces = meshio.read(structures_study / "structures/vtk/trilith-load-static-interfaces.vtu")
    assert sum(len(cells.data) for cells in faces.cells) == 4


@pytest.mark.engine
def test_what_never_falls_is_an_answer_of_the_static_model_and_of_engines(tmp_path: Path) -> None:
    glued = {"cohesion": 1e8, "tensile_strength": 1e8}
    tilted = {**CUBE, "interfaces": glued, "load": {"tilt": {"axis": [0, 1, 0]}}}
    config = {"structures": {"glued": {"description": tilted}}, "models": ["static"]}
    records = solved(tmp_path, **config, dem={"engines": [*DISTINCT]})
    table = structures_table(records).set_index("model")
    for model in ("static", *DISTINCT):
        words = f"{model}: in equilibrium up to a tilt of 180 degrees"
        assert table.loc[model, "refused"] == words
    assert table["error"].isna().all()


OBJ = """o stone
v 0 0 0
v {0} 0 0
v {0} {0} 0
v 0 {0} 0
v 0 0 {1}
v {0} 0 {1}
v {0} {0} {1}
v 0 {0} {1}
f 4 3 2 1
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
"""


def test_a_mesh_in_a_description_or_a_variant_is_part_of_the_case(tmp_path: Path) -> None:
    """Its file counts from the folder of the configuration, wherever the study is started."""
    inside = tmp_path / "meshes"
    inside.mkdir()
    blocks: dict[str, Any] = {"ground": CUBE["blocks"]["ground"]}
    blocks["stone"] = {"file": "meshes/low.obj", "unit": "m"}
    description = {"blocks": blocks, "interfaces": {"friction": 0.9}, "load": PUSH}
    tall = {"blocks": {"stone": {"file": "meshes/tall.obj", "unit": "m"}}}
    section = {"description": description, "variants": {"tall": tall}}
    path = tmp_path / "study.yaml"
    path.write_text(yaml.safe_dump(study_of() | {"structures": {"s": section}}))

    def digests() -> dict[str, str]:
        return {case.name: case.digest() for case in structure_cases(read_study_file(path))}

    (inside / "low.obj").write_text(OBJ.format(1, 1.4))
    (inside / "tall.obj").write_text(OBJ.format(1, 3.0))
    before = digests()
    (inside / "tall.obj").write_text(OBJ.format(1, 2.0))
    between = digests()
    assert before["s-load"] == between["s-load"]
    assert before["s-load-tall"] != between["s-load-tall"]
    (inside / "low.obj").write_text(OBJ.format(1, 1.2))
    assert digests()["s-load"] != between["s-load"]


@pytest.mark.study
def test_a_results_folder_knows_what_it_was_made_from_wherever_it_is(tmp_path: Path) -> None:
    """Under another path, without Snakemake's notes, copied, with a damaged record."""
    blocks, config = tmp_path / "blocks.yaml", tmp_path / "study.yaml"
    config.write_text("structures: {t: {file: blocks.yaml}}\nmodels: [static]\ndem: {engines: []}")

    def load(results: str, friction: float) -> float:
        text = CUBE | {"interfaces": {"friction": friction}, "load": PUSH}
        blocks.write_text(yaml.safe_dump(text))
        command = "-m", "workflow", "study", "study.yaml", f"--results={results}"
        python(*command, cwd=tmp_path, check=True, PYTHONPATH=str(ROOT))
        table = read_table(STRUCTURES, tmp_path / results / "tables/structures.csv")
        return float(table["load_N"].iloc[0])

    assert load("one", 0.1) == pytest.approx(0.1 * WEIGHT, rel=2e-3)
    shutil.copytree(tmp_path / "one", tmp_path / "two")
    shutil.rmtree(tmp_path / ".snakemake")
    assert load(str(tmp_path / "one"), 0.2) == pytest.approx(0.2 * WEIGHT, rel=2e-3)
    record = tmp_path / "two/structures/static/t/records.jsonl"
    record.write_text(record.read_text()[:400])
    assert load("two", 0.3) == pytest.approx(0.3 * WEIGHT, rel=2e-3)
