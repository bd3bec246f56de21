"""Studies of ground motions: what falls, and fragility."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import yaml
from conftest import run_study
from scipy.optimize import minimize
from scipy.stats import norm

from analysis.summary.earthquakes import summary
from analysis.tables.earthquakes import earthquakes_table, fragility, fragility_table
from sidmacib.mechanics.assembly import GRAVITY
from workflow.configuration import ConfigError, read_study_file
from workflow.earthquakes import moved
from workflow.jobs import case_jobs
from workflow.schema import Study

TARGETS = "figures/fragility-block.png", "report.html", ".complete"
ACCELERATION = "peak_acceleration_m_s2"
BLOCK = {  # it slips under what is above friction, and does not rock
    "blocks": {
        "ground": {"low": [-3, -3, -0.5], "high": [3, 3, 0], "fixed": True},
        "block": {"low": [0, 0, 0], "high": [0.6, 0.3, 0.2]},
    },
    "interfaces": {"friction": 0.3},
    "load": {
        "ground": {"pulse": {"acceleration": "1g", "duration": 0.1}, "direction": [-1, 0, 0]},
        "duration": "1s",
    },
}


def motions(seed: int = 0, records: int = 8) -> pd.DataFrame:
    """Ground motions at factors on records, and what falls by a lognormal chance about 4 m/s2."""
    chance = np.random.default_rng(seed)
    own = np.exp(0.3 * chance.standard_normal(records))
    rows = [(name, 2.0 * k * own[name]) for name in range(records) for k in (1.0, 1.5, 2.0, 3.0)]
    table = pd.DataFrame(rows, columns=["record", ACCELERATION])
    limit = 4.0 * np.exp(0.5 * chance.standard_normal(len(table)))
    table["falls"] = table[ACCELERATION] > limit
    return table


def test_fragility_is_the_likeliest_lognormal_distribution() -> None:
    """In its own unknowns, median and dispersion, as in Baker (2015)."""
    table = motions()
    x, fell = np.log(table[ACCELERATION]), table["falls"]

    def unlikely(unknowns: Any) -> float:
        reach = (x - unknowns[0]) / np.exp(unknowns[1])
        return -float(np.where(fell, norm.logcdf(reach), norm.logsf(reach)).sum())

    best = minimize(unlikely, (1.0, -0.5), method="Nelder-Mead", options={"xatol": 1e-7}).x
    found = fragility(table, ACCELERATION)
    assert found["median"] == pytest.approx(math.exp(best[0]), rel=1e-3)
    assert found["dispersion"] == pytest.approx(math.exp(best[1]), rel=1e-3)
    assert found["median_low"] < found["median"] < found["median_high"]


def test_motions_of_one_record_do_not_count_as_many() -> None:
    table = motions()
    once, thrice = (fragility(pd.concat([table] * n), ACCELERATION) for n in (1, 3))
    assert thrice["median_low"] == pytest.approx(once["median_low"], rel=1e-5)
    assert thrice["median_high"] == pytest.approx(once["median_high"], rel=1e-5)


def test_the_interval_holds_the_median_about_as_often_as_it_says() -> None:
    found = [fragility(motions(seed, 20), ACCELERATION) for seed in range(200)]
    held = [each["median_low"] < 4.0 < each["median_high"] for each in found]
    assert 0.82 < np.mean(held) < 0.96


def test_where_falls_and_stands_do_not_overlap_the_interval_is_what_lies_between() -> None:
    rows = {"record": [1, 1, 2, 2], ACCELERATION: [1.0, 3.0, 1.5, 4.0], "falls": [0, 1, 0, 1]}
    found = fragility(pd.DataFrame(rows), ACCELERATION)
    assert (found["median_low"], found["median_high"]) == (1.5, 3.0)
    assert "median" not in found
    table = pd.DataFrame({**rows, "falls": [1, 1, 1, 1]})
    assert fragility(table, ACCELERATION)["note"] == "all fall: no fit"


@pytest.mark.parametrize(
    ("intensity", "falls", "words"),
    [
        ([1.0, 2.0, 3.0, 3.0], [0, 0, 0, 1], "no motion that stands is above one that falls"),
        ([2.0, 2.0, 2.0, 2.0], [0, 1, 0, 1], "one intensity: no fit"),
        ([0.0, 2.0, 3.0, 4.0], [0, 0, 1, 1], "no motion that stands is above one that falls"),
    ],
)
def test_without_a_likeliest_fit_there_is_none(
    intensity: list[float], falls: list[int], words: str
) -> None:
    rows = {"record": [1, 2, 3, 4], ACCELERATION: intensity, "falls": falls}
    found = fragility(pd.DataFrame(rows), ACCELERATION)
    assert words in found["note"] and "median" not in found


def study_of(folder: Path, description: dict[str, Any] = BLOCK, **keys: Any) -> Study:
    (folder / "block.yaml").write_text(yaml.safe_dump(description))
    path = folder / "study.yaml"
    path.write_text(yaml.safe_dump({"earthquakes": {"block": {"file": "block.yaml", **keys}}}))
    return read_study_file(path)


def write_pulse(path: Path, level: float, unit: float = 1.0) -> None:
    """A constant acceleration (m/s2) for 0.2 s."""
    rows = [(0.0, level), (0.2, level), (0.2001, 0.0), (1.4, 0.0)]
    path.write_text("".join(f"{time} {value / unit}\n" for time, value in rows))


def test_a_case_moves_as_far_as_newmark_says_at_each_factor(tmp_path: Path) -> None:
    """Records are followed to their ends, whatever the duration in the file."""
    write_pulse(tmp_path / "a-pulse.txt", 0.2 * GRAVITY, GRAVITY)
    jobs = case_jobs(study_of(tmp_path, records="a-*.txt", unit="g", factors=[1, 2, 4]))
    (cases,) = jobs.earthquakes.values()
    assert [each.name for each in cases] == [f"block-a_pulse-{k}" for k in (1, 2, 4)]
    for case, level in zip(cases, (0.2, 0.4, 0.8), strict=True):
        part = moved(case).part
        faster = max(level - 0.3, 0.0) * GRAVITY * 0.2
        slip = 0.1 * faster + faster**2 / (2 * 0.3 * GRAVITY)
        assert part.displacement_m == pytest.approx(slip, rel=5e-3, abs=1e-8)
        assert part.peak_acceleration_m_s2 == pytest.approx(level * GRAVITY)
        assert part.peak_velocity_m_s == pytest.approx(level * GRAVITY * 0.2, rel=1e-3)
        assert part.falls is False


def test_without_records_the_motion_in_the_file_is_taken(tmp_path: Path) -> None:
    ((case,),) = case_jobs(study_of(tmp_path)).earthquakes.values()
    assert case.name == "block-ground-1"
    assert moved(case).part.peak_acceleration_m_s2 == pytest.approx(GRAVITY)


def test_records_whose_names_are_alike_are_refused(tmp_path: Path) -> None:
    for name in ("a b.txt", "a_b.txt"):
        write_pulse(tmp_path / name, 1.0)
    with pytest.raises(ConfigError, match="two files are called a_b"):
        study_of(tmp_path, records="a*.txt")
    with pytest.raises(ConfigError, match="records: 5 is not allowed; it must be names of files"):
        study_of(tmp_path, records=5)


def test_a_changed_record_is_another_case(tmp_path: Path) -> None:
    found = []
    for level in (1.0, 2.0):
        write_pulse(tmp_path / "one.txt", level)
        ((case,),) = case_jobs(study_of(tmp_path, records=["one.txt"])).earthquakes.values()
        found.append(case.digest())
    assert found[0] != found[1]


@pytest.mark.parametrize(
    ("keys", "load", "words"),
    [
        ({"records": "no/*.txt"}, None, "records: 'no/*.txt' is not allowed; it must be files"),
        ({"factors": [0]}, None, "factors.1: 0 is not allowed; it must be greater than 0"),
        ({"factors": [1, 2, 1.0]}, None, "factors: must differ in their first six digits"),
        ({"unit": "m"}, None, "unit: 'm' is not allowed; it must be one of m/s2, cm/s2, g"),
        ({}, {"acceleration": [1, 0, 0]}, "load.ground: has 0 motions; it must have one"),
        ({}, {**BLOCK["load"], "duration": -1}, "duration: -1 is not allowed"),
    ],
)
def test_faults_are_one_line(tmp_path: Path, keys: Any, load: Any, words: str) -> None:
    description = BLOCK if load is None else {**BLOCK, "load": load}
    with pytest.raises(ConfigError) as raised:
        study_of(tmp_path, description, **keys)
    assert words in str(raised.value)
    assert "\n" not in str(raised.value)


def test_a_summary_counts_what_is_open(tmp_path: Path) -> None:
    (cases,) = case_jobs(study_of(tmp_path, factors=[1, 2])).earthquakes.values()
    first, second = (moved(each) for each in cases)
    table = earthquakes_table([first, replace(second, part=replace(second.part, falls=None))])
    text = summary(fragility_table(table), table)
    assert "block: 0 of 1 motions bring it down; by peak ground acceleration, none falls" in text
    assert "1 motions are open or have no result" in text


def test_a_structure_without_any_answer_is_named(tmp_path: Path) -> None:
    ((case,),) = case_jobs(study_of(tmp_path)).earthquakes.values()
    record = moved(case)
    table = earthquakes_table([replace(record, part=replace(record.part, falls=None))])
    assert "block: 0 of 0 motions bring it down" in summary(fragility_table(table), table)


@pytest.mark.study
def test_a_study_of_earthquakes_is_one_command(tmp_path: Path) -> None:
    study_of(tmp_path, factors=[1, 3])
    assert read_study_file(tmp_path / "study.yaml").earthquakes
    config = yaml.safe_load((tmp_path / "study.yaml").read_text())
    run_study(config, tmp_path, *TARGETS)
    table = pd.read_csv(tmp_path / "tables/earthquakes.csv")
    assert list(table["factor"]) == [1, 3]
    assert (tmp_path / "figures/fragility-block.png").is_file()
    assert "Structures in earthquakes" in (tmp_path / "report.html").read_text()
