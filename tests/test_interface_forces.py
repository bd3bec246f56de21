"""Utilisation of interfaces: hinges, sliding and turning faces, bonds."""

import math

import numpy as np
import pytest
from structures import GROUND, dry

from sidmacib import limit_load, static_peak
from sidmacib.mechanics.assembly import Assembly, FaceMaterial, Loads, Vector
from sidmacib.structure.analysis.forces import InterfaceRow, interface_forces
from sidmacib.structure.blocks import box
from sidmacib.structure.loads import acceleration, force_at
from sidmacib.structure.structure import structure
from studies.structures.shapes import arch


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
    glue = FaceMaterial(1e10, 1e10, 0.5, 5e4, 5e4)
    assembly = on_ground((0.4, 0.4, 0.8), glue)
    path = static_peak(assembly, acceleration(assembly, (1.0, 0.0, 0.0))).path
    first = next(point for point in path if point.state.bonded.all() and point.load > 0.0)
    (face,) = interface_forces(assembly, first.force, first.state)
    tension = -first.force[:, 0] / assembly.nodes.area / 5e4
    shear = np.hypot(first.force[:, 1], first.force[:, 2]) / assembly.nodes.area / 5e4
    assert face.bonded_share == 1.0
    assert face.utilisation == pytest.approx(max(tension.max(), shear.max()), rel=1e-9)
