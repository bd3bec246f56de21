"""Meanings of the library's parameters, on its page.

Words come from the docstring (``name``: words), from the joint's parameters, or from the docstring
of its class; ranges and units from the annotation.
"""

import inspect
import re
import typing
from collections.abc import Iterator
from enum import StrEnum
from typing import Any

from sphinx.application import Sphinx
from sphinx.util.typing import ExtensionMetadata

from sidmacib.joint.joint import Joint
from sidmacib.joint.parameters import PARAMETERS
from sidmacib.mechanics.assembly import Elastic
from sidmacib.validation import UNIONS, number_of

# Names, what may stand in brackets behind them, and words up to the end of the sentence or clause.
SAID = re.compile(r"((?:``\w+``(?:, | and )?)+)(?: \([^)]*\))?: (.+?)[.;](?=\s|$)")
OF_JOINT = {Joint: "", Elastic: "elastic"}  # parts whose fields `PARAMETERS` describes


def described(thing: Any) -> Iterator[tuple[str, str, str]]:
    """Name, type and meaning of each parameter; no type where its annotation reads well."""
    owner = thing.__init__ if inspect.isclass(thing) else thing
    kinds = typing.get_type_hints(owner, include_extras=True)
    said = {
        name: words
        for names, words in SAID.findall(" ".join((inspect.getdoc(thing) or "").split()))
        for name in re.findall(r"``(\w+)``", names)
    }
    for name in inspect.signature(thing).parameters:
        if name in kinds:
            kind = _without_none(kinds[name])
            words = _of_joint(thing, name) or said.get(name) or _of_class(kind)
            yield name, _type(kind), "; ".join(filter(None, (words, _range(kind))))


def _without_none(kind: Any) -> Any:
    """The other member of a union with None."""
    parts = [each for each in typing.get_args(kind) if each is not type(None)]
    return parts[0] if typing.get_origin(kind) in UNIONS and len(parts) == 1 else kind


def _of_joint(thing: Any, name: str) -> str:
    part = OF_JOINT.get(thing)
    field = f"{part}.{name}" if part else name
    words = (each.words for each in PARAMETERS.values() if each.fields[0] == field)
    return "" if part is None else next(words, "")


def _of_class(kind: Any) -> str:
    """The first sentence of the docstring of a class of the library."""
    if not (inspect.isclass(kind) and kind.__module__.startswith("sidmacib")):
        return ""
    words = " ".join((inspect.getdoc(kind) or "").split("\n\n")[0].split())
    return re.split(r"[.;:](?:\s|$)", words)[0]


def _range(kind: Any) -> str:
    """The range of a number with its unit, or the words of a choice."""
    if number := number_of(kind):
        return number.range(kind=True)
    if inspect.isclass(kind) and issubclass(kind, StrEnum):
        return " or ".join(f"``{member}``" for member in kind)
    return ""


def _type(kind: Any) -> str:
    return typing.get_args(kind)[0].__name__ if number_of(kind) else ""


def add(app: Sphinx, what: str, name: str, thing: Any, options: object, lines: list[str]) -> None:
    """Add a line for each parameter to the docstring of a class or function."""
    if what not in ("class", "function", "method"):
        return
    lines.append("")
    for parameter, kind, words in described(thing):
        if words:
            lines.append(f":param {parameter}: {words}")
        if kind:
            lines.append(f":type {parameter}: {kind}")
    lines.append("")


def setup(app: Sphinx) -> ExtensionMetadata:
    """Have autodoc call `add`."""
    app.connect("autodoc-process-docstring", add)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
