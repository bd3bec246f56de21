"""The best geometries of a calibration, as the engines and the static model see them."""

import argparse
from pathlib import Path

import pandas as pd

from analysis.calibration import misfit_columns, size_columns
from analysis.reading import Published, read_published
from workflow.configuration import read_study_file
from workflow.models import detailed
from workflow.results import write_table
from workflow.schema import Study
from workflow.schema.geometry import GeometrySection


def confirmation_table(
    study: Study, capacity: pd.DataFrame, weights: pd.DataFrame, published: Published
) -> pd.DataFrame:
    """One row for each geometry (by rank; 0 is the study's own) and model, in pure shear."""
    rows = []
    (mesh,) = study.meshes
    for rank in dict.fromkeys(name.split("_")[0] for name in study.samples):
        own = {n: s.locks for n, s in study.samples.items() if n.split("_")[0] == rank}
        joint = study.joint(next(iter(own)))
        geometry = GeometrySection(a=joint.a, b=joint.b, h=joint.h, H=joint.H)
        for model in (m for m in detailed(study.model_names) if m in set(capacity["model"])):
            loads = capacity[capacity["model"] == model].set_index("sample")["load_N"]
            shares = weights[weights["model"] == model].sort_values("lock")
            peaks = {locks: float(loads[name]) for name, locks in own.items()}
            lists = {
                locks: shares.loc[shares["sample"] == name, "weight"].to_list()
                for name, locks in own.items()
            }
            rows.append(
                {"rank": int(rank.removeprefix("rank")), "model": model}
                | size_columns(geometry)
                | misfit_columns(peaks, lists, published, mesh)
            )
    return pd.DataFrame(rows)


def describe(table: pd.DataFrame) -> str:
    """The table in words, one line for each geometry and model."""
    peaks = [column for column in table if column.startswith("peak_")]
    lines = ["Geometries by misfit (rank 0: the study's own), pure shear"]
    for _, row in table.iterrows():
        sizes = ", ".join(f"{name} {row[f'{name}_m']:.4g}" for name in ("a", "b", "h", "H"))
        loads = ", ".join(f"{row[column]:.1f}" for column in peaks)
        lines.append(
            f"  {row['rank']}  {sizes} m  {row['model']:7}  peaks {loads} N  misfit "
            f"{row['misfit_swapped']:.2f} (first two weights swapped), "
            f"{row['misfit_printed']:.1f} (as printed)"
        )
    return "\n".join([*lines, ""])


def main() -> None:
    """Command line: files to write (table, text), the confirmation's configuration, its tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("output", type=Path, nargs=2)
    parser.add_argument("config", type=Path)
    parser.add_argument("tables", type=Path, nargs=2, help="capacity, weights")
    arguments = parser.parse_args()
    capacity, weights = (pd.read_csv(path) for path in arguments.tables)
    study = read_study_file(arguments.config)
    table = confirmation_table(study, capacity, weights, read_published())
    write_table(table, arguments.output[0])
    arguments.output[1].write_text(describe(table))


if __name__ == "__main__":
    main()
