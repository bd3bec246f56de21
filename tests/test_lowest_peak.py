"""The lowest peak: searches that start elsewhere, where friction leaves several equilibria."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import a_case
from joints import sawn

from sidmacib import lowest_peak, static_peak
from sidmacib.joint import INNER, Direction, Elastic, Joint, UpperBody
from sidmacib.joint.loading import Loading, posed
from sidmacib.mechanics.assembly import FaceMaterial, Failure, NodeLayout
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.contact_law.kernels import utilisation
from sidmacib.mechanics.equilibrium import placed, unbalanced_share
from sidmacib.mechanics.solution import StaticSolution
from sidmacib.mechanics.static import peaks as module
from sidmacib.mechanics.static.peaks import LOWER, MOST, MOST_ELASTIC, STARTS, FromElsewhere
from sidmacib.models.static import solve
from workflow.results.joint_part import JointRecord
from workflow.solve import solved

# Of 11 locks at e = a on a fine mesh: a long cascade.
LONG = posed(sawn(11), Loading(Direction(1.0)), 0.0124875)


@pytest.fixture(scope="module")
def far() -> StaticSolution:
    return lowest_peak(*LONG)


# --- what is found -------------------------------------------------------------------------------
def test_a_peak_is_found_below_that_of_the_first_path(far: StaticSolution) -> None:
    first = static_peak(*LONG)
    assert first.peak.load == pytest.approx(167.3, rel=1e-3)
    assert far.peak.load == pytest.approx(155.9, rel=5e-3)
    assert far.spread == pytest.approx(first.peak.load / far.peak.load - 1.0, abs=1e-3)
    assert far.first_failure_load == first.first_failure_load


@pytest.mark.long
def test_the_lowest_peak_stays_where_last_digits_of_the_input_change(far: StaticSolution) -> None:
    assembly, loads = LONG
    nodes = assembly.nodes
    change = 1e-9 * np.random.default_rng(0).uniform(-1.0, 1.0, len(nodes.area))
    nearly = replace(assembly, nodes=replace(nodes, area=nodes.area * (1.0 + change)))
    assert lowest_peak(nearly, loads).peak.load == pytest.approx(far.peak.load, rel=5e-3)


def test_the_lowest_peak_is_one_of_equilibria_that_obey_the_same_laws(far: StaticSolution) -> None:
    assembly, loads = LONG
    law = ContactLaw.of(assembly)
    for point in far.path[1:]:
        motion = placed(assembly, point.unknowns)
        assert unbalanced_share(assembly, loads, point.load, point.force, motion) < 1e-6
        assert utilisation(law, point.state, point.force).max() < 1.0 + 1e-9
    assert [point.load for point in far.path] == sorted(point.load for point in far.path)


def test_a_peak_that_newtons_method_alone_misses_is_found() -> None:
    """Nine tall locks in one piece: another solver has 512.6 N, Newton's method alone 421 N."""
    joint = sawn(
        *(9, 0.1119038, 0.05, 0.0291186, 0.0236134),
        inner=replace(INNER, shear_stiffness=1.40776e10),
        dry=FaceMaterial(1.539137e9, 1.539137e9, 0.256094, 0.0, 0.0),
        upper_body=UpperBody.MONOLITHIC,
    )
    found = lowest_peak(*posed(joint, Loading(Direction(0.3)), 0.04995))
    assert found.peak.load == pytest.approx(512.6, rel=0.02)
    assert found.spread < 0.02


# --- how long it is sought -----------------------------------------------------------------------
@pytest.mark.parametrize("joint", [sawn(5), sawn(5, failure=Failure.DUCTILE)])
def test_no_lower_peak_is_sought_in_vain(joint: Joint, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "another_peak", None)
    assert lowest_peak(*posed(joint, Loading(Direction(0.0)), 0.02)).spread == 0.0


def sought(
    peaks: list[float], monkeypatch: pytest.MonkeyPatch, cost: int = 1, joint: Joint | None = None
) -> tuple[StaticSolution, int]:
    """The lowest peak if each start finds one of ``peaks``, over the first; and how many did."""
    starts = 0

    def found(_, searches: FromElsewhere, first: StaticSolution) -> StaticSolution:
        nonlocal starts
        share = peaks[min(starts, len(peaks) - 1)]
        starts, searches.number = starts + 1, cost
        peak = replace(first.peak, load=share * first.peak.load)
        below = (point for point in first.path if point.load < peak.load)
        return replace(first, path=(*below, peak))

    monkeypatch.setattr(module, "another_peak", found)
    lowest = lowest_peak(*posed(joint or sawn(5), Loading(Direction(0.5)), 0.04))
    return lowest, starts


def test_the_search_ends_after_ten_starts_without_a_lower(monkeypatch: pytest.MonkeyPatch) -> None:
    same, starts = sought([1.0], monkeypatch)
    assert (starts, same.spread) == (STARTS, 0.0)
    lower, starts = sought([1.0, 1.1, 0.9, 1.0], monkeypatch)
    assert starts == 3 + STARTS
    assert lower.peak.load == pytest.approx(0.9 * same.peak.load)
    assert lower.spread == round(1.1 / 0.9 - 1.0, 4)
    assert sought([1.0, 1.0 - 0.9 * LOWER], monkeypatch)[1] == STARTS


def test_the_search_ends_after_so_many_searches(monkeypatch: pytest.MonkeyPatch) -> None:
    assert sought([1.0], monkeypatch, cost=MOST // 3)[1] == 4
    joint = sawn(3, elastic=Elastic(1e10, 0.2))
    whole, starts = sought([1.0], monkeypatch, 1000, joint)
    assert starts == 1
    monkeypatch.undo()
    assert sought([1.0], monkeypatch, MOST_ELASTIC * len(whole.path) // 2, joint)[1] <= 3


# --- reported peaks ------------------------------------------------------------------------------
def test_a_record_has_lowest_peak_spread_and_first_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    case = a_case("static", sawn(5), Loading(Direction(0.5)), 0.02, NodeLayout.LOBATTO)
    first = solved(case, solve)[0]
    assert first.load_N is not None and first.peak_spread == 0.0
    sought([0.97], monkeypatch)
    found = solved(case, solve)[0]
    assert found.load_N == found.peak_N == found.path[-1][0] == pytest.approx(0.97 * first.load_N)
    assert found.first_failure_load_N == first.first_failure_load_N
    assert found.peak_spread == round(1.0 / 0.97 - 1.0, 4)
    assert JointRecord.from_json(found.to_json()) == found
