"""The command `multilock`: answers for one joint, in a terminal."""

import signal
import sys


def run() -> None:
    """The program: ^C ends it with one word, while it is loaded too."""
    signal.signal(signal.SIGINT, _interrupt)
    try:
        from sidmacib.command.main import main

        main(prog_name="multilock")
    except KeyboardInterrupt:
        sys.exit("Aborted!")


def _interrupt(*_: object) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # it is ending already
    raise KeyboardInterrupt
