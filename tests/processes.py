"""Programs that tests run in processes of their own."""

import subprocess
import sys
from functools import partial
from os import environ
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]


def ran(
    *words: str | Path, check: bool = False, cwd: Path = ROOT, **variables: str
) -> subprocess.CompletedProcess[str]:
    """A program with more ``variables`` in its environment, and what it printed."""
    env = environ | variables
    return subprocess.run(
        words, cwd=cwd, env=env, check=check, capture_output=True, text=True, timeout=600
    )


def started(*words: str | Path, **more: Any) -> subprocess.Popen[str]:
    """A program that runs on; all that it prints is in one stream. ``more``: as of `Popen`."""
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
    return subprocess.Popen(words, cwd=ROOT, text=True, **streams, **more)


python = partial(ran, sys.executable)
