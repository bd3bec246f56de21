"""The site: what `make docs` makes from the code, and the examples of its gallery."""

import json
from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt
import pytest
from conftest import ROOT
from promises import require_kept

from workflow.site.gallery import examples, index, page, read, run, write_gallery
from workflow.site.mathml import mathml

GALLERY = ROOT / "docs" / "gallery"
SCRIPTS = sorted(GALLERY.glob("*.py"))
SCRIPT = '''"""A title

Some words.
"""

from pathlib import Path

Path("short.png").write_bytes(b"picture")
print("V =", 2.5)
'''


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
