"""Numbers in pages: made from tables, between marks."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from studies.attack.search import MORE, MORE_LOCKS
from studies.measured.contacts import CONTACTS
from studies.pages import BLOCK, BLOCKS, filled
from studies.published import page as published
from workflow.results.tables import CASES, read_table, write_table
from workflow.schema import Study

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted(ROOT.glob("docs/**/*.md"))]


def blocks_of(text: str) -> set[str]:
    return {name for _, name, _ in BLOCK.findall(text)}


def test_a_block_is_made_from_its_table(tmp_path: Path) -> None:
    row = ("plywood", "feet 1", 0, 0.002, 5.1, 5.0, 1.02)
    table = pd.DataFrame([row], columns=list(CONTACTS.columns))
    write_table(CONTACTS, table, tmp_path / "tables" / "contacts.csv")
    page = "before\n<!-- numbers: contacts-short -->\nold\n<!-- end -->\nafter\n"
    made = filled(page, tmp_path)
    assert "| plywood | three feet | 1 | 5.1 to 5.1 | 1.02 |" in made
    assert "old" not in made
    assert made.startswith("before\n<!-- numbers: contacts-short -->\n|")
    assert made.endswith("|\n<!-- end -->\nafter\n")
    assert filled(made, tmp_path) == made


def test_an_unknown_block_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="nothing: unknown block of numbers; it must be one of"):
        filled("<!-- numbers: nothing -->\n<!-- end -->", tmp_path)


def test_a_block_without_a_table_stays(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page = "<!-- numbers: curves -->\nold\n<!-- end -->"
    assert filled(page, tmp_path) == page
    assert "curves: unchanged, as" in capsys.readouterr().err


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_block_of_a_page_is_known_and_filled(page: Path) -> None:
    text = page.read_text()
    assert blocks_of(text) <= set(BLOCKS)
    assert all("|" in block.group(0) for block in BLOCK.finditer(text))


def test_every_kind_of_numbers_is_in_a_page() -> None:
    assert set().union(*(blocks_of(page.read_text()) for page in PAGES)) == set(BLOCKS)


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
@pytest.mark.parametrize("name", ["published-short", "options"])
def test_published_numbers_are_beside_computed(name: str, solved_study: tuple[Study, Path]) -> None:
    text = BLOCKS[name](solved_study[1])
    assert "nan" not in text
    assert len(text.splitlines()) > 3
    assert "static model" in text


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
