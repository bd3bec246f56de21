"""The programs that a study can run: distinct elements, and finite ones for elastic pieces.

To add one, see CONTRIBUTING.md.
"""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

YADE_CONFIGURATION = "/usr/lib", "*/yade-double/py/yade/config.py"  # Debian's


# What schedulers and MPI tell the processes that they start: an engine is none of them.
FOREIGN = ("SLURM_", "SLURMD_", "SRUN_", "PMI_", "PMIX_", "OMPI_", "PRTE_")


def own_environment(**more: str) -> dict[str, str]:
    """The environment of an engine's process: without what a scheduler has put into this one's."""
    own = {name: value for name, value in os.environ.items() if not name.startswith(FOREIGN)}
    return own | more


@dataclass(frozen=True)
class Engine:
    """An external program.

    ``template``: file in ``templates/``; ``script``: what it is rendered to; ``command``: starts
    the program, followed by the script's name; ``package``: Debian's package that has it;
    ``probe``: a program of that package, which tells whether it is installed; ``version_text``: a
    text of the program that holds its version where ``version_pattern`` tells.

    What it cannot do: ``brittle_only``: it knows no ductile faces; ``one_stiffness``: its inner
    faces are as stiff along as across. What it can: ``shares_out``: share a case out to several
    processes. ``elastic``: its pieces are elastic, and it needs no time step or period of rigid
    ones. ``first_failure_only``: it goes no further than to the first node that fails.
    ``ignores``: numerics that it does not use.
    """

    name: str
    template: str
    script: str
    command: tuple[str, ...]
    package: str
    probe: str
    version_text: Callable[[], str]
    version_pattern: str
    brittle_only: bool = False
    one_stiffness: bool = False
    shares_out: bool = False
    elastic: bool = False
    first_failure_only: bool = False
    ignores: tuple[str, ...] = ()

    def missing(self) -> str | None:
        """What to install, in one line; None if the program is there."""
        if shutil.which(self.probe) and shutil.which(self.command[0]):
            return None
        return f"{self.name}: not installed; on Debian: apt-get install {self.package}"

    def version(self) -> str:
        """The program's own version, such as 3.8.0; RuntimeError if it is not installed."""
        return _version(self)


@cache
def _version(engine: Engine) -> str:
    if missing := engine.missing():
        raise RuntimeError(missing)
    found = re.search(engine.version_pattern, engine.version_text(), re.MULTILINE)
    if not found:
        raise RuntimeError(f"{engine.name}: it does not tell its version")
    return found[1]


def _yade_configuration() -> str:
    """YADE's configuration: asking the program takes it two seconds."""
    root, pattern = YADE_CONFIGURATION
    return "".join(path.read_text() for path in sorted(Path(root).glob(pattern)))


def _liggghts_help() -> str:
    alone = {"OMPI_MCA_ess_singleton_isolated": "1", "OMPI_MCA_btl": "self"}
    return subprocess.run(
        ["liggghts", "-h"],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        errors="replace",
        env=own_environment(**alone),
        check=False,
    ).stdout


def _calculix_version() -> str:
    """What CalculiX says of itself; it ends with an exit code although nothing is wrong."""
    return subprocess.run(
        ["ccx", "-v"], stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False
    ).stdout


ENGINES = {
    engine.name: engine
    for engine in (
        Engine(
            name="yade",
            template="yade.py.j2",
            script="joint.py",
            # Debian's Python, not yade's own launcher: the latter opens ports on the loopback.
            command=(os.environ.get("YADE_PYTHON", "/usr/bin/python3"),),
            package="yade",
            probe="yade",
            version_text=_yade_configuration,
            version_pattern=r"^version='(.+)'",
            ignores=("ranks",),
        ),
        Engine(
            name="liggghts",
            template="liggghts.py.j2",
            script="joint.py",
            command=(sys.executable,),  # the script starts LIGGGHTS and gives it commands
            package="liggghts",
            probe="liggghts",
            version_text=_liggghts_help,
            version_pattern=r"LIGGGHTS \(Version LIGGGHTS-\w+ ([\w.]+)",
            brittle_only=True,
            one_stiffness=True,
            shares_out=True,
            ignores=("damping",),
        ),
        Engine(
            name="calculix",
            template="calculix.py.j2",
            script="joint.py",
            command=(sys.executable,),  # the script starts CalculiX and reads what it writes
            package="calculix-ccx",
            probe="ccx",
            version_text=_calculix_version,
            version_pattern=r"Version ([\d.]+)",
            brittle_only=True,
            elastic=True,
            first_failure_only=True,
            ignores=(
                *("ramp_periods", "hold_periods", "unbalanced_ratio", "collapse_ratio"),
                *("damping", "time_step_ratio", "guided"),
            ),
        ),
    )
}


def versions(engine: Engine) -> dict[str, str]:
    """The version of an engine; empty if it is not installed."""
    return {} if engine.missing() else {engine.name: engine.version()}
