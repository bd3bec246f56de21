"""LIGGGHTS: distinct elements, on several processes if need be."""

import subprocess
import sys

from sidmacib.drawing import ORANGE
from sidmacib.engines.engine import Engine, engine_environment
from sidmacib.model import Ability


def _help() -> str:
    alone = {"OMPI_MCA_ess_singleton_isolated": "1", "OMPI_MCA_btl": "self"}
    return subprocess.run(
        ["liggghts", "-h"],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        errors="replace",
        env=engine_environment(**alone),
        check=False,
    ).stdout


LIGGGHTS = Engine(
    name="liggghts",
    label="LIGGGHTS",
    colour=ORANGE,
    abilities=frozenset(  # its inner faces are as stiff along as across
        {
            *(Ability.BRITTLE, Ability.FRICTION, Ability.PROGRESSIVE),
            *(Ability.RIGID, Ability.SHARED),
            Ability.FIRST_FAILURE,
        }
    ),
    template="liggghts.py.j2",
    command=(sys.executable,),  # the script starts LIGGGHTS and gives it commands
    package="liggghts",
    probe="liggghts",
    version_text=_help,
    version_pattern=r"LIGGGHTS \(Version LIGGGHTS-\w+ ([\w.]+)",
    reads=frozenset(
        {
            *("tolerance", "guided", "first_increment", "ramp_periods", "hold_periods"),
            *("unbalanced_ratio", "collapse_share", "time_step_ratio", "ranks"),
        }
    ),
)
