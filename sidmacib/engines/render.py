"""Render a case: an engine's script from its template, and beside it the assembly and modules."""

import json
import math
import shutil
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

import jinja2
import numpy as np

from sidmacib.engines import Engine, Numerics
from sidmacib.engines.scripts.assembly import GivenMaterial, Guide
from sidmacib.engines.sides import convex_solids, sides, vertices_above
from sidmacib.mechanics.assembly import (
    Assembly,
    Cuboid,
    Face,
    FaceMaterial,
    Failure,
    Floats,
    Kind,
    Piece,
    Rectangle,
)
from sidmacib.mechanics.equilibrium import natural_frequencies
from sidmacib.mechanics.loads import Loads
from sidmacib.structure.blocks import Block, Compound
from sidmacib.structure.loads import SupportMotion

DATA_FILE = "joint.json"
MODULES = Path(__file__).parent
PACKED = Path(__file__).parents[1] / "templates"  # of an installed package
TEMPLATES = PACKED if PACKED.is_dir() else Path(__file__).parents[2] / "templates"
# Radii of contact spheres over the mean size of pieces: the small one is far more than what presses
# contacts together, and by the slip over the large one a normal turns.
POINT, FLAT = 0.001, 1000.0
# Rough dry faces so much stiffer than bonds slip as pieces swing, and that slip stays locked in: so
# the load is raised this many times more slowly. At the usual pace first failures were 9 % low to
# 2 % high; now they are within 0.2 % of the static model.
STIFFER, SLOWER = 100.0, 10.0
# Drag on pieces in LIGGGHTS, over critical drag at the longest natural period. It holds up what
# slides: with as much as elsewhere, joints that slip early carried up to 4 % more than in the
# static model. Blocks that friction holds swing themselves up against less: an arch gave way at
# 1310 N, and with this at 1363 N; the static model has 1361 N.
DRAG, DRAG_WHERE_IT_SLIPS, DRAG_OF_BLOCKS = 0.05, 0.005, 0.5
LARGEST_LOAD = 1e6  # over the first increment
FIRST_MOVEMENT = 1e-4  # of a support, over the mean size of pieces, or in rad
ENVIRONMENT = jinja2.Environment(
    loader=jinja2.FileSystemLoader(TEMPLATES),
    undefined=jinja2.StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
    keep_trailing_newline=True,
)


@dataclass(frozen=True, eq=False)
class GroundSteps:
    """Accelerations of the ground in steps of ``step`` (s), (K, 3) in m/s2.

    Pieces turn about the horizontal axis ``across`` the motion, a unit vector.
    """

    step: float
    acceleration: Floats
    across: Floats

    @property
    def data(self) -> dict[str, Any]:
        """As a script reads it."""
        return {"step_s": self.step, "acceleration": self.acceleration.tolist()}

    def inertia(self, piece: Piece) -> float:
        """That of a block about the axis, kg m2."""
        assert isinstance(piece, Block | Compound), "blocks of a structure"
        return float(self.across @ piece.inertia_tensor @ self.across)


def write_script(
    engine: Engine,
    assembly: Assembly,
    loads: Loads,
    numerics: Numerics,
    title: str,
    folder: Path,
    guide: Guide | None = None,
    furthest: float | None = None,
    ground: GroundSteps | None = None,
) -> None:
    """Write into ``folder`` all that the engine needs to run there, by hand as well.

    ``guide``: where it looks first. In place of a search, ``furthest``: the displacement (m) to
    which YADE moves the assembly; or the ``ground`` that shakes it.
    """
    folder.mkdir(parents=True, exist_ok=True)
    data = assembly_data(assembly, loads)
    if ground is not None:
        data["ground"] = ground.data
        for piece, of in zip(data["pieces"], assembly.pieces, strict=True):
            piece["inertia_kgm2"] = ground.inertia(of)
    (folder / DATA_FILE).write_text(json.dumps(data))
    text = ENVIRONMENT.get_template(engine.template).render(
        title=title,
        script_file=engine.script,
        data_file=DATA_FILE,
        materials={name: engine_material(law) for law, name in _material_names(assembly).items()},
        ductile=assembly.failure is Failure.DUCTILE,
        ranks=numerics.ranks,
        **_range(assembly, loads, numerics),
        tolerance=numerics.tolerance,
        guide=guide,
        found="motion" if ground else "peak" if furthest is None else "curve",
        furthest_m=furthest,
        **({} if engine.elastic else _rigid_pieces_in_time(assembly, numerics)),
    )
    (folder / engine.script).write_text(text)
    modules = folder / MODULES.name
    shutil.rmtree(modules, ignore_errors=True)
    compiled = shutil.ignore_patterns("__pycache__")
    for package in ("scripts", engine.name):
        shutil.copytree(MODULES / package, modules / package, ignore=compiled)


def _range(assembly: Assembly, loads: Loads, numerics: Numerics) -> dict[str, float | str]:
    """The first increment, the last load, and what there is to say where that is carried.

    A support moves by such loads (m or rad): at most as far as the structure is wide, or by pi.
    """
    first = numerics.first_increment * loads.scale
    last, unit = min(LARGEST_LOAD * first, loads.raised.most * loads.scale), "N"
    no_peak = loads.raised.endless or "the load grows without a peak"
    if isinstance(loads, SupportMotion):
        wide = float(np.ptp(assembly.nodes.position, axis=0).max())
        size, last, unit = (1.0, math.pi, "rad") if loads.turns else (assembly.length, wide, "m")
        first = FIRST_MOVEMENT * size
        no_peak = f"the structure stands where the support has moved by {last:.3g} {unit}"
    return {"first_increment_N": first, "last_N": last, "unit": unit, "no_peak": no_peak}


def _rigid_pieces_in_time(assembly: Assembly, numerics: Numerics) -> dict[str, float | int | bool]:
    """Additional data for rigid pieces that move in time on contact spheres."""
    blocks = not all(isinstance(piece, Cuboid) for piece in assembly.pieces)
    frequencies = natural_frequencies(assembly)
    time_step = numerics.time_step_ratio * 2.0 / float(frequencies[-1])
    period_steps = 2.0 * math.pi / float(frequencies[0]) / time_step
    slips = _slips_early(assembly)
    ramp_periods = numerics.ramp_periods * (SLOWER if slips else 1.0)
    return {
        "point_m": POINT * assembly.length,
        "flat_m": FLAT * assembly.length,
        "time_step_s": _rounded(time_step),
        "period_steps": _rounded(period_steps),
        "ramp_steps": math.ceil(ramp_periods * period_steps),
        "hold_steps": math.ceil(numerics.hold_periods * period_steps),
        "collapse_m": numerics.collapse_share * assembly.length,
        "damping": numerics.damping,
        "drag": DRAG_OF_BLOCKS if blocks else DRAG_WHERE_IT_SLIPS if slips else DRAG,
        "gradual": blocks,
        "unbalanced_ratio": numerics.unbalanced_ratio,
    }


def _slips_early(assembly: Assembly) -> bool:
    """Whether rough dry faces are over `STIFFER` times as stiff as a bond in shear."""
    bonds = [f.material.shear_stiffness for f in assembly.faces if f.kind is Kind.INNER]
    rough = [f.material for f in assembly.faces if f.kind is Kind.DRY and f.material.friction > 0.0]
    stiffest = max((material.normal_stiffness for material in rough), default=0.0)
    return stiffest > STIFFER * min(bonds, default=math.inf)


def assembly_data(assembly: Assembly, loads: Loads) -> dict[str, Any]:
    """Pieces, faces, nodes and loads in SI units, in plain types: all that a script needs to know.

    Pieces and faces are referred to by index, materials by the names that the script gives them.
    """
    names, support = _material_names(assembly), None
    if isinstance(loads, SupportMotion):
        support = {"piece": loads.support, "along": loads.along, "about_m": loads.about}
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
            if load.any() and loads.raised.axis is None
        ],
        "axis": loads.raised.axis,
        "support": support,
        "sides": [asdict(side) for side in loads.sides],
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
        law = piece.elastic
        data |= {"low_m": piece.low, "high_m": piece.high}
        data |= {"young_Pa": law and law.young, "poisson": law.poisson if law else 0.0}
    return data


def _face(face: Face, material: str) -> dict[str, Any]:
    """A face; only a rectangle has no tangents, as it lies along the axes."""
    data: dict[str, Any] = {
        "name": face.name,
        "kind": str(face.kind),
        "below": face.below,
        "above": face.above,
        "normal": face.axes[0].tolist(),
        "material": material,
    }
    if not isinstance(face, Rectangle):
        data["tangents"] = face.axes[1:].tolist()
    return data


def sources(engine: Engine) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The module that an engine's script runs, and the files that it is made of, by their paths."""
    parts = ("assembly.py.j2",) if engine.elastic else ("joint.py.j2", "assembly.py.j2")
    files = tuple(f"{TEMPLATES.name}/{name}" for name in (engine.template, *parts))
    return (f"sidmacib.engines.{engine.name}.run",), files


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
