"""The process of a run: how it ends when it receives a signal, and its text, which is UTF-8.

It ends its jobs, then itself, with one line and no traceback. Light to import, so that this works
from the start.
"""

import locale
import os
import signal
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

STOPPED = "Stopped. The next run continues from here."
SHOW_CURSOR = "\x1b[?25h"  # which a bar on a terminal hides
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
UTF8 = {"PYTHONUTF8": "1"}
LOOK = 0.5  # s, between looks at the process that started this one

_received: list[int] = []
_patience = [0.0]


def end_on_signals(patience: float = 0.0) -> None:
    """Have SIGINT, SIGTERM and SIGHUP end this process and the jobs that it has started.

    It may clean up for ``patience`` s, unless a second signal arrives. Signals that `nohup` ignores
    stay ignored.
    """
    _patience[0] = patience
    for number in SIGNALS:
        if number != signal.SIGHUP or signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, stop)


def stopping() -> bool:
    """Whether this process has received a signal to end."""
    return bool(_received)


def stop(number: int = signal.SIGTERM, *_: Any) -> None:
    """End the jobs and this process; a handler of signals. Raises SystemExit."""
    _received.append(number)
    _end_children()
    if len(_received) > 1 or not _patience[0]:
        _end_at_once()
    # An exception is lost where it cannot propagate, as in a destructor; end the process anyway.
    later = threading.Timer(_patience[0], _end_at_once)
    later.daemon = True
    later.start()
    raise SystemExit(STOPPED)


def end_with_make() -> None:
    """Have this process end when make, which started it, receives a signal to end.

    make passes SIGTERM on, but when SIGINT or SIGHUP reach it alone it waits for its recipes, with
    the signal blocked.
    """
    threading.Thread(target=_watch, args=(os.getppid(),), daemon=True).start()


def _watch(parent: int) -> None:
    waiting = 1 << (signal.SIGINT - 1) | 1 << (signal.SIGHUP - 1)
    with suppress(OSError, StopIteration):  # it has ended
        while not _blocked(parent) & waiting:
            time.sleep(LOOK)
        os.kill(os.getpid(), signal.SIGTERM)


def _blocked(pid: int) -> int:
    """The signals that a process blocks, a bit for each."""
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    return int(next(line for line in lines if line.startswith("SigBlk:")).split()[1], 16)


def _end_at_once() -> None:
    _end_children()
    end = SHOW_CURSOR if sys.stderr.isatty() else ""
    os.write(2, f"{end}{STOPPED}\n".encode())
    os._exit(1)  # the jobs end with this process, see `workflow.run.job`


def _end_children() -> None:
    """Ask the processes that this one has started to end."""
    for children in Path("/proc/self/task").glob("*/children"):
        with suppress(OSError):
            for pid in children.read_text().split():
                with suppress(ProcessLookupError, PermissionError):
                    os.kill(int(pid), signal.SIGTERM)


def read_utf8() -> None:
    """Restart this program, and its child processes, in UTF-8 mode if the locale is another."""
    asked = os.environ.get("PYTHONUTF8") == UTF8["PYTHONUTF8"]
    if locale.getpreferredencoding(False).lower() != "utf-8" and not asked:
        os.environ.update(UTF8)
        os.execv(sys.executable, [sys.executable, *sys.orig_argv[1:]])
