"""YADE as its model needs it: compiled modules alone, and contacts of two spheres.

``import yade`` also imports IPython, numpy, mpmath and more, which takes longer than a small case.
In the launcher of YADE, which has already imported it, that module is used.
"""

import contextlib
import os
import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

from ..scripts.assembly import GivenFace
from ..scripts.records import NodeForce

LIBRARIES = "usr/lib/*/yade-double"  # Debian's


def _import_compiled_part() -> None:
    """Import the compiled part as ``yade/__init__.py`` does, and nothing else."""
    found = sorted(Path("/").glob(LIBRARIES))
    if not found:
        raise SystemExit(f"YADE is not in /{LIBRARIES}")
    package = ModuleType("yade")
    package.__path__ = [f"{found[0]}/py/yade"]
    sys.modules["yade"] = package
    sys.setdlopenflags(os.RTLD_NOW | os.RTLD_GLOBAL)
    config = import_module("yade.config")
    plugins = sorted(str(path) for path in Path(config.libDir).rglob("lib*.so"))
    import_module("yade.boot").initialize(plugins, config.confDir)


os.environ.setdefault("OMP_NUM_THREADS", "1")  # sums in a fixed order: results repeat exactly
if "yade" not in sys.modules:
    _import_compiled_part()

# In this order: each needs the types that those before it have made known.
wrapper: Any = import_module("yade.wrapper")
Vector3: Any = import_module("yade._minieigenHP").Vector3
import_module("yade._customConverters")  # of lists
create_interaction: Any = import_module("yade._utils").createInteraction

O: Any = wrapper.Omega()  # noqa: E741 (YADE's name for the simulation)
VERSION: str = import_module("yade.config").version

# States are kept in memory: the folder that YADE has made in /tmp stays empty, and for ever.
with contextlib.suppress(OSError):
    Path(O.tmpFilename()).parent.rmdir()


def contact(pair: tuple[int, int]) -> Any:
    """YADE's contact of two spheres; None if they do not touch."""
    touches = O.interactions.has(*pair) and O.interactions[pair].isReal
    return O.interactions[pair] if touches else None


def node_force(pair: tuple[int, int], face: GivenFace) -> NodeForce:
    """The force between two spheres."""
    found = contact(pair)
    if found is None:
        return NodeForce(0.0, (0.0, 0.0, 0.0), False)
    normal = found.geom.normal
    # YADE's forces act on the second body; the normal points from the first to the second.
    on_above = 1.0 if normal.dot(Vector3(face.normal)) > 0 else -1.0
    bonded = face.cohesive and not found.phys.cohesionBroken
    shear = tuple(on_above * found.phys.shearForce)
    return NodeForce(found.phys.normalForce.dot(normal), shear, bonded)


def watch(pairs: list[tuple[int, int]]) -> None:
    """Have every node looked at in each step, whether it is in contact or not."""
    for pair in pairs:
        if not O.interactions.has(*pair):
            create_interaction(*pair, virtualI=True)
