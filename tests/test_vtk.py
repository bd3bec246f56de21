"""The load path as ParaView reads it."""

from pathlib import Path
from xml.etree import ElementTree

import meshio
import numpy as np
import pytest
from conftest import a_case

from analysis.vtk import write_path
from sidmacib import Direction, Elastic, Joint, Loading, NodeLayout

LOBATTO = NodeLayout.LOBATTO


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    case = a_case("static", Joint(3), Loading(Direction(0.3)), nodes=LOBATTO)
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
    assert np.linalg.norm(shear, axis=1).max() <= Joint(3).inner.cohesion * (1 + 1e-6)
    assert load > 0.0
    assert set(np.unique(mesh.point_data["bonded"])) <= {0.0, 1.0}


def test_pieces_that_bend_have_stresses_but_no_movement(tmp_path: Path) -> None:
    joint = Joint(3, elastic=Elastic(1e10))
    bends = a_case("static", joint, Loading(Direction(0.0)), nodes=LOBATTO)
    pieces, nodes = write_path(bends, tmp_path)
    assert (steps(pieces)[-1][1].point_data["displacement_m"] == 0.0).all()
    assert np.abs(steps(nodes)[-1][1].point_data["normal_Pa"]).max() > 0.0
