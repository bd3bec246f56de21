"""Draw one figure of a study."""

import argparse
from collections.abc import Callable
from pathlib import Path

import pandas as pd
from matplotlib.figure import Figure

from analysis.figures import curves, models, side_by_side, stress_maps, style
from analysis.figures.catalogue import figures_of
from analysis.figures.material import Material
from analysis.reading import read_case
from workflow.schema import Study

DRAWN_BY: dict[str, Callable[[Material], Figure]] = {
    "options": curves.options,
    "meshes": curves.meshes,
    "revised": curves.revised,
    "shear_stress": stress_maps.shear_stress,
    "torsion_stress": stress_maps.torsion_stress,
    "models": models.models,
    "side_by_side": side_by_side.side_by_side,
}


def main() -> None:
    """Command line: the figure's name, the study as JSON, tables, stresses, and files to write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("name")
    parser.add_argument("study", type=Study.model_validate_json)
    parser.add_argument("--tables", type=Path, nargs=3, help="capacity, validation, models")
    parser.add_argument("--case", type=Path, nargs="*", help="files of the case shown")
    parser.add_argument("--output", type=Path, nargs="+")
    arguments = parser.parse_args()
    spec = figures_of(arguments.study)[arguments.name]
    capacity, validation, table = (pd.read_csv(path) for path in arguments.tables)
    result = read_case(arguments.case[0].parent) if arguments.case else None
    material = Material(spec, arguments.study, capacity, validation, table, result)
    style.save(DRAWN_BY[spec.kind](material), arguments.output)


if __name__ == "__main__":
    main()
