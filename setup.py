"""Build the package, with the engines' templates and functions compiled for this machine."""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from setuptools import setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_py import build_py

MODULE = "sidmacib.dynamics.precompiled"
CODE = "sidmacib/mechanics/machine_code"
# 0: for any Python and processor, such as for PyPI; functions are then compiled at first use.
PRECOMPILE = os.environ.get("MULTILOCK_PRECOMPILE", "1") != "0"


class Build(build_py):
    """Copies modules and templates, and compiles what otherwise the first command has to."""

    def run(self) -> None:
        """As setuptools does, then compile in a process of its own."""
        super().run()
        if self.editable_mode:
            return
        self.copy_tree("templates", str(Path(self.build_lib) / "sidmacib/templates"))
        shutil.rmtree(Path(self.build_lib) / CODE, ignore_errors=True)  # of an earlier build
        if not PRECOMPILE:
            return
        with tempfile.TemporaryDirectory() as kept:  # what is compiled on the way is not shipped
            environment = os.environ | {"NUMBA_CACHE_DIR": kept, "PYTHONDONTWRITEBYTECODE": "1"}
            command = [sys.executable, "-m", MODULE]
            done = subprocess.run(command, cwd=self.build_lib, env=environment, check=False)
        if done.returncode:
            self.announce("functions are not compiled; the first command will do that", level=3)
            shutil.rmtree(Path(self.build_lib) / CODE, ignore_errors=True)


class Wheel(bdist_wheel):
    """Tagged for this Python and platform if it has compiled functions, else for any."""

    def get_tag(self) -> tuple[str, str, str]:
        """Python, ABI and platform."""
        built = self.get_finalized_command("build_py")
        compiled = Path(built.build_lib, CODE).is_dir() and not built.editable_mode
        self.root_is_pure = not compiled
        return super().get_tag()


setup(cmdclass={"build_py": Build, "bdist_wheel": Wheel})
