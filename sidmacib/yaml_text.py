"""Read YAML text as plain values: any bytes give a value or one line with the place of the fault.

Scalars are read as in YAML 1.2's core schema, but in decimals only: 6e-2 is a number, while ``no``,
010 and dates are text. Keys are always text. Duplicate keys, tags, and aliases that grow beyond
bounds are refused: PyYAML's loaders keep the last of two keys and follow aliases without end, and
ruamel.yaml (YAML 1.2) takes 010, 0x10 and 1_000 for numbers.
"""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml

from sidmacib.quantities import number_in

# One reader for the workflow's configuration and for the command's joints.
MAX_BYTES = 4_000_000
MAX_DEPTH = 20
MAX_VALUES = 200_000

_WORDS = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL"), None),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
    **dict.fromkeys((".inf", ".Inf", ".INF", "+.inf", "+.Inf", "+.INF"), math.inf),
    **dict.fromkeys(("-.inf", "-.Inf", "-.INF"), -math.inf),
    **dict.fromkeys((".nan", ".NaN", ".NAN"), math.nan),
}
_Loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # ten times as fast, where it is available


class TextError(ValueError):
    """The text is not one YAML document of plain values; the message is one line."""


def read_yaml(path: Path) -> Any:
    """The value that the YAML file ``path`` describes; None if it is empty.

    Raises `TextError`, which does not name the file. Nothing is read but a file: folders, pipes and
    devices, some of which have no end, are refused.
    """
    try:
        if not path.is_file():
            path.stat()  # says whether anything is there
            raise TextError("not a file")
        with path.open("rb") as stream:
            return parsed(stream.read(MAX_BYTES + 1))
    except OSError as error:
        raise TextError(error.strerror or str(error)) from None
    except ValueError as error:  # also for NUL in the file's name
        raise TextError(str(error)) from None


def parsed(data: bytes) -> Any:
    """The value that the YAML text ``data`` describes; None if it is empty. Raises `TextError`."""
    if len(data) > MAX_BYTES:
        raise TextError(f"too long; at most {MAX_BYTES:,} bytes are allowed")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise TextError(f"line {line}: not UTF-8 text; save the file as UTF-8") from None
    try:
        return _Reader(yaml.parse(text, Loader=_Loader)).document()
    except yaml.MarkedYAMLError as error:
        raise TextError(_syntax_fault(error, text)) from None
    except yaml.YAMLError as error:  # characters that no text has, such as NUL
        place = getattr(error, "position", 0)
        line = text[:place].count("\n") + 1
        raise TextError(f"line {line}: not text; it contains a control character") from None


def _syntax_fault(error: yaml.MarkedYAMLError, text: str) -> str:
    mark = error.problem_mark or error.context_mark
    number = mark.line if mark else 0
    lines = text.splitlines()
    if number < len(lines) and "\t" in lines[number]:
        return f"line {number + 1}: a tab where spaces are needed; indent with spaces"
    return f"line {number + 1}: not YAML: {error.problem or error.context}"


class _Reader:
    """Builds values from YAML's events and counts them; an alias counts as all its values."""

    def __init__(self, events: Iterator[yaml.Event]) -> None:
        self.events = events
        self.count = 0
        self.anchored: dict[str, tuple[Any, int]] = {}

    def document(self) -> Any:
        next(self.events)  # start of the stream
        if isinstance(next(self.events), yaml.StreamEndEvent):
            return None
        value = self.value(next(self.events), 0)
        next(self.events)  # end of the document
        following = next(self.events)
        if not isinstance(following, yaml.StreamEndEvent):
            raise _at(following, "a second document; a file must hold only one")
        return value

    def value(self, event: Any, depth: int) -> Any:
        if depth > MAX_DEPTH:
            raise _at(event, f"nested too deeply; at most {MAX_DEPTH} levels are allowed")
        if isinstance(event, yaml.AliasEvent):
            return self.alias(event)
        if event.tag is not None:
            raise _at(event, f"the tag {event.tag[:60]} is not allowed; leave it out")
        before = self.count
        self.count += 1
        self.check(event)
        value: Any
        if isinstance(event, yaml.ScalarEvent):
            value = _scalar(event.value) if event.implicit[0] else event.value
        elif isinstance(event, yaml.SequenceStartEvent):
            value = []
            while not isinstance(item := next(self.events), yaml.SequenceEndEvent):
                value.append(self.value(item, depth + 1))
        else:
            value = self.mapping(depth)
        if event.anchor:
            self.anchored[event.anchor] = value, self.count - before
        return value

    def mapping(self, depth: int) -> dict[str, Any]:
        found: dict[str, Any] = {}
        while not isinstance(key := next(self.events), yaml.MappingEndEvent):
            if not isinstance(key, yaml.ScalarEvent):
                raise _at(key, "a list or mapping as a key; keys must be plain words")
            if key.value in found:
                raise _at(key, f"{key.value[:60]!r} appears twice; each key must appear only once")
            found[key.value] = self.value(next(self.events), depth + 1)
        return found

    def alias(self, event: Any) -> Any:
        if event.anchor not in self.anchored:
            raise _at(event, f"*{event.anchor[:60]} is an alias of an undefined anchor")
        value, count = self.anchored[event.anchor]
        self.count += count
        self.check(event)
        return value

    def check(self, event: yaml.Event) -> None:
        if self.count > MAX_VALUES:
            raise _at(event, f"too many values; at most {MAX_VALUES:,} are allowed")


def _scalar(text: str) -> Any:
    """The value of an unquoted scalar."""
    if text in _WORDS:
        return _WORDS[text]
    number = number_in(text)
    return text if number is None else number


def _at(event: Any, message: str) -> TextError:
    return TextError(f"line {event.start_mark.line + 1}: {message}")
