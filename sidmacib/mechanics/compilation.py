"""Compilation of functions: by numba, once, and kept on disk.

No library for linear algebra is called, so results are the same on every processor.
"""

from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from typing import Any

from numba import njit

_texts = [path.read_bytes() for path in sorted(Path(__file__).parent.rglob("*.py"))]
# Numba compiles a function again where its file has changed, but not where one that it calls has.
VERSION = sha256(b"".join(text for text in _texts if b"@compiled" in text)).hexdigest()[:12]
del _texts


def compiled(function: Callable[..., Any]) -> Any:
    """``function``, compiled when it is first called after a change in any file that has such."""
    function.__qualname__ += f"-{VERSION}"  # part of the name of its file in the cache
    decorate = njit(cache=True, error_model="numpy")  # division by zero gives inf, as in numpy
    return decorate(function)
