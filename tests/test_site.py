"""The site: what `make docs` makes from the code."""

import pytest

from workflow.site.mathml import mathml


def test_an_equation_becomes_mathml() -> None:
    element = mathml(r"\frac{V}{T_0}", "block")
    assert element.startswith("<math") and 'display="block"' in element
    assert "<mfrac>" in element and "<msub><mi>T</mi><mn>0</mn></msub>" in element


@pytest.mark.parametrize("latex", [r"\nosuchcommand x", r"\begin{aligned} a &= b \end{aligned}"])
def test_an_equation_that_cannot_be_drawn_is_refused(latex: str) -> None:
    with pytest.raises(ValueError, match="no MathML"):
        mathml(latex)
