"""What variants change: in the joints, in a table, and in its figures."""

import math
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import pandas as pd
import pytest
from made_up_results import capacity_of, record_with
from small import TWO_MESHES

from analysis.tables.collect import weight_sums, weights_table
from analysis.tables.comparisons import variants_table
from sidmacib.mechanics.assembly import Failure
from workflow.case import JointCase
from workflow.cases import cases_of
from workflow.configuration import read_study
from workflow.schema import Study

BENDS = {"soft": {"young": 1e9}, "rigid": {"pieces": "rigid"}}
FADES = {
    "tough": {"failure": "softening", "fracture_energy": 10},
    "tougher": {"failure": "softening", "fracture_energy": 100, "eccentricities": [0]},
    "ductile": {"failure": "ductile"},
}


def study_of(variants: Mapping[str, Any], **others: Any) -> Study:
    return read_study({**TWO_MESHES, "variants": variants, **others})


def elastic_study() -> Study:
    return study_of(BENDS, assembly={"pieces": "elastic"})


def tables_of(
    study: Study, load: Callable[[JointCase], float]
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Capacities, and what variants change, of results with made-up loads."""
    results = [record_with(case, 0.5, load(case)) for case in cases_of(study).values()]
    capacity = capacity_of(study, results)
    return capacity, variants_table(study, capacity, weight_sums(weights_table(results)))


@cache
def any_capacity() -> pd.DataFrame:
    """Capacities of the elastic study: those of SiDMACIB are the same whatever its models carry."""
    return tables_of(elastic_study(), lambda case: 100.0)[0]


def test_a_variant_changes_the_fracture_energy_of_inner_faces() -> None:
    cases = cases_of(study_of(FADES))
    tough = cases["static", "n3-mesh0.02-e0a-tough"].subject.joint
    assert (tough.failure, tough.inner.fracture_energy) == (Failure.SOFTENING, 10.0)
    assert cases["static", "n3-mesh0.02-e0a"].subject.joint.inner.fracture_energy == 0.0


def test_every_direction_of_every_variant_has_a_row_with_what_it_changes() -> None:
    study = elastic_study()
    _, table = tables_of(study, lambda case: 100.0 if case.variant == "soft" else 200.0)
    assert len(table) == 3 * 2 * 3
    rows = table[table["case"] == "n3-mesh0.02-e0a"].set_index("variant")
    assert rows["stiffness_ratio"].to_dict() == pytest.approx(
        {"reference": 20.0, "soft": 2.0, "rigid": math.nan}, nan_ok=True
    )
    assert rows["load_over_T0"].to_dict() == pytest.approx(
        {"reference": 200 / 240, "soft": 100 / 240, "rigid": 200 / 240}
    )
    assert (rows["lower_weight_sum"] == 0.5).all()


@pytest.mark.parametrize("option", ["option1", "option2", "option3", "option4"])
def test_the_option_that_a_variant_follows_is_its_best(option: str) -> None:
    study = elastic_study()
    half = any_capacity().query("option == @option and reduction == 'half' and friction == False")
    follows = half.set_index("case")["load_N"].to_dict()

    def load(case: JointCase) -> float:
        return follows[case.name.removesuffix("-soft")] if case.variant == "soft" else 1.0

    _, table = tables_of(study, load)
    soft = table[table["variant"] == "soft"]
    assert set(soft["option"]) == {option}
    assert soft["misfit"].to_numpy() == pytest.approx(0.0, abs=1e-9)
