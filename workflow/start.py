"""What must hold before anything that takes long is imported."""

import locale
import os
import signal
import sys

STOPPED = "Stopped. The next run goes on from here."
UTF8 = {"PYTHONUTF8": "1"}


def begin() -> None:
    """Tell ^C in a line, and read all text as UTF-8, whatever the locale says."""
    signal.signal(signal.SIGINT, _stop)
    told = os.environ.get("PYTHONUTF8") == UTF8["PYTHONUTF8"]
    if locale.getpreferredencoding(False).lower() != "utf-8" and not told:
        os.environ.update(UTF8)  # of the programs that are started, too
        os.execv(sys.executable, [sys.executable, *sys.orig_argv[1:]])


def _stop(*_: object) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # it is stopping already
    sys.exit(STOPPED)
