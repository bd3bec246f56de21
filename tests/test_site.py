"""The site: what `make docs` makes from the code, and the examples of its gallery."""

import json
import re
from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt
import pytest
from conftest import ROOT
from docutils.utils.math.latex2mathml import tex2mathml
from processes import python
from promises import require_kept

import sidmacib
from workflow.site import accessible, described

GALLERY = ROOT / "docs" / "gallery"
SCRIPTS = sorted(GALLERY.glob("*.py"))


def test_what_scrolls_can_be_reached_by_the_keyboard() -> None:
    assert accessible("<pre>x</pre>") == '<pre tabindex="0">x</pre>'
    assert accessible('<th class="head"><p></p></th>') == '<td class="head"></td>'
    once = accessible('<aside class="sidebar-drawer">')
    assert once == '<aside aria-label="Pages" class="sidebar-drawer">' == accessible(once)


def test_an_equation_becomes_mathml() -> None:
    element = "".join(tex2mathml(r"\frac{V}{T_0}", as_block=True).split())
    assert element.startswith("<math") and 'display="block"' in element
    assert "<mfrac>" in element and "<msub><mi>T</mi><mn>0</mn></msub>" in element


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
    assert set(drawn.values()) == set(names.values()), "draw them again, see CONTRIBUTING.md"
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
    text = re.sub(r"^```(?!math).*?^```$|`[^`\n]+`", "", page.read_text(), flags=re.M | re.S)
    blocks = re.findall(r"^```math\n(.*?)^```$", text, re.M | re.S)
    lines = re.findall(r"\$([^$]+)\$", re.sub(r"^```math.*?^```$", "", text, flags=re.M | re.S))
    for equation in [*blocks, *lines]:
        assert tex2mathml(equation).startswith("<math")
        assert "operatorname" not in equation, "GitHub refuses it"
    for equation in lines:
        assert not re.search(r"\\[^A-Za-z]", equation), "Markdown takes the backslash on GitHub"
