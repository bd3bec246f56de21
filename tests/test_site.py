"""The site: what `make docs` makes from the code, its gallery, and schemas for editors."""

import json
import re
from pathlib import Path
from typing import Any

import matplotlib as mpl
import matplotlib.pyplot as plt
import pytest
from conftest import ROOT
from docutils.utils.math.latex2mathml import tex2mathml
from jsonschema import Draft202012Validator
from processes import python
from promises import require_kept
from referencing import Registry
from referencing.jsonschema import DRAFT202012

import sidmacib
from sidmacib.yaml_text import read_yaml
from workflow.site import accessible, described, page, schemas, structure_page

GALLERY = ROOT / "docs" / "gallery"
SCRIPTS = sorted(GALLERY.glob("*.py"))


def test_what_scrolls_can_be_reached_by_the_keyboard() -> None:
    assert accessible("<pre>x</pre>") == '<pre tabindex="0">x</pre>'
    assert accessible('<th class="head"><p></p></th>') == '<td class="head"></td>'
    once = accessible('<aside class="sidebar-drawer">')
    assert once == '<aside aria-label="Pages" class="sidebar-drawer">' == accessible(once)


@pytest.mark.study
@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_an_example_prints_what_it_promises_and_draws_its_picture(
    script: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    require_kept(script.read_text(), {"__name__": "__main__"})
    plt.close("all")
    picture = tmp_path / f"{script.stem}.png"
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert len(script.read_text().splitlines()) <= 65


@pytest.mark.study
def test_the_notebook_runs_and_has_no_outputs() -> None:
    cells = json.loads((GALLERY / "first_joint.ipynb").read_text())["cells"]
    code = [cell for cell in cells if cell["cell_type"] == "code"]
    assert not any(cell["outputs"] or cell["execution_count"] for cell in code)
    with mpl.rc_context({"backend": "Agg"}):
        require_kept("\n".join("".join(cell["source"]) for cell in code), {})
    plt.close("all")


@pytest.mark.study
def test_the_drawing_of_the_rules_is_current() -> None:
    found = (ROOT / "docs" / "images" / "rules.svg").read_text()
    text = python("-m", "snakemake", "--rulegraph", "--forceall", check=True).stdout
    names = dict(re.findall(r"^\s*(\d+)\[label = \"([^\"]+)\"", text, re.M))
    drawn = dict(re.findall(r"<title>(\d+)</title>.*?<text[^>]*>(\w+)<", found, re.S))
    assert set(drawn.values()) == set(names.values()), (
        "draw them again, see .github/CONTRIBUTING.md"
    )
    pairs = re.findall(r"(\d+)&#45;&gt;(\d+)", found)
    arrows = {(drawn[one], drawn[other]) for one, other in pairs}
    known = {(names[one], names[other]) for one, other in re.findall(r"(\d+) -> (\d+)", text)}
    assert arrows <= known
    assert {one for one, _ in known} == {one for one, _ in arrows}


@pytest.mark.parametrize("name", ["Joint", "FaceMaterial", "Elastic", "Demand", "Prices", "law"])
def test_every_parameter_of_the_library_has_words(name: str) -> None:
    found = list(described(getattr(sidmacib, name)))
    assert found
    assert all(words for _, _, words in found)


def test_a_parameter_has_its_type_range_unit_and_choices() -> None:
    found = {name: (kind, words) for name, kind, words in described(sidmacib.Joint)}
    assert found["a"] == ("float", "length of a lock (x); a number greater than 0 (m)")
    assert found["locks"][0] == "int"
    assert found["failure"][1].endswith("``brittle`` or ``softening`` or ``ductile``")
    assert found["inner"] == ("", "material of the inner faces")


@pytest.mark.parametrize("page", sorted((ROOT / "docs").rglob("*.md")), ids=lambda path: path.stem)
def test_equations_can_be_drawn_here_and_on_github(page: Path) -> None:
    fenced = re.compile(r"^```([^\n]*)\n(.*?)^```$", re.M | re.S)
    blocks = [text for language, text in fenced.findall(page.read_text()) if language == "math"]
    prose = re.sub(r"`[^`\n]+`", "", fenced.sub("", page.read_text()))
    lines = re.findall(r"\$([^$]+)\$", prose)
    for equation in [*blocks, *lines]:
        assert tex2mathml(equation).startswith("<math")
        assert "operatorname" not in equation, "GitHub refuses it"
    for equation in lines:
        assert not re.search(r"\\[^A-Za-z]", equation), "Markdown takes the backslash on GitHub"


SCHEMAS = {name: json.loads(text) for name, text in schemas().items()}
BESIDE: Any = Registry().with_resources(
    (name, DRAFT202012.create_resource(schema)) for name, schema in SCHEMAS.items()
)
FILES = {
    path: line.rpartition("/")[2]
    for path in sorted({ROOT / "config.yaml", *(ROOT / "studies").rglob("*.yaml")})
    if (line := path.read_text().partition("\n")[0]).startswith("# yaml-language-server: ")
}


def faults(name: str, value: Any) -> list[str]:
    """The places where ``value`` does not fit a schema."""
    errors = Draft202012Validator(SCHEMAS[name], registry=BESIDE).iter_errors(value)
    return [error.json_path for error in errors]


@pytest.mark.parametrize("name", SCHEMAS)
def test_the_schema_in_the_repository_is_current(name: str) -> None:
    """If it is not: make docs."""
    assert (ROOT / "docs" / name).read_text() == schemas()[name]
    Draft202012Validator.check_schema(SCHEMAS[name])


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_study_or_structure_of_this_checkout_fits_the_schema_that_it_names(path: Any) -> None:
    assert faults(FILES[path], read_yaml(path)) == []
    (where,) = [line for line in path.read_text().splitlines() if "$schema=" in line]
    assert (path.parent / where.partition("$schema=")[2]).is_file()


def test_the_studies_and_the_examples_name_their_schemas() -> None:
    named = {str(path.relative_to(ROOT)) for path in FILES}
    studies = {str(path.relative_to(ROOT)) for path in (ROOT / "studies").glob("*/config.yaml")}
    assert named >= {"config.yaml", "studies/structures/trilith.yaml", *studies}


@pytest.mark.parametrize(
    ("keys", "value", "place"),
    [
        (("geometry", "a"), -1, "$.geometry.a"),
        (("geometry", "c"), 1, "$.geometry"),
        (("meshes",), [], "$.meshes"),
        (("eccentricities",), ["twist"], "$.eccentricities[0]"),
        (("assembly", "failure"), "soft", "$.assembly.failure"),
        (("assembly", "hold_down"), {"force": -1}, "$.assembly.hold_down"),
        (("structures",), {"s": {"description": {"blocks": {}}}}, "$.structures.s.description"),
    ],
)
def test_a_fault_is_seen_by_an_editor(keys: tuple[str, ...], value: Any, place: str) -> None:
    section = study = read_yaml(ROOT / "config.yaml")
    for key in keys[:-1]:
        section = section[key]
    section[keys[-1]] = value
    (found,) = faults("study.schema.json", study)
    assert found.startswith(place)


def test_the_pages_have_all_keys_with_default_and_what_is_allowed() -> None:
    for text, name in ((page(), "study.schema.json"), (structure_page(), "structure.schema.json")):
        for section in (SCHEMAS[name], *SCHEMAS[name]["$defs"].values()):
            for key in section.get("properties", ()):
                assert f"\n| `{key}` | " in text
    assert "| `young` | `1e+10` | a number greater than 0 (Pa) |" in page()
    words = "number of locks; a whole number of at least 1 |"
    assert f"| `count` | must be given | {words}" in structure_page()
    assert "## locks.<number>.condensed\n" in structure_page()
