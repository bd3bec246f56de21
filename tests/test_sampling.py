"""Samplings, and the campaign of locks: tables of what the law is worth on them."""

import json
import math
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from conftest import ROOT, outputs_of
from joints import sawn
from small import SMALL

from sidmacib import Direction, Sidmacib, capacity
from sidmacib.contact_points import OPTIONS, active
from sidmacib.joint.loading import Push
from sidmacib.mechanics.assembly import Failure
from sidmacib.yaml_text import read_yaml
from studies.locks import law
from studies.locks.tables import freedoms_table, law_table, points_of, unit_loads
from studies.locks.variation import VARIED, sensitivity_table
from workflow import sampling as solve_step
from workflow.configuration import read_study_file
from workflow.sampling import SampledJoint, sampled_joints, samplings_table
from workflow.schema.sections import SamplingSection

RATIOS = [0.0, 0.3, math.inf]


def joints_of(count: int, **others: Any) -> list[SampledJoint]:
    section = SamplingSection(joints=count, **others)
    return list(sampled_joints(section, sawn(3), 0, count))


def test_any_part_of_a_sampling_can_be_made_alone() -> None:
    sampling = SamplingSection(joints=100)
    assert list(sampled_joints(sampling, sawn(3), 37, 45)) == joints_of(100)[37:45]


def test_joints_lie_within_the_spans_and_fill_them() -> None:
    section = SamplingSection(joints=512)
    joints = [one.joint for one in joints_of(512)]
    for values, (low, high) in (
        ([j.a / j.b for j in joints], section.a_over_b),
        ([j.h / j.b for j in joints], section.h_over_b),
        ([j.H / j.b for j in joints], section.H_over_b),
        (
            [j.inner.shear_stiffness / j.inner.normal_stiffness for j in joints],
            section.shear_over_normal,
        ),
        (
            [j.dry.normal_stiffness / j.inner.normal_stiffness for j in joints],
            section.dry_over_inner,
        ),
    ):
        place = np.log(np.array(values) / low) / np.log(high / low)
        assert place.min() >= -1e-12
        assert place.max() <= 1.0 + 1e-12
        assert np.histogram(place, bins=8, range=(0, 1))[0].tolist() == [64] * 8
    assert {j.locks for j in joints} == set(range(2, 32))
    smooth = sum(j.dry.friction == 0.0 for j in joints)
    assert smooth == pytest.approx(512 * section.smooth, abs=2)
    assert max(j.dry.friction for j in joints) <= 0.8


def test_even_joints_are_pushed_both_ways_and_odd_ones_one() -> None:
    pushes = {(one.joint.locks % 2, one.push) for one in joints_of(256)}
    assert pushes == {(0, Push.PLUS_Y), (0, Push.MINUS_Y), (1, Push.PLUS_Y)}


def test_elastic_pieces_and_softening_bonds_are_sampled_too() -> None:
    elastic = joints_of(16, stiffness_ratio=[1, 1000])
    ratios = [one.joint.stiffness_ratio for one in elastic]
    assert len(ratios) == 16
    assert 1.0 <= min(ratios) < 3.0
    assert 300.0 < max(ratios) <= 1000.0
    (fades, *_) = joints_of(1, failure="softening")
    assert fades.joint.failure is Failure.SOFTENING
    assert fades.joint.inner.fracture_energy > 0.0


@pytest.fixture(scope="module")
def points(tmp_path_factory: pytest.TempPathFactory) -> pd.DataFrame:
    """Twelve joints in three directions, solved by both steps as a study does."""
    folder = tmp_path_factory.mktemp("sampling")
    section = SamplingSection(joints=16, seed=11, locks=(3, 9), pressed=0.0)
    arguments = {
        **{"name": "made_up", "sampling": section.parameters(), "base": asdict(sawn(3))},
        **{"start": 0, "stop": 12, "eccentricities": RATIOS, "cells": (1, 2), "limited": 6},
    }
    batches = []
    for step in (solve_step, law):
        step.run(json.loads(json.dumps(arguments)), {}, {"joints": folder / "batch.parquet"})
        batches.append(pd.read_parquet(folder / "batch.parquet"))
    return points_of(samplings_table(batches[:1]), batches[1:])


def test_every_joint_has_a_row_for_each_direction(points: pd.DataFrame) -> None:
    assert len(points) == 12 * len(RATIOS)
    assert points["error"].isna().all()
    assert points["limit"].notna().sum() == 2 * len(RATIOS)
    assert (points["peak"] >= points["first_failure"] * (1 - 1e-9)).all()
    assert points["first_failure_mesh_error"].abs().max() < 0.1
    pure = points[points["eccentricity_over_a"] == 0.0]
    assert (pure["closed_form"] <= pure["pairs"] * (1 + 1e-9)).all()


def test_the_law_is_near_the_static_model_and_safe_below_its_peak(points: pd.DataFrame) -> None:
    table = law_table(points).set_index(["quantity", "held"])
    whole = table[table["eccentricity_over_a"] == "all"]
    law = whole.loc[("law / first failure", "all")]
    # Two joints have dry faces too stiff for their roots, which the rule refuses.
    assert law["points"] == points["law"].notna().sum() == len(points) - 2 * len(RATIOS)
    assert law["mean_absolute_error"] < 0.02
    assert max(law["largest_error"], -law["least_error"]) < 0.06
    safe = whole.loc[("safe / peak", "all")]
    assert safe["largest_error"] < 0.0
    assert safe["mean_error"] > -0.12


@pytest.mark.parametrize("option", list(OPTIONS))
def test_sidmacib_without_friction_grows_with_the_locks_that_count(option: str) -> None:
    joint = sawn(9)
    model = Sidmacib(joint, OPTIONS[option], active(joint, 4), friction=False)
    loads = unit_loads(OPTIONS[option], RATIOS)
    for ratio, load in zip(RATIOS, loads, strict=True):
        expected = capacity(model, Direction(ratio)).load
        assert 4 * joint.T0 * load == pytest.approx(expected, rel=1e-6)


@pytest.mark.long
def test_more_freedom_never_fits_worse(points: pd.DataFrame) -> None:
    table = freedoms_table(points)
    rows = ["upper_body", "locks"]
    misfit = table.pivot_table(index=rows, columns="freedom", values="mean_misfit")
    assert (misfit["own three points"] <= misfit["own pair"] + 1e-12).all()
    assert (misfit["own pair"] <= misfit["one pair for all"] + 1e-12).all()
    assert (misfit["own pair"] <= misfit["option4"] + 0.02).all()  # positions are a grid
    assert (misfit["option4"] <= misfit["half with option4"] + 1e-12).all()


@pytest.mark.study
def test_the_study_of_the_law_is_planned_in_batches(tmp_path: Path) -> None:
    config = ROOT / "studies/locks/config.yaml"
    joints = sum(section.joints for section in read_study_file(config).samplings.values())
    assert joints == 512 + 32 + 64 + 32
    made = outputs_of(read_yaml(config), tmp_path)
    for rule in ("sampling", "law"):
        assert len(made[rule]) == 8 + 3  # of 64 joints at most
    assert "tables/law.csv" in made["law_tables"]


@pytest.mark.study
def test_a_study_of_no_campaign_has_the_table_of_its_samplings_only(tmp_path: Path) -> None:
    made = outputs_of(SMALL | {"samplings": {"one": {"joints": 65}}}, tmp_path)
    assert made["sampling"] == ["sampling/one-0000.parquet", "sampling/one-0001.parquet"]
    assert made["samplings"] == ["tables/samplings.csv"]
    assert not {"law_tables", "points", "law"} & made.keys()


@pytest.mark.long
def test_the_first_failure_hangs_on_friction_not_where_there_is_none() -> None:
    """In pure shear a hangs together with nothing: forces and strengths grow with it alike."""
    section = SamplingSection(joints=2, friction=(0.0, 1e-9))
    table = sensitivity_table(section, sawn(3), draws=2)
    assert len(table) == 2 * 2 * 2 * len(VARIED)
    total = table.set_index(["eccentricity_over_a", "parameter"])["total"]
    assert total.loc[(slice(None), "friction")].abs().max() < 0.05
    assert total.loc[(0.0, "a_over_b")].abs().max() < 0.05
