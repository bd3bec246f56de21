"""A page that shows what models say of a structure: data, styles and scripts in one file."""

import importlib
import json
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from sidmacib.errors import lacks
from sidmacib.quantities import digits

HERE = Path(__file__).parent
SCRIPTS = ("chart.js", "parts.js", "structure.js", "report.js", "address.js")
TEMPLATE = HERE / "report.html.j2"
DIGITS = 7  # of numbers that are drawn
# What laboratory tests say of the static model of structures: see docs/measured.md.
VALIDATED = (
    "24 loads measured on 14 dry granite walls are 0.99 to 1.22 of the computed ones; 7 on "
    "sandstone walls, which slid or were crushed at the toe, 0.75 to 1.57; of 500 loads of dry "
    "contacts in shear and torsion, medians are 0.95 to 1.12. No laboratory test has validated "
    "bonds or locks."
)


def page(data: Mapping[str, Any], words: Mapping[str, Any], template: Path = TEMPLATE) -> str:
    """The page as HTML, which needs no network.

    ``data``: for each of ``structures`` its ``title``, ``shape``, ``loads``, and for each of
    ``models`` its label and the values of `Drawn`; those of the first are shown first. ``words``:
    of the ``template``. ValueError without the package plotly.
    """
    # Names of blocks may hold anything: nothing in them ends the script that they are in.
    short = json.loads(json.dumps(data, allow_nan=False), parse_float=_rounded)
    text = json.dumps(short, separators=(",", ":")).replace("</", "<\\/")
    return rendered(
        template,
        data=text,
        plotly=plotly_js(),
        style=(HERE / "report.css").read_text(),
        script="".join((HERE / name).read_text() for name in SCRIPTS),
        **words,
    )


def plotly_js() -> str:
    """The scripts of plotly; ValueError without that package."""
    try:
        return str(importlib.import_module("plotly.offline").get_plotlyjs())
    except ImportError:
        raise lacks("plotly", "report") from None


def rendered(template: Path, **words: Any) -> str:
    """A ``template`` with its ``words``, the ``version`` of multilock, and what is ``validated``.

    It may include others beside it or in this folder.
    """
    folders = FileSystemLoader([HERE, template.parent])
    environment = Environment(loader=folders, undefined=StrictUndefined, autoescape=True)
    environment.filters["digits"] = digits
    given = {"version": version("multilock"), "validated": VALIDATED}
    return environment.get_template(template.name).render(**given | words)


def _rounded(text: str) -> float:
    return float(f"{float(text):.{DIGITS}g}")
