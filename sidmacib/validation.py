"""Checks of input: each error is one line that names the key, its value and what is allowed."""

import math
from enum import Enum
from numbers import Integral, Real
from typing import Any

SMALL = 1e-100  # length of a direction: squares of shorter ones are 0
LARGE = 1e9  # coordinates (m) and components of directions: products of larger ones overflow


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


def require_direction(**values: Any) -> None:
    """ValueError unless each of ``values`` is three numbers, not all 0, of at most `LARGE`."""
    for name, value in values.items():
        numbers = list(value)
        fine = len(numbers) == 3 and all(is_number(x) and abs(x) <= LARGE for x in numbers)
        if not (fine and math.hypot(*numbers) > SMALL):
            raise refused(name, numbers, f"three numbers of at most {LARGE:g}, not all 0")


def is_number(value: Any) -> bool:
    """Whether ``value`` is a real number, a boolean not being one."""
    if type(value) is float:  # at once, as almost all are
        return True
    return isinstance(value, Real) and not isinstance(value, bool)


def refused(name: str, value: Any, allowed: str) -> ValueError:
    """The error for a ``value`` other than what is ``allowed``."""
    # As Python numbers, because the repr of numpy's includes the type.
    shown = value.item() if is_number(value) and hasattr(value, "item") else value
    return ValueError(f"{name}: {shown!r} is not allowed; it must be {allowed}")
