"""Configuration of Sphinx, which builds the pages as a site: `make docs`."""

import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from workflow.site import (  # noqa: E402
    gallery,
    options,
    reference,
)

project = "multilock"
author = "the multilock developers"
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.viewcode",
    "workflow.site.accessible",
    "workflow.site.mathml",
    "workflow.site.parameters",
]
html_theme = "furo"
html_title = "multilock"
html_math_renderer = "mathml"  # no script, no network
html_static_path = ["static"]
html_css_files = ["pages.css"]
html_show_copyright = False
html_show_sourcelink = False
myst_heading_anchors = 3
myst_enable_extensions = ["dollarmath"]
myst_fence_as_directive = ["math"]  # GitHub draws these fences too
myst_links_external_new_tab = False
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
autodoc_typehints = "description"
exclude_patterns = ["_build", "paper"]
nitpicky = False
suppress_warnings = ["myst.xref_missing"]  # links to files outside of the site; tests follow them

# Pages of keys, columns and options are made each time, pictures where code has changed.
reference.write_pages(Path(__file__).parent)
options.write_options(Path(__file__).parent)
gallery.write_gallery(Path(__file__).parent / "gallery")
