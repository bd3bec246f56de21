"""A running LIGGGHTS that takes commands."""

import math
import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterable, Sequence
from itertools import count
from pathlib import Path

from ..scripts.children import ENDS_WITH_PARENT, in_private_network
from ..scripts.records import NoAnswerError

LIGGGHTS = ("liggghts", "-log", "none")
# Ranks talk through shared memory: without these, every rank listens on ports of all interfaces.
MPI = {"OMPI_MCA_btl": "self,vader"}
ALONE = {"OMPI_MCA_ess_singleton_isolated": "1"}  # no daemon either, which would do the same
# Ranks that wait for each other give way where there are more of them than cores.
MPIRUN = ("--allow-run-as-root", "--oversubscribe", "--mca", "mpi_yield_when_idle", "1")


def command(ranks: int) -> tuple[str, ...]:
    """The command for LIGGGHTS; mpirun, which always listens, runs in a private network."""
    prefix = (*ENDS_WITH_PARENT, "stdbuf", "-oL")
    if ranks == 1:
        return (*prefix, *LIGGGHTS)
    mpirun = ("mpirun", "-np", str(ranks), *MPIRUN)
    return (*in_private_network(), *prefix, *mpirun, *ENDS_WITH_PARENT, *LIGGGHTS)


class LiggghtsProcess:
    """LIGGGHTS on ``ranks`` processes; an error ends this script with its last lines."""

    def __init__(self, ranks: int) -> None:
        self.process = subprocess.Popen(
            command(ranks),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",  # of its error messages some are not text
            env={
                **os.environ,
                **MPI,
                # In the system's folders files of the dead stay, and of two that start and end at
                # once one may fail.
                "OMPI_MCA_btl_vader_backing_directory": str(Path.cwd()),
                "OMPI_MCA_orte_tmpdir_base": str(Path.cwd()),
                **(ALONE if ranks == 1 else {}),
            },
        )
        self.marks = count()
        self.steps, self.fresh = 0, True
        found = re.search(r"LIGGGHTS \(Version LIGGGHTS-\w+ ([\w.]+)", "\n".join(self.send()))
        assert found, "LIGGGHTS states no version"
        self.version = found[1]

    def send(self, *commands: str) -> list[str]:
        """Give it commands, wait for their end, and return the lines that it printed."""
        assert self.process.stdin and self.process.stdout
        mark = f"done {next(self.marks)}"
        lines: list[str] = []
        try:
            self.process.stdin.write("".join(f"{c}\n" for c in commands) + f'print "{mark}"\n')
            self.process.stdin.flush()
        except BrokenPipeError:
            pass  # it has ended: its last words follow
        for line in self.process.stdout:
            if line.strip() == mark:
                return lines
            lines.append(line.rstrip())
        status = self.process.wait()
        how = f"exit code {status}" if status >= 0 else f"signal {-status}"
        said = next(filter(None, reversed(lines)), "it said nothing")
        words = f"LIGGGHTS ended before its commands were done ({how}): {said}"
        print("\n".join([*lines[-20:], words]), file=sys.stderr)
        if any("Lost atoms" in line for line in lines):
            raise NoAnswerError(
                "no peak: the pieces moved further than contact spheres can follow; LIGGGHTS lost "
                "some"
            )
        sys.exit(128 + signal.SIGKILL if status == -signal.SIGKILL else 1)

    def run(self, steps: int) -> None:
        """Advance; what was changed since the last run is set up only where ``fresh``."""
        self.steps += steps
        self.send(f"run {steps} pre {'yes' if self.fresh else 'no'} post no")
        self.fresh = False

    def forces(self) -> dict[int, list[float]]:
        """Force (N) on each atom."""
        pattern = "%d %.17g %.17g %.17g"
        self.send(f'write_dump all custom now.dump id fx fy fz modify format "{pattern}"')
        return dumped_rows(Path("now.dump").read_text())

    def values(self, names: Iterable[str]) -> list[float]:
        """Values of variables."""
        text = " ".join("$" + "{" + name + "}" for name in names)
        return printed_values(self.send(f'print "values {text}"'))

    def stop(self) -> None:
        """End it by closing its input, so that it removes its temporary files."""
        self.process.communicate()


def dumped_rows(text: str) -> dict[int, list[float]]:
    """Numbers of the atoms in the last snapshot of a dump, by atom."""
    lines = text.splitlines()
    start = max(i for i, line in enumerate(lines) if line.startswith("ITEM: ATOMS")) + 1
    rows = (line.split() for line in lines[start:])
    return {int(row[0]): [float(value) for value in row[1:]] for row in rows}


def printed_values(lines: Sequence[str]) -> list[float]:
    """Numbers of the printed line that begins with "values"; exits if one is not finite."""
    line = next(line for line in lines if line.startswith("values "))
    found = [float(value) for value in line.split()[1:]]
    if not all(map(math.isfinite, found)):
        raise SystemExit(
            "the computation has diverged: LIGGGHTS returned values that are not finite numbers"
        )
    return found
