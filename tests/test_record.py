"""What a model returns is held against its case before it counts."""

import json
import math
import re
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import a_case, with_subject
from joints import sawn
from small import merged

from sidmacib import Assembly, Direction, Joint, Loading, lock_weights
from sidmacib.engines.results import (
    HISTORY,
    NODE_COLUMNS,
    NODES,
    RESULT,
    check_first_failure,
    force_to_stress,
    read_outcome,
)
from sidmacib.errors import ResultError
from sidmacib.mechanics.assembly import Elastic
from sidmacib.mechanics.equilibrium import face_frames
from sidmacib.models import static
from sidmacib.models.static import solve
from sidmacib.problem import Outcome, State
from workflow.case import JointCase
from workflow.cases import cases_of
from workflow.configuration import read_study
from workflow.results import BENCHMARKS, Record, read_times, record_of, record_without_result
from workflow.solve import solved
from workflow.threedec import INCREMENT, deck, decks, fingerprint, read_returned

JOINT = sawn(3)


def case_of(ratio: float = 0.0, joint: Joint = JOINT) -> JointCase:
    return a_case("static", joint, Loading(Direction(ratio)))


def parts(case: JointCase) -> tuple[Assembly, Outcome]:
    problem = case.subject.problem()
    return problem.assembly, static.solve(problem)


def write_engine_files(folder: Path, case: JointCase) -> Assembly:
    """What an engine would write if it found what the static model finds."""
    assembly, found = parts(case)
    peak = found.path[-1]
    stress = force_to_stress(assembly.nodes, face_frames(assembly), peak.force)
    lines = [",".join(NODE_COLUMNS)]
    nodes = assembly.nodes
    rows = zip(nodes.face, nodes.position, nodes.area, stress, peak.bonded, strict=True)
    for number, place, area, values, bonded in rows:
        face = assembly.faces[number]
        numbers = ",".join(repr(float(v)) for v in (*place, area, *values))
        lines.append(f"{face.name},{face.kind},{numbers},{int(bonded)}")
    (folder / NODES).write_text("\n".join(lines) + "\n")
    rows = [f"{s.load!r},{s.displacement!r},equilibrium" for s in found.path]
    (folder / HISTORY).write_text("\n".join(["load_N,displacement_m,stage", *rows]) + "\n")
    loads = {"peak_load_N": peak.load, "failed_load_N": found.failed_load, "mode": "bonds"}
    loads["first_failure_load_N"] = found.first_failure_load
    (folder / RESULT).write_text(json.dumps(loads))
    return assembly


def test_an_engines_files_become_the_record_of_its_case(tmp_path: Path) -> None:
    case = case_of(0.5)
    assembly = write_engine_files(tmp_path, case)
    outcome = read_outcome(tmp_path, assembly)
    record = record_of(case, case.subject.problem(), outcome, {"yade": "1"})
    expected, _, found = solved(case, static.solve)
    assert np.array_equal(outcome.path[-1].bonded, found.path[-1].bonded)
    assert 0 < np.count_nonzero(outcome.path[-1].bonded) < len(assembly.nodes.area)
    assert record.load_N == expected.load_N
    assert record.mode == "bonds"
    weights = [lock.weight for lock in expected.part.weights]
    assert [lock.weight for lock in record.part.weights] == pytest.approx(weights)
    assert record.unbalanced_share < 5e-3  # stresses do not say where pieces have moved to
    assert record.part.torque_Nm == pytest.approx(record.part.shear_N * 0.5 * JOINT.a)


@pytest.mark.parametrize(
    ("name", "old", "new", "message"),
    [
        (RESULT, '"peak_load_N": ', '"peak_load_N": Infinity, "x": ', "peak load inf N"),
        (RESULT, "{", "", "results unreadable"),
        (RESULT, '"peak_load_N"', '"peak"', "results unreadable: 'peak_load_N'"),
        (NODES, "shear_y_Pa", "shear_w_Pa", "results unreadable: 'shear_y_Pa'"),
        (HISTORY, "load_N", "load", "results unreadable: 'load_N'"),
    ],
)
def test_results_that_cannot_be_are_refused(
    tmp_path: Path, name: str, old: str, new: str, message: str
) -> None:
    case = case_of()
    assembly = write_engine_files(tmp_path, case)
    text = (tmp_path / name).read_text()
    assert old in text
    (tmp_path / name).write_text(text.replace(old, new, 1))
    with pytest.raises(ResultError, match=message):
        record_of(case, case.subject.problem(), read_outcome(tmp_path, assembly), {})


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"path": (State(0.0),)}, "peak load 0 N is not allowed"),
        ({"path": (State(math.inf),)}, "peak load inf N is not allowed"),
        ({"failed_load": 99.999}, "failed load 99.999 N is not allowed"),
        ({"failed_load": math.nan}, "failed load nan N is not allowed"),
        ({"first_failure_load": -0.001}, "first failure at -0.001 N is not allowed"),
        ({"first_failure_load": 110.001}, "first failure at 110.001 N is not allowed"),
        ({"path": (State(100.001), State(100.0))}, "load 100.001 N is not allowed on the path"),
        ({"path": (State(math.nan), State(100.0))}, "load nan N is not allowed on the path"),
        ({"path": (State(50.0, math.inf), State(100.0))}, "displacement inf m at 50 N"),
        ({"path": (State(100.0, 0.0, np.zeros((1, 3))),)}, "1 nodes have stresses, but the case"),
        ({"path": (State(100.0, 0.0, np.full((44, 3), np.nan)),)}, "a stress is not a finite"),
    ],
)
def test_what_cannot_be_is_refused(change: dict, words: str) -> None:
    case = case_of()
    problem = case.subject.problem()
    found = Outcome((State(50.0, 1e-6), State(100.0, 2e-6)), 110.0, 80.0)
    assert record_of(case, problem, found, {}).load_N == 100.0
    with pytest.raises(ResultError, match=words):
        record_of(case, problem, replace(found, **change), {})


@pytest.mark.parametrize("ratio", [0.0, 0.5, math.inf])
def test_a_record_has_what_each_lock_carries_and_reads_as_it_was_written(ratio: float) -> None:
    case = case_of(ratio)
    record, assembly, found = solved(case, static.solve)
    force, strength = found.path[-1].force, JOINT.T0
    locks = lock_weights(JOINT, assembly, force)
    for recorded, lock in zip(record.part.weights, locks, strict=True):
        assert (recorded.lock, recorded.block) == (lock.lock, lock.block)
        for name in ("weight", "mean_shear_ratio", "max_shear_ratio"):
            assert getattr(recorded, name) == pytest.approx(getattr(lock, name), abs=1e-9)
        for name in ("shear_x_N", "shear_y_N"):
            expected = getattr(lock, name)
            assert getattr(recorded, name) == pytest.approx(expected, rel=1e-9, abs=1e-9 * strength)
    most = max(abs(lock.shear_x_N) for lock in record.part.weights)
    assert most > 1e-3 * strength if ratio else most == 0.0
    assert Record.from_json(record.to_json()) == record


@pytest.mark.parametrize(("peak", "refused"), [(79.0, True), (81.0, False), (300.0, False)])
def test_a_peak_far_below_the_static_first_failure_is_no_result(peak: float, refused: bool) -> None:
    with pytest.raises(ResultError, match="nothing fails up to") if refused else nullcontext():
        check_first_failure(Outcome((State(peak),), peak), 100.0)


@pytest.mark.parametrize(("factor", "refused"), [(1.0, False), (1.04, False), (1.2, True)])
def test_stresses_that_do_not_balance_the_loads_are_refused(factor: float, refused: bool) -> None:
    case = case_of(0.5)
    _, found = parts(case)
    peak = found.path[-1]
    wrong = replace(found, path=(*found.path[:-1], replace(peak, force=factor * peak.force)))
    with pytest.raises(ResultError, match="do not balance") if refused else nullcontext():
        record_of(case, case.subject.problem(), wrong, {})


def test_a_failed_case_has_a_record_with_its_reason_on_one_line() -> None:
    record = record_without_result(case_of(), error="out of\n time ")
    assert record.error == "out of time"
    assert record.load_N is None
    assert Record.from_json(record.to_json()) == record


def test_times_are_those_of_the_jobs_that_were_measured(tmp_path: Path) -> None:
    folder, head = tmp_path / BENCHMARKS / "cases/yade", "s\th:m:s\tcpu_time\n"
    folder.mkdir(parents=True)
    (folder / "one.tsv").write_text(f"{head}2.5\t0:00:02\t1.5\n")
    (folder / "two.tsv").write_text(f"{head}0.1\t0:00:00\tNA\n")  # it ended at once
    assert list(read_times(tmp_path)) == [("yade", 2.5, 1.5)]
    assert list(read_times(tmp_path / "nothing")) == []


# --- decks for 3DEC, and what comes back: what can be tested without it --------------------------
STUDY = read_study(merged(meshes=[0.03], eccentricities=[0, 0.5, "torsion"]))
NUMBER = r"(-?[\d.e+-]+)"


@pytest.fixture(params=["n3-mesh0.03-e0a", "n3-mesh0.03-e0.5a", "n3-mesh0.03-torsion"])
def case(request: pytest.FixtureRequest) -> JointCase:
    return decks(STUDY, cases_of(STUDY).values())[request.param]


def static_outcome(case: JointCase) -> Outcome:
    return solve(case.subject.problem())


def returned(case: JointCase, load: float) -> str:
    """What 3DEC would print if it found what the static model finds."""
    assembly, peak = case.subject.problem().assembly, static_outcome(case).path[-1]
    nodes = assembly.nodes
    forces = force_to_stress(nodes, face_frames(assembly), peak.force) * nodes.area[:, None]
    lines = [
        "3DEC>program log on",
        f"MULTILOCK|CASE|{fingerprint(case)}",
        f"MULTILOCK|LOAD|{load}|{1.001 * load}",
    ]
    rows = zip(nodes.face, nodes.position, nodes.area, forces, strict=True)
    for number, place, area, force in rows:
        face = assembly.faces[number]
        pair = [assembly.pieces[face.below].name, assembly.pieces[face.above].name]
        values = [*place, area, *force, 0]
        lines.append("|".join(["MULTILOCK", "NODE", *pair, *(repr(float(v)) for v in values)]))
    return "\n".join([*lines, "MULTILOCK|END"])


def test_blocks_are_the_pieces_and_fixed_where_they_are(case: JointCase) -> None:
    text, model = deck(case), case.subject.problem().assembly
    bricks = re.findall(rf"block create brick {' '.join([NUMBER] * 6)}", text)
    groups = re.findall(r"^block group '(\w+)'", text, re.MULTILINE)
    assert groups == [piece.name for piece in model.pieces]
    for brick, piece in zip(bricks, model.pieces, strict=True):
        assert [float(v) for v in brick[::2]] == pytest.approx(piece.low)
        assert [float(v) for v in brick[1::2]] == pytest.approx(piece.high)
    fixed = re.findall(r"block fix range group '(\w+)'", text)
    assert fixed == [piece.name for piece in model.pieces if piece.fixed]


def test_every_face_has_its_law(case: JointCase) -> None:
    text, model = deck(case), case.subject.problem().assembly
    found = re.findall(
        rf"friction {NUMBER} cohesion {NUMBER} tension {NUMBER} range group-intersection"
        r" '(\w+)' '(\w+)'",
        text,
    )
    assert len(found) == len(model.faces)
    for (angle, cohesion, tension, below, above), face in zip(found, model.faces, strict=True):
        law = face.material
        assert (below, above) == (model.pieces[face.below].name, model.pieces[face.above].name)
        assert np.tan(np.radians(float(angle))) == pytest.approx(law.friction)
        assert (float(cohesion), float(tension)) == (law.cohesion, law.tensile_strength)


def test_forces_on_the_corners_have_the_resultant_of_the_load(case: JointCase) -> None:
    text, model = deck(case), case.subject.problem().assembly
    found = re.findall(
        rf"force-x {NUMBER} force-y {NUMBER} force-z {NUMBER} range group '(\w+)' sphere center "
        rf"{NUMBER} {NUMBER} {NUMBER}",
        text,
    )
    increment = INCREMENT * case.subject.joint.T0
    loads = case.subject.problem().loads.variable
    for piece, load in zip(model.pieces, loads, strict=True):
        if not load.any():
            continue
        rows = np.array([[float(v) for v in (*r[:3], *r[4:])] for r in found if r[3] == piece.name])
        assert len(rows) == 4
        force, arm = rows[:, :3], rows[:, 3:] - piece.centre
        assert force.sum(axis=0) == pytest.approx(increment * load[:3])
        moment = np.cross(arm, force).sum(axis=0)
        assert moment[2] == pytest.approx(increment * load[5])
        assert moment[0] == pytest.approx(0.0, abs=1e-12)  # acts at mid-height


def test_what_comes_back_reads_like_any_other_model(case: JointCase) -> None:
    load = static_outcome(case).path[-1].load
    record = record_of(case, *read_returned(returned(case, load), case), {})
    assert (record.name, record.load_N) == (case.name, pytest.approx(load, rel=1e-9))
    assert record.failed_load_N == pytest.approx(1.001 * load, rel=1e-9)
    assert record.unbalanced_share < 2e-3  # stresses do not say where pieces have moved to
    assert max(each.weight for each in record.part.weights) <= 1.0 + 1e-6


def test_results_of_another_case_cut_short_or_without_a_face_are_refused(case: JointCase) -> None:
    text = returned(case, 100.0)
    holed = "\n".join(line for line in text.splitlines() if "lock1|column1" not in line)
    for wrong, words in (
        (text.replace(case.name, "other"), "results of other-.*; they must be results of n3-mesh0"),
        (text.removesuffix("MULTILOCK|END"), "incomplete; run the deck again"),
        (holed, "0 m2 of subcontacts on inner-lock1-column1; they must cover"),
    ):
        with pytest.raises(ResultError, match=words):
            read_returned(wrong, case)


@pytest.mark.parametrize("value", ["ten", ""])
def test_a_number_that_is_none_is_refused(case: JointCase, value: str) -> None:
    lines = returned(case, 100.0).splitlines()
    lines[3] = "|".join([*lines[3].split("|")[:8], value, *lines[3].split("|")[9:]])
    with pytest.raises(ResultError, match=f"could not convert string to float: '{value}'"):
        read_returned("\n".join(lines), case)


def test_elastic_pieces_are_deformable_blocks_with_the_material(case: JointCase) -> None:
    bends = with_subject(case, joint=replace(case.subject.joint, elastic=Elastic(2e10, 0.25)))
    lines = deck(bends).splitlines()
    assert "block zone cmodel assign elastic" in lines
    (law,) = (line for line in lines if line.startswith("block zone property"))
    assert law.split()[3:] == ["density", "1400.0", "young", "20000000000.0", "poisson", "0.25"]
    assert not any("densify" in line for line in lines)
    assert any("densify" in line for line in deck(case).splitlines())
