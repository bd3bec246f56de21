"""Build the package, with the engines' templates and functions compiled for this machine."""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

MODULE = "sidmacib.mechanics.precompiled"


class Build(build_py):
    """Copies modules and templates, and compiles what otherwise the first command has to."""

    def run(self) -> None:
        """As setuptools does, then compile in a process of its own."""
        super().run()
        if self.editable_mode:
            return
        self.copy_tree("templates", str(Path(self.build_lib) / "sidmacib/templates"))
        with tempfile.TemporaryDirectory() as kept:  # what is compiled on the way is not shipped
            environment = os.environ | {"NUMBA_CACHE_DIR": kept, "PYTHONDONTWRITEBYTECODE": "1"}
            command = [sys.executable, "-m", MODULE]
            done = subprocess.run(command, cwd=self.build_lib, env=environment, check=False)
        if done.returncode:
            self.announce("functions are not compiled; the first command will do that", level=3)


setup(cmdclass={"build_py": Build})
