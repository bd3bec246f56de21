"""The documents: their examples run, and what they name is there."""

import re
import shlex
from pathlib import Path
from typing import Any

import pytest
from axe_playwright_python.sync_playwright import Axe
from chromium import CHROMIUM, Opened
from command_runner import run
from conftest import ROOT
from processes import python, ran
from promises import require_kept

from sidmacib.command.main import main
from sidmacib.yaml_text import parsed
from workflow import site
from workflow.cases import cases_of
from workflow.configuration import read_study
from workflow.results.tables import MODELS, TABLES, columns_of, meaning, meanings, read_table
from workflow.schema import Study
from workflow.schema.sections import AssemblySection

DOCS = ROOT / "docs"
GALLERY = DOCS / "examples"
MADE = {  # by the site, from the code
    *(DOCS / name for name in ("configuration.md", "structure_file.md", "columns.md")),
    GALLERY / "index.rst",
}
FIRST = [ROOT / "README.md", ROOT / ".github/CONTRIBUTING.md"]
PAGES = [*FIRST, *(page for page in sorted(DOCS.rglob("*.md")) if page not in MADE)]
EXAMPLES = {  # a study for what a page changes of one
    "samples": {"n3": {"locks": 3}},
    "samplings": {"short": {"joints": 64, "seed": 1}},
}

BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\(([^)\s]+)\)")
CODE = re.compile(r"(?<!`)`([^`]+)`(?!`)")
PATH = re.compile(
    r"(?:[\w.*<>-]+/)*[\w.*<>-]+(?:/|\.(?:py|md|yaml|smk|j2|csv|json|jsonl|parquet|png|txt|dat))"
)
OWNED = re.compile(r"`(\w+)`\s+(?:of|in)\s+`([\w/]+\.py)`")


def blocks(page: Path, *languages: str) -> list[str]:
    """Code blocks of a page in any of ``languages``."""
    return [text for language, text in BLOCK.findall(page.read_text()) if language in languages]


def inline(page: Path) -> list[str]:
    """What stands between backticks in a page's prose."""
    prose = BLOCK.sub("", page.read_text())
    return [" ".join(code.split()) for code in CODE.findall(prose)]


def commands(page: Path, program: str) -> list[list[str]]:
    """Words behind ``program`` in commands of a page, in blocks and in its prose."""
    lines = [line for block in blocks(page, "", "sh") for line in block.splitlines()]
    called = [line for line in [*lines, *inline(page)] if line.startswith(program + " ")]
    words = [shlex.split(line, comments=True) for line in called]
    return [each[1:] for each in words if each[0] == program]


@pytest.mark.long
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_python_examples_print_what_their_comments_promise(page: Path) -> None:
    names: dict[str, Any] = {}
    for code in blocks(page, "python"):
        require_kept(code, names)


@pytest.mark.parametrize("page", ["README.md", "docs/faq.md"])
def test_by_how_much_half_the_locks_are_unsafe_is_what_the_table_has(page: str) -> None:
    table = (ROOT / "docs/validation.md").read_text().partition("numbers: options -->")[2]
    rows = [line.split("|") for line in table.partition("<!-- end")[0].splitlines()]
    unsafe = {
        row[1].partition(":")[0].strip(): row[6].strip()
        for row in rows
        if len(row) > 6 and row[2].strip() == "0.005" and row[3].strip() == "(n − 1) / 2"  # noqa: RUF001
    }
    text = (ROOT / page).read_text()
    assert unsafe["n5"] in text and unsafe["n5_fits"] in text


def test_the_readme_is_short_and_has_examples_of_every_kind() -> None:
    readme, contributing, *_ = PAGES
    for page, most in ((readme, 750), (contributing, 900)):
        words = [word for word in page.read_text().split() if re.search(r"\w", word)]
        assert len(words) <= most, page
    assert blocks(readme, "python") and blocks(readme, "yaml")
    assert {("study",), ("test",)} <= {tuple(words) for words in commands(readme, "make")}


@pytest.mark.study
def test_the_command_takes_what_pages_show(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    programs = ("multilock", ".venv/bin/multilock")
    wanted = {tuple(words) for page in PAGES for name in programs for words in commands(page, name)}
    assert len(wanted) >= 5
    # Those whose output is shown are run for it by another test.
    for words in sorted(wanted - {words for _, words, _ in printed_in_pages()}):
        monkeypatch.chdir(ROOT if words[0] in ("assembly", "design") else tmp_path)
        found = run(*words)
        assert found.exit_code == 0, f"multilock {' '.join(words)}: {found.output}"


def printed_in_pages() -> list[tuple[str, tuple[str, ...], str]]:
    """What pages show at a prompt: as it is typed, its words, and what is printed."""
    shown = []
    for block in (block for page in PAGES for block in blocks(page, "console")):
        typed, _, expected = block.partition("\n")
        dollar, program, *words = shlex.split(typed)
        assert (dollar, program) == ("$", "multilock")
        shown.append((typed, tuple(words), expected))
    return shown


@pytest.mark.study
def test_the_command_prints_what_pages_show() -> None:
    shown = printed_in_pages()
    assert len(shown) >= 4
    for typed, words, expected in shown:
        found = run(*words)
        assert found.exit_code == 0, typed
        lines = map(str.rstrip, found.output.splitlines())
        assert "\n".join(lines) == expected.rstrip("\n"), typed


@pytest.mark.study
def test_the_site_is_built_without_warnings(tmp_path: Path, request: pytest.FixtureRequest) -> None:
    command = ("-m", "sphinx", "-q", "-W", "--keep-going", "-b", "html")
    done = python(*command, DOCS, tmp_path)
    assert done.returncode == 0, done.stderr
    assert "sidmacib.joint.Joint" in (tmp_path / "api.html").read_text()
    assert (tmp_path / "howto" / "joint.html").is_file()
    assert (tmp_path / "objects.inv").is_file()
    options = (tmp_path / "options.html").read_text()
    for name, command in main.commands.items():
        for option in command.params:
            assert f'id="cmdoption-multilock-{name}-' in options and option.opts[0] in options
    picture = (tmp_path / "examples" / "arch.html").read_text()
    assert "sphx_glr_arch_001.png" in picture and "of the weight" in picture
    if CHROMIUM is None:
        return
    browser = request.getfixturevalue("browser")  # one for all tests
    for name in ("index", "models", "options", "validation", "examples/index"):
        opened = Opened(browser.new_page())
        opened.page.goto((tmp_path / f"{name}.html").as_uri())
        violations = Axe().run(opened.page).response["violations"]
        assert not violations, (name, [each["id"] for each in violations])
        assert not [url for url in opened.requests if not url.startswith(("file:", "data:"))]
        opened.page.close()
    found = Opened(browser.new_page())
    found.page.goto(f"{(tmp_path / 'search.html').as_uri()}?q=hinge")
    found.page.wait_for_selector("#search-results li:has-text('your first structure')")
    assert "Tutorial: your first structure" in (found.page.text_content("#search-results") or "")
    assert found.errors == []


def test_every_column_of_every_table_has_a_meaning_and_every_meaning_a_column() -> None:
    for table in TABLES:
        for column in columns_of(table):
            assert meaning(table, column), f"{table.name}: {column}"
    names = {table.name: columns_of(table) for table in TABLES}
    everywhere, by_table = meanings()
    assert set(everywhere) <= {column for columns in names.values() for column in columns}
    for name, exceptions in by_table.items():
        assert set(exceptions) <= set(names[name])
        assert all(everywhere.get(column) != text for column, text in exceptions.items())


@pytest.mark.study
def test_columns_that_may_follow_have_a_meaning_too(solved_study: tuple[Study, Path]) -> None:
    rows = read_table(MODELS, solved_study[1] / "tables" / "models.csv")
    patterns = [re.sub(r"<\w+>", r"\\d+", name) for name in columns_of(MODELS)]
    assert all(any(re.fullmatch(each, column) for each in patterns) for column in rows)


def test_the_page_of_columns_has_every_table_and_no_broken_row() -> None:
    text = site.columns_page()
    assert [f"{table.name}.csv" for table in TABLES] == re.findall("^## (.*)", text, re.M)
    rows = [line for line in text.splitlines() if line.startswith("| ")]
    assert {line.count("|") for line in rows} == {3}


def test_make_knows_every_command() -> None:
    wanted = {tuple(words) for page in PAGES for words in commands(page, "make")}
    for words in wanted:
        done = ran("make", "--dry-run", *words)
        assert done.returncode == 0, f"make {' '.join(words)}: {done.stderr}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_configurations_and_values_of_their_keys_in_a_page_are_allowed(page: Path) -> None:
    for block in blocks(page, "yaml"):
        study = read_study(parsed(block.encode()))
        assert cases_of(study) or study.structures
    for code in inline(page):
        key, colon, _ = code.partition(": ")
        if not colon:
            continue
        change = parsed(code.encode())
        if key in AssemblySection.model_fields:
            change = {"assembly": change, "dem": {"engines": ["yade"]}, "models": ["limit"]}
        elif key not in Study.model_fields:
            continue
        read_study({**EXAMPLES, **change})


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_headings_paths_and_names_of_a_page_are_there(page: Path) -> None:
    for target in LINK.findall(page.read_text()):
        if "://" not in target:
            file, _, heading = target.partition("#")
            path = (page.parent / file).resolve() if file else page
            assert path.exists() or path in MADE, target
            if heading:  # as GitHub makes names of titles
                titles = re.findall(r"^#+ (.*)$", BLOCK.sub("", path.read_text()), re.MULTILINE)
                names = [re.sub(r"[^\w\- ]", "", title).strip().lower() for title in titles]
                assert heading in {name.replace(" ", "-") for name in names}, target
    for code in (code for code in inline(page) if re.fullmatch(r"[\w./-]+\.(py|smk|j2|md)", code)):
        places = ROOT / code, page.parent / code, *ROOT.glob(f"*/{code}")
        assert "joint.py" in code or any(place.exists() for place in places), code
    for name, module in OWNED.findall(page.read_text()):
        text = (ROOT / module).read_text()
        assert re.search(rf"^(class|def) {name}\b|^{name}\b.*=", text, re.M), name


def test_the_way_of_the_data_leads_through_files_that_are_there() -> None:
    (way,) = (block for block in blocks(ROOT / ".github/CONTRIBUTING.md", "") if "→" in block)
    for line in way.splitlines():
        folder = ROOT
        for path in (word for word in re.split(r"[\s,]+", line) if PATH.fullmatch(word)):
            place = ROOT / path if (ROOT / path).exists() else folder / path
            assert place.exists(), path
            folder = place if place.is_dir() else place.parent
