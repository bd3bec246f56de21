"""The documentation site: pages and schemas made from the code, and an extension of Sphinx.

`write_pages` writes the pages of keys and of columns, and the schemas of files for editors; so does
`python -m workflow.site`, without building the site. The extension adds the meanings of parameters
to the library's page: words from the docstring (``name``: words), from the joint's parameters, or
from the docstring of its class; ranges and units from the annotation. It writes equations as MathML
by docutils, as the renderers of Sphinx load a script from another machine or need LaTeX, and makes
all pages fit for keyboards and screen readers.
"""

import inspect
import json
import math
import re
import typing
from collections.abc import Iterator, Mapping
from enum import StrEnum
from pathlib import Path
from typing import Any

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.util.typing import ExtensionMetadata
from sphinx.writers.html5 import HTML5Translator

from sidmacib.design.file import DesignFile
from sidmacib.joint import Joint
from sidmacib.joint.parameters import PARAMETERS
from sidmacib.mechanics.assembly import Elastic
from sidmacib.validation import UNIONS, number_of
from workflow.results.tables import TABLES, Table, columns_of, meaning
from workflow.schema import FILE, Study

Schema = dict[str, Any]
FILLED = {"models": "all that can do it", "dem": "all engines that can do it"}  # by the reader
INTRODUCTION = """# Every key of the configuration

A study is a YAML file of these keys. Omitted keys take their defaults. Each error is reported on
one line, with the key, its value and what is allowed.
"""


COLUMNS_INTRODUCTION = """# Every column of the tables

The tables of a study are in `tables/` of the results folder, as CSV and Parquet. Column names end
with the unit; numbers without one are dimensionless. A cell is empty where a model does not give
that number. The key columns, which identify the rows of a table, are in **bold**. Tables that only
a campaign of `studies` writes are not listed.
"""


STRUCTURE_INTRODUCTION = """# Every key of the file of a structure

The YAML file that `multilock assembly`, `multilock design` and the `structures` of a study read;
for examples see [Arches, walls, any blocks](howto/structure.md). Lengths are in m, forces in N,
stresses in Pa, stiffnesses in Pa/m.
"""
# Names, what may stand in brackets behind them, and words up to the end of the sentence or clause.
SAID = re.compile(r"((?:``\w+``(?:, | and )?)+)(?: \([^)]*\))?: (.+?)[.;](?=\s|$)")
OF_JOINT = {Joint: "", Elastic: "elastic"}  # parts whose fields `PARAMETERS` describes
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


def write_pages(folder: Path) -> None:
    """Write all pages, and the schemas for editors, into ``folder``."""
    (folder / "configuration.md").write_text(page())
    (folder / "structure_file.md").write_text(structure_page())
    (folder / "columns.md").write_text(columns_page())
    for name, text in schemas().items():
        (folder / name).write_text(text)


def columns_page() -> str:
    """The page of columns, a section for each table."""
    sections_of_tables = ["\n".join(_section(table)) for table in TABLES]
    return "\n".join([COLUMNS_INTRODUCTION, *sections_of_tables])


def _section(table: Table) -> list[str]:
    rows = [
        f"| {f'**`{name}`**' if name in table.key else f'`{name}`'} | {meaning(table, name)} |"
        for name in columns_of(table)
    ]
    return [f"## {table.name}.csv", "", "| column | meaning |", "| --- | --- |", *rows, ""]


def page() -> str:
    """The page of the keys of a study."""
    schema = Study.model_json_schema()
    return "\n".join([INTRODUCTION, *_sections(schema, "The study", FILLED)])


def structure_page() -> str:
    """The page of the keys of a structure's file."""
    schema = DesignFile.model_json_schema()
    return "\n".join([STRUCTURE_INTRODUCTION, *_sections(schema, "The file", {})])


def _sections(schema: Schema, first: str, filled: Mapping[str, str]) -> Iterator[str]:
    """A heading and a table for each section, where it stands first."""
    places: dict[str, list[str]] = {}
    for path, name in _paths(schema, schema, ""):
        places.setdefault(name, []).append(path)
    for name, paths in places.items():
        section = schema["$defs"][name] if name else schema
        words = " ".join(section["description"].replace("``", "`").split())
        yield f"## {paths[0] or first}\n\n{words}\n"
        if paths[1:]:
            yield f"The same keys: {', '.join(f'`{path}`' for path in paths[1:])}.\n"
        yield "| key | default | value |\n| --- | --- | --- |"
        needed = section.get("required", ())
        for key, node in section["properties"].items():
            default = "must be given" if key in needed else _default(node.get("default", ""))
            default = default if name else filled.get(key, default)
            words = "; ".join(filter(None, (node.get("description"), _allowed(schema, node))))
            yield f"| `{key}` | {default} | {words} |"
        yield ""


def _paths(schema: Schema, section: Schema, path: str) -> Iterator[tuple[str, str]]:
    """Each section below ``path``, by its path and its name in the ``schema``; "" for the first."""
    yield path, section["title"] if path else ""
    for key, node in section["properties"].items():
        for name, here in _below(node, f"{path}.{key}" if path else key):
            below = schema["$defs"][name]
            if "properties" in below:
                yield from _paths(schema, below, here)


def _below(node: Schema, path: str) -> Iterator[tuple[str, str]]:
    """Names of the sections that the node at ``path`` refers to, and their paths."""
    if "$ref" in node:
        yield node["$ref"].rsplit("/", 1)[1], path
    for each in node.get("anyOf", ()):
        yield from _below(each, path)
    for key, of in (("items", "number"), ("additionalProperties", "name")):
        if isinstance(node.get(key), dict):
            yield from _below(node[key], f"{path}.<{of}>")


def _default(value: Any) -> str:
    if isinstance(value, dict):
        return "see below"
    return "not given" if value is None else f"`{_spelled(value)}`" if value != "" else "none"


def _spelled(value: Any) -> str:
    if isinstance(value, list):
        return f"[{', '.join(map(_spelled, value))}]"
    if isinstance(value, float):
        return "torsion" if math.isinf(value) else f"{value:g}"
    return str(value).lower() if isinstance(value, bool) else str(value)


def _allowed(schema: Schema, node: Schema) -> str:
    """What a value may be, in words."""
    names = node.get("enum", [node["const"]] if "const" in node else ())
    if "allowed" in node or names:
        words = str(node.get("allowed") or " or ".join(f"`{name}`" for name in names))
    elif "$ref" in node:
        below = schema["$defs"][node["$ref"].rsplit("/", 1)[1]]
        words = "see below" if "properties" in below else _allowed(schema, below)
    elif "anyOf" in node:
        every = dict.fromkeys(_allowed(schema, each) for each in node["anyOf"])
        words = " or ".join(filter(None, every))
    elif node.get("type") == "array":
        some = "at least one" * (node.get("minItems") == 1)
        words = "; ".join(filter(None, ("a list", _allowed(schema, node.get("items", {})), some)))
    else:
        some = "; at least one" * ("minProperties" in node)
        kinds = {"boolean": "true or false", "string": "a text", "object": f"by name{some}"}
        words = kinds.get(node.get("type", ""), "")
    return words


def schemas() -> dict[str, str]:
    """The schemas for editors by the names of their files, with a line for each section."""
    study, structure = Study.model_json_schema(), DesignFile.model_json_schema()
    for section in (study, study["$defs"]["DemSection"]):
        del section["required"]  # the reader takes all models and engines that can do it
    return {"study.schema.json": _lines(study), FILE: _lines(structure)}


def _lines(schema: Schema) -> str:
    schema = _for_editors(schema)
    parts = {
        name: ",\n".join(f'"{k}": {json.dumps(v)}' for k, v in schema.pop(name).items())
        for name in ("$defs", "properties")
    }
    head = ",\n".join(f'"{key}": {json.dumps(value)}' for key, value in schema.items())
    return "{\n" + head + "".join(f',\n"{k}": {{\n{v}\n}}' for k, v in parts.items()) + "\n}\n"


def _for_editors(node: Any) -> Any:
    """A schema whose descriptions say what is allowed, too."""
    if isinstance(node, float) and math.isinf(node):
        return "torsion"
    if isinstance(node, list):
        return list(map(_for_editors, node))
    if not isinstance(node, dict):
        return node
    texts = {key: node[key] for key in ("description", "allowed") if type(node.get(key)) is str}
    left_out = {
        *texts,
        *(key for key in ("title", "default") if not isinstance(node.get(key), dict)),
    }
    found = {
        {"see": "$ref"}.get(key, key): _for_editors(value)
        for key, value in node.items()
        if key not in left_out
    }
    return {**found, "description": "; ".join(texts.values())} if texts else found


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
            parts = [each for each in typing.get_args(kinds[name]) if each is not type(None)]
            optional = typing.get_origin(kinds[name]) in UNIONS and len(parts) == 1
            kind = parts[0] if optional else kinds[name]
            words = _of_joint(thing, name) or said.get(name) or _of_class(kind)
            numbers = typing.get_args(kind)[0].__name__ if number_of(kind) else ""
            yield name, numbers, "; ".join(filter(None, (words, _range(kind))))


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
    """Register the renderer, the meanings of parameters and the changes of pages."""
    app.connect("autodoc-process-docstring", add)
    app.add_html_math_renderer("mathml", (inline, None), (block, None))
    app.connect("build-finished", change_pages)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


if __name__ == "__main__":
    write_pages(Path(__file__).parents[1] / "docs")
