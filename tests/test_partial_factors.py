"""Partial factors on a structure, against statics by hand."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from command_runner import assembly
from structures import CUBE, DOWN, PUSH, WEIGHT, condensed_keys

import sidmacib
from sidmacib import PartialFactors, limit_load
from sidmacib.scene.forces import load_of
from sidmacib.structure.files.structure_file import demands_of

SLIDES: dict[str, Any] = {**CUBE, "load": {**PUSH, "newtons": "4kN"}}
FRICTION = 0.5


def carried(description: Any, factors: PartialFactors) -> tuple[float, float]:
    """What limit analysis finds, and what is to be carried, in N."""
    (demand,) = demands_of(description, factors=factors)
    assert demand.newtons
    return limit_load(*demand.problem, friction=True).load, demand.newtons


def test_weight_friction_and_load_have_their_factors() -> None:
    found = carried(SLIDES, PartialFactors(gamma_g=0.9, gamma_q=1.5, gamma_m=1.2))
    assert found == pytest.approx((0.9 * WEIGHT * FRICTION / 1.2, 1.5 * 4000.0), rel=1e-6)


def test_permanent_loads_have_the_factor_of_weight() -> None:
    pressed = {**SLIDES, "permanent": [{"force": {**DOWN["force"], "newtons": "5kN"}}]}
    found, _ = carried(pressed, PartialFactors(gamma_g=1.35))
    assert found == pytest.approx(1.35 * (WEIGHT + 5e3) * FRICTION, rel=1e-6)


def test_a_permanent_load_may_have_a_factor_of_its_own(tmp_path: Path) -> None:
    force = {**DOWN["force"], "newtons": "5kN"}
    pressed = {**SLIDES, "permanent": [{"force": {**force, "gamma_g": 0.5}}, {"force": force}]}
    for gamma in (1.0, 1.35):
        found, _ = carried(pressed, PartialFactors(gamma_g=gamma))
        expected = (gamma * (WEIGHT + 5e3) + 0.5 * 5e3) * FRICTION
        assert found == pytest.approx(expected, rel=1e-6)
    note = tmp_path / "note.html"
    given = "--gamma-g", "1.35", "--note", str(note)
    told = assembly(tmp_path / "cube.yaml", pressed, *given).stderr
    assert "Note: permanent.1.force: is multiplied by its own gamma_g, 0.5" in told
    (row,) = (line for line in note.read_text().splitlines() if "Other permanent loads" in line)
    assert f"{1.35 * 5e3 + 0.5 * 5e3:g} N" in row
    assembly(tmp_path / "cube.yaml", pressed, "--note", str(note))
    words = "No partial factors are applied, but those that permanent loads have of their own."
    assert words in note.read_text()
    force["gamma_g"] = 0
    with pytest.raises(ValueError, match=r"permanent\.2\.force\.gamma_g: 0 is not allowed"):
        demands_of(pressed)


def test_strengths_and_friction_are_divided_and_stiffness_is_not() -> None:
    laws = {"friction": 0.6, "cohesion": "12kPa", "tensile_strength": "6kPa"}
    (demand,) = demands_of({**SLIDES, "interfaces": {**laws, "compressive_strength": "3MPa"}})
    (face,) = demand.factored(PartialFactors(gamma_m=1.5)).problem.assembly.faces
    (given,) = demand.problem.assembly.faces
    law: Any = face.material
    assert (law.friction, law.cohesion, law.tensile_strength) == pytest.approx((0.4, 8e3, 4e3))
    assert law.compressive_strength == pytest.approx(2e6)
    assert law.normal_stiffness == given.material.normal_stiffness


def test_more_weight_is_no_load_beside_it() -> None:
    (demand,) = demands_of(SLIDES)
    factored = demand.factored(PartialFactors(gamma_g=1.35))
    assert load_of(factored.problem) == load_of(demand.problem)


def test_without_factors_nothing_changes() -> None:
    (demand,) = demands_of(SLIDES)
    assert demand.factored(PartialFactors()) is demand


def test_the_answer_says_the_factors_it_is_computed_with(tmp_path: Path) -> None:
    given = "--gamma-g", "0.9", "--gamma-q", "1.5", "--gamma-m", "1.2"
    note = tmp_path / "note.html"
    found = assembly(
        tmp_path / "cube.yaml", SLIDES, *given, "--format", "json", "--note", str(note)
    )
    answer = json.loads(found.stdout)
    words = "with gamma_G = 0.9, gamma_Q = 1.5, gamma_M = 1.2"
    assert answer["answer"] == f"Yes: it carries 6000 N with a factor of 1.23; {words}"
    assert [answer[f"gamma_{symbol}"] for symbol in "GQM"] == [0.9, 1.5, 1.2]
    assert answer["required_N"] == 6000.0
    assert answer["deciding_factor"] == pytest.approx(0.9 * WEIGHT * FRICTION / 1.2 / 6e3, rel=1e-3)
    (solved,) = sidmacib.ask(SLIDES, factors=PartialFactors(0.9, 1.5, 1.2)).values()
    assert str(solved.verdict) == answer["answer"]
    assert "No partial factors" not in note.read_text() and words in note.read_text()


@pytest.mark.parametrize(
    ("description", "options", "message"),
    [
        ({**CUBE, "load": PUSH}, ("--gamma-q", "1.5"), "gamma_Q: needs a load that is to be carri"),
        (SLIDES, ("--reserve", "--gamma-m", "1.2"), "gamma_M: needs a load that is to be carried"),
        (SLIDES, ("--gamma-m", "0.9"), "--gamma-m: '0.9' is not allowed; it must be from 1 to 10"),
        (SLIDES, ("--gamma-g", "0"), "--gamma-g: '0' is not allowed; it must be greater than 0"),
    ],
)
def test_factors_without_a_load_to_carry_and_out_of_range_are_refused(
    tmp_path: Path, description: Any, options: tuple[str, ...], message: str
) -> None:
    found = assembly(tmp_path / "cube.yaml", description, *options)
    assert found.exit_code == 2
    assert message in found.output


def test_condensed_locks_have_no_factor_of_the_material() -> None:
    (demand,) = demands_of(condensed_keys())
    with pytest.raises(
        ValueError, match=r"gamma_M: 1\.2 is not allowed; it must be 1 for condensed"
    ):
        replace(demand, newtons=1.0).factored(PartialFactors(gamma_m=1.2))
