"""Verification of mechanisms for earthquakes by Circolare 7/2019, against hand calculations."""

import math
from pathlib import Path
from typing import Any

import pytest
import yaml
from command_runner import assembly
from conftest import ROOT

from sidmacib.mechanics.assembly import GRAVITY
from sidmacib.structure.analysis.seismic import SeismicCheck, Spectrum, seismic_check
from sidmacib.structure.files.structure_file import structure_of

GROUND = {"low": [-20, -20, -1], "high": [20, 20, 0], "fixed": True}
WALL = {"low": [0, 0, 0], "high": [0.4, 1, 4]}
AG = 0.15 * GRAVITY
SPECTRUM = Spectrum(AG, 1.2, (0.15, 0.5, 2.0))
PUSH = {"acceleration": [1, 0, 0], "newtons": 100}
HEAVY = {"surcharge": {"blocks": "wall", "pascals": "100kPa"}}
KEYS = {"ag": "0.15g", "S": 1.2, "TB": 0.15, "TC": 0.5, "TD": 2}


def described(**more: Any) -> dict[str, Any]:
    blocks = {"ground": GROUND, "wall": WALL, **more}
    return {
        "blocks": blocks,
        "interfaces": {"friction": 0.6},
        "load": {"acceleration": [1, 0, 0]},
    }


def checked(spectrum: Spectrum = SPECTRUM, **more: Any) -> SeismicCheck:
    return seismic_check(*structure_of(described(**more)), spectrum)


def test_a_wall_that_turns_over_as_calculated_by_hand() -> None:
    """The acceleration is g (b/h - d/(h/2)) / FC for small turns; d0 is half the thickness."""
    found = checked()
    start = 0.1 * GRAVITY / 1.35
    assert (found.share, found.start) == pytest.approx((1.0, start), rel=1e-6)
    assert found.end == pytest.approx(0.2, rel=5e-3)
    assert found.period == pytest.approx(1.68 * math.pi * math.sqrt(0.08 / (0.6 * start)), rel=5e-3)
    far = AG * 1.2 * 2.5 * math.sqrt(10 / 13) * 0.5 * 2.0 / (2 * math.pi) ** 2
    assert found.demand == pytest.approx(far, rel=1e-6)
    assert found.ratio == pytest.approx(0.08 / far, rel=5e-3)
    assert found.ground == pytest.approx(2.0 * start / 1.2, rel=1e-6)


@pytest.mark.long
def test_blocks_that_stay_do_not_count() -> None:
    squat = {"low": [5, 5, 0], "high": [8, 8, 1]}
    alone, both = checked(), checked(squat=squat)
    for name in ("share", "start", "end", "ratio"):
        assert getattr(both, name) == pytest.approx(getattr(alone, name), rel=1e-5)


@pytest.mark.parametrize("cuts", [(2.0,), (1.0, 2.5)])
def test_how_a_wall_is_cut_into_blocks_does_not_matter(cuts: tuple[float, ...]) -> None:
    whole, levels = checked(), (0.0, *cuts, 4.0)
    blocks = {
        f"b{k}": {"low": [0, 0, levels[k]], "high": [0.4, 1, levels[k + 1]]}
        for k in range(len(levels) - 1)
    }
    description = {**described(), "blocks": {"ground": GROUND, **blocks}}
    found = seismic_check(*structure_of(description), SPECTRUM)
    for name in ("share", "start", "end", "ratio"):
        assert getattr(found, name) == pytest.approx(getattr(whole, name), rel=2e-3)


def test_of_two_walls_the_mass_that_takes_part_is_less_where_they_move_apart() -> None:
    """A lintel's piers: e* is (sum P d)^2 / (sum P  sum P d^2) of the three blocks."""
    pier = {"low": [2, 0, 0], "high": [2.4, 1, 4]}
    lintel = {"low": [0, 0, 4], "high": [2.4, 1, 4.4]}
    found = checked(pier=pier, lintel=lintel)
    P, d = (1.6, 1.6, 0.96), (2.0, 2.0, 4.0)  # piers turn about their feet, the lintel shifts
    share = sum(p * u for p, u in zip(P, d, strict=True)) ** 2
    share /= sum(P) * sum(p * u**2 for p, u in zip(P, d, strict=True))
    assert found.share == pytest.approx(share, rel=1e-3)


@pytest.mark.parametrize("damping", [0.05, 0.08])
def test_the_spectrum_is_continuous_and_flat_where_it_should_be(damping: float) -> None:
    """Equations 3.2 to 3.5 of EN 1998-1:2004."""
    factor = math.sqrt(10 / (5 + 100 * damping))
    rise, flat, far = SPECTRUM.corners
    most = AG * 1.2 * 2.5 * factor
    assert SPECTRUM.acceleration(0.0, damping) == pytest.approx(AG * 1.2)
    assert SPECTRUM.acceleration(0.5 * (rise + flat), damping) == pytest.approx(most)
    for corner in SPECTRUM.corners:
        before, after = (SPECTRUM.acceleration(corner * k, damping) for k in (1 - 1e-9, 1 + 1e-9))
        assert before == pytest.approx(after)
    ends = [SPECTRUM.displacement(k * far, damping) for k in (1.0, 2.0)]
    assert ends[0] == pytest.approx(ends[1])
    assert SPECTRUM.acceleration(4.0 * far, damping) == pytest.approx(most * flat * far / 64.0)


def test_the_command_says_no_with_its_equations(tmp_path: Path) -> None:
    files = "--picture", str(tmp_path / "s.png"), "--note", str(tmp_path / "note.html")
    options = "--seismic", *files
    told = assembly(tmp_path / "wall.yaml", {**described(), "seismic": KEYS}, *options)
    assert told.exit_code == 1
    assert "No: the mechanism bears 0.08 m; the spectrum asks for 0.09807 m" in told.output
    assert "1.68 pi sqrt(d_SLV / a(d_SLV)) (C8.7.1.10)" in told.output
    assert (tmp_path / "s.png").stat().st_size > 10_000
    note = (tmp_path / "note.html").read_text()
    assert "NOT verified" in note and "(C8.7.1.10)" in note and "SHA-256" in note


@pytest.mark.long
@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({}, "seismic: missing; --seismic needs the spectrum"),
        ({"seismic": {**KEYS, "TC": 0.1}}, "TB, TC and TD must grow"),
        ({"seismic": {**KEYS, "ag": 0}}, "seismic.ag: 0 is not allowed"),
        ({"seismic": KEYS, "interfaces": {"friction": 0.05}}, "seismic: blocks slide, which"),
        ({"seismic": KEYS, "load": {"acceleration": [1, 0, -1]}}, "must be horizontal"),
        ({"seismic": KEYS, "permanent": [HEAVY]}, "have no mass; give what is heavy as blocks"),
        ({"seismic": KEYS, "load": None, "load_cases": {"a": PUSH}}, "one acceleration"),
        ({"seismic": KEYS, "load": {"tilt": {"axis": [0, 1, 0]}}}, "a load that is an accel"),
    ],
)
def test_faults_are_one_line(tmp_path: Path, change: Any, words: str) -> None:
    given = {k: v for k, v in {**described(), **change}.items() if v is not None}
    told = assembly(tmp_path / "wall.yaml", given, "--seismic")
    assert told.exit_code
    assert words in told.output


@pytest.mark.long
def test_the_showpiece_arch_bears_a_strong_earthquake() -> None:
    description = yaml.safe_load((ROOT / "studies/time/arch.yaml").read_text())
    description["load"] = {"acceleration": [1, 0, 0]}
    spectrum = Spectrum(0.35 * GRAVITY, 1.2, (0.15, 0.5, 2.0))
    found = seismic_check(*structure_of(description), spectrum)
    assert found.ratio == pytest.approx(1.087, rel=5e-3)
