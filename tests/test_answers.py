"""One question has one answer: which load of a structure counts, at every door, and why."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from campaigns.peaks import block, outcome
from command_runner import assembly, by_model
from conftest import ROOT
from structures import FILES, read_structure, study

import sidmacib
from analysis.report.structures import structures_verdict
from analysis.summary.structures import summary
from analysis.tables.structures import counted, structures_table
from sidmacib.answers import structure
from sidmacib.answers.structure import static_answer
from sidmacib.answers.structure_paths import followed, without_other_meshes
from sidmacib.errors import DOES_NOT_STAND, CapacityError, NoEquilibriumError
from sidmacib.mechanics.static import static_peak
from sidmacib.mesh_error import SETTLED
from sidmacib.models import structure_limit, structure_static
from sidmacib.problem import FIRST_FAILURE, PEAK, Counts, Failures
from sidmacib.structure.analysis.tilt import static_tilt
from sidmacib.structure.files.structure_file import structure_of
from sidmacib.structure.structure import refined
from workflow.case import Case, StructureSubject
from workflow.results import Record, record_without_result
from workflow.results.structure_part import StructureRecord
from workflow.solve import solved_or_not

CASES = ROOT / "tests/cases"
SOLVE = {"static": structure_static.solve, "limit": structure_limit.solve}


def record_of(description: dict[str, Any], model: str = "static") -> StructureRecord:
    case = Case("s-load", model, "reference", StructureSubject("s", "load", description), None)
    found = solved_or_not(case, SOLVE[model])
    return found if isinstance(found, Record) else found[0]


@pytest.mark.long
@pytest.mark.parametrize("name", FILES)
def test_a_file_has_the_same_load_at_every_door(name: str, path: Path) -> None:
    description = FILES[name]
    answer, printed = static_answer(structure_of(description)), by_model(path, description)
    table = structures_table([record_of(description), record_of(description, "limit")])
    row = table.set_index("model").loc["static"]
    limit = table.set_index("model").loc["limit"]
    assert printed["static"]["load_N"] == pytest.approx(answer.load, rel=1e-9)
    assert printed["static"]["peak_N"] == pytest.approx(row["peak_N"], rel=1e-9)
    assert row["load_N"] == pytest.approx(answer.load, rel=1e-9)
    assert (row["counts"], row["because"]) == (answer.counts.name, answer.counts.why)
    assert printed["limit"]["load_N"] == pytest.approx(limit["load_N"], rel=1e-6)
    assert f"{answer.load:.5g}" in summary("results", table)
    assert f"{answer.load:.4g} N" in structures_verdict(table)[0]["text"]
    assert row["load_N"] <= row["peak_N"] and row["first_failure_load_N"] <= row["peak_N"]


def test_the_first_failure_counts_where_meshes_disagree_on_the_peak() -> None:
    answer = static_answer(structure_of(FILES["bonded block"]))
    assert answer.counts.name == FIRST_FAILURE and "not converged" in answer.counts.why
    assert answer.load == answer.state.load == pytest.approx(2150.436, rel=1e-4)
    assert answer.failures.peak > 1.1 * answer.load


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "same"), [("bonded arch", "arch/arch"), ("mortar wall", "wall/wall")]
)
def test_mortar_does_not_weaken_dry_joints(name: str, same: str) -> None:
    """Where meshes disagree on the peak of bonds that fail early, that of dry joints counts."""
    answer = static_answer(structure_of(FILES[name]))
    dry = static_answer(structure_of(study(same)))
    assert answer.failures.first < 0.8 * dry.load
    assert answer.load == answer.state.load == pytest.approx(dry.load, rel=1e-3)
    assert answer.counts.name == "peak of dry joints"
    assert answer.counts.why.startswith("with bonds, peak not converged")


@pytest.mark.long
def test_a_peak_counts_where_three_meshes_agree_or_no_bond_fails_before() -> None:
    answer = static_answer(structure_of(FILES["trilith"]))
    assert answer.counts == Counts(peak=True, why="three meshes agree on the peak")
    assert answer.load == answer.failures.peak > 4.0 * answer.failures.first
    assert answer.spread == 0.0
    dry = static_answer(structure_of(FILES["dry wall"]))
    assert dry.counts == Counts(peak=True, why="no bond fails before the peak")


@pytest.mark.long
@pytest.mark.parametrize("name", ["rocks_about_a_corner", "slides_turned"])
def test_meshes_that_agree_by_chance_are_found_by_limit_analysis(name: str) -> None:
    problem = read_structure(CASES / f"{name}.yaml")
    found, fine = static_answer(problem), refined(problem.assembly, 24)
    if problem.loads.raised.axis:
        expected = static_tilt(fine, problem.loads).angle
    else:
        expected = static_peak(fine, problem.loads).peak.load
    assert found.load == pytest.approx(expected, rel=0.006)
    if name == "slides_turned":  # a face on few cells resists more torque
        coarse = followed(refined(problem.assembly, 1), problem.loads)
        assert found.load < 0.96 * coarse.failures.peak


def test_a_structure_that_falls_alone_is_said_to(path: Path) -> None:
    falls = study("arch/arch", friction=0.1)
    for load in ({}, {"load": {"tilt": {"axis": [0, 1, 0]}}}):
        with pytest.raises(NoEquilibriumError, match=f"^{DOES_NOT_STAND}$"):
            static_answer(structure_of(falls | load))
    record = record_of(falls)
    assert (record.refused, record.error) == (f"static: {DOES_NOT_STAND}", None)  # an answer
    found = assembly(path, falls, "--format", "json")
    assert (found.exit_code, json.loads(found.stdout)["rows"][-1]["note"]) == (1, DOES_NOT_STAND)


def test_a_peak_that_depends_on_the_mesh_does_not_count() -> None:
    with pytest.raises(CapacityError, match="alone, and peak not converged"):
        static_answer(read_structure(CASES / "leans_on_a_corner.yaml"))


# --- engines -------------------------------------------------------------------------------------
def engine(name: str, peak: float, first: float | None) -> StructureRecord:
    case = Case("s-load", name, "reference", StructureSubject("s", "load", {}), None)
    record = record_without_result(case)
    return replace(record, load_N=peak, peak_N=peak, first_failure_load_N=first)


@pytest.mark.long
def test_an_engine_has_the_load_that_counts_in_the_static_model() -> None:
    static = record_of(FILES["bonded block"])
    found = counted(engine("yade", 3329.0, 416.0), static)
    assert (found.load_N, found.peak_N, found.part.counts) == (416.0, 3329.0, FIRST_FAILURE)
    assert found.part.mesh_error == static.part.mesh_error
    assert found.part.because == static.part.because
    dry = counted(engine("yade", 3329.0, 416.0), record_of(FILES["bonded arch"]))
    assert (dry.load_N, dry.part.counts) == (416.0, FIRST_FAILURE)  # it has bonds
    settled = counted(engine("yade", 7850.0, 1599.0), record_of(FILES["trilith"]))
    assert (settled.load_N, settled.part.counts) == (7850.0, PEAK)


@pytest.mark.long
def test_an_engine_has_the_mesh_error_of_the_cells_of_the_file() -> None:
    static = record_of(FILES["trilith"])
    above = 1.5  # on the cells of the file, over the load on smaller ones
    coarse = replace(static.part, given_peak_N=above * static.peak_N, mesh_error=0.02)
    found = counted(engine("yade", 9000.0, None), replace(static, part=coarse))
    assert found.part.mesh_error == pytest.approx(0.02 + above - 1.0)


def test_engines_are_compared_with_the_static_model_on_their_own_cells() -> None:
    static = record_of(FILES["bonded block"])
    yade = engine("yade", 3329.0, 416.0)
    table = structures_table([static, replace(yade, physics=static.physics)])
    row = table.set_index("model").loc["yade"]
    assert row["static_load_N"] == static.part.given_first_failure_N
    assert row["difference_to_static"] == pytest.approx(416.0 / row["static_load_N"] - 1.0)


@pytest.mark.long
def test_limit_analysis_is_compared_with_the_static_load_on_the_smallest_cells() -> None:
    static = record_of(FILES["trilith"])
    coarse = replace(static, part=replace(static.part, given_peak_N=1.5 * static.peak_N))
    limit = replace(engine("limit", 0.99 * static.peak_N, None), physics=static.physics)
    row = structures_table([coarse, limit]).set_index("model").loc["limit"]
    assert row["difference_to_static"] == pytest.approx(-0.01)


@pytest.mark.parametrize(("first", "counts"), [(400.0, FIRST_FAILURE), (None, PEAK)])
def test_an_engines_peak_alone_counts_if_no_bond_fails(first: float | None, counts: str) -> None:
    found = counted(engine("yade", 900.0, first), None)
    assert found.part.counts == counts and found.load_N == (first or 900.0)
    assert without_other_meshes(Failures(900.0, 900.0)).peak


@pytest.mark.long
# --- mesh errors ---------------------------------------------------------------------------------
def test_loads_of_random_blocks_are_within_their_mesh_errors() -> None:
    found = [outcome(block(np.random.default_rng(seed))) for seed in range(20)]
    assert sum(each.peak for each in found) >= 4  # so that the test is one of peaks, too
    assert sum(each.change > each.error for each in found) <= 1
    assert max(each.error for each in found) <= SETTLED


@pytest.mark.long
def test_a_notebook_shows_the_verdict_or_both_loads() -> None:
    cases = sidmacib.ask(ROOT / "studies/structures/retaining.yaml")
    assert repr(cases["crowd"]) == f"<{cases['crowd'].verdict}>"
    (alone,) = sidmacib.ask(ROOT / "studies/structures/trilith.yaml").values()
    told = (f"{each.model}: {each.value:.0f} N" for each in (alone.of_limit, alone.of_static))
    assert repr(alone) == f"<{'; '.join(told)}>"


def test_more_blocks_than_a_path_can_follow_are_told_so_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(structure, "MOST_BLOCKS", 0)
    found = by_model(tmp_path / "trilith.yaml", study("structures/trilith"))
    assert found["limit"]["load_N"] > 0
    assert found["static"]["note"] == "3 free blocks; the path of at most 0 is followed"
