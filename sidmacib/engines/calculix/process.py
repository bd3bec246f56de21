"""CalculiX on a deck, and the results that it writes while it runs."""

import os
import re
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

from ..scripts.children import ENDS_WITH_PARENT

COMMAND = "ccx"
WAIT = 0.1  # s, until results are looked for again
NUMBER = 12  # characters of a number in the .frd file
END, DISPLACEMENT = "\n -3\n", "\n -4  DISP "  # of a block; where displacements begin
STATE = re.compile(r"^ +100CL +\d+ *([-+.\dEe]+) ", re.MULTILINE)
Displacements = dict[int, tuple[float, float, float]]  # m, by node


class CalculixProcess:
    """CalculiX on the deck ``job``.inp, until it ends or is stopped."""

    def __init__(self, job: str) -> None:
        self.log = Path(f"{job}.log")
        self.results = Path(f"{job}.frd")
        self.results.unlink(missing_ok=True)
        with self.log.open("w") as stream:
            self.process = subprocess.Popen(
                [*ENDS_WITH_PARENT, COMMAND, job],
                stdin=subprocess.DEVNULL,
                stdout=stream,
                stderr=subprocess.STDOUT,
                env={**os.environ, "OMP_NUM_THREADS": "1"},
            )

    def states(self) -> Iterator[tuple[float, Displacements]]:
        """Times and displacements of all increments, each as soon as it is complete."""
        position, pending = 0, ""
        while True:
            ended = self.process.poll() is not None
            if self.results.exists():
                with self.results.open() as stream:
                    stream.seek(position)
                    pending += stream.read()
                    position = stream.tell()
            *blocks, pending = pending.split(END)
            for block in blocks:
                if DISPLACEMENT in block:
                    yield read_state(block)
            if ended:
                return
            time.sleep(WAIT)

    def stop(self) -> None:
        """End it, whatever it does."""
        self.process.kill()
        self.process.wait()

    def version(self) -> str:
        """The version of CalculiX, such as 2.20, from its results."""
        with self.results.open() as stream:
            found = re.search(r"^ +1UVERSION +Version ([\w.]+)", stream.read(4096), re.MULTILINE)
        if not found:
            raise SystemExit("CalculiX: its output states no version")
        return found[1]

    def why(self) -> str:
        """Its last error, or how it ended."""
        lines = [line.strip() for line in self.log.read_text(errors="replace").splitlines()]
        errors = [line for line in lines if line.startswith("*ERROR")]
        return errors[-1] if errors else f"CalculiX ended with exit code {self.process.returncode}"


def read_state(block: str) -> tuple[float, Displacements]:
    """Time and displacements in the part of an .frd file that ends with a state's last line."""
    found = STATE.findall(block)
    if not found:
        raise SystemExit("CalculiX's results are not understood: displacements without a time")
    lines = block[block.rindex(DISPLACEMENT) :].splitlines()
    moved: Displacements = {}
    for line in lines:
        if line.startswith(" -1"):
            x, y, z = (float(line[13 + NUMBER * k : 13 + NUMBER * (k + 1)]) for k in range(3))
            moved[int(line[3:13])] = x, y, z
    return float(found[-1]), moved
