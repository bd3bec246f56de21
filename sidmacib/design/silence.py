"""Standard output without what compiled code prints although it is asked not to."""

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

OUTPUT = 1  # the file descriptor


@contextmanager
def silent() -> Iterator[None]:
    """Drop what compiled code writes to standard output meanwhile.

    HiGHS writes debugging lines there (``HighsMipSolverData::transformNewIntegerFeasibleSolution``)
    even without a log, which would end up between the lines of a table or of JSON.
    """
    try:
        kept = os.dup(OUTPUT)
    except OSError:  # there is none
        yield
        return
    c_library = ctypes.CDLL(None)
    sys.stdout.flush()
    c_library.fflush(None)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, OUTPUT)
    os.close(nowhere)
    try:
        yield
    finally:
        c_library.fflush(None)  # else it comes later, out of C's own buffer
        os.dup2(kept, OUTPUT)
        os.close(kept)
