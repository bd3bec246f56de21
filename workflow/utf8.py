"""All text is UTF-8, whatever the locale says."""

import locale
import os
import sys

MODE = {"PYTHONUTF8": "1"}


def read_utf8() -> None:
    """Begin this program again in UTF-8 mode if the locale is another, also for what it starts."""
    told = os.environ.get("PYTHONUTF8") == MODE["PYTHONUTF8"]
    if locale.getpreferredencoding(False).lower() != "utf-8" and not told:
        os.environ.update(MODE)
        os.execv(sys.executable, [sys.executable, *sys.orig_argv[1:]])
