"""Memory: what the elastic solver needs and what this machine has, compared before it starts."""

import math
import os
import resource
from contextlib import suppress
from pathlib import Path

from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import Assembly, Integers, NodeLayout
from sidmacib.mechanics.elastic.flexibility import element_edges

GIB = 2.0**30
BYTES = 8.0  # of a number
MATRICES = 3.5  # that are in memory at the same time
ENTRY = 6.0  # numbers for each entry of a stiffness while it is put together
CGROUP = Path("/sys/fs/cgroup/memory.max")  # of a container


def require_memory(needed: float, what: str) -> None:
    """Raise `CapacityError` if ``what`` needs more than this machine has; ``needed``: bytes."""
    available = memory()
    if needed > available:
        raise CapacityError(
            f"{what} need {needed / GIB:.1f} GiB of memory or more, and this machine has "
            f"{available / GIB:.1f} GiB; use a coarser mesh"
        )


def memory() -> float:
    """Memory (bytes) that a process may use on this machine."""
    limits = [float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))]
    allowed, _ = resource.getrlimit(resource.RLIMIT_AS)
    if allowed != resource.RLIM_INFINITY:
        limits.append(float(allowed))
    with suppress(OSError, ValueError):  # no container, or one without a limit
        limits.append(float(CGROUP.read_text()))
    return min(limits)


def memory_needed(assembly: Assembly, kept: Integers) -> float:
    """Least memory (bytes) of the elastic solver for the node components ``kept``.

    It keeps several matrices at a time, by components; before, the stiffness of the largest piece.
    """
    quadratic = assembly.layout is not NodeLayout.VERTICES
    step, coupled = (2, 4) if quadratic else (1, 3)  # nodes of an element and to others, on a line
    freedoms = 0.0
    for number, piece in enumerate(assembly.pieces):
        if piece.elastic is not None and not piece.fixed:
            edges = element_edges(assembly, number)
            freedoms = max(freedoms, 3.0 * math.prod(step * (len(e) - 1) + 1 for e in edges))
    square = float(len(kept)) ** 2
    return BYTES * max(MATRICES * square, square + ENTRY * 3.0 * coupled**3 * freedoms)
