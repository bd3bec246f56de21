"""The distinct-element programs that a study can run. To add one, see CONTRIBUTING.md."""

import os
import shutil
import sys
from dataclasses import dataclass


@dataclass(frozen=True)
class Engine:
    """An external program.

    ``template``: file in ``templates/``; ``script``: what it is rendered to; ``command``: starts
    the program, followed by the script's name; ``package``: Debian's package that has it;
    ``probe``: a program of that package, which tells whether it is installed; ``brittle_only``: it
    knows no ductile faces; ``one_stiffness``: its inner faces are as stiff along as across;
    ``shares_out``: it can share a case out to several processes; ``ignores``: keys of the numerics
    that do nothing in it.
    """

    name: str
    template: str
    script: str
    command: tuple[str, ...]
    package: str
    probe: str
    brittle_only: bool = False
    one_stiffness: bool = False
    shares_out: bool = False
    ignores: tuple[str, ...] = ()

    def missing(self) -> str | None:
        """What to install, in one line; None if the program is there."""
        if shutil.which(self.probe) and shutil.which(self.command[0]):
            return None
        return f"{self.name}: not installed; on Debian: apt-get install {self.package}"


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
        ),
        Engine(
            name="liggghts",
            template="liggghts.py.j2",
            script="joint.py",
            command=(sys.executable,),  # the script starts LIGGGHTS and gives it commands
            package="liggghts",
            probe="liggghts",
            brittle_only=True,
            one_stiffness=True,
            shares_out=True,
            ignores=("damping",),
        ),
    )
}
