"""An external program that a study can run, and the parameters of its search for the peak."""

import os
import re
import shutil
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import Annotated

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
    ``version_text``: a text of the program that contains its version, found by
    ``version_pattern``; ``reads``: keys of dem.numerics that have an effect on it.
    """

    template: str
    command: tuple[str, ...]
    package: str
    probe: str
    version_text: Callable[[], str]
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
        """The version of the program, such as 3.8.0; RuntimeError if it is not installed."""
        return _version(self)

    def versions(self) -> dict[str, str]:
        """Its version by its name; empty if it is not installed."""
        return {} if self.missing() else {self.name: self.version()}


@cache
def _version(engine: Engine) -> str:
    if missing := engine.missing():
        raise RuntimeError(missing)
    found = re.search(engine.version_pattern, engine.version_text(), re.MULTILINE)
    if not found:
        raise RuntimeError(f"{engine.name}: its output states no version")
    return found[1]
