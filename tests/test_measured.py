"""Measured loads, what stands beside them, and how many specimens a laboratory needs."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from conftest import outputs_of
from scipy.stats import norm
from small import SMALL

from analysis.tables.comparisons import measured_table
from studies.measured.specimens import LEAST, POWER, SIGNIFICANCE, specimens
from workflow.configuration import read_study
from workflow.schema import MeasuredLoad

LOAD = {"sample": "n3", "eccentricity": 0.5, "torque": 3.0, "specimen": "A1"}
SOURCE = {"source": "a made-up campaign, for tests", "digitised": "not at all"}
CONFIG = SMALL | {
    "meshes": [0.02, 0.005],
    "models": ["static", "law"],
    "measured": SOURCE | {"loads": [LOAD]},
}


@pytest.mark.parametrize(
    ("load", "expected"),
    [
        ({"eccentricity": 0, "shear": 100.0}, (100.0, 0.0)),
        ({"eccentricity": 0.5, "shear": 100.0}, (100.0, 3.0)),
        ({"eccentricity": 0.5, "torque": 3.0}, (100.0, 3.0)),
        ({"eccentricity": "torsion", "torque": 3.0}, (0.0, 3.0)),
    ],
)
def test_a_load_is_a_shear_or_a_torque(load: dict[str, Any], expected: tuple[float, float]) -> None:
    found = MeasuredLoad.model_validate({"sample": "n3", **load}).components(a=0.06)
    assert found == pytest.approx(expected)


def test_every_model_stands_beside_a_measured_load_in_the_same_direction() -> None:
    study = read_study(CONFIG)
    fine, coarse = min(study.meshes), max(study.meshes)
    capacity = pd.DataFrame(
        [("law", fine, 115.0), ("static", fine, None), ("static", coarse, 1.0)],
        columns=["model", "mesh_m", "load_N"],
    ).assign(variant="reference", sample="n3", eccentricity_over_a=0.5)
    assert study.measured is not None
    table = measured_table(study, study.measured, capacity).set_index("model")
    assert table.loc["law", "measured_load_N"] == pytest.approx(math.hypot(100.0, 3.0 / 0.06))
    assert table.loc["law", "difference"] == pytest.approx(115.0 / math.hypot(100.0, 50.0) - 1.0)
    assert math.isnan(table.loc["static", "difference"])


@pytest.mark.study
def test_a_study_with_measured_loads_has_a_table_of_them(tmp_path: Path) -> None:
    assert "tables/measured.csv" in outputs_of(CONFIG, tmp_path)["comparisons"]


def test_so_many_specimens_find_a_difference_as_often_as_asked() -> None:
    """By simulation: samples of the difference, tested with its known deviation."""
    difference, deviation = 0.1, 0.2
    count = specimens(difference, deviation)
    means = np.random.default_rng(3).normal(difference, deviation / math.sqrt(count), 20_000)
    found = np.abs(means) > norm.isf(SIGNIFICANCE / 2) * deviation / math.sqrt(count)
    assert found.mean() == pytest.approx(POWER, abs=0.015)


def test_a_large_difference_still_takes_a_few() -> None:
    assert specimens(1.0, 0.1) == LEAST
