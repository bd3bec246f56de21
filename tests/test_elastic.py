"""Joints of elastic pieces: the rigid ones' limit, exact cases, energy, convergence, memory."""

import math
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
import skfem
from conftest import scaled
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st
from joints import loaded, sawn
from skfem.models.elasticity import lame_parameters, linear_elasticity

from sidmacib import (
    Assembly,
    CapacityError,
    Elastic,
    FaceMaterial,
    Loads,
    NodeLayout,
    SolverError,
    safe,
)
from sidmacib.joint import Direction, HoldDown, Joint, Side, UpperBody
from sidmacib.joint.loading import Loading, Push, posed
from sidmacib.joint.pieces import shared_face
from sidmacib.mechanics.assembly import Cuboid, Floats, Kind
from sidmacib.mechanics.contact_law import Flags
from sidmacib.mechanics.contact_nodes import contact_nodes
from sidmacib.mechanics.elastic import ElasticSolver, memory, memory_needed
from sidmacib.mechanics.elastic.finite_elements import ElasticCuboid, Grid, Spread
from sidmacib.mechanics.elastic.jumps import OpenGaps
from sidmacib.mechanics.equilibrium import unbalanced_forces, unbalanced_share
from sidmacib.mechanics.loads import SideLoad
from sidmacib.mechanics.solution import StaticSolution
from sidmacib.mechanics.static import solver_of, static_first_failure, static_peak

YOUNG = 1e10
LAYOUTS = list(NodeLayout)
BODIES = [UpperBody.COLUMNS, UpperBody.MONOLITHIC]


def solved(joint: Joint, mesh: float, nodes: NodeLayout, e_over_a: float = 0.0) -> StaticSolution:
    return static_peak(*loaded(joint, e_over_a, mesh, nodes))


def elastic(locks: int, young: float = YOUNG, body: UpperBody = UpperBody.COLUMNS) -> Joint:
    return sawn(locks, upper_body=body, elastic=Elastic(young))


# --- the limit of stiff blocks -------------------------------------------------------------------
@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("body", BODIES)
def test_stiff_blocks_are_rigid_ones(layout: NodeLayout, body: UpperBody) -> None:
    """But for the geometry, which is followed for rigid blocks only."""
    stiff = solved(elastic(3, 1e15, body), 0.03, layout, 0.5)
    rigid = solved(sawn(3, upper_body=body), 0.03, layout, 0.5)
    assert stiff.first_failure_load == pytest.approx(rigid.first_failure_load, rel=3e-3)
    assert stiff.peak.load == pytest.approx(rigid.peak.load, rel=3e-3)
    assert stiff.peak.displacement == pytest.approx(rigid.peak.displacement, rel=3e-3)


# --- exact cases ---------------------------------------------------------------------------------


@pytest.mark.parametrize("layout", LAYOUTS)
def test_uniform_tension_passes_the_patch_test(layout: NodeLayout) -> None:
    pieces = (
        Cuboid("ground", (-0.03, 0.0, -0.02), (0.03, 0.05, 0.0), 1.0, fixed=True),
        Cuboid("block", (-0.03, 0.0, 0.0), (0.03, 0.05, 0.04), 1.0, elastic=Elastic(YOUNG, 0.0)),
    )
    material = FaceMaterial(1e10, 1e10, friction=0.0, cohesion=8e4, tensile_strength=3.7e5)
    faces = (shared_face("face", Kind.INNER, material, pieces, (0, 1)),)
    nodes = contact_nodes(faces, 0.02, layout)
    model = Assembly(pieces, faces, nodes, 0.06, mesh=0.02, layout=layout)
    variable = np.zeros((2, 6))
    variable[1, 2] = 1.0
    pull = SideLoad(1, 2, True, (0.0, 0.0, 1.0, 0.0, 0.0, 0.0))
    loads = Loads(np.zeros((2, 6)), variable, 100.0, sides=(pull,))
    start = solver_of(model, loads).start()
    found = ElasticSolver(model, loads).solve(100.0, start.unknowns, start.state)
    area = 0.06 * 0.05
    stress = -found.force[:, 0] / model.nodes.area
    assert stress == pytest.approx(np.full(len(stress), 100.0 / area), rel=1e-9)
    assert np.abs(found.force[:, 1:]).max() < 1e-9 * 100.0
    # The face's springs and the block's whole height, in series.
    assert found.displacement == pytest.approx(100.0 / area * (1e-10 + 0.04 / YOUNG), rel=1e-9)


# --- properties ----------------------------------------------------------------------------------
@hypothesis_settings(max_examples=8)
@given(
    st.integers(3, 4),
    st.sampled_from([NodeLayout.CENTRES, NodeLayout.VERTICES]),
    st.sampled_from(list(UpperBody)),
    st.floats(9.0, 12.0),
    st.sampled_from([0.0, 0.2, 1.0, math.inf]),
    st.sampled_from(Push),
)
def test_every_piece_is_in_equilibrium_at_the_peak(
    locks: int,
    layout: NodeLayout,
    body: UpperBody,
    exponent: float,
    eccentricity: float,
    push: Push,
) -> None:
    joint = elastic(locks, 10.0**exponent, body)
    model, loads = loaded(joint, eccentricity, 0.03, layout, push)
    peak = static_peak(model, loads).peak
    assert unbalanced_share(model, loads, peak.load, peak.force) < 1e-6


@pytest.mark.parametrize("factor", [1e-3, 1e3])
def test_capacity_scales_with_strength_and_stiffness_alike(factor: float) -> None:
    """Forces scale with strengths, stiffnesses and weight; displacements stay."""
    joint = elastic(3)
    other = replace(scaled(joint, 1.0, factor), elastic=Elastic(factor * YOUNG))
    one, two = (solved(each, 0.03, NodeLayout.LOBATTO, 0.5) for each in (joint, other))
    assert two.peak.load == pytest.approx(factor * one.peak.load, rel=1e-6)
    assert two.peak.displacement == pytest.approx(one.peak.displacement, rel=1e-6)


# --- elements ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("locks", "body", "expected"),
    [
        (3, UpperBody.MONOLITHIC, 234.0),
        (5, UpperBody.MONOLITHIC, 445.0),
        (3, UpperBody.COLUMNS, 234.0),
        (5, UpperBody.COLUMNS, 386.0),
    ],
)
def test_another_program_finds_the_same_loads(locks: int, body: UpperBody, expected: float) -> None:
    """Loads (N) in pure shear at mesh 0.02 m, of hexahedra of another make."""
    found = solved(elastic(locks, body=body), 0.02, NodeLayout.CENTRES)
    assert found.first_failure_load == pytest.approx(expected, rel=0.03)


def test_joined_columns_are_as_stiff_as_one_piece() -> None:
    for block in (None, Elastic(YOUNG)):
        joined, whole = (
            solved(sawn(5, upper_body=body, elastic=block), 0.02, NodeLayout.VERTICES)
            for body in (UpperBody.JOINED, UpperBody.MONOLITHIC)
        )
        assert joined.first_failure_load == pytest.approx(whole.first_failure_load, rel=5e-3)


def test_a_pair_whose_only_face_does_not_reach_the_load_carries_nothing() -> None:
    """It turns on smooth faces; the little stiffness that is added held it 700 m away, at 0.4 N."""
    dry = FaceMaterial(2.98e8, 1.6e8, 0.0, 0.0, 0.0)
    inner = FaceMaterial(1e10, 1.3e10, 0.0, 8e4, 9.24e4)
    pair = sawn(2, a=0.0382, b=0.05, h=0.01175, H=0.1645, density=29.56, inner=inner, dry=dry)
    pair = replace(pair, upper_body=UpperBody.MONOLITHIC, hold_down=HoldDown.pressure(1031.0))
    for direction in (Direction(-0.887), Direction(0.887)):
        joint = replace(pair, elastic=Elastic(2.13e11, 0.14))
        loading = Loading(direction)
        found = static_first_failure(*posed(joint, loading, joint.least_side / 2, least=2))
        assert found.point.load <= 1e-6 * joint.T0
        with pytest.raises(CapacityError, match="moves freely"):
            safe(joint, direction)


@pytest.mark.long
def test_a_joint_without_weight_that_cannot_be_solved_is_refused_and_carries_no_0_N() -> None:
    """The attack found it: 45 N with the least weight, and a mechanism at 0 N without."""
    joint = sawn(
        3,
        *(0.0358822256137526, 0.05, 0.00860082630980514, 0.08724305802660312),
        density=0.0,
        inner=FaceMaterial(1e10, 80504948.32021742, 0.0, 8e4, 302361.2937938144),
        dry=FaceMaterial(3587758198.973877, 360162955.10149163, 0.06074133697940792, 0.0, 0.0),
        upper_body=UpperBody.MONOLITHIC,
        first=Side.LOWER,
        elastic=Elastic(7037868640.542238, 0.04577574982686521),
    )
    given = (1.4500311737370246, joint.least_side / 3, NodeLayout.LOBATTO)
    with pytest.raises(SolverError, match="give them a density"):
        static_first_failure(*loaded(joint, *given))
    heavy = static_first_failure(*loaded(replace(joint, density=1.0), *given))
    assert heavy.point.load == pytest.approx(45.058, rel=1e-4)


def test_a_smooth_pressed_joint_is_solved_silently(capfd: pytest.CaptureFixture[str]) -> None:
    joint = replace(
        elastic(2, body=UpperBody.MONOLITHIC),
        hold_down=HoldDown.pressure(5e4),
        dry=replace(sawn(2).dry, friction=0.0),
    )
    assert solved(joint, 0.03, LAYOUTS[0]).peak.load == pytest.approx(225.0, rel=0.04)
    assert capfd.readouterr() == ("", "")


@pytest.mark.long
@pytest.mark.parametrize("cells", [2, 3, 4])
@pytest.mark.parametrize("layout", [NodeLayout.CENTRES, NodeLayout.VERTICES])
@pytest.mark.parametrize(
    "hold_down",
    [HoldDown.weight(), HoldDown.force(500.0), HoldDown.pressure(5e4), HoldDown.plate()],
    ids=lambda held: str(held.kind),
)
def test_stiff_rough_faces_are_at_rest(hold_down: HoldDown, layout: NodeLayout, cells: int) -> None:
    """Newton's method alone cycles on some of these meshes: there was no equilibrium at 0 N."""
    joint = sawn(
        2,
        a=0.1,
        inner=FaceMaterial(1e10, 1.05e9, 0.0, 8e4, 3.7e5),
        dry=FaceMaterial(2.3e12, 7.3e11, 0.148, 0.0, 0.0),
        upper_body=UpperBody.MONOLITHIC,
        first=Side.LOWER,
        hold_down=hold_down,
        elastic=Elastic(4.9e10),
    )
    model, loads = loaded(joint, 0.3, 0.999 * joint.b / cells, layout)
    resting = solver_of(model, loads).start()
    unbalanced = np.abs(unbalanced_forces(model, loads, 0.0, resting.force))
    assert unbalanced.max() < 1e-6 * np.abs(loads.permanent).max()
    pressed, shear = resting.force[:, 0], np.hypot(*resting.force[:, 1:].T)
    dry = np.array([face.kind is Kind.DRY for face in model.faces])[model.nodes.face]
    assert (pressed[dry] >= 0.0).all() and pressed[dry].sum() > 0.0
    assert (shear[dry] <= 0.148 * pressed[dry] * (1.0 + 1e-6) + 1e-6).all()


# --- memory --------------------------------------------------------------------------------------
def test_elastic_pieces_that_no_machine_holds_are_refused_before_anything_is_allocated() -> None:
    problem = loaded(elastic(9), 0.0, 0.002, NodeLayout.LOBATTO)
    tracemalloc.start()
    words = r"[\d,]+ components .* need [\d.]+ GiB of memory or more, and this machine has [\d.]+ "
    with pytest.raises(CapacityError, match=f"^elastic pieces with {words}GiB; .* coarser mesh$"):
        static_peak(*problem)
    assert tracemalloc.get_traced_memory()[1] < 1e9
    tracemalloc.stop()


@pytest.mark.parametrize("body", [UpperBody.COLUMNS, UpperBody.MONOLITHIC])
def test_the_memory_that_is_asked_for_is_a_close_bound(body: UpperBody) -> None:
    assembly, loads = loaded(elastic(3, body=body), 0.0, 0.02, NodeLayout.LOBATTO)
    tracemalloc.start()
    static_peak(assembly, loads)
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    needed = memory_needed(assembly, np.asarray(ElasticSolver(assembly, loads).kept))
    assert 0.4 * most < needed < 1.2 * most


def test_a_container_limits_the_memory(monkeypatch: pytest.MonkeyPatch, tmp_path) -> None:
    limit = tmp_path / "memory.max"
    monkeypatch.setattr("sidmacib.mechanics.elastic.CGROUP", limit)
    whole = memory()
    assert 1e8 < whole < math.inf
    limit.write_text("max\n")
    assert memory() == whole
    limit.write_text("1000000\n")
    assert memory() == 1e6


# --- elastic cuboids against theory and elements in three dimensions; gaps -----------------------
SIZE = np.array([0.06, 0.05, 0.027])
POISSON = 0.2


def grid(size: Floats, *cells: int) -> Grid:
    ends = zip(size, cells, strict=True)
    x, y, z = (tuple(np.linspace(-s / 2, s / 2, n + 1).tolist()) for s, n in ends)
    return x, y, z


@pytest.mark.parametrize("quadratic", [True, False])
def test_elements_are_those_of_the_library_in_3d(quadratic: bool) -> None:
    edges = grid(SIZE, 2, 1, 1)
    cuboid = ElasticCuboid(edges, POISSON, quadratic=quadratic)
    mesh = skfem.MeshHex.init_tensor(*map(np.array, edges))
    element = skfem.ElementHex2() if quadratic else skfem.ElementHex1()
    basis = skfem.Basis(mesh, skfem.ElementVector(element), intorder=4)
    whole = sp.csr_array(linear_elasticity(*lame_parameters(1.0, POISSON)).assemble(basis))
    component = np.empty(basis.N)
    for place in ("nodal", "edge", "facet", "interior"):
        dofs = getattr(basis.dofs, f"{place}_dofs")
        if dofs is not None and dofs.size:
            component[dofs] = np.arange(3)[:, None]
    # The library's degrees of freedom by place, then by component: as the cuboid has them.
    order = np.lexsort([component, *np.round(basis.doflocs, 9)[::-1]])
    assert abs(whole[order][:, order] - cuboid.stiffness).max() < 1e-12 * abs(whole).max()


@pytest.mark.parametrize("quadratic", [True, False])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_pull_gives_a_uniform_strain(quadratic: bool, axis: int) -> None:
    cuboid = ElasticCuboid(grid(SIZE, 3, 2, 1), POISSON, quadratic=quadratic)
    force = np.zeros((2, 6))
    force[0, axis], force[1, axis] = -1.0, 1.0
    pull = [Spread(tuple(row), axis, bool(high)) for high, row in enumerate(force)]
    rows = cuboid.values(np.repeat(cuboid.place[[0, -1]], 3, axis=0))
    found = cuboid.flexibility(cuboid.contact(rows, np.tile([0, 1, 2], 2)), pull)
    moved = found.by_load.sum(axis=1).reshape(2, 3)
    stress = 1.0 / (SIZE.prod() / SIZE[axis])
    strain = np.where(np.arange(3) == axis, stress, -POISSON * stress)
    assert moved[1] - moved[0] == pytest.approx(strain * SIZE, rel=1e-9)
    assert found.load.sum() == pytest.approx(stress * SIZE[axis], rel=1e-9)  # twice the energy


def test_a_load_has_its_wrench_on_any_side() -> None:
    cuboid = ElasticCuboid(grid(SIZE, 2, 2, 1), POISSON)
    wrench = (1.0, -2.0, 3.0, 0.04, 0.05, -0.06)
    for axis, high in ((None, False), (0, True), (1, False), (2, True)):
        found = cuboid.rigid.T @ cuboid.load(Spread(wrench, axis, high))
        assert found == pytest.approx(np.array(wrench))


COMPONENTS = 24


def influence(size: int = COMPONENTS) -> Floats:
    factor = np.random.default_rng(1).normal(size=(size, size))
    return np.asarray(factor @ factor.T) + np.eye(size)


def anew(matrix: Floats, gaps: Flags) -> Floats:
    """The transform by its definition: R, P and -H."""
    own = np.linalg.inv(matrix[np.ix_(gaps, gaps)])
    whole = np.empty_like(matrix)
    across = matrix[np.ix_(~gaps, gaps)]
    whole[np.ix_(gaps, gaps)] = -own
    whole[np.ix_(~gaps, gaps)] = across @ own
    whole[np.ix_(gaps, ~gaps)] = whole[np.ix_(~gaps, gaps)].T
    whole[np.ix_(~gaps, ~gaps)] = matrix[np.ix_(~gaps, ~gaps)] - across @ own @ across.T
    return whole


def test_gaps_that_open_and_close_are_as_solved_anew() -> None:
    matrix, random = influence(), np.random.default_rng(2)
    gaps = OpenGaps(matrix, np.zeros(COMPONENTS))
    for share in (0.5, 0.6, 0.6, 0.4, 0.0, 0.7):
        which = random.random(COMPONENTS) < share
        assert np.abs(gaps.opened(which) - anew(matrix, which)).max() < 1e-9


def test_more_components_come_last_and_closed() -> None:
    matrix, old = influence(), COMPONENTS - 6
    which = np.arange(COMPONENTS) % 3 == 0
    which[old:] = False
    gaps = OpenGaps(matrix[:old, :old], np.zeros(old))
    gaps.opened(which[:old])
    more = gaps.extended(matrix, np.zeros(COMPONENTS))
    assert np.abs(more.opened(which) - anew(matrix, which)).max() < 1e-9
    which[-2:] = True
    assert np.abs(more.opened(which) - anew(matrix, which)).max() < 1e-9


def test_digits_that_a_loose_piece_costs_are_won_back() -> None:
    """Two components that only the floor holds together: open, then closed again."""
    matrix = np.array([[1.0, 1.0, 0.5], [1.0, 1.0, 0.5], [0.5, 0.5, 2.0]])
    gaps = OpenGaps(matrix, np.full(3, 1e-12))
    one, both = np.array([True, False, False]), np.array([True, True, False])
    gaps.opened(one)
    gaps.opened(both)
    found = gaps.opened(one)
    assert np.abs(found - anew(matrix + 1e-12 * np.eye(3), one)).max() < 1e-11


def test_no_gap_and_nothing_but_gaps_are_no_error(capfd: pytest.CaptureFixture[str]) -> None:
    """LAPACK prints its errors itself, about a matrix of no rows too."""
    matrix = influence()
    for first, then in ((True, False), (False, True)):
        gaps = OpenGaps(matrix, np.zeros(COMPONENTS))
        for whole in (first, then):
            which = np.full(COMPONENTS, whole)
            gaps.accurate = False  # so that it is computed from the start
            assert np.abs(gaps.opened(which) - anew(matrix, which)).max() < 1e-9
    assert capfd.readouterr() == ("", "")
