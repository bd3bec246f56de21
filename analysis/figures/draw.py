"""Draw all figures of a study."""

from collections.abc import Callable
from pathlib import Path

import pandas as pd
from matplotlib.figure import Figure

from analysis.figures import curves, figures_of, joint, models, style
from analysis.figures.style import FigureData
from workflow.case import JointCase
from workflow.results import BATCH_NODES, read_records
from workflow.results.joint_part import JointRecord
from workflow.results.tables import read_tables
from workflow.schema import Study
from workflow.step import Arguments, FileLists, Files, step

DRAWN_BY: dict[str, Callable[[FigureData], Figure]] = {
    "joint": joint.joint,
    "options": curves.options,
    "meshes": curves.meshes,
    "revised": curves.revised,
    "shear_stress": joint.stress_map,
    "torsion_stress": joint.stress_map,
    "models": models.models,
    "side_by_side": curves.side_by_side,
    "stiffness": models.stiffness,
    "fracture_energy": models.fracture_energy,
}


def stresses_of(case: JointCase, records: Path) -> tuple[JointRecord, pd.DataFrame] | None:
    """Record, in the file ``records``, and nodes of a ``case``; None if it failed.

    The nodes are in the case's own folder, or in those of the batch that it was solved in.
    """
    (record,) = (each for each in read_records([records]) if each.name == case.name)
    if record.error is not None:
        return None
    batch = records.with_name(BATCH_NODES)
    if batch.exists():
        nodes = pd.read_parquet(batch, filters=[("case", "==", case.name)])
    else:
        nodes = pd.read_csv(records.with_name("nodes.csv"))
    return record, nodes


def run(arguments: Arguments, inputs: Files, outputs: FileLists) -> None:
    """Draw every figure into the files that are named after it.

    ``inputs``: the tables, and by a figure's name the records of the case whose stresses it shows.
    """
    study = Study.model_validate_json(arguments["study"])
    tables = read_tables(inputs)
    for name, spec in figures_of(study).items():
        stresses = None
        if spec.case is not None and name in inputs:
            stresses = stresses_of(spec.case, inputs[name])
        figure = DRAWN_BY[spec.kind](FigureData(spec, study, stresses, **tables))
        style.save(figure, [path for path in outputs["figures"] if path.stem == name])


if __name__ == "__main__":
    step(run)
