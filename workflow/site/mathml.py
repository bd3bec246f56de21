"""Equations of the site as MathML, which browsers draw without a script and without a network.

The renderers that come with Sphinx load a script from another machine (MathJax) or draw pictures
with LaTeX.
"""

import re

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.util.typing import ExtensionMetadata
from sphinx.writers.html5 import HTML5Translator

# What the converter does not know stays in its output: commands, and the marks of alignments.
UNKNOWN = re.compile(r"\\[A-Za-z]+|<mi>&</mi>")


def mathml(latex: str, display: str = "inline") -> str:
    """The element ``math`` of an equation in LaTeX; ``display`` is inline or block.

    Raises:
        ValueError: for a command that the converter does not know.

    """
    element: str = convert(latex, display=display)
    if unknown := UNKNOWN.search(element):
        raise ValueError(f"{latex}: {unknown.group()} has no MathML")
    return element


def inline(translator: HTML5Translator, node: nodes.Element) -> None:
    """Write an equation within a line."""
    translator.body.append(mathml(node.astext()))
    raise nodes.SkipNode


def block(translator: HTML5Translator, node: nodes.Element) -> None:
    """Write an equation between lines, which scrolls where it is wider than the page."""
    equation = mathml(node.astext(), "block")
    translator.body.append(f'<div class="equation" tabindex="0">{equation}</div>\n')
    raise nodes.SkipNode


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register the renderer for ``html_math_renderer``."""
    app.add_html_math_renderer("mathml", (inline, None), (block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
