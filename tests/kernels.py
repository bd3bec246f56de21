"""Kernels of OpenBLAS, which round differently, and the processors that can run them."""

import platform
from pathlib import Path

NEEDS = {"SkylakeX": "avx512f", "Haswell": "avx2", "Zen": "avx2", "Nehalem": "sse4_2"}


def can_run(kernel: str) -> bool:
    """Whether this processor can."""
    info = Path("/proc/cpuinfo")
    return platform.machine() == "x86_64" and info.exists() and NEEDS[kernel] in info.read_text()
