"""Tables of the report: headings with units, shares in percent, names in words."""

import re
from collections import Counter

import pandas as pd
import pytest
from conftest import ROOT

from analysis.report import headings, words
from analysis.report.joints import sample_words
from analysis.report.page import ADDRESS, SCRIPTS_OF_PARTS
from analysis.report.page import SCRIPTS as SCRIPTS_OF_ALL
from sidmacib.scene.page import SCRIPTS
from workflow.configuration import read_study
from workflow.results.columns import TABLES


@pytest.mark.parametrize(
    ("column", "title", "times"),
    [
        ("load_N", "load (N)", 1),
        ("shear_N", "V (N)", 1),
        ("torque_Nm", "M (N m)", 1),
        ("eccentricity_over_a", "e / a", 1),
        ("mesh_m", "mesh (m)", 1),
        ("load_over_T0", "load / T0", 1),
        ("mesh_error", "mesh error (%)", 100),
        ("peak_spread", "peak spread (%)", 100),
        ("error", "error", 1),
    ],
)
def test_headings_have_units_and_no_underscores(column: str, title: str, times: int) -> None:
    held = "a reason" if column == "error" else 0.5
    (found,) = headings({"capacity": pd.DataFrame({column: [held]})})["capacity"]
    assert (found["title"], found["times"]) == (title, times)


def test_every_column_has_a_heading_that_can_be_read_and_a_meaning() -> None:
    tables = {form.name: pd.DataFrame(columns=list(form.columns)) for form in TABLES}
    for name, heads in headings(tables).items():
        for head in heads:
            assert head["meaning"], (name, head)
            assert "_" not in head["title"] and "`" not in head["meaning"]


def test_names_of_models_rules_and_quantities_are_in_words() -> None:
    table = pd.DataFrame(
        {"model": ["static"], "reduction": ["half"], "quantity": ["weight_lock1"], "option": [None]}
    )
    found = words({"fit": table})
    assert found["model"] == {"static": "static model"}
    assert found["reduction"] == {"half": "(n - 1) / 2 locks count"}
    assert found["quantity"] == {"weight_lock1": "weight of lock 1"}
    assert found["option"] == {}


def test_samples_are_told_by_what_tells_them_apart() -> None:
    plain = {"samples": {"n3": {"locks": 3}, "n5": {"locks": 5}}}
    assert sample_words(read_study(plain)) == {"n3": "n3: 3 locks", "n5": "n5: 5 locks"}
    smooth = {"locks": 5, "dry": {"friction": 0.1}}
    found = sample_words(read_study({"samples": {"n5": {"locks": 5}, "smooth": smooth}}))
    assert found["smooth"] == "smooth: 5 locks, friction 0.1"
    assert found["n5"] == "n5: 5 locks, friction 0.3 as printed"
    long = {"samples": {"n5": {"locks": 5}, "long": {"locks": 5, "a": 0.08}}}
    assert sample_words(read_study(long))["long"] == "long: 5 locks, a (mm) 80"


def test_the_scripts_of_the_report_declare_no_name_twice() -> None:
    """They share one scope with those that draw, as do those of the command's page."""
    declared = re.compile(r"^(?:const|let|function\*?|class) +(\w+)", re.MULTILINE)
    parts = [script for part in SCRIPTS_OF_PARTS.values() for script in part]
    of_study = [*SCRIPTS_OF_ALL, *parts, ADDRESS]
    of_command = [ROOT / "sidmacib/scene" / name for name in SCRIPTS]
    for scripts in (of_study, of_command):
        names = [name for script in scripts for name in declared.findall(script.read_text())]
        assert [name for name, count in Counter(names).items() if count > 1] == []
