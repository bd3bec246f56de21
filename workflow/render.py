"""Render a case: an engine's script from its template, and the joint as data beside it."""

import argparse
import json
import math
from dataclasses import asdict
from pathlib import Path
from typing import Any

import jinja2

from sidmacib.loading import lateral_load
from sidmacib.mechanics.assembly import Assembly, Failure, Loads
from sidmacib.mechanics.vibration import compliance, natural_frequencies
from sidmacib.pieces import assemble
from workflow.case import Case
from workflow.engines import ENGINES, Engine
from workflow.numerics import Numerics

DATA_FILE = "joint.json"
TEMPLATES = Path(__file__).parents[1] / "templates"
ENVIRONMENT = jinja2.Environment(
    loader=jinja2.FileSystemLoader(TEMPLATES),
    undefined=jinja2.StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
    keep_trailing_newline=True,
)


def assembly_data(assembly: Assembly, loads: Loads) -> dict[str, Any]:
    """Pieces, faces, nodes and loads in SI units, in plain types: all that a script needs to know.

    Pieces and faces are referred to by index. Loads are per newton.
    """
    return {
        "pieces": [
            {
                "name": piece.name,
                "fixed": piece.fixed,
                "centre_m": piece.centre.tolist(),
                "mass_kg": piece.mass,
                "inertia_kgm2": float(piece.inertia.max()),
                "weight_N": piece.weight,
            }
            for piece in assembly.pieces
        ],
        "faces": [
            {
                "name": face.name,
                "kind": str(face.kind),
                "below": face.below,
                "above": face.above,
                "normal": face.normal.tolist(),
            }
            for face in assembly.faces
        ],
        "loads": [
            {"piece": index, "force": load[:3].tolist(), "moment_m": load[3:].tolist()}
            for index, load in enumerate(loads.variable)
            if load.any()
        ],
        "nodes": {
            "face": assembly.nodes.face.tolist(),
            "position_m": assembly.nodes.position.tolist(),
            "area_m2": assembly.nodes.area.tolist(),
        },
    }


def script(
    engine: Engine,
    title: str,
    assembly: Assembly,
    loads: Loads,
    numerics: Numerics,
) -> str:
    """The engine's script for ``assembly`` under ``loads``."""
    frequencies = natural_frequencies(assembly)
    time_step = numerics.time_step_ratio * 2.0 / float(frequencies[-1])
    period_steps = 2.0 * math.pi / float(frequencies[0]) / time_step
    return ENVIRONMENT.get_template(engine.template).render(
        title=title,
        script_file=engine.script,
        data_file=DATA_FILE,
        materials={str(face.kind): asdict(face.material) for face in assembly.faces},
        ductile=assembly.failure is Failure.DUCTILE,
        flat_radius_m=2 * assembly.length,
        time_step_s=_rounded(time_step),
        period_steps=_rounded(period_steps),
        ranks=numerics.ranks,
        ramp_steps=math.ceil(numerics.ramp_periods * period_steps),
        hold_steps=math.ceil(numerics.hold_periods * period_steps),
        first_increment_N=numerics.first_increment * loads.scale,
        collapse_m_per_N=_rounded(numerics.collapse_ratio * compliance(assembly, loads)),
        damping=numerics.damping,
        tolerance=numerics.tolerance,
        unbalanced_ratio=numerics.unbalanced_ratio,
    )


def _rounded(value: float) -> float:
    """``value`` without the last digits, which depend on the machine's linear algebra."""
    return float(f"{value:.9g}")


def write_case(case: Case, folder: Path) -> None:
    """Write the case, its data and its engine's script into ``folder``."""
    engine = ENGINES[case.model]
    assert case.numerics is not None, f"{case.name}: an engine needs numerics"
    assembly = assemble(case.joint, case.mesh)
    loads = lateral_load(case.joint, assembly, case.loading)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / DATA_FILE).write_text(json.dumps(assembly_data(assembly, loads)))
    (folder / "case.json").write_text(case.to_json())
    title = f"{case.name}: {case.joint.locks} locks, mesh {case.mesh:g} m."
    (folder / engine.script).write_text(script(engine, title, assembly, loads, case.numerics))


def main() -> None:
    """Command line: the case as JSON, and the folder to write to."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("case", type=Case.from_json)
    parser.add_argument("folder", type=Path)
    arguments = parser.parse_args()
    write_case(arguments.case, arguments.folder)


if __name__ == "__main__":
    main()
