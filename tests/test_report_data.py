"""Tables and paths of the report: headings with units, names in words, places and loads."""

import re
from collections import Counter
from pathlib import Path
from xml.etree import ElementTree

import meshio
import numpy as np
import pandas as pd
import pytest
from conftest import ROOT, a_case
from joints import sawn
from small import ONE, SMALL

from analysis.paths import path_of, shown_cases
from analysis.report import headings, words
from analysis.report.joints import sample_words
from analysis.report.page import ADDRESS, SCRIPTS_OF_PARTS, versions_of
from analysis.report.page import SCRIPTS as SCRIPTS_OF_ALL
from analysis.vtk import write_path
from sidmacib import Direction, Elastic, Loading, NodeLayout
from sidmacib.mechanics.static import static_peak
from sidmacib.scene.page import SCRIPTS
from workflow.case import JointCase
from workflow.cases import cases_of
from workflow.configuration import read_study
from workflow.results.tables import TABLES


def test_headings_have_units_and_no_underscores() -> None:
    known = {
        **{"load_N": ("load (N)", 1), "shear_N": ("V (N)", 1), "torque_Nm": ("M (N m)", 1)},
        **{"eccentricity_over_a": ("e / a", 1), "mesh_m": ("mesh (m)", 1)},
        **{"load_over_T0": ("load / T0", 1), "mesh_error": ("mesh error (%)", 100)},
        **{"peak_spread": ("peak spread (%)", 100), "error": ("error", 1)},
    }
    held = dict.fromkeys(known, 0.5) | {"error": "a reason"}
    found = headings({"capacity": pd.DataFrame([held])})["capacity"]
    assert [(each["title"], each["times"]) for each in found] == [*known.values()]


def test_an_engine_of_several_cases_is_told_once() -> None:
    versions = ["yade 2022.01a", "liggghts 3.8.0, yade 2022.01a", None]
    told = [name for name, _ in versions_of({"cases": pd.DataFrame({"versions": versions})})]
    assert told[1:3] == ["LIGGGHTS", "YADE"]
    assert len(told) == len(set(told))


def test_every_column_has_a_heading_that_can_be_read_and_a_meaning() -> None:
    tables = {form.name: pd.DataFrame(columns=list(form.columns)) for form in TABLES}
    for name, heads in headings(tables).items():
        for head in heads:
            assert head["meaning"], (name, head)
            assert "_" not in head["title"] and "`" not in head["meaning"]


def test_names_of_models_rules_and_quantities_are_in_words() -> None:
    row = {"model": "static", "reduction": "half", "quantity": "weight_lock1", "option": None}
    found = words({"fit": pd.DataFrame([row])})
    assert found["model"] == {"static": "static model"}
    assert found["reduction"] == {"half": "(n - 1) / 2 locks count"}
    assert found["quantity"] == {"weight_lock1": "weight of lock 1"}
    assert found["option"] == {}


def test_samples_are_told_by_what_tells_them_apart() -> None:
    plain = {"samples": {"n3": {"locks": 3}, "n5": {"locks": 5}}}
    assert sample_words(read_study(plain)) == {"n3": "n3: 3 locks", "n5": "n5: 5 locks"}
    smooth = {"locks": 5, "dry": {"friction": 0.1}}
    found = sample_words(read_study({**ONE, "samples": {"n5": {"locks": 5}, "smooth": smooth}}))
    assert found["smooth"] == "smooth: 5 locks, friction 0.1"
    assert found["n5"] == "n5: 5 locks, friction 0.3 as printed"
    long = {"samples": {"n5": {"locks": 5}, "long": {"locks": 5, "a": 0.08}}}
    assert sample_words(read_study(long))["long"] == "long: 5 locks, a (mm) 80"


def test_the_scripts_of_the_report_declare_no_name_twice() -> None:
    """They share one scope with those that draw, as do those of the command's page."""
    declared = re.compile(r"^(?:const|let|function\*?|class) +(\w+)", re.MULTILINE)
    parts = [script for part in SCRIPTS_OF_PARTS.values() for script in part]
    of_study = [*SCRIPTS_OF_ALL, *parts, ADDRESS]
    of_command = [ROOT / "sidmacib/scene" / name for name in SCRIPTS]
    for scripts in (of_study, of_command):
        names = [name for script in scripts for name in declared.findall(script.read_text())]
        assert [name for name, count in Counter(names).items() if count > 1] == []


@pytest.fixture(scope="module")
def case() -> JointCase:
    found, *_ = shown_cases(cases_of(read_study(SMALL | {"eccentricities": [0.3]})).values())
    return found


def test_nodes_lie_on_the_inner_face_of_their_lock(case: JointCase) -> None:
    joint, found = case.subject.joint, path_of(case)
    assert [face["lock"] for face in found["faces"]] == [1, 2, 3]
    for face in found["faces"]:
        lock = face["lock"]
        assert (min(face["x"]), max(face["x"])) == pytest.approx((-joint.a / 2, joint.a / 2))
        edges = joint.edge(lock - 1), joint.edge(lock)
        assert (min(face["y"]), max(face["y"])) == pytest.approx(edges)
        assert face["z"] == pytest.approx(joint.h if joint.is_upper(lock) else 0.0)
        assert len(set(zip(face["x"], face["y"], strict=True))) == len(face["x"])


def test_stresses_stand_at_their_nodes(case: JointCase) -> None:
    """They give the shear and, with the places of the nodes, the torque that a lock carries."""
    found, problem = path_of(case), case.subject.problem()
    peak, nodes = static_peak(*problem).peak, problem.assembly.nodes
    shear = np.hypot(peak.force[:, 1], peak.force[:, 2])
    stress = shear / nodes.area / case.subject.joint.inner.cohesion
    for face, shear in zip(found["faces"], found["steps"][-1]["shear"], strict=True):
        place = np.column_stack([face["x"], face["y"], np.full(len(shear), face["z"])])
        for where, value in zip(place, shear, strict=True):
            near = np.abs(nodes.position - where).max(axis=1) < 1e-5
            assert np.abs(stress[near] - value).min() <= 6e-3 * max(value, 1e-6)


def test_loads_are_those_of_the_static_model(case: JointCase) -> None:
    found, solution = path_of(case), static_peak(*case.subject.problem())
    assert found["first"] == pytest.approx(solution.first_failure_load, rel=1e-5)
    assert found["steps"][-1]["load"] == pytest.approx(solution.peak.load, rel=1e-5)
    peak = [solution.peak.displacement, solution.peak.load]
    assert found["curve"][-1] == pytest.approx(peak, rel=1e-4)
    lost = [face["fails_from"] for face in found["faces"] if face["fails_from"] is not None]
    assert all(solution.first_failure_load <= load <= solution.peak.load for load in lost)


# --- the load path as ParaView reads it ----------------------------------------------------------
LOBATTO = NodeLayout.LOBATTO


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    case = a_case("static", sawn(3), Loading(Direction(0.3)), nodes=LOBATTO)
    return write_path(case, tmp_path_factory.mktemp("vtk"))


def steps(collection: Path) -> list[tuple[float, meshio.Mesh]]:
    sets = ElementTree.parse(collection).getroot().iter("DataSet")
    rows = [(float(each.attrib["timestep"]), each.attrib["file"]) for each in sets]
    return [(step, meshio.read(collection.parent / file)) for step, file in rows]


def test_pieces_are_boxes_that_move(written: list[Path]) -> None:
    (_, first), *_, (_, last) = steps(written[0])
    assert len(first.cells_dict["hexahedron"]) == 1 + 1 + 3 + 3
    assert np.ptp(first.points[:8], axis=0).prod() > 0.0
    before, after = (np.abs(mesh.point_data["displacement_m"]).max() for mesh in (first, last))
    assert after > before
    assert (last.point_data["displacement_m"][:8] == 0.0).all()  # the lower body is fixed


def test_stresses_on_locks_are_within_their_strength(written: list[Path]) -> None:
    load, mesh = steps(written[1])[-1]
    shear = mesh.point_data["shear_Pa"][mesh.point_data["inner"] == 1.0]
    assert np.linalg.norm(shear, axis=1).max() <= sawn(3).inner.cohesion * (1 + 1e-6)
    assert load > 0.0
    assert set(np.unique(mesh.point_data["bonded"])) <= {0.0, 1.0}


def test_pieces_that_bend_have_stresses_but_no_movement(tmp_path: Path) -> None:
    joint = sawn(3, elastic=Elastic(1e10))
    bends = a_case("static", joint, Loading(Direction(0.0)), nodes=LOBATTO)
    pieces, nodes = write_path(bends, tmp_path)
    assert (steps(pieces)[-1][1].point_data["displacement_m"] == 0.0).all()
    assert np.abs(steps(nodes)[-1][1].point_data["normal_Pa"]).max() > 0.0
