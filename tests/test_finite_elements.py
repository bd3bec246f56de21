"""Elastic cuboids against theory and elements in three dimensions; gaps that open and close."""

import numpy as np
import pytest
import scipy.sparse as sp
import skfem
from skfem.models.elasticity import lame_parameters, linear_elasticity

from sidmacib.mechanics.assembly import Floats
from sidmacib.mechanics.contact_law import Flags
from sidmacib.mechanics.elastic.finite_elements import ElasticCuboid, Grid, Spread
from sidmacib.mechanics.elastic.jumps import OpenGaps

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
