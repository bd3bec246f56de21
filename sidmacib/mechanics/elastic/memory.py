"""Memory: what the elastic solver needs and what this machine has, compared before it starts."""

import math
import os
import resource
from contextlib import suppress
from pathlib import Path

import numpy as np

from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import Assembly, Integers, NodeLayout
from sidmacib.mechanics.elastic.flexibility import element_edges

GIB = 2.0**30
BYTES = 8.0  # of a number
MATRICES = 5.0  # that are in memory at the same time
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

    It keeps several matrices at a time: by components, or by components and degrees of freedom.
    """
    seen = np.bincount(assembly.nodes.face[kept // 3], minlength=len(assembly.faces))
    step = 2 if assembly.layout is not NodeLayout.VERTICES else 1
    most = 0.0
    for number, piece in enumerate(assembly.pieces):
        if piece.elastic is not None and not piece.fixed:
            touches = [number in (face.below, face.above) for face in assembly.faces]
            freedoms = 3 * math.prod(
                step * (len(e) - 1) + 1 for e in element_edges(assembly, number)
            )
            most = max(most, float(freedoms) * float(seen[touches].sum()))
    square = float(len(kept)) ** 2
    return BYTES * max(MATRICES * square, square + MATRICES * most)
