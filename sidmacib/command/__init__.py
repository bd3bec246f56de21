"""The command `multilock`: answers for joints and structures, in a terminal."""

import os
import signal
import sys

FAULT = 2  # exit status, as click's of wrong usage


def run() -> None:
    """The program: ^C ends it with one word, while it is loaded too; a full disk with one line."""
    signal.signal(signal.SIGINT, _interrupt)
    os.environ["MPLBACKEND"] = "Agg"  # that of a notebook is not there
    try:
        from sidmacib.command.main import main

        main(prog_name="multilock")
    except KeyboardInterrupt:
        sys.exit("Aborted!")
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # what is left to print has no room either
        place = f"{error.filename}: " if error.filename else ""
        print(f"Error: {place}{error.strerror or error}", file=sys.stderr)
        sys.exit(FAULT)


def _interrupt(*_: object) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # it is ending already
    raise KeyboardInterrupt
