"""Configuration of Sphinx, which builds the pages as a site: `make docs`."""

import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from workflow.site import write_pages  # noqa: E402

project = "multilock"
author = "the multilock developers"
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.viewcode",
    "sphinx_click",
    "sphinx_gallery.gen_gallery",
    "workflow.site",
]
html_theme = "furo"
html_title = "multilock"
html_math_renderer = "mathml"  # no script, no network
html_static_path = ["static"]
html_css_files = ["pages.css"]
html_show_copyright = False
html_show_search_summary = False  # excerpts are fetched, which pages opened as files may not do
highlight_language = "none"  # of blocks that name none: commands and what they print
html_show_sourcelink = False
myst_heading_anchors = 3
myst_enable_extensions = ["dollarmath"]
myst_fence_as_directive = ["math"]  # GitHub draws these fences too
smartquotes = False  # a flag has two hyphens
myst_links_external_new_tab = False
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
autodoc_typehints = "description"
exclude_patterns = ["_build", "paper", "gallery/GALLERY_HEADER.rst"]
nitpicky = False
suppress_warnings = ["myst.xref_missing"]  # links to files outside of the site; tests follow them
sphinx_gallery_conf = {
    "examples_dirs": "gallery",
    "gallery_dirs": "examples",
    "filename_pattern": r"\.py$",  # all of them run
    "abort_on_example_error": True,
    "within_subsection_order": "ExampleTitleSortKey",
    "download_all_examples": False,
    "min_reported_time": 3600,
}

write_pages(Path(__file__).parent)  # of keys and columns
