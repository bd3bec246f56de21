"""Solve all cases of a model that needs no engine, and write what an engine would."""

import argparse
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from sidmacib.errors import CapacityError
from sidmacib.loading import lateral_load
from sidmacib.mechanics.assembly import Assembly
from sidmacib.mechanics.equilibrium import face_frames
from sidmacib.pieces import assemble
from workflow.case import Case
from workflow.cases import case_folder, cases_of
from workflow.models import MODELS, Obtained, obtained_by
from workflow.outcome import Outcome, State
from workflow.results import write_results
from workflow.schema import Study


def solve_case(case: Case) -> tuple[Assembly, Outcome]:
    """The assembly of ``case``, and what its model finds."""
    assembly = assemble(case.joint, case.mesh)
    loads = lateral_load(case.joint, assembly, case.loading)
    return assembly, MODELS[case.model].solve(assembly, loads)


def node_table(assembly: Assembly, state: State) -> pd.DataFrame:
    """Stresses at all nodes, in the columns of an engine's nodes.csv."""
    assert state.force is not None and state.bonded is not None
    faces = [assembly.faces[number] for number in assembly.nodes.face]
    stress = state.force / assembly.nodes.area[:, None]
    shear = np.einsum("nt,ntx->nx", stress[:, 1:], face_frames(assembly)[:, 1:])
    return pd.DataFrame(
        {
            "face": [face.name for face in faces],
            "kind": [str(face.kind) for face in faces],
            **dict(zip(("x_m", "y_m", "z_m"), assembly.nodes.position.T, strict=True)),
            "area_m2": assembly.nodes.area,
            "normal_Pa": stress[:, 0],
            **dict(zip(("shear_x_Pa", "shear_y_Pa", "shear_z_Pa"), shear.T, strict=True)),
            "bonded": state.bonded.astype(int),
        }
    )


def history_row(assembly: Assembly, state: State) -> dict[str, Any]:
    """Load, displacement, shear on and broken share of each inner face."""
    assert state.force is not None and state.bonded is not None
    row: dict[str, Any] = {
        "load_N": state.load,
        "displacement_m": state.displacement,
    }
    frames = face_frames(assembly)
    for number, face in enumerate(assembly.faces):
        own = assembly.nodes.face == number
        if face.kind == "inner":
            shear = np.einsum("nt,ntx->x", state.force[own, 1:], frames[own, 1:])
            row[f"{face.name}_shear_x_N"], row[f"{face.name}_shear_y_N"] = shear[:2]
    for number, face in enumerate(assembly.faces):
        if face.kind == "inner":
            row[f"{face.name}_broken_share"] = (
                1.0 - state.bonded[assembly.nodes.face == number].mean()
            )
    return row


def write_outcome(case: Case, assembly: Assembly, outcome: Outcome, folder: Path) -> None:
    """Write what a model found, see `workflow.results`."""
    history = pd.DataFrame([history_row(assembly, state) for state in outcome.path])
    loads = (outcome.path[-1].load, outcome.failed_load, outcome.first_failure_load)
    write_results(case, folder, node_table(assembly, outcome.path[-1]), history, loads)


def main() -> None:
    """Command line: the model, the study as JSON, and the results' folder."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("model", choices=obtained_by(Obtained.SOLVED))
    parser.add_argument("study", type=Study.model_validate_json)
    parser.add_argument("results")
    arguments = parser.parse_args()
    for (name, _), case in cases_of(arguments.study).items():
        if name != arguments.model:
            continue
        try:
            assembly, outcome = solve_case(case)
        except CapacityError as error:
            sys.exit(f"{case.name}: {name}: {error}")
        write_outcome(
            case, assembly, outcome, Path(case_folder(arguments.results, name, case.name))
        )


if __name__ == "__main__":
    main()
