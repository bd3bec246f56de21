"""What compiled code prints although it is asked not to."""

import subprocess
import sys

PRINTS = """
import ctypes
from sidmacib.mechanics.optimisation import silent
c = ctypes.CDLL(None)
print("before")
with silent():
    c.printf(b"noise in the buffer\\n")
    c.puts(b"more noise")
print("after")
c.puts(b"heard again")
"""


def test_only_what_is_printed_meanwhile_is_dropped() -> None:
    found = subprocess.run(
        [sys.executable, "-c", PRINTS], capture_output=True, text=True, check=True
    )
    assert set(found.stdout.split("\n")) == {"before", "after", "heard again", ""}
