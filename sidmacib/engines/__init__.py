"""The programs that a study can run: distinct elements, and finite ones for elastic pieces.

What an engine is, the parameters of its search for the peak, and the engines that there are. To add
one, see docs/maintain/extend.md.
"""

import os
import re
import shutil
import subprocess
import sys
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache
from tempfile import TemporaryDirectory
from typing import Annotated

from sidmacib.drawing import ORANGE, PURPLE, VERMILION
from sidmacib.model import Ability, Model
from sidmacib.quantities import Number, Share

# Variables that schedulers and MPI set for the processes that they start; not for engines.
FOREIGN = ("SLURM_", "SLURMD_", "SRUN_", "PMI_", "PMIX_", "OMPI_", "PRTE_")


@dataclass(frozen=True)
class Numerics:
    """Parameters of the search for the peak; all are dimensionless.

    The configuration takes keys, ranges and defaults of ``dem.numerics`` from here. Which of them
    an engine takes notice of is in its `reads`.
    """

    # last load increment over the peak
    tolerance: Annotated[float, Number(at_least=1e-5, at_most=0.0025)] = 0.001
    # whether the search starts near the result of the static model
    guided: bool = True
    # over the loads' scale, where it does not
    first_increment: Annotated[float, Number(above=0, at_most=1)] = 0.02
    # time in which the whole load is raised, and the longest wait for equilibrium after an
    # increment, both over the longest natural period of the unbroken assembly
    ramp_periods: Annotated[float, Number(at_least=1, at_most=1000)] = 40.0
    hold_periods: Annotated[float, Number(at_least=1, at_most=100_000)] = 4000.0
    # mean unbalanced force on a piece over the load; less is equilibrium
    unbalanced_ratio: Annotated[float, Number(at_least=1e-9, at_most=0.01)] = 1e-4
    # displacement since the last equilibrium over the mean size of pieces; what has moved further,
    # and moves ever faster, falls
    collapse_share: Annotated[float, Number(at_least=0.001, at_most=1)] = 0.04
    # share of the unbalanced force that is removed
    damping: Share = 0.4
    # over the largest stable time step
    time_step_ratio: Share = 0.4
    # processes for one case
    ranks: Annotated[int, Number(at_least=1, at_most=1024, whole=True)] = 1


def engine_environment(**more: str) -> dict[str, str]:
    """The environment of an engine's process, without variables set by a scheduler."""
    environment = {
        name: value for name, value in os.environ.items() if not name.startswith(FOREIGN)
    }
    return environment | more


@dataclass(frozen=True, kw_only=True)
class Engine(Model):
    """An external program and its abilities.

    ``template``: file in ``templates/``; ``script``: what it is rendered to; ``command``: starts
    the program, followed by the script's name; ``package``: Debian's package that has it;
    ``probe``: a program of that package, whose presence shows that it is installed;
    ``prints_version``: a command whose output contains the version, found by ``version_pattern``;
    ``reads``: keys of dem.numerics that have an effect on it.
    """

    template: str
    command: tuple[str, ...]
    package: str
    probe: str
    prints_version: tuple[str, ...]
    version_pattern: str
    reads: frozenset[str]
    script: str = "joint.py"

    @property
    def elastic(self) -> bool:
        """Whether its pieces are elastic; it needs no time step or period of rigid ones then."""
        return Ability.ELASTIC in self.abilities

    def numerics(self, given: Numerics) -> Numerics:
        """``given``, for one process unless the engine can use several."""
        return given if "ranks" in self.reads else replace(given, ranks=1)

    def missing(self) -> str | None:
        """The package to install, in one line; None if the program is installed."""
        if shutil.which(self.probe) and shutil.which(self.command[0]):
            return None
        return f"{self.name}: not installed; on Debian: apt-get install {self.package}"

    def version(self) -> str:
        """The version of the program, such as 3.8.0; RuntimeError if it states none."""
        printed = _printed(self.prints_version)
        found = re.search(self.version_pattern, printed, re.MULTILINE)
        if not found:
            last = printed.strip().rpartition("\n")[2]
            raise RuntimeError(f"{self.name}: does not start: {last or 'it prints nothing'}")
        return found[1]

    def versions(self) -> dict[str, str]:
        """Its version by its name; empty if it is not installed, or does not start."""
        with suppress(RuntimeError):
            return {} if self.missing() else {self.name: self.version()}
        return {}


@cache
def _printed(command: tuple[str, ...]) -> str:
    """What a command prints, whatever its exit code: that of CalculiX never says success."""
    # LIGGGHTS would start a daemon of MPI, which listens on ports; it leaves a log where it runs.
    alone = {"OMPI_MCA_ess_singleton_isolated": "1", "OMPI_MCA_btl": "self"}
    with TemporaryDirectory() as folder:
        return subprocess.run(
            command,
            cwd=folder,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            env=engine_environment(TMPDIR=folder, **alone),
            check=False,
        ).stdout


ALL_CAN = {Ability.BRITTLE, Ability.FRICTION, Ability.SHARED, Ability.FIRST_FAILURE}
DISTINCT_CAN = {*ALL_CAN, Ability.PROGRESSIVE, Ability.RIGID}
DISTINCT_READ = {
    *("tolerance", "guided", "first_increment", "ramp_periods", "hold_periods"),
    *("unbalanced_ratio", "collapse_share", "time_step_ratio"),
}

YADE = Engine(
    name="yade",
    label="YADE",
    colour=VERMILION,
    abilities=frozenset({*DISTINCT_CAN, Ability.DUCTILE, Ability.TWO_STIFFNESSES}),
    template="yade.py.j2",
    # Debian's Python, not the launcher of YADE, which opens ports on the loopback interface.
    command=(os.environ.get("YADE_PYTHON", "/usr/bin/python3"),),
    package="yade",
    probe="yade",
    # Of its configuration: asking the program takes it two seconds.
    prints_version=("sh", "-c", "cat /usr/lib/*/yade-double/py/yade/config.py"),
    version_pattern=r"^version='(.+)'",
    reads=frozenset({*DISTINCT_READ, "damping"}),
)

LIGGGHTS = Engine(
    name="liggghts",
    label="LIGGGHTS",
    colour=ORANGE,
    # Its inner faces are as stiff along as across.
    abilities=frozenset({*DISTINCT_CAN, Ability.BOND_FRICTION}),
    template="liggghts.py.j2",
    command=(sys.executable,),  # the script starts LIGGGHTS and gives it commands
    package="liggghts",
    probe="liggghts",
    prints_version=("liggghts", "-h"),
    version_pattern=r"LIGGGHTS \(Version LIGGGHTS-\w+ ([\w.]+)",
    reads=frozenset({*DISTINCT_READ, "ranks"}),
)

CALCULIX = Engine(
    name="calculix",
    label="CalculiX",
    colour=PURPLE,
    abilities=frozenset(
        {*ALL_CAN, Ability.TWO_STIFFNESSES, Ability.BOND_FRICTION, Ability.ELASTIC, Ability.JOINED}
    ),
    template="calculix.py.j2",
    command=(sys.executable,),  # the script starts CalculiX and reads what it writes
    package="calculix-ccx",
    probe="ccx",
    prints_version=("ccx", "-v"),
    version_pattern=r"Version ([\d.]+)",
    reads=frozenset({"tolerance", "first_increment"}),
)

ENGINES: dict[str, Engine] = {engine.name: engine for engine in (YADE, LIGGGHTS, CALCULIX)}
