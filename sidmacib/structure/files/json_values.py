"""Values in JSON files of COMPAS, checked; every fault in one line that names the key."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from sidmacib.mechanics.assembly import Floats
from sidmacib.quantities import shown
from sidmacib.validation import LARGE

MOST_DIGITS = 9  # of the number of a node


def json_in(path: Path) -> Any:
    """What a JSON file holds; ValueError, which names the file."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (UnicodeDecodeError, json.JSONDecodeError, RecursionError) as error:
        raise ValueError(f"{path.name}: is no JSON ({error})") from None


def data_of(name: str, value: Any, kinds: tuple[str, ...] = ()) -> Mapping[str, Any]:
    """What an object of COMPAS holds; of one of ``kinds``, if it names its own.

    Version 2 calls the kind `dtype` and what it holds `data`; version 1 `value`, and older ones
    have no kind.
    """
    held = mapping(name, value)
    kind = held.get("dtype", held.get("datatype"))
    if kinds and kind is not None and kind not in kinds:
        allowed = " or ".join(kinds)
        raise ValueError(f"{name}: dtype {shown(kind)} is not allowed; it must be {allowed}")
    return mapping(f"{name}: data", held.get("data", held.get("value", held)))


def key_of(name: str, value: Mapping[str, Any], key: str) -> Any:
    """What is at a ``key``, which must be there."""
    if key not in value:
        raise ValueError(f"{name}: lacks the key {key}")
    return value[key]


def mapping(name: str, value: Any) -> dict[str, Any]:
    """The ``value``, which must be a mapping."""
    if not isinstance(value, dict):
        raise ValueError(f"{name}: {shown(value)} is not allowed; it must be a mapping")
    return value


def number_of_node(node: str) -> int:
    """The number of a node, which is a text in JSON."""
    if not node.isdecimal() or len(node) > MOST_DIGITS:
        raise ValueError(f"node: {shown(node)} is not allowed; it must be a whole number")
    return int(node)


def flag(name: str, value: Any) -> bool:
    """The ``value``, which must be true or false."""
    if not isinstance(value, bool):
        raise ValueError(f"{name}: {shown(value)} is not allowed; it must be true or false")
    return value


def matrix_of(name: str, value: Any) -> Floats:
    """A transformation, (4, 4), which mirrors nothing."""
    if value is None:
        return np.eye(4)
    given = key_of(name, data_of(name, value), "matrix")
    try:
        matrix = np.array(given, float)
    except (TypeError, ValueError):
        raise ValueError(f"{name}: must be a matrix of 4 x 4 numbers") from None
    if matrix.shape != (4, 4) or not (np.abs(matrix) <= LARGE).all():
        raise ValueError(f"{name}: must be a matrix of 4 x 4 numbers of at most {LARGE:g}")
    if not (matrix[3] == (0.0, 0.0, 0.0, 1.0)).all() or np.linalg.det(matrix) <= 0.0:
        raise ValueError(f"{name}: must end with 0, 0, 0, 1 and not mirror the blocks")
    return matrix
