"""Render a case: an engine's script from its template, and beside it the assembly and modules."""

import ast
import json
import math
import re
import shutil
from dataclasses import asdict, fields
from functools import cache
from importlib.util import resolve_name
from pathlib import Path
from typing import Any

import jinja2
import jinja2.meta
import numpy as np

from sidmacib.engines.engine import Engine, Numerics
from sidmacib.engines.scripts.assembly import NEVER_FALLS, GivenMaterial, Guide
from sidmacib.engines.sides import convex_solids, sides, vertices_above
from sidmacib.mechanics.assembly import (
    Assembly,
    Cuboid,
    Face,
    FaceMaterial,
    Failure,
    Floats,
    Loads,
    Piece,
    Rectangle,
)
from sidmacib.mechanics.polygons import Polygon
from sidmacib.mechanics.springs import natural_frequencies
from sidmacib.structure.loads import SupportMotion

DATA_FILE = "joint.json"
MODULES = Path(__file__).parent
PACKED = Path(__file__).parents[1] / "templates"  # of an installed package
TEMPLATES = PACKED if PACKED.is_dir() else Path(__file__).parents[2] / "templates"
# Radii of contact spheres over the mean size of pieces: the small one is far more than what presses
# contacts together, and by the slip over the large one a normal turns.
POINT, FLAT = 0.001, 1000.0
LARGEST_LOAD = 1e6  # over the first increment
FIRST_MOVEMENT = 1e-4  # of a support, over the mean size of pieces, or in rad
ENVIRONMENT = jinja2.Environment(
    loader=jinja2.FileSystemLoader(TEMPLATES),
    undefined=jinja2.StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
    keep_trailing_newline=True,
)


def write_script(
    engine: Engine,
    assembly: Assembly,
    loads: Loads,
    numerics: Numerics,
    title: str,
    folder: Path,
    guide: Guide | None = None,
    furthest: float | None = None,
) -> None:
    """Write into ``folder`` all that the engine needs to run there, by hand as well.

    ``guide``, ``furthest``: see `script`.
    """
    folder.mkdir(parents=True, exist_ok=True)
    (folder / DATA_FILE).write_text(json.dumps(assembly_data(assembly, loads)))
    text = script(engine, assembly, loads, numerics, title, guide, furthest)
    (folder / engine.script).write_text(text)
    modules = folder / MODULES.name
    shutil.rmtree(modules, ignore_errors=True)
    for name in script_modules(text):
        (modules / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(MODULES / name, modules / name)


def script(
    engine: Engine,
    assembly: Assembly,
    loads: Loads,
    numerics: Numerics,
    title: str,
    guide: Guide | None = None,
    furthest: float | None = None,
) -> str:
    """The engine's script for ``assembly`` under ``loads``; ``guide``: where it looks first.

    ``furthest``: the displacement (m) to which YADE moves the assembly, in place of a search.
    """
    return ENVIRONMENT.get_template(engine.template).render(
        title=title,
        script_file=engine.script,
        data_file=DATA_FILE,
        materials={name: engine_material(law) for law, name in _material_names(assembly).items()},
        ductile=assembly.failure is Failure.DUCTILE,
        ranks=numerics.ranks,
        **_range(assembly, loads, numerics),
        tolerance=numerics.tolerance,
        guide=guide,
        furthest_m=furthest,
        **({} if engine.elastic else _rigid_pieces_in_time(assembly, loads, numerics)),
    )


def _range(assembly: Assembly, loads: Loads, numerics: Numerics) -> dict[str, float | str]:
    """The first increment, the last load, and what there is to say where that is carried.

    A support moves by such loads (m or rad): at most as far as the structure is wide, or by pi.
    """
    first = numerics.first_increment * loads.scale
    last, unit, no_peak = LARGEST_LOAD * first, "N", "the load grows without a peak"
    if loads.axis is not None:
        last, no_peak = math.pi * loads.scale, NEVER_FALLS
    if isinstance(loads, SupportMotion):
        wide = float(np.ptp(assembly.nodes.position, axis=0).max())
        size, last, unit = (1.0, math.pi, "rad") if loads.turns else (assembly.length, wide, "m")
        first = FIRST_MOVEMENT * size
        no_peak = f"the structure stands where the support has moved by {last:.3g} {unit}"
    return {"first_increment_N": first, "last_N": last, "unit": unit, "no_peak": no_peak}


def _rigid_pieces_in_time(
    assembly: Assembly, loads: Loads, numerics: Numerics
) -> dict[str, float | int | bool]:
    """Additional data for rigid pieces that move in time on contact spheres."""
    blocks = not all(isinstance(piece, Cuboid) for piece in assembly.pieces)
    frequencies = natural_frequencies(assembly)
    time_step = numerics.time_step_ratio * 2.0 / float(frequencies[-1])
    period_steps = 2.0 * math.pi / float(frequencies[0]) / time_step
    return {
        "point_m": POINT * assembly.length,
        "flat_m": FLAT * assembly.length,
        "time_step_s": _rounded(time_step),
        "period_steps": _rounded(period_steps),
        "ramp_steps": math.ceil(numerics.ramp_periods * period_steps),
        "hold_steps": math.ceil(numerics.hold_periods * period_steps),
        "collapse_m": numerics.collapse_share * assembly.length,
        "damping": numerics.damping,
        "gradual": blocks,
        "unbalanced_ratio": numerics.unbalanced_ratio,
    }


def assembly_data(assembly: Assembly, loads: Loads) -> dict[str, Any]:
    """Pieces, faces, nodes and loads in SI units, in plain types: all that a script needs to know.

    Pieces and faces are referred to by index, materials by the names that the script gives them.
    """
    names = _material_names(assembly)
    return {
        "pieces": [
            _piece(piece, permanent)
            for piece, permanent in zip(assembly.pieces, loads.permanent, strict=True)
        ],
        "faces": [
            _face(face, names[face.material]) | sides(assembly, face) for face in assembly.faces
        ],
        "loads": [
            {"piece": index, "force": load[:3].tolist(), "moment_m": load[3:].tolist()}
            for index, load in enumerate(loads.variable)
            if load.any() and loads.axis is None
        ],
        "axis": loads.axis and list(loads.axis),
        "support": _support(loads),
        "sides": [{**asdict(side), "wrench": list(side.wrench)} for side in loads.sides],
        "length_m": assembly.length,
        "mesh_m": assembly.mesh if math.isfinite(assembly.mesh) else None,
        "layout": str(assembly.layout),
        "nodes": {
            "face": assembly.nodes.face.tolist(),
            "position_m": assembly.nodes.position.tolist(),
            "area_m2": assembly.nodes.area.tolist(),
            "vertex_above": vertices_above(assembly).tolist(),
        },
    }


def _support(loads: Loads) -> dict[str, Any] | None:
    """The support that moves, as `SupportMove` has it; None if none does."""
    if not isinstance(loads, SupportMotion):
        return None
    along, about = list(loads.along), loads.about and list(loads.about)
    return {"piece": loads.support, "along": along, "about_m": about}


def _piece(piece: Piece, permanent: Floats) -> dict[str, Any]:
    """A piece and its permanent loads; only a cuboid has corners, and may be elastic."""
    data = {
        "name": piece.name,
        "fixed": piece.fixed,
        "centre_m": piece.centre.tolist(),
        "mass_kg": piece.mass,
        "inertia_kgm2": float(piece.inertia.max()),
        "force_N": permanent[:3].tolist(),
        "moment_Nm": permanent[3:].tolist(),
        "solids": convex_solids(piece),
    }
    if isinstance(piece, Cuboid):
        data |= {
            "low_m": list(piece.low),
            "high_m": list(piece.high),
            "young_Pa": piece.elastic.young if piece.elastic else None,
            "poisson": piece.elastic.poisson if piece.elastic else 0.0,
        }
    return data


def _face(face: Face, material: str) -> dict[str, Any]:
    """A face: a rectangle has sizes along x, y, z, any other along its normal and tangents."""
    data = {
        "name": face.name,
        "kind": str(face.kind),
        "below": face.below,
        "above": face.above,
        "normal": face.axes[0].tolist(),
    }
    if isinstance(face, Rectangle):
        size = [high - low for low, high in zip(face.low, face.high, strict=True)]
        return {**data, "size_m": size, "material": material}
    if not isinstance(face, Polygon):
        raise TypeError(f"{face.name}: must be a rectangle or a polygon")
    low_p, low_q, high_p, high_q = face.outline.bounds
    size = [0.0, high_p - low_p, high_q - low_q]
    tangents = face.axes[1:].tolist()
    return {**data, "size_m": size, "material": material, "tangents": tangents}


@cache
def script_modules(text: str) -> tuple[str, ...]:
    """Files below `MODULES` that a script of this text imports, directly or not."""
    names: set[str] = set()
    waiting = _imported(text, "")
    while waiting:
        name = waiting.pop()
        if name not in names:
            names.add(name)
            waiting |= _imported_by(name)
    return tuple(sorted(names))


@cache
def _imported_by(file: str) -> frozenset[str]:
    package = ".".join((MODULES.name, *Path(file).parent.parts))
    return frozenset(_imported((MODULES / file).read_text(), package))


def _imported(text: str, package: str) -> set[str]:
    """Files below `MODULES` that a module of ``package`` imports, and those of their packages."""
    names = (
        resolve_name("." * node.level + node.module, package)
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.ImportFrom) and node.module
    )
    below = [name.split(".")[1:] for name in names if name.startswith(f"{MODULES.name}.")]
    return {f"{folder}/{file}.py" for folder, name in below for file in ("__init__", name)}


@cache
def sources(engine: Engine) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Modules that the engine's script imports, and files it is made of, below the project."""
    files, waiting = [], [engine.template]
    while waiting:
        name = waiting.pop()
        files.append(name)
        text = (TEMPLATES / name).read_text()
        found = jinja2.meta.find_referenced_templates(ENVIRONMENT.parse(text))
        waiting += [other for other in found if other]
    texts = "".join((TEMPLATES / name).read_text() for name in files)
    named = re.findall(rf"^from ({MODULES.name}[\w.]+) import", texts, re.MULTILINE)
    root = __name__.removesuffix(f"{MODULES.name}.render")
    modules = tuple(f"{root}{name}" for name in dict.fromkeys(named))
    return modules, tuple(f"{TEMPLATES.name}/{name}" for name in files)


def _material_names(assembly: Assembly) -> dict[FaceMaterial, str]:
    """A name for every material: the kind of the first face that has it, numbered if need be."""
    names: dict[FaceMaterial, str] = {}
    for face in assembly.faces:
        if face.material not in names:
            same = sum(name.split("-")[0] == face.kind for name in names.values())
            names[face.material] = f"{face.kind}-{same + 1}" if same else str(face.kind)
    return names


def engine_material(material: FaceMaterial) -> dict[str, float]:
    """The properties of a material that scripts of engines read; engines model no softening."""
    return {field.name: getattr(material, field.name) for field in fields(GivenMaterial)}


def _rounded(value: float) -> float:
    """``value`` without the last digits, which depend on the machine's linear algebra."""
    return float(f"{value:.9g}")
