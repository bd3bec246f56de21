"""Dataclasses from the plain data that `dataclasses.asdict` and JSON make. Light to import."""

import types
import typing
from dataclasses import fields, is_dataclass
from enum import StrEnum
from functools import cache
from typing import Any, TypeVar

Kind = TypeVar("Kind")


def read_plain(kind: type[Kind], value: Any) -> Kind:
    """``value`` as a dataclass of the ``kind``; ValueError or TypeError if it is anything else."""
    found = _built(kind, value)
    assert isinstance(found, kind)
    return found


def _built(kind: Any, value: Any) -> Any:
    """``value``, read from JSON, as ``kind``; ValueError or TypeError if it is not of that kind."""
    if isinstance(kind, types.UnionType):
        *_, kept = (k for k in typing.get_args(kind) if k is not types.NoneType)
        # Of several kinds that are taken, the last is the one that is kept, and so written.
        return None if value is None else _built(kept, value)
    if typing.get_origin(kind) is tuple:
        if not isinstance(value, list):
            raise ValueError(f"{str(value)[:60]!r} is not a list")
        first, *others = typing.get_args(kind)
        every = [first] * len(value) if others == [...] else [first, *others]
        return tuple(_built(own, each) for own, each in zip(every, value, strict=True))
    if isinstance(kind, type) and is_dataclass(kind):
        hints = _hints(kind)
        if not isinstance(value, dict) or set(value) != set(hints):
            raise ValueError(f"{kind.__name__} must have the keys {', '.join(hints)}")
        return kind(**{key: _built(hints[key], own) for key, own in value.items()})
    if issubclass(kind, StrEnum):
        return kind(value)
    if kind is float and (value in ("inf", "-inf") or type(value) in (float, int)):
        return float(value)
    if type(value) is not kind:
        raise ValueError(f"{str(value)[:60]!r} is not of the kind {kind.__name__}")
    return value


@cache
def _hints(kind: Any) -> dict[str, Any]:
    hints = typing.get_type_hints(kind)
    return {field.name: hints[field.name] for field in fields(kind)}
