"""How functions are compiled: by numba, once, and kept on disk.

No library for linear algebra is called, so results are the same on every processor.
"""

from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from typing import Any

from numba import njit

SOURCES = sorted(Path(__file__).parent.glob("*.py"))
# Numba compiles a function again where its file has changed, but not where one that it calls has.
VERSION = sha256(b"".join(path.read_bytes() for path in SOURCES)).hexdigest()[:12]


def compiled(function: Callable[..., Any]) -> Any:
    """``function``, compiled when it is first called after a change of this folder."""
    function.__qualname__ += f"-{VERSION}"  # part of the name of its file in the cache
    decorate = njit(cache=True, error_model="numpy")  # division by zero gives inf, as in numpy
    return decorate(function)
