"""One computation at a time, and of each page only what it asked last."""

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Condition

MOST_PAGES = 64  # that are remembered


class SupersededError(Exception):
    """The page has asked for something newer."""


class Desk:
    """A queue of requests. A newer request of a page sends its older ones away at once."""

    def __init__(self) -> None:
        self._changed = Condition()
        self._busy = False
        self._latest: dict[str, int] = {}

    @contextmanager
    def turn(self, page: str, number: int) -> Iterator[None]:
        """Wait for the turn of request ``number`` of ``page``; `SupersededError` if it has none."""
        with self._changed:
            self._latest[page] = max(number, self._latest.pop(page, number))  # to the end
            while len(self._latest) > MOST_PAGES:
                self._latest.pop(next(iter(self._latest)))
            self._changed.notify_all()
            self._changed.wait_for(lambda: not self._busy or self._is_old(page, number))
            if self._is_old(page, number):
                raise SupersededError
            self._busy = True
        try:
            yield
        finally:
            with self._changed:
                self._busy = False
                self._changed.notify_all()

    def _is_old(self, page: str, number: int) -> bool:
        return self._latest.get(page, number) > number
