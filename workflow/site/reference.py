"""Pages in Markdown that are made from the code: keys of the configuration, columns of tables."""

import math
import types
import typing
from collections.abc import Iterator, Mapping
from enum import StrEnum
from pathlib import Path
from typing import Any

from pydantic import BeforeValidator
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from sidmacib.joint.hold_down import HoldDown
from sidmacib.quantities import Number, Span
from workflow.results.columns import TABLES, columns_of, meaning
from workflow.results.tables import Table
from workflow.schema import Study
from workflow.schema.measured import words
from workflow.schema.structures import samples
from workflow.schema.values import Section, eccentricity, entries, folder, name, several, some

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


def write_pages(folder: Path) -> None:
    """Write all pages into ``folder``."""
    (folder / "configuration.md").write_text(page())
    (folder / "columns.md").write_text(columns_page())


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
    """The page of keys, a section for each section of the configuration."""
    lines = [INTRODUCTION]
    places: dict[type[Section], list[str]] = {}
    for path, section in sections(Study, ""):
        places.setdefault(section, []).append(path)
    for section, paths in places.items():
        heading, *others = (path or "The study" for path in paths)
        also = (
            [f"The same keys: {', '.join(f'`{path}`' for path in others)}.", ""] if others else []
        )
        lines += [f"## {heading}", "", _words(section), "", *also, *_table(section), ""]
    return "\n".join(lines)


def sections(section: type[Section], path: str) -> Iterator[tuple[str, type[Section]]]:
    """``section`` and those below it, each with the path of its keys."""
    yield path, section
    for key, field in section.model_fields.items():
        here = f"{path}.{key}" if path else key
        for below, many in _below(field.annotation):
            yield from sections(below, f"{here}.<name>" if many else here)


def _below(annotation: Any, many: bool = False) -> Iterator[tuple[type[Section], bool]]:
    """Sections in an annotation, and whether there is one for each name."""
    if isinstance(annotation, type) and issubclass(annotation, Section):
        yield annotation, many
    origin = typing.get_origin(annotation)
    for part in typing.get_args(annotation):
        yield from _below(part, many or origin in (dict, tuple))


def _words(section: type[Section]) -> str:
    text = " ".join((section.__doc__ or "").replace("``", "`").split())
    return text.removesuffix(" ")


def _table(section: type[Section]) -> list[str]:
    rows = ["| key | default | allowed |", "| --- | --- | --- |"]
    for key, field in section.model_fields.items():
        default = FILLED.get(key) if section is Study else None
        rows.append(f"| `{key}` | {default or _default(field)} | {_allowed(field)} |")
    return rows


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return "must be given"
    value = field.default
    if value is PydanticUndefined or isinstance(value, Section) or value in ((), {}):
        return "see below" if isinstance(value, Section) else "none"
    if value is None:
        return "not given"
    if isinstance(value, Mapping):
        return ", ".join(f"`{key}`" for key in value)
    return f"`{_spelled(value)}`"


def _spelled(value: Any) -> str:
    if isinstance(value, tuple | list):
        return f"[{', '.join(map(_spelled, value))}]"
    if isinstance(value, HoldDown):
        return str(value.kind)
    if isinstance(value, float):
        return "torsion" if math.isinf(value) else f"{value:g}"
    return str(value).lower() if isinstance(value, bool) else str(value)


def _allowed(field: FieldInfo) -> str:
    """The allowed values of a key, from its checks."""
    checks = list(dict.fromkeys([*_checks(field.metadata), *_inner(field.annotation)]))
    return "; ".join(checks).replace("|", "\\|") or "see below"


def _inner(annotation: Any) -> Iterator[str]:
    if isinstance(annotation, type) and issubclass(annotation, StrEnum):
        yield " or ".join(f"`{member}`" for member in annotation)
    elif annotation is bool:
        yield "true or false"
    elif typing.get_origin(annotation) is typing.Annotated:
        kind, *metadata = typing.get_args(annotation)
        yield from _checks(metadata)
        yield from _inner(kind)
    else:
        if typing.get_origin(annotation) is tuple:
            yield "a list"
        for part in typing.get_args(annotation):
            if part is not types.NoneType:
                yield from _inner(part)


def _checks(metadata: Any) -> Iterator[str]:
    for each in metadata:
        check: Any = each.func if isinstance(each, BeforeValidator) else None
        if isinstance(each, Number):
            one = each.at_least == each.at_most
            yield f"{each.at_least:g}" if one else each.range(kind=True)
        elif isinstance(each, Span):
            yield f"the least and the largest, each {each.number.range(kind=True)}"
        elif check in WORDS:
            yield WORDS[check]
        elif check is not None and check.__doc__:
            (first, *_) = check.__doc__.split(".")
            yield first[:1].lower() + first[1:].replace("``", "`")
