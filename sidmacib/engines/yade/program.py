"""The compiled modules of YADE, without the other imports of its Python package.

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
