"""Progress lines of a process that has nothing else to show yet."""

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

FIRST, NEXT = 1.5, 15.0  # s, until the first line and between others


class Waiting:
    """A running task: ``words`` are printed after a moment, then again with the time so far."""

    def __init__(self, words: str) -> None:
        self.words = words
        self.over = threading.Event()

    def end(self) -> None:
        """Stop printing, as there is something else to show."""
        self.over.set()

    def report(self) -> None:
        """Print a line at intervals until the end."""
        begun, pause = time.monotonic(), FIRST
        while not self.over.wait(pause):
            seconds = time.monotonic() - begun
            after = f", {seconds:.0f} s so far" if pause == NEXT else ""
            print(f"{self.words}{after}", file=sys.stderr, flush=True)
            pause = NEXT


@contextmanager
def waiting(words: str) -> Iterator[Waiting]:
    """Print what is being done while it lasts; nothing if it ends at once."""
    task = Waiting(words)
    threading.Thread(target=task.report, daemon=True).start()
    try:
        yield task
    finally:
        task.end()
