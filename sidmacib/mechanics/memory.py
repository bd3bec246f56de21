"""Memory: what this machine has, asked before it is needed."""

import os
import resource
from contextlib import suppress
from pathlib import Path

from sidmacib.errors import CapacityError

GIB = 2.0**30
CGROUP = Path("/sys/fs/cgroup/memory.max")  # of a container


def require_memory(needed: float, what: str) -> None:
    """Raise `CapacityError` where ``what`` needs more than this machine has; ``needed``: bytes."""
    there = memory()
    if needed > there:
        raise CapacityError(
            f"{what} need {needed / GIB:.1f} GiB of memory or more, and this machine has "
            f"{there / GIB:.1f} GiB; use a coarser mesh"
        )


def memory() -> float:
    """Memory (bytes) that a process of this machine may have."""
    limits = [float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))]
    allowed, _ = resource.getrlimit(resource.RLIMIT_AS)
    if allowed != resource.RLIM_INFINITY:
        limits.append(float(allowed))
    with suppress(OSError, ValueError):  # no container, or one without a limit
        limits.append(float(CGROUP.read_text()))
    return min(limits)
