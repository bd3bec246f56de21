"""Checks of input: each error is one line that names the key, its value and what is allowed.

The fields of dataclasses are checked against their annotations, and read from JSON.
"""

import math
import types
import typing
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from enum import Enum, StrEnum
from functools import cache
from numbers import Integral
from typing import Any, TypeVar

from sidmacib.quantities import Number, is_number

SMALL = 1e-100  # length of a direction: squares of shorter ones are 0
LARGE = 1e9  # coordinates (m) and components of directions: products of larger ones overflow
Kind = TypeVar("Kind")
Check = Callable[[str, Any], None]
UNIONS = (typing.Union, types.UnionType)


def require_positive(**values: Any) -> None:
    """ValueError unless every one of ``values`` is a finite number above 0."""
    for name, value in values.items():
        if not (is_number(value) and 0 < value < math.inf):
            raise refused(name, value, "a finite number above 0")


def require_not_negative(**values: Any) -> None:
    """ValueError unless every one of ``values`` is 0 or a finite number above it."""
    for name, value in values.items():
        if not (is_number(value) and 0 <= value < math.inf):
            raise refused(name, value, "0 or a finite number above it")


def require_whole(least: int, **values: Any) -> None:
    """ValueError unless every one of ``values`` is a whole number of at least ``least``."""
    for name, value in values.items():
        if isinstance(value, bool) or not isinstance(value, Integral) or value < least:
            raise refused(name, value, f"a whole number of at least {least}")


def require_member(kind: type[Enum], **values: Any) -> None:
    """ValueError unless every one of ``values`` is a member of ``kind``."""
    for name, value in values.items():
        if not isinstance(value, kind):
            members = ", ".join(str(member) for member in kind.__members__)
            raise refused(name, value, f"{kind.__name__}: {members}")


def refused(name: str, value: Any, allowed: str) -> ValueError:
    """The error for a ``value`` other than what is ``allowed``."""
    # As Python numbers, because the repr of numpy's includes the type.
    shown = value.item() if is_number(value) and hasattr(value, "item") else value
    return ValueError(f"{name}: {shown!r} is not allowed; it must be {allowed}")


@cache
def kinds_of(dataclass: Any) -> dict[str, Any]:
    """The annotation of each field of a ``dataclass``, with its `Number` if it has one."""
    hints = typing.get_type_hints(dataclass, include_extras=True)
    return {field.name: hints[field.name] for field in fields(dataclass)}


def require_kinds(instance: Any) -> None:
    """ValueError unless every field of the dataclass ``instance`` is as its annotation says.

    Numbers must be in their range, members of an enum and dataclasses must be such. Fields of any
    other kind are left to the dataclass itself.
    """
    kind: Any = type(instance)
    for name, check in _checks(kind):
        check(name, getattr(instance, name))


def number_of(kind: Any) -> Number | None:
    """The range that an annotation has, also one of a number or None."""
    kinds = typing.get_args(kind) if typing.get_origin(kind) in UNIONS else (kind,)
    given = (each for kind in kinds for each in getattr(kind, "__metadata__", ()))
    return next((each for each in given if type(each) is Number), None)


def plain(value: Any) -> Any:
    """A dataclass as plain values for JSON, of which `dataclass_from` makes it again.

    Tuples are lists, and infinite numbers are text. Many times as fast as `dataclasses.asdict`.
    """
    if isinstance(value, float):
        return value if math.isfinite(value) else str(value)
    if isinstance(value, tuple):
        return [plain(each) for each in value]
    if is_dataclass(value):
        kind: Any = type(value)
        return {name: plain(getattr(value, name)) for name in kinds_of(kind)}
    return value


def dataclass_from(kind: type[Kind], value: Any) -> Kind:
    """The dataclass ``kind`` from what `plain`, or `dataclasses.asdict`, and JSON make of one.

    ValueError, TypeError, KeyError or AttributeError if ``value`` is something else; what has other
    keys or numbers in other forms may pass.
    """
    return typing.cast(Kind, _made(kind, value))


@cache
def _checks(dataclass: Any) -> tuple[tuple[str, Check], ...]:
    checks = ((name, _check(kind)) for name, kind in kinds_of(dataclass).items())
    return tuple((name, check) for name, check in checks if check is not None)


def _check(kind: Any, or_none: str = "") -> Check | None:
    """The check that an annotation requires of a value; None if it requires none."""
    if typing.get_origin(kind) in UNIONS:
        kinds = [each for each in typing.get_args(kind) if each is not types.NoneType]
        inner = _check(kinds[0], " or None") if len(kinds) == 1 else None
        return inner and (lambda name, value: None if value is None else inner(name, value))
    if number := number_of(kind):
        return number.require
    if isinstance(kind, type) and issubclass(kind, StrEnum):
        return lambda name, value: require_member(kind, **{name: value})
    if isinstance(kind, type) and is_dataclass(kind):
        article = "an" if kind.__name__[0] in "AEIOU" else "a"

        def check(name: str, value: Any) -> None:
            if not isinstance(value, kind):
                raise refused(name, value, f"{article} {kind.__name__}{or_none}")

        return check
    return None


def _made(kind: Any, value: Any) -> Any:
    origin, parts = typing.get_origin(kind), typing.get_args(kind)
    if origin is typing.Annotated:
        return _made(parts[0], value)
    if origin in UNIONS:
        # Of several kinds that are taken, the last is the one that is kept, and so written.
        *_, kept = (part for part in parts if part is not types.NoneType)
        return None if value is None else _made(kept, value)
    if origin is tuple:
        kinds = parts[:1] * len(value) if parts[-1] is ... else parts
        return tuple(_made(each, item) for each, item in zip(kinds, value, strict=True))
    if not is_dataclass(kind):
        return kind(value)
    dataclass: Any = kind
    fields_of = kinds_of(dataclass).items()
    return dataclass(**{name: _made(each, value[name]) for name, each in fields_of})
