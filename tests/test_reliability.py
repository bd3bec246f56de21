"""Locks whose strengths scatter; characteristic and design resistance of a joint."""

import json
import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from chromium import needs_browser
from command_runner import run as command
from joints import sawn
from scipy.stats import binom, lognorm

import sidmacib
from sidmacib import characteristic, design_resistance
from sidmacib.joint import INNER, Direction, Hold, HoldDown, Joint, OwnLock
from sidmacib.joint.loading import Loading, posed
from sidmacib.mechanics.solution import Mode
from sidmacib.mechanics.static import first_failure_of, solver_of
from sidmacib.quantities import rounded
from sidmacib.rule import COARSE, first_failure, safe_at_most, weakened
from sidmacib.rule.reliability import Reliability, Scatter, scatter

PURE_SHEAR = Direction(0.0)


def strengths(variation: float, shape: tuple[int, ...]) -> np.ndarray:
    """Lognormal strengths of mean 1."""
    deviation = math.sqrt(math.log1p(variation**2))
    random = np.random.default_rng(7)
    return random.lognormal(-(deviation**2) / 2.0, deviation, shape)


@pytest.mark.parametrize("share", [0.001, 0.05, 0.5, 0.99])
@pytest.mark.parametrize("variation", [0.05, 0.3])
def test_one_lock_has_the_quantiles_of_its_strength(variation: float, share: float) -> None:
    scattered = Scatter(100.0, np.array([1.0]), variation)
    deviation = math.sqrt(math.log1p(variation**2))
    expected = 100.0 * lognorm.ppf(share, deviation, scale=math.exp(-(deviation**2) / 2.0))
    assert scattered.quantile(share) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("share", [0.05, 0.5])
def test_quantiles_are_those_of_many_joints(share: float) -> None:
    scattered = scatter(sawn(7), Direction(0.2), 0.2)
    assert len(scattered.utilisation) == 7 + 6  # roots and cuts
    drawn = (strengths(0.2, (40_000, 13)) / scattered.utilisation).min(axis=1) * scattered.load
    assert scattered.quantile(share) == pytest.approx(np.quantile(drawn, share), rel=5e-3)


@pytest.mark.parametrize(
    ("variation", "share", "name"),
    [*((0.2, share, "share") for share in (0.0, 1.0, -1.0)), (0.0, 0.5, "variation")],
)
def test_quantiles_of_nothing_are_refused(variation: float, share: float, name: str) -> None:
    with pytest.raises(ValueError, match=name):
        scatter(sawn(3), PURE_SHEAR, variation).quantile(share)


ECCENTRIC = Direction(0.3)
JOINT = sawn(5, a=0.08, H=0.06)
PRESSED = replace(JOINT, hold_down=HoldDown(Hold.PRESSURE, 4e4))


@pytest.mark.long
@pytest.mark.parametrize("joint", [JOINT, PRESSED], ids=["plate", "pressure"])
def test_five_of_a_hundred_drawn_joints_fail_below_the_characteristic_value(joint: Joint) -> None:
    """By the static model, of joints whose locks differ in strength."""
    count, failed, bond = 120, 0, joint.inner
    load = characteristic(joint, ECCENTRIC, 0.2).capacity.load
    for factors in strengths(0.2, (count, joint.locks)).tolist():
        own = {}
        for lock, factor in zip(joint.numbers, factors, strict=True):
            cohesion, tension = bond.cohesion * factor, bond.tensile_strength * factor
            own[lock] = OwnLock(inner=replace(bond, cohesion=cohesion, tensile_strength=tension))
        drawn = replace(joint, different=own)
        assembly, loads = posed(drawn, Loading(ECCENTRIC), joint.least_side / COARSE)
        failed += first_failure_of(solver_of(assembly, loads)).point.load < load
    least, most = binom.interval(0.99, count, 0.05)
    assert least <= failed <= most


def test_with_forces_in_proportion_it_is_the_quantile_of_the_weakest_lock() -> None:
    weightless = replace(JOINT, density=0.0)
    found, whole = (f(weightless, ECCENTRIC, 0.2) for f in (characteristic, scatter))
    assert found.capacity.load == pytest.approx(whole.quantile(), rel=1e-3)
    weak = first_failure(weakened(weightless, found.margin), Loading(ECCENTRIC))
    assert found.capacity.load == weak.load


def test_cuts_between_columns_scatter_too() -> None:
    """20,000 joints drawn with stresses of the intact path have 220.7 N; their mean is 340 N."""
    bond = replace(INNER, cohesion=3e5, tensile_strength=2e5)
    joint = sawn(5, inner=bond)
    state = first_failure(joint, Loading(ECCENTRIC))
    assert 2.0 * state.utilisation.max() < state.cuts.max() == pytest.approx(1.0, abs=1e-4)
    found = characteristic(joint, ECCENTRIC, 0.25).capacity.load
    assert found == pytest.approx(220.7, rel=0.01)


def test_more_scatter_gives_less() -> None:
    loads = [characteristic(JOINT, ECCENTRIC, v).capacity.load for v in (0.01, 0.1, 0.2, 0.4)]
    assert loads == sorted(loads, reverse=True)
    assert loads[0] == pytest.approx(sidmacib.law(JOINT, ECCENTRIC).load, rel=0.03)


def test_where_the_joint_slides_first_strengths_do_not_decide() -> None:
    smooth = replace(JOINT.dry, friction=0.0)
    loose = sawn(2, h=0.004, dry=smooth, hold_down=HoldDown(Hold.WEIGHT))
    law = sidmacib.law(loose, Direction(0.0))
    assert law.mode is Mode.APART
    assert characteristic(loose, Direction(0.0), 0.05).capacity == law


def test_strengths_that_are_design_values_leave_the_safe_load() -> None:
    safe = sidmacib.safe(JOINT, ECCENTRIC)
    assert design_resistance(JOINT, ECCENTRIC, Reliability()) == safe


@pytest.mark.parametrize("joint", [JOINT, PRESSED], ids=["plate", "pressure"])
def test_the_factor_divides_resistance_or_strengths_whichever_gives_less(joint: Joint) -> None:
    found = design_resistance(joint, ECCENTRIC, Reliability(partial_factor=1.5)).load
    of_resistance = sidmacib.safe(joint, ECCENTRIC).load / 1.5
    of_strengths = sidmacib.safe(weakened(joint, 1.5), ECCENTRIC).load
    assert found == min(of_resistance, of_strengths)


def test_the_design_resistance_is_below_the_characteristic_value_over_the_factor() -> None:
    reliability = Reliability(0.2, 1.5)
    found = design_resistance(JOINT, ECCENTRIC, reliability).load
    whole = characteristic(JOINT, ECCENTRIC, 0.2).capacity.load
    assert 0.85 * whole / 1.5 < found <= whole / 1.5 / 1.05
    assert found <= safe_at_most(JOINT, ECCENTRIC) / reliability.partial_factor


@pytest.mark.parametrize("given", [(20.0, 1.0), (-0.1, 1.0), (float("nan"), 1.0), (0.2, 0.9)])
def test_what_is_no_scatter_or_no_partial_factor_is_refused(given: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match="is not allowed; it must be"):
        Reliability(*given)


# --- in the command, and its calculation note ----------------------------------------------------
GIVEN = ["-n", "9", "-a", "0.08", "-H", "0.06", "-e", "0.3"]
NINE, DIRECTION = sidmacib.Joint(9, a=0.08, H=0.06), sidmacib.Direction(0.3)


def run(*words: str, code: int = 0) -> str:
    found = command(*words)
    assert found.exit_code == code, found.output
    return found.output


def note_in(path: Path, *words: str) -> str:
    run(*words, "--note", str(path))
    return path.read_text(encoding="utf-8")


def test_capacity_prints_characteristic_value_and_design_resistance() -> None:
    options = ["-m", "law", "--scatter", "0.2", "--gamma-m", "1.5"]
    rows = json.loads(run("capacity", *GIVEN, *options, "--format", "json"))["rows"]
    loads = {row["model"]: row["V_N"] for row in rows}
    assert list(loads) == ["law", "characteristic", "design"]
    found = sidmacib.characteristic(NINE, DIRECTION, 0.2)
    assert loads["characteristic"] == rounded(found.capacity.shear)
    design = sidmacib.design_resistance(NINE, DIRECTION, Reliability(0.2, 1.5))
    assert loads["design"] == rounded(design.shear)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ([], "Strengths are taken as design values"),
        (["--gamma-m", "1.5"], "Strengths are taken as characteristic values"),
        (["--scatter", "0.2"], "Strengths are means with a scatter of 20 %; no gamma_M is given"),
        (["--scatter", "0.2", "--gamma-m", "1.3"], "Strengths are means with a scatter of 20 %."),
    ],
)
def test_the_last_lines_say_what_strengths_and_blocks_are_taken_for(
    options: list[str], words: str
) -> None:
    asked = "capacity", "-n", "3", "-m", "law", *options
    *_, strengths, block = run(*asked, "--upper-body", "columns").splitlines()
    assert strengths.startswith(words)
    assert block == "The upper block is cut into columns, as in the paper."
    assert run(*asked).splitlines()[-1].startswith(words)


def test_the_number_of_locks_is_found_by_the_design_resistance() -> None:
    options = ["--scatter", "0.2", "--gamma-m", "1.5", "--format", "json"]
    rows = json.loads(run("joint", "-V", "150", *GIVEN[2:], *options))["rows"]
    reliability = Reliability(0.2, 1.5)
    for row in rows:
        joint = sidmacib.Joint(row["locks"], a=0.08, H=0.06)
        shear = sidmacib.design_resistance(joint, DIRECTION, reliability).shear
        assert (row["note"] == "strong enough") == (shear >= 150.0)
        assert row["design_V_N"] in (None, rounded(shear))
    assert rows[-1]["note"] == "strong enough"


@pytest.mark.long
@pytest.mark.parametrize(
    ("options", "shear", "by"),
    [
        ([], "300N", "the safe rule"),
        (["--scatter", "20%"], "300N", "the design resistance"),
        (["--scatter", "0.2", "--gamma-m", "1.5"], "140N", "the design resistance"),
        (["-m", "law"], "400N", "the law"),
    ],
)
def test_capacity_answers_as_joint(options: list[str], shear: str, by: str, tmp_path: Path) -> None:
    words = [*GIVEN[:-2], *options, "-V", shear, "-e", "0.3"]
    found = command("capacity", *words)
    verdict, *_ = found.output.splitlines()
    factor = float(re.search(r"factor (?:of|is) (\S+) by ", verdict)[1])
    assert verdict.endswith(f" by {by}")
    assert verdict.startswith("Yes: it carries V = " if factor >= 1 else "No: it does not carry V")
    assert found.exit_code == (factor < 1.0)
    if "-m" in options:
        return
    ended = command("joint", *words[2:], "--vary", "locks=9", "--all", "--format", "json")
    (row,) = json.loads(ended.stdout.partition("Error")[0])["rows"]
    usage = next(value for name, value in row.items() if name.startswith("required_over_"))
    assert usage is None or factor == pytest.approx(1 / usage, rel=5e-3)
    note = tmp_path / "note.html"
    command("capacity", *words, "--note", str(note))
    noted = float(re.search(r"Utilisation (\S+):", note.read_text())[1])
    assert noted == pytest.approx(1 / factor, rel=5e-3)


@pytest.mark.long
def test_the_note_has_the_numbers_of_the_library(tmp_path: Path) -> None:
    options = ["-m", "law", "--scatter", "0.2", "--gamma-m", "1.5"]
    note = note_in(tmp_path / "note.html", "capacity", *GIVEN, *options)
    design = sidmacib.design_resistance(NINE, DIRECTION, Reliability(0.2, 1.5))
    whole = sidmacib.characteristic(NINE, DIRECTION, 0.2).capacity
    shown = f"Design resistance: V = {design.shear:.4g} N, M = {design.torque:.4g} N m"
    assert shown in note
    assert f"V = {whole.shear:.4g} N" in note
    assert f"<mn>{NINE.T0:.4g}</mn>" in note
    for size in ("b = 50", "H = 60", "h = 8", "a = 80"):
        assert size in note
    assert "multilock 1." in note and "No laboratory test" in note
    held = "what holds the joint down</td><td>pressure of 20000</td><td>Pa"
    pressed = "--hold-down", "pressure:20kPa"
    assert held in note_in(tmp_path / "note.html", "capacity", *GIVEN, *options, *pressed)
    note = note_in(tmp_path / "note.html", "capacity", *GIVEN, *options, "--units", "kN")
    shown = f"V = {design.shear / 1e3:.4g} kN, M = {design.torque:.4g} N m"
    assert f"Design resistance: {shown}" in note


def test_a_joint_that_was_sought_has_a_note_with_its_utilisation(tmp_path: Path) -> None:
    words = ["joint", "-V", "300", *GIVEN[2:]]
    rows = json.loads(run(*words, "--format", "json"))["rows"]
    note = note_in(tmp_path / "note.html", *words)
    assert f"Utilisation {rows[-1]['required_over_safe']:.3f}: verified" in note


@pytest.mark.parametrize("ratio", ["0", "torsion", "-0.4"])
def test_the_note_is_well_formed_whole_and_the_same_each_time(tmp_path: Path, ratio: str) -> None:
    words = ["capacity", "-n", "4", "-m", "law", "-e", ratio]
    first = note_in(tmp_path / "note.html", *words)
    assert first == note_in(tmp_path / "note.html", *words)
    assert not re.search(r"(src|href)=|url\(|@import", first)
    for kind in ("svg", "math"):
        for part in re.findall(rf"<{kind}.*?</{kind}>", first, re.DOTALL):
            ElementTree.fromstring(part)


@pytest.mark.study
@needs_browser
def test_the_note_prints_on_two_pages_and_fits_a_telephone(tmp_path: Path, browser: Any) -> None:
    path = tmp_path / "note.html"
    note_in(path, "capacity", *GIVEN, "-m", "law", "--scatter", "0.2", "--gamma-m", "1.5")
    page = browser.new_page(viewport={"width": 390, "height": 800})
    page.goto(path.as_uri())
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    printed = page.pdf(prefer_css_page_size=True)
    page.close()
    assert len(re.findall(rb"/Type\s*/Page\b(?!s)", printed)) <= 2


def test_torsion_may_be_said_beside_the_torque() -> None:
    alone = command("capacity", "-n", "5", "-M", "5Nm")
    assert alone.output.startswith("Yes: it carries M = 5 N m with a factor of 1.58 ")
    assert command("capacity", "-n", "5", "-M", "5Nm", "-e", "torsion").output == alone.output
