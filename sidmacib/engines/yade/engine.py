"""YADE: distinct elements, in Python."""

import os
from pathlib import Path

from sidmacib.drawing import VERMILION
from sidmacib.engines.engine import Engine
from sidmacib.model import Ability

CONFIGURATION = "/usr/lib", "*/yade-double/py/yade/config.py"  # Debian's


def _configuration() -> str:
    """YADE's configuration: asking the program takes it two seconds."""
    root, pattern = CONFIGURATION
    return "".join(path.read_text() for path in sorted(Path(root).glob(pattern)))


YADE = Engine(
    name="yade",
    label="YADE",
    colour=VERMILION,
    abilities=frozenset(
        {
            *(Ability.BRITTLE, Ability.DUCTILE, Ability.TWO_STIFFNESSES, Ability.FRICTION),
            *(Ability.PROGRESSIVE, Ability.RIGID, Ability.SHARED),
            Ability.FIRST_FAILURE,
        }
    ),
    template="yade.py.j2",
    # Debian's Python, not the launcher of YADE, which opens ports on the loopback interface.
    command=(os.environ.get("YADE_PYTHON", "/usr/bin/python3"),),
    package="yade",
    probe="yade",
    version_text=_configuration,
    version_pattern=r"^version='(.+)'",
    reads=frozenset(
        {
            *("tolerance", "guided", "first_increment", "ramp_periods", "hold_periods"),
            *("unbalanced_ratio", "collapse_share", "time_step_ratio", "damping"),
        }
    ),
)
