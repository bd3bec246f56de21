"""Numbers in pages: made from tables, between marks."""

from pathlib import Path

import pandas as pd
import pytest

from analysis.pages import BLOCK, BLOCKS, PageError, blocks_of, filled, markdown, percent
from workflow.results.tables import BONDS, write_table

ROOT = Path(__file__).parents[1]
PAGES = sorted(ROOT.glob("docs/*.md"))


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
    with pytest.raises(PageError, match="nothing: no such numbers; there are law-errors"):
        filled("<!-- numbers: nothing -->\n<!-- end -->", tmp_path)


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
