"""Decks for 3DEC: what can be tested without it."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analysis.balance import unbalanced_share
from analysis.reading import read_case
from analysis.weights import lock_weights
from sidmacib.loading import lateral_load
from sidmacib.mechanics.assembly import Assembly
from workflow.cases import Case
from workflow.configuration import read_study
from workflow.solve import node_table, solve_case
from workflow.threedec import INCREMENT, convert, deck, decks, fingerprint, read_returned

STUDY = read_study(
    {"samples": {"n3": {"locks": 3}}, "meshes": [0.03], "eccentricities": [0, 0.5, "torsion"]}
)
NUMBER = r"(-?[\d.e+-]+)"


@pytest.fixture(params=["n3-mesh0.03-e0a", "n3-mesh0.03-e0.5a", "n3-mesh0.03-torsion"])
def case(request: pytest.FixtureRequest) -> Case:
    return decks(STUDY)[request.param]


def returned(case: Case, load: float) -> str:
    """What 3DEC would print if it found what the static model finds."""
    model, outcome = solve_case(replace(case, model="static"))
    nodes = node_table(model, outcome.path[-1])
    faces = {face.name: face for face in model.faces}
    lines = [
        "3DEC>program log on",
        f"MULTILOCK|CASE|{fingerprint(case)}",
        f"MULTILOCK|LOAD|{load}|{load}",
    ]
    for row in nodes.itertuples():
        face = faces[str(row.face)]
        forces = np.array([row.normal_Pa, row.shear_x_Pa, row.shear_y_Pa, row.shear_z_Pa])
        values = [row.x_m, row.y_m, row.z_m, row.area_m2, *(forces * row.area_m2), 0]
        pair = [model.pieces[face.below].name, model.pieces[face.above].name]
        lines.append("|".join(["MULTILOCK", "NODE", *pair, *(repr(float(v)) for v in values)]))
    return "\n".join([*lines, "MULTILOCK|END"])


def discretised(case: Case) -> Assembly:
    return assemble(case.joint, case.mesh)


def test_there_is_a_deck_for_every_case_of_the_reference() -> None:
    study = STUDY.model_copy(update={"variants": {}})
    assert len(decks(study)) == 3
    assert {case.model for case in decks(STUDY).values()} == {"3dec"}


def test_blocks_are_the_pieces_and_fixed_where_they_are(case: Case) -> None:
    text, model = deck(case), discretised(case)
    bricks = re.findall(rf"block create brick {' '.join([NUMBER] * 6)}", text)
    groups = re.findall(r"^block group '(\w+)'", text, re.MULTILINE)
    assert groups == [piece.name for piece in model.pieces]
    for brick, piece in zip(bricks, model.pieces, strict=True):
        assert [float(v) for v in brick[::2]] == pytest.approx(piece.low)
        assert [float(v) for v in brick[1::2]] == pytest.approx(piece.high)
    fixed = re.findall(r"block fix range group '(\w+)'", text)
    assert fixed == [piece.name for piece in model.pieces if piece.fixed]


def test_every_face_has_its_law(case: Case) -> None:
    text, model = deck(case), discretised(case)
    found = re.findall(
        rf"friction {NUMBER} cohesion {NUMBER} tension {NUMBER} range group-intersection"
        r" '(\w+)' '(\w+)'",
        text,
    )
    assert len(found) == len(model.faces)
    for (angle, cohesion, tension, below, above), face in zip(found, model.faces, strict=True):
        law = model.material(face.kind)
        assert (below, above) == (model.pieces[face.below].name, model.pieces[face.above].name)
        assert np.tan(np.radians(float(angle))) == pytest.approx(law.friction)
        assert (float(cohesion), float(tension)) == (law.cohesion, law.tensile_strength)


def test_forces_on_the_corners_have_the_resultant_of_the_load(case: Case) -> None:
    text, model = deck(case), discretised(case)
    found = re.findall(
        rf"force-x {NUMBER} force-y {NUMBER} force-z {NUMBER} range group '(\w+)' sphere center "
        rf"{NUMBER} {NUMBER} {NUMBER}",
        text,
    )
    increment = INCREMENT * case.joint.T0
    for load in lateral_load(model, case.loading):
        piece = model.pieces[load.piece]
        rows = np.array([[float(v) for v in (*r[:3], *r[4:])] for r in found if r[3] == piece.name])
        assert len(rows) == 4
        force, arm = rows[:, :3], rows[:, 3:] - piece.centre
        assert force.sum(axis=0) == pytest.approx(increment * load.force)
        moment = np.cross(arm, force).sum(axis=0)
        assert moment[2] == pytest.approx(increment * load.moment[2])
        assert moment[0] == pytest.approx(0.0, abs=1e-12)  # acts at mid-height


def test_every_line_is_a_command_or_fish(case: Case) -> None:
    depth = 0
    for line in deck(case).splitlines():
        words = line.split()
        if not words or words[0].startswith((";", "[", "'", "...")):
            continue
        if words[0] in ("fish", "loop", "if", "command"):
            depth += 1
        elif words[0] in ("end", "endloop", "endif", "endcommand"):
            depth -= 1
        else:
            commands = ("block", "model", "program", "local", "out", "carried", "failed", "rounds")
            assert words[0] in (*commands, "standing", "else", "system.error"), line
    assert depth == 0


def test_what_comes_back_reads_like_any_other_model(case: Case, tmp_path: Path) -> None:
    static = solve_case(replace(case, model="static"))[1]
    load = static.path[-1].load
    convert(case, returned(case, load), tmp_path)
    result = read_case(tmp_path)
    assert (result.case, result.peak_load) == (case, load)
    assert unbalanced_share(result) < 1e-6
    assert lock_weights(result)["weight"].max() <= 1.0 + 1e-6


def test_results_of_another_case_or_cut_short_are_refused(case: Case) -> None:
    text = returned(case, 100.0)
    with pytest.raises(ValueError, match=r"got results of other-.*, allowed are: n3-mesh0.03"):
        read_returned(text.replace(case.name, "other"), case)
    with pytest.raises(ValueError, match=r"not whole, run the deck again"):
        read_returned(text.removesuffix("MULTILOCK|END"), case)


def test_results_of_the_same_case_on_another_joint_are_refused(case: Case) -> None:
    taller = replace(case, joint=replace(case.joint, h=0.02))
    with pytest.raises(ValueError, match=r"got results of n3-mesh0.03-.*, allowed are: n3-mesh0.0"):
        read_returned(returned(case, 100.0), taller)


def test_a_face_that_is_not_covered_is_named(case: Case) -> None:
    lines = [x for x in returned(case, 100.0).splitlines() if "lock1|column1" not in x]
    with pytest.raises(
        ValueError, match=r"got 0 m2 of subcontacts on inner-lock1-column1, allowed"
    ):
        read_returned("\n".join(lines), case)
