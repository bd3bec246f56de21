"""What the theme's pages lack for people who use a keyboard or a screen reader."""

from pathlib import Path

from sphinx.application import Sphinx
from sphinx.util.typing import ExtensionMetadata

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


def setup(app: Sphinx) -> ExtensionMetadata:
    """Change the pages when all are written."""
    app.connect("build-finished", change_pages)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
