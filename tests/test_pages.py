"""Numbers in pages: made from tables, between marks."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from studies import run_times
from studies.attack.search import MORE, MORE_LOCKS
from studies.elastic import page as elastic
from studies.layouts import page as layouts
from studies.locks.bonds import BONDS
from studies.markdown import markdown, percent
from studies.pages import BLOCK, BLOCKS, PageError, blocks_of, filled
from studies.published import page as published
from workflow.results.tables import CAPACITY, CASES, FIT, VARIANTS, read_table, write_table
from workflow.schema import Study

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted(ROOT.glob("docs/**/*.md"))]


def test_a_block_is_made_from_its_table(tmp_path: Path) -> None:
    (tmp_path / "tables").mkdir()
    row = ("ductile", "columns", 0.0, 3, 1.5, 2.0, 0.98, 0.0)
    table = pd.DataFrame([row], columns=list(BONDS.columns))
    write_table(BONDS, table, tmp_path / "tables" / "bonds.csv")
    page = "before\n<!-- numbers: bonds -->\nold\n<!-- end -->\nafter\n"
    made = filled(page, tmp_path)
    assert "| ductile | columns | 3 | 1.50 | 2.00 | 0.98 |" in made
    assert "old" not in made
    assert made.startswith("before\n<!-- numbers: bonds -->\n|")
    assert made.endswith("|\n<!-- end -->\nafter\n")
    assert filled(made, tmp_path) == made


def test_what_stands_between_empty_blocks_stays(tmp_path: Path) -> None:
    empty = "<!-- numbers: bonds -->\n<!-- end -->\n"
    assert blocks_of(f"{empty}between\n{empty}") == ["bonds", "bonds"]
    assert len(BLOCK.findall(f"{empty}between\n{empty}")) == 2


def test_an_unknown_block_is_refused(tmp_path: Path) -> None:
    with pytest.raises(PageError, match="nothing: unknown block of numbers; it must be one of"):
        filled("<!-- numbers: nothing -->\n<!-- end -->", tmp_path)


def test_a_block_whose_table_is_missing_stays(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = "<!-- numbers: peaks -->\nold\n<!-- end -->"
    assert filled(page, tmp_path) == page
    assert "peaks: unchanged, as" in capsys.readouterr().err


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_block_of_a_page_is_known_and_filled(page: Path) -> None:
    text = page.read_text()
    assert set(blocks_of(text)) <= set(BLOCKS)
    assert all("|" in block.group(0) for block in BLOCK.finditer(text))


def test_every_kind_of_numbers_is_in_a_page() -> None:
    assert {name for page in PAGES for name in blocks_of(page.read_text())} == set(BLOCKS)


def test_tables_in_markdown() -> None:
    assert markdown(["a", "b"], [["1", "2"]]) == "| a | b |\n| --- | --- |\n| 1 | 2 |"
    assert percent(-0.123) == "\N{MINUS SIGN}12.3 %"
    assert percent(0.5, 0) == "+50 %"


@pytest.mark.study
def test_numbers_of_a_study_are_those_of_its_tables(solved_study: tuple[Study, Path]) -> None:
    _, results = solved_study
    cases = read_table(CASES, results / "tables" / "cases.csv")
    finest = cases[cases["model"].eq("static") & cases["mesh_m"].eq(0.01)]
    loads = finest.set_index(["sample", "eccentricity_over_a"])["load_N"]
    lines = published.curves(results).splitlines()
    assert lines[0] == "| e / a | n3 (N) | n5 (N) |"
    assert lines[2] == f"| 0 | {loads['n3', 0.0]:.1f} | {loads['n5', 0.0]:.1f} |"
    torsion = (loads["n3", np.inf], loads["n5", np.inf])
    assert lines[4] == f"| torsion | {torsion[0]:.1f} | {torsion[1]:.1f} |"


@pytest.mark.study
def test_slopes_are_those_of_the_curve(solved_study: tuple[Study, Path]) -> None:
    _, results = solved_study
    capacity = read_table(CAPACITY, results / "tables" / "capacity.csv")
    curve = capacity[
        capacity["model"].eq("static") & capacity["mesh_m"].eq(0.01) & capacity["sample"].eq("n3")
    ].sort_values("eccentricity_m", ascending=False)
    slopes = -np.diff(curve["torque_Nm"] / 0.06) / np.diff(curve["shear_N"])
    row = next(row for row in published.slopes(results).splitlines() if row.startswith("| n3 "))
    assert row == f"| n3 | {', '.join(f'{slope:.2f}' for slope in slopes)} |"


@pytest.mark.study
@pytest.mark.parametrize("name", ["published-short", "peaks", "weights", "options"])
def test_published_numbers_stand_beside_computed_ones(
    name: str, solved_study: tuple[Study, Path]
) -> None:
    text = BLOCKS[name](solved_study[1])
    assert "nan" not in text
    assert len(text.splitlines()) > 3
    assert "static model" in text


def test_samples_of_as_many_locks_stand_below_each_other(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    loads = {("n3", "yade"): 248.0, ("n3", "static"): 248.2}
    loads |= {("n3_fits", "yade"): 240.0, ("n3_fits", "static"): 240.3}
    table = pd.DataFrame(
        {
            **{"model": model, "sample": sample, "case": f"{sample}-mesh0.01-e0a", "locks": 3},
            **{"mesh_m": 0.01, "load_N": load, "first_failure_load_N": load},
            "eccentricity_over_a": 0.0,
        }
        for (sample, model), load in loads.items()
    )
    monkeypatch.setattr(published, "table_in", lambda *_: table)
    rows = [row for row in published.models(tmp_path).splitlines() if row.startswith("| n3")]
    assert rows == [
        "| n3 | 0 | 248.00, 248.00 | 248.20, 248.20 |",
        "| n3_fits | 0 | 240.00, 240.00 | 240.30, 240.30 |",
    ]


def test_growth_has_a_row_for_each_number_of_cases(tmp_path: Path) -> None:
    (tmp_path / "tables").mkdir()
    columns = [column for column, _ in run_times.COLUMNS.values()]
    rows = [dict.fromkeys(columns, number) for number in (1000.4, 20_000.0)]
    pd.DataFrame(rows).to_csv(tmp_path / "tables/scaling.csv", index=False)
    lines = BLOCKS["scaling"](tmp_path).splitlines()
    assert lines[0].startswith("| cases | jobs | first run (s) |")
    assert [line.split(" | ")[:2] for line in lines[2:]] == [
        ["| 1,000", "1000"],
        ["| 20,000", "20000"],
    ]


def test_elastic_blocks_are_listed_from_stiff_to_soft(tmp_path: Path) -> None:
    (tmp_path / "tables").mkdir()
    columns = dict.fromkeys(VARIANTS.columns)
    rows = [
        {
            **columns,
            **{"model": "static", "variant": name, "sample": f"n{locks}", "locks": locks},
            **{"mesh_m": 0.02, "case": f"n{locks}-e0a", "upper_body": "columns"},
            **{"young_Pa": young, "stiffness_ratio": ratio, "eccentricity_m": 0.0},
            **{"load_N": load, "load_over_T0": load, "option": "option4"},
            **{"largest_unsafe_error": 0.1, "mesh_error": 0.01},
        }
        for name, young, ratio, load in (("soft", 1e10, 20.0, 1.0), ("stiff", None, None, 1.5))
        for locks in (3, 5)
    ]
    table = pd.DataFrame(rows, columns=list(VARIANTS.columns))
    write_table(VARIANTS, table, tmp_path / "tables" / "variants.csv")
    lines = elastic.loads(tmp_path).splitlines()
    minus = "\N{MINUS SIGN}"
    assert lines[2] == f"| rigid | \N{INFINITY} | columns | 1.50 (+50 %) | 1.50 ({minus}25 %) |"
    assert lines[3] == f"| 10 | 20 | columns | 1.00 (+0 %) | 1.00 ({minus}50 %) |"
    assert elastic.unsafe(tmp_path).splitlines()[2] == "| rigid | columns | 4: 10 % | 4: 10 % |"


def test_each_layout_has_a_column_and_each_mesh_a_row(tmp_path: Path) -> None:
    for number, layout in enumerate(layouts.NodeLayout, start=1):
        loads = pd.DataFrame(
            {"sample": sample, "mesh_m": mesh, "model": "static", "eccentricity_over_a": np.inf}
            | {
                "load_N": number * mesh * 1000,
                "mesh_error": number * mesh,
                "case": f"{sample}{mesh}",
            }
            for sample in ("n3", "n5")
            for mesh in (0.02, 0.01)
        )
        fits = pd.DataFrame(
            {"sample": sample, "mesh_m": 0.02, "model": "static", "friction": False}
            | {"reduction": rule, "option": option, "misfit": misfit}
            | {"largest_unsafe_error": -0.1 if option == "option4" else 0.2}
            for sample in layouts.SAMPLES
            for rule in layouts.RULE_WORDS
            for option, misfit in (("option1", 0.5), ("option4", 0.04 * number))
        )
        for form, table in ((CASES, loads), (FIT, fits)):
            path = tmp_path / layout / "tables" / f"{form.name}.csv"
            write_table(form, table.reindex(columns=list(form.columns)), path)
    assert layouts.torsion(tmp_path).splitlines()[2:] == [
        "| 3 locks as printed | 0.02 | 20.00 | 40.00 | 60.00 |",
        "| 3 locks as printed | 0.01 | 10.00 | 20.00 | 30.00 |",
        "| 5 locks as printed | 0.02 | 20.00 | 40.00 | 60.00 |",
        "| 5 locks as printed | 0.01 | 10.00 | 20.00 | 30.00 |",
        "| largest mesh-error estimate | 0.02 | 2 % | 4 % | 6 % |",
        "| largest mesh-error estimate | 0.01 | 1 % | 2 % | 3 % |",
    ]
    rows = layouts.options(tmp_path).splitlines()[2:]
    assert rows[0] == (
        "| 3 locks as printed | 0.02 | 4 (4.0 %; 0.0 %) | 4 (8.0 %; 0.0 %) | 4 (12.0 %; 0.0 %) |"
    )
    assert [row.split(" |")[0] for row in rows[-2:]] == [
        *("| 5 locks fitted, (n \N{MINUS SIGN} 1) / 2", "| 5 locks fitted, lower locks")
    ]
    assert len(rows) == 6


def test_frictions_are_listed_with_the_geometries_that_fit(tmp_path: Path) -> None:
    folder = tmp_path / "calibration"
    folder.mkdir()
    grid = pd.DataFrame({"candidate": ["g0", "g1", "own0", "g2"], "friction": [0, 0, 0, 0.3]})
    grid.to_csv(folder / "map.csv", index=False)
    found = {"misfit_swapped": 0.661, "largest_peak_difference": 0.006}
    found |= {"largest_weight_difference": 0.0213, "least_peak_difference": 0.0021}
    rows = [(0.0, 1), (0.005236, 2), (0.3, 0)]
    table = pd.DataFrame({"friction": mu, "geometries_that_fit": n} | found for mu, n in rows)
    table.to_csv(folder / "friction.csv", index=False)
    head, _, *lines = published.frictions(tmp_path).splitlines()
    assert "of 2 geometries fit" in head
    assert lines[0] == "| 0 | 0.66 | 0.60 %, 0.021 | 1 | 0.21 % |"
    assert lines[1].startswith("| 0.005236 = tan 0.3° |")
    assert lines[2].startswith("| 0.3, as printed |") and "| none |" in lines[2]


def test_attacks_on_rigid_and_on_elastic_blocks_fill_tables_of_their_own(tmp_path: Path) -> None:
    (tmp_path / "tables").mkdir()
    rows = [
        {"space": "elastic columns", "evaluations": 600, "answered": 400, "unsolved": 1}
        | {"safe_over_first_failure": ratio, "safe_over_peak_1": ratio - 0.1}
        | {MORE.format(n): ratio - 0.001 * n for n in MORE_LOCKS}
        for ratio in (0.9, 0.95)
    ]
    pd.DataFrame(rows).to_csv(tmp_path / "tables/attack.csv")
    blocks = "".join(
        f"<!-- numbers: {name} -->\n{name}\n<!-- end -->\n" for name in ("attack", "attack-elastic")
    )
    rigid, elastic = filled(blocks, tmp_path).split("<!-- end -->\n")[:2]
    assert rigid.splitlines()[1:] == ["attack"]
    numbers = "1,200 | 800 | 2 | 0.950 | 0.850 | 0.943 | 0.941 | 0.938 | 0.935 |"
    assert elastic.splitlines()[-1] == f"| elastic columns | {numbers}"
