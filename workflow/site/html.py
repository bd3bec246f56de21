"""An extension of Sphinx: equations without a script, and pages for keyboards and screen readers.

The renderers that come with Sphinx load a script from another machine (MathJax) or draw pictures
with LaTeX; docutils, on which it builds, writes MathML, which browsers draw by themselves.
"""

from pathlib import Path

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.util.typing import ExtensionMetadata
from sphinx.writers.html5 import HTML5Translator

CHANGES = {
    # Code and tables that scroll can be reached by the keyboard.
    "<pre>": '<pre tabindex="0">',
    '<div class="table-wrapper': '<div tabindex="0" class="table-wrapper',
    # Captions of the navigation are headings of a level.
    'class="caption" role="heading"': 'class="caption" role="heading" aria-level="2"',
    # Both sides of a page have names.
    '<aside class="sidebar-drawer"': '<aside aria-label="Pages" class="sidebar-drawer"',
    '<aside class="toc-drawer': '<aside aria-label="On this page" class="toc-drawer',
    # A column without a heading has no empty one.
    '<th class="head"><p></p></th>': '<td class="head"></td>',
}


def accessible(page: str) -> str:
    """The HTML of a page with all `CHANGES`."""
    for old, new in CHANGES.items():
        page = page.replace(old, new)
    return page


def change_pages(app: Sphinx, error: Exception | None) -> None:
    """Change all pages that were built."""
    if error is None and app.builder.format == "html":
        for path in Path(app.outdir).rglob("*.html"):
            path.write_text(accessible(path.read_text()))


def inline(translator: HTML5Translator, node: nodes.Element) -> None:
    """Write an equation within a line."""
    translator.body.append(tex2mathml(node.astext()))
    raise nodes.SkipNode


def block(translator: HTML5Translator, node: nodes.Element) -> None:
    """Write an equation between lines, which scrolls where it is wider than the page."""
    equation = tex2mathml(node.astext(), as_block=True)
    translator.body.append(f'<div class="equation" tabindex="0">{equation}</div>\n')
    raise nodes.SkipNode


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register the renderer and, for when all pages are written, their changes."""
    app.add_html_math_renderer("mathml", (inline, None), (block, None))
    app.connect("build-finished", change_pages)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
