"""Read YAML text as plain values: any bytes give a value or one line with the place of the fault.

PyYAML's safe loader, but with the scalars of YAML 1.2's core schema, in decimals only: 6e-2 is a
number, while ``no``, 010 and dates are text. Keys are text, and each appears only once.
"""

import math
from pathlib import Path
from typing import Any

import yaml

from sidmacib.quantities import number_in

_WORDS: dict[str, Any] = {"": None, "~": None, **dict.fromkeys((".nan", ".NaN", ".NAN"), math.nan)}
for _sign in ("", "+", "-"):
    _WORDS |= dict.fromkeys((f"{_sign}.inf", f"{_sign}.Inf", f"{_sign}.INF"), float(f"{_sign}inf"))
for _name, _value in {"null": None, "true": True, "false": False}.items():
    _WORDS |= dict.fromkeys((_name, _name.title(), _name.upper()), _value)

MAX_DEPTH = 20  # far below what makes PyYAML's parser in C crash


class TextError(ValueError):
    """The text is not one YAML document of plain values; the message is one line."""


class _Loader(getattr(yaml, "CSafeLoader", yaml.SafeLoader)):  # type: ignore[misc]
    yaml_constructors: dict[str | None, Any] = {}  # noqa: RUF012 (PyYAML's): no tags but these
    depth = 0

    def descend_resolver(self, parent: yaml.Node, index: Any) -> None:
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise _fault(parent, f"nested too deeply; at most {MAX_DEPTH} levels are allowed")

    def ascend_resolver(self) -> None:
        self.depth -= 1

    def resolve(self, kind: type[yaml.Node], value: str, implicit: tuple[bool, bool]) -> Any:
        return "plain" if kind is yaml.ScalarNode and implicit[0] else kind.id  # type: ignore[attr-defined]

    def plain(self, node: yaml.ScalarNode) -> Any:
        number = number_in(node.value)
        return _WORDS.get(node.value, node.value) if number is None else number

    def mapping(self, node: yaml.MappingNode) -> dict[str, Any]:
        found: dict[str, Any] = {}
        for key, value in node.value:
            if not isinstance(key, yaml.ScalarNode):
                raise _fault(key, "a list or mapping as a key; keys must be plain words")
            if key.value in found:
                raise _fault(
                    key, f"{key.value[:60]!r} appears twice; each key must appear only once"
                )
            found[key.value] = self.construct_object(value, deep=True)
        return found

    def unknown(self, node: yaml.Node) -> Any:
        raise _fault(node, f"the tag {node.tag[:60]} is not allowed; leave it out")


def _fault(node: yaml.Node, words: str) -> yaml.MarkedYAMLError:
    return yaml.MarkedYAMLError(problem=words, problem_mark=node.start_mark)


_Loader.add_constructor("plain", _Loader.plain)
_Loader.add_constructor("scalar", lambda _, node: node.value)
_Loader.add_constructor("sequence", lambda loader, node: loader.construct_sequence(node, deep=True))
_Loader.add_constructor("mapping", _Loader.mapping)
_Loader.add_constructor(None, _Loader.unknown)


def read_yaml(path: Path) -> Any:
    """The value that the YAML file ``path`` describes; None if it is empty.

    Raises `TextError`, which does not name the file. Folders, pipes and devices are refused.
    """
    try:
        if path.exists() and not path.is_file():
            raise TextError("not a file")
        return parsed(path.read_bytes())
    except OSError as error:
        raise TextError(error.strerror or str(error)) from None
    except ValueError as error:  # also for NUL in the file's name
        raise TextError(str(error)) from None


def parsed(data: bytes) -> Any:
    """The value that the YAML text ``data`` describes; None if it is empty. Raises `TextError`."""
    try:
        return yaml.load(data.decode("utf-8-sig"), Loader=_Loader)
    except UnicodeDecodeError as error:
        line, words = data[: error.start].count(b"\n"), "not UTF-8 text; save the file as UTF-8"
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = mark.line if mark else 0
        words = " ".join(filter(None, (error.context, error.problem)))
        if b"\t" in b"".join(data.split(b"\n")[line:][:1]):
            words = "a tab where spaces are needed; indent with spaces"
        elif type(error) is not yaml.MarkedYAMLError:
            words = f"not YAML: {words}"
    except yaml.YAMLError as error:  # a character that no text has, such as NUL
        line = data.decode("utf-8-sig")[: getattr(error, "position", 0)].count("\n")
        words = "not text; it contains a control character"
    raise TextError(f"line {line + 1}: {words}")
