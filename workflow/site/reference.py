"""What is made from the code: pages of keys and of columns, and schemas of files for editors."""

import json
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from sidmacib.design.file import DesignFile
from workflow.results.columns import TABLES, columns_of, meaning
from workflow.results.tables import Table
from workflow.schema import Study
from workflow.schema.structures import FILE

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
