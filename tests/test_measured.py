"""Loads that walls carried in laboratories."""

import math
import re

import numpy as np
import pandas as pd
import pytest
from conftest import ROOT
from scipy.optimize import minimize

from sidmacib.engines import YADE
from sidmacib.mechanics.equilibrium import is_dry
from sidmacib.mechanics.static import static_peak
from sidmacib.scene.page import VALIDATED
from sidmacib.structure.files.structure_file import structure_of
from sidmacib.yaml_text import read_yaml
from studies.measured import yade
from studies.measured.contacts import description, given, pushes
from studies.measured.walls import HERE, Campaign, campaigns, computed, cracked, rows
from workflow.schema import with_changes

SPAN = re.compile(r"(\d\.\d+) to (\d\.\d+)")


@pytest.mark.long
def test_every_kind_of_wall_is_a_structure() -> None:
    for campaign in campaigns().values():
        file = read_yaml(HERE / campaign.file)
        for changes in campaign.kinds.values():
            assert is_dry(structure_of(with_changes(file, changes)).assembly)
        assert {each.kind for each in campaign.specimens.values()} == set(campaign.kinds)


def test_a_brick_wall_carries_out_of_its_plane_what_was_measured() -> None:
    """Rigid halves of width t and height h / 2 carry 2 t / h of their weight; the stop is 10 mm."""
    brick = campaigns()["brick"]
    (row,) = rows("brick", brick, computed(brick))
    weight = 1800 * 9.81 * 0.95 * 0.11 * 1.5
    assert row["limit_N"] == pytest.approx(2 * 0.11 / 1.495 * weight, rel=2e-3)
    assert row["static_N"] < row["limit_N"]
    assert row["measured_over_static"] == pytest.approx(1.021, abs=2e-3)


@pytest.mark.engine
def test_yade_pulls_a_wall_as_the_static_model_does_at_the_same_nodes() -> None:
    table = pd.DataFrame([*yade.rows(yade.AT_NODES, 1), *yade.rows(YADE.name, 1, 0.006)])
    static, moved = (table[table["model"].eq(name)] for name in (yade.AT_NODES, YADE.name))
    at = moved["displacement_m"].clip(upper=static["displacement_m"].max())
    known = np.interp(at, static["displacement_m"], static["load_N"])
    assert np.abs(moved["load_N"] - known).max() < 0.02 * known.max()
    assert moved["load_N"].max() == pytest.approx(38.1e3, rel=5e-3)
    measured = pd.read_csv(HERE / "curves.csv")
    labels = yade.drawn(table, measured).axes[0].get_legend_handles_labels()[1]
    assert labels == ["measured", "static model, pressure at nodes, 468 nodes", "YADE, 468 nodes"]


@pytest.mark.study
def test_walls_part_where_they_cracked_course_by_course() -> None:
    walls = [wall for campaign in campaigns().values() for wall in cracked(campaign)]
    assert [wall.specimen for wall in walls] == ["WS.100", "SW.30.1"]
    for wall in walls:
        rows = [*wall.rows]
        assert len(rows) == 8
        for row in rows:
            assert row["computed_m"] == pytest.approx(row["crack_m"], abs=0.011)


@pytest.mark.long
def test_a_granite_wall_rocks_at_what_was_measured() -> None:
    granite = campaigns()["granite"]
    kind = {"40 kN": granite.kinds["40 kN"]}
    some = granite.model_copy(
        update={"kinds": kind, "specimens": {"WS.40": granite.specimens["WS.40"]}}
    )
    (row,) = rows("granite", some, computed(some))
    assert row["measured_over_static"] == pytest.approx(1.098, abs=3e-3)


def test_pages_and_notes_say_what_the_table_says() -> None:
    page = (ROOT / "docs/measured.md").read_text()
    table = page.partition("<!-- numbers: walls-short -->\n")[2].partition("<!-- end -->")[0]
    of_granite, of_sandstone, _ = SPAN.findall(table)
    rest = page.partition("<!-- numbers: contacts-short -->\n")[2].partition("<!-- end -->")[0]
    medians = [line.split("|")[5].strip() for line in rest.splitlines()[2:]]
    of_contacts = min(medians), max(medians)
    assert SPAN.findall(VALIDATED) == [of_granite, of_sandstone, of_contacts]
    readme = (ROOT / "README.md").read_text().partition("dry granite")[2]
    assert SPAN.findall(readme)[:3] == [of_granite, of_sandstone, of_contacts]


def test_a_block_on_feet_slips_at_what_its_friction_allows() -> None:
    """Pushed through its centroid at mu times its weight; twisted about the feet's median point."""
    known = given()
    problem = structure_of(description("plywood", "feet 1", (-2.0, -1.0, 0.0)))
    assert static_peak(*problem).peak.load == pytest.approx(known["friction"]["plywood"], rel=2e-3)
    far = description("plywood", "feet 2", (-1e-3, 0.0, 1.0))
    feet = known["supports"]["feet 2"]
    arms = minimize(lambda at: sum(math.dist(each, at) for each in feet) / 3, [0.05, 0.05]).fun
    torque = 1e3 * static_peak(*structure_of(far)).peak.load
    assert torque == pytest.approx(known["friction"]["plywood"] * arms, rel=5e-3)


def test_each_push_has_a_support_and_a_surface_of_the_file() -> None:
    known = given()
    every = pushes()
    assert len(every) == 500
    assert {each["surface"] for each in every} == set(known["friction"])
    assert {each["support"] for each in every} == set(known["supports"])


def test_a_specimen_of_no_kind_is_refused() -> None:
    given = campaigns()["brick"].model_dump()
    given["specimens"]["wall 12"]["kind"] = "other"
    with pytest.raises(ValueError, match=r"wall 12\.kind: other; it must be one of as built"):
        Campaign.read(given)
