"""The site: what `make docs` makes from the code, and the examples of its gallery."""

import json
import re
from pathlib import Path

import click
import matplotlib as mpl
import matplotlib.pyplot as plt
import pytest
from conftest import ROOT
from promises import require_kept

import sidmacib
from sidmacib.command.main import main
from sidmacib.joint.parameters import PARAMETERS
from workflow.site import rule_graph
from workflow.site.accessible import accessible
from workflow.site.gallery import examples, index, page, read, run, write_gallery
from workflow.site.mathml import mathml
from workflow.site.options import page as page_of_options
from workflow.site.parameters import described
from workflow.site.rule_graph import before, layout, reduced, rules, svg

GALLERY = ROOT / "docs" / "gallery"
SCRIPTS = sorted(GALLERY.glob("*.py"))
SCRIPT = '''"""A title

Some words.
"""

from pathlib import Path

Path("short.png").write_bytes(b"picture")
print("V =", 2.5)
'''


def test_what_scrolls_can_be_reached_by_the_keyboard() -> None:
    assert accessible("<pre>x</pre>") == '<pre tabindex="0">x</pre>'
    assert accessible('<th class="head"><p></p></th>') == '<td class="head"></td>'
    once = accessible('<aside class="sidebar-drawer">')
    assert once == '<aside aria-label="Pages" class="sidebar-drawer">' == accessible(once)


def test_an_equation_becomes_mathml() -> None:
    element = mathml(r"\frac{V}{T_0}", "block")
    assert element.startswith("<math") and 'display="block"' in element
    assert "<mfrac>" in element and "<msub><mi>T</mi><mn>0</mn></msub>" in element


@pytest.mark.parametrize("latex", [r"\nosuchcommand x", r"\begin{aligned} a &= b \end{aligned}"])
def test_an_equation_that_cannot_be_drawn_is_refused(latex: str) -> None:
    with pytest.raises(ValueError, match="no MathML"):
        mathml(latex)


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


def test_every_example_has_a_page_that_the_gallery_leads_to() -> None:
    found = examples(GALLERY)
    assert {example.name for example in found} == {script.stem for script in SCRIPTS}
    for example in found:
        assert f"[![]({example.name}.png) {example.title}]({example.name}.md)" in index(found)
        assert f"\n{example.name}\n" in index(found)


def test_a_page_has_text_picture_output_and_code(tmp_path: Path) -> None:
    (tmp_path / "short.py").write_text(SCRIPT)
    made = tmp_path / "made"
    made.mkdir()
    text = page(read(tmp_path / "short.py"), run(tmp_path, "short", made))
    assert text.startswith("# A title\n\nSome words.\n\n![A title](short.png)\n")
    assert "```text\nV = 2.5\n```" in text
    assert "```python\nfrom pathlib import Path\n" in text
    assert (made / "short.png").read_bytes() == b"picture"


def test_a_script_runs_again_only_where_it_has_changed(tmp_path: Path) -> None:
    script = tmp_path / "short.py"
    script.write_text(SCRIPT)
    write_gallery(tmp_path)
    picture = tmp_path / "made" / "short.png"
    picture.unlink()
    write_gallery(tmp_path)
    assert not picture.exists()
    script.write_text(SCRIPT.replace("2.5", "3.5"))
    write_gallery(tmp_path)
    assert picture.exists()
    assert "V = 3.5" in (tmp_path / "made" / "short.md").read_text()


def test_a_script_that_fails_or_says_nothing_is_refused(tmp_path: Path) -> None:
    (tmp_path / "bad.py").write_text('"""A title."""')
    with pytest.raises(ValueError, match="title and text"):
        read(tmp_path / "bad.py")
    (tmp_path / "bad.py").write_text("1 / 0")
    with pytest.raises(RuntimeError, match="ZeroDivisionError"):
        run(tmp_path, "bad", tmp_path)


def test_every_option_of_every_command_is_on_its_page_once() -> None:
    text = page_of_options()
    assert re.findall("^## (.*)", text, re.M) == ["A joint", *sorted(main.commands)]
    for command in main.commands.values():
        for param in command.params:
            name = param.opts[0] if isinstance(param, click.Option) else param.human_readable_name
            assert f"| `{name}`" in text
    assert text.count("Young's modulus of elastic pieces, Pa. Default: rigid pieces.") == 1
    joint = text[: text.index("## assembly")]
    assert joint.count("\n| `-") == len(PARAMETERS) + 2  # push and file


GRAPH = """
	0[label = "all", color = "red"];
	1[label = "solve", color = "red"];
	2[label = "collect", color = "red"];
	1 -> 2
	1 -> 0
	2 -> 0
"""


def test_an_arrow_that_others_imply_is_left_out() -> None:
    graph = rule_graph.read(GRAPH)
    assert before(graph, "all") == {"solve", "collect"}
    assert reduced(graph) == {
        "all": frozenset({"collect"}),
        "collect": frozenset({"solve"}),
        "solve": frozenset(),
    }


def test_a_long_arrow_passes_beside_the_rules_between() -> None:
    places = layout(rule_graph.read(GRAPH))
    (gap,) = set(places) - {"all", "solve", "collect"}
    assert places[gap][1] == places["collect"][1]
    assert abs(places[gap][0] - places["collect"][0]) > rule_graph.BOX[0] / 2
    assert places["solve"][1] < places["collect"][1] < places["all"][1]


@pytest.mark.study
def test_the_drawing_of_the_rules_is_current() -> None:
    assert (ROOT / "docs" / "images" / "rules.svg").read_text() == svg(reduced(rules()))


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


def test_words_of_a_parameter_come_from_the_docstring_or_its_class() -> None:
    found = {name: words for name, _, words in described(sidmacib.Demand)}
    assert found["torque"] == "M, in N m"
    found = {name: words for name, _, words in described(sidmacib.law)}
    assert found["push"].startswith("The direction in which the lateral load acts; ``+y``")


@pytest.mark.parametrize("page", sorted((ROOT / "docs").rglob("*.md")), ids=lambda path: path.stem)
def test_equations_can_be_drawn_here_and_on_github(page: Path) -> None:
    text = re.sub(r"^```(?!math).*?^```$|`[^`\n]+`", "", page.read_text(), flags=re.M | re.S)
    blocks = re.findall(r"^```math\n(.*?)^```$", text, re.M | re.S)
    lines = re.findall(r"\$([^$]+)\$", re.sub(r"^```math.*?^```$", "", text, flags=re.M | re.S))
    for equation in [*blocks, *lines]:
        assert mathml(equation).startswith("<math")
        assert "operatorname" not in equation, "GitHub refuses it"
    for equation in lines:
        assert not re.search(r"\\[^A-Za-z]", equation), "Markdown takes the backslash on GitHub"
