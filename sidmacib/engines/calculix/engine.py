"""CalculiX: finite elements, up to the first node that fails."""

import subprocess
import sys

from sidmacib.drawing import PURPLE
from sidmacib.engines.engine import Engine
from sidmacib.model import Ability


def _version() -> str:
    """The text with CalculiX's version; it ends with an exit code although it succeeds."""
    return subprocess.run(
        ["ccx", "-v"], stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False
    ).stdout


CALCULIX = Engine(
    name="calculix",
    label="CalculiX",
    colour=PURPLE,
    abilities=frozenset(
        {
            *(Ability.BRITTLE, Ability.TWO_STIFFNESSES, Ability.FRICTION),
            *(Ability.ELASTIC, Ability.JOINED, Ability.SHARED),
            Ability.FIRST_FAILURE,
        }
    ),
    template="calculix.py.j2",
    command=(sys.executable,),  # the script starts CalculiX and reads what it writes
    package="calculix-ccx",
    probe="ccx",
    version_text=_version,
    version_pattern=r"Version ([\d.]+)",
    reads=frozenset({"tolerance", "first_increment"}),
)
