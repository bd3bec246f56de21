"""Compilation of functions: by numba, once, and kept on disk.

No library for linear algebra is called, so results are the same on every processor.

Numba keeps what it compiles in folders of its own. Before them, what was compiled when the package
was built is looked up, see `sidmacib.mechanics.precompiled`; it counts for the same Python, numba
and processor only. Where no folder can be written to, functions are compiled for the process alone.
"""

# mypy: allow-untyped-calls

from collections.abc import Callable
from contextlib import suppress
from hashlib import sha256
from pathlib import Path
from pickle import UnpicklingError
from typing import Any, ClassVar

from numba import njit
from numba.core.caching import CompileResultCacheImpl, FunctionCache, NullCache, _CacheLocator

SHIPPED = Path(__file__).parent / "machine_code"
UNUSABLE = OSError, EOFError, UnpicklingError  # of a file: not readable, no room for it, cut off
# With their names, as what is kept refers to modules by name.
_texts = [
    path.parent.name.encode() + path.name.encode() + path.read_bytes()
    for folder in (Path(__file__).parent, Path(__file__).parents[1] / "dynamics")
    for path in sorted(folder.rglob("*.py"))
]
# Numba compiles a function again where its file has changed, but not where one that it calls has.
VERSION = sha256(b"".join(text for text in _texts if b"@compiled" in text)).hexdigest()[:12]
del _texts


class _Place(_CacheLocator):
    """The folder `SHIPPED`, whose files count for one `VERSION`, whenever they were written."""

    def __init__(self, line: int) -> None:
        self.line = line

    @classmethod
    def from_function(cls, py_func: Any, py_file: str) -> "_Place":
        return cls(py_func.__code__.co_firstlineno)

    def get_cache_path(self) -> str:
        return str(SHIPPED)

    def get_source_stamp(self) -> str:
        return VERSION

    def get_disambiguator(self) -> str:
        return str(self.line)


class _ShippedFunction(CompileResultCacheImpl):
    _locator_classes = [_Place]  # type: ignore[list-item]  # noqa: RUF012 (of numba)


class Shipped(FunctionCache):
    """A function's files in `SHIPPED`."""

    _impl_class = _ShippedFunction


class Kept(NullCache):
    """Looks for a compiled function where it was shipped, then where numba keeps its own.

    ``at_first``: called before the first function of this process that has to be compiled.
    """

    at_first: ClassVar[Callable[[], object] | None] = None

    def __init__(self, function: Callable[..., Any]) -> None:
        self._places: list[Any] = [Shipped(function)]
        with suppress(RuntimeError):  # no folder can be written to
            self._places.append(FunctionCache(function))

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The function for these types; None where it has to be compiled."""
        for place in self._places:
            with suppress(*UNUSABLE):
                found = place.load_overload(sig, target_context)
                if found is not None:
                    return found
        tell, Kept.at_first = Kept.at_first, None
        if tell is not None:
            tell()
        return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep the function for these types, if there is a folder with room for it."""
        for place in self._places[1:]:
            with suppress(*UNUSABLE):
                place.save_overload(sig, data)


def compiled(function: Callable[..., Any]) -> Any:
    """``function``, compiled when it is first called after a change in any file that has such."""
    function.__qualname__ += f"-{VERSION}"  # part of the name of its file in the cache
    dispatcher: Any = njit(error_model="numpy")(function)  # division by zero gives inf, as in numpy
    dispatcher._cache = Kept(function)
    return dispatcher
