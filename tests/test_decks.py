"""Decks for 3DEC: what can be tested without it."""

import re
from dataclasses import replace

import numpy as np
import pytest
from conftest import with_subject
from small import merged

from sidmacib.engines.results import force_to_stress
from sidmacib.errors import ResultError
from sidmacib.mechanics.assembly import Elastic
from sidmacib.mechanics.equilibrium import face_frames
from sidmacib.models.static import solve
from sidmacib.problem import Outcome
from workflow.case import JointCase
from workflow.cases import cases_of
from workflow.configuration import read_study
from workflow.results import record_of
from workflow.threedec import INCREMENT, deck, decks, fingerprint, read_returned

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
    assert record.unbalanced_share < 1e-6
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


@pytest.mark.parametrize("value", ["nan", "inf", "ten", ""])
def test_a_number_that_is_none_is_named_with_its_line(case: JointCase, value: str) -> None:
    lines = returned(case, 100.0).splitlines()
    lines[3] = "|".join([*lines[3].split("|")[:8], value, *lines[3].split("|")[9:]])
    with pytest.raises(ResultError, match=r"results.txt, line 4: must have 9 finite numbers"):
        read_returned("\n".join(lines), case)


def test_elastic_pieces_are_deformable_blocks_with_the_material(case: JointCase) -> None:
    bends = with_subject(case, joint=replace(case.subject.joint, elastic=Elastic(2e10, 0.25)))
    lines = deck(bends).splitlines()
    assert "block zone cmodel assign elastic" in lines
    (law,) = (line for line in lines if line.startswith("block zone property"))
    assert law.split()[3:] == ["density", "1400.0", "young", "20000000000.0", "poisson", "0.25"]
    assert not any("densify" in line for line in lines)
    assert any("densify" in line for line in deck(case).splitlines())
