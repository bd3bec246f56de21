"""Lines that tell that a process is at work before it has anything else to show."""

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

FIRST, NEXT = 1.5, 15.0  # s, until the first line and between others


class Waiting:
    """What is being done: ``words``, told after a moment, and then again with the time so far."""

    def __init__(self, words: str) -> None:
        self.words = words
        self.over = threading.Event()

    def end(self) -> None:
        """There is something else to show now."""
        self.over.set()

    def tell(self) -> None:
        """Print a line now and then until the end."""
        begun, pause = time.monotonic(), FIRST
        while not self.over.wait(pause):
            seconds = time.monotonic() - begun
            after = f", {seconds:.0f} s so far" if pause == NEXT else ""
            print(f"{self.words}{after}", file=sys.stderr, flush=True)
            pause = NEXT


@contextmanager
def waiting(words: str) -> Iterator[Waiting]:
    """Tell what is being done while it lasts; nothing if it takes but a moment."""
    found = Waiting(words)
    threading.Thread(target=found.tell, daemon=True).start()
    try:
        yield found
    finally:
        found.end()
