"""The table of capacities: every model's largest load in every direction of loading."""

import argparse
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

import pandas as pd

from analysis.balance import unbalanced_share
from analysis.reading import CaseResult, Published, read_case, read_published
from analysis.weights import case_columns
from sidmacib.joint import Direction
from sidmacib.programme import Sidmacib, capacities
from sidmacib.revision import REDUCTIONS
from workflow.case import REFERENCE
from workflow.models import detailed
from workflow.results import write_table
from workflow.schema import Study

COLUMNS = (
    *("model", "variant", "locks", "mesh_m", "eccentricity_m", "shear_N", "torque_Nm"),
    *(
        "sample",
        "load_N",
        "failed_load_N",
        "first_failure_load_N",
        "unbalanced_share",
        "option",
        "friction",
        "reduction",
        "weights_from",
    ),
)


def model_row(result: CaseResult) -> dict[str, Any]:
    """The capacity that a model of the joint's pieces found."""
    return case_columns(result) | {
        "shear_N": result.shear,
        "torque_Nm": result.torque,
        "load_N": result.peak_load,
        "failed_load_N": result.failed_load,
        "first_failure_load_N": result.first_failure_load,
        "unbalanced_share": unbalanced_share(result),
    }


def pure_shear_weights(weights: pd.DataFrame, sample: str) -> dict[tuple[str, float], list[float]]:
    """Weights of a sample's locks by model and mesh, in the reference variant.

    They are read at the smallest eccentricity of the study: pure shear, as in the paper.
    """
    rows = weights[(weights["sample"] == sample) & (weights["variant"] == REFERENCE)]
    rows = rows[rows["eccentricity_m"] == rows["eccentricity_m"].min()].sort_values("lock")
    return {
        (str(model), float(mesh)): group["weight"].tolist()
        for (model, mesh), group in rows.groupby(["model", "mesh_m"], sort=False)
    }


def sidmacib_rows(study: Study, weights: pd.DataFrame) -> Iterator[dict[str, Any]]:
    """SiDMACIB's capacities for every option, with and without friction, under every reduction.

    Where a reduction depends on weights, once for each model and mesh that they were read from.
    """
    for sample in study.samples:
        joint = study.joint(sample)
        directions = [Direction(e) for e in study.eccentricities]
        read = {
            source: own
            for source, own in pure_shear_weights(weights, sample).items()
            if source[0] in detailed(study.model_names)
        }
        strengths: dict[tuple[float, ...], list[tuple[str, str, float]]] = {}
        for reduction, (source, own) in product(study.sidmacib.reductions, read.items()):
            strength = REDUCTIONS[reduction](joint, own)
            strengths.setdefault(strength, []).append((reduction, *source))
        for strength, uses in strengths.items():
            for (name, option), friction in product(study.sidmacib.options.items(), (False, True)):
                model = Sidmacib(
                    joint, option.contact_option(), strength, friction, study.sidmacib.overload
                )
                found = capacities(model, directions)
                for (reduction, source_model, mesh), (ratio, point) in product(
                    uses, zip(study.eccentricities, found, strict=True)
                ):
                    yield {
                        "model": "sidmacib",
                        "variant": sidmacib_variant(name, friction, reduction),
                        "sample": sample,
                        "locks": joint.locks,
                        "mesh_m": mesh,
                        "eccentricity_m": ratio * joint.a,
                        "shear_N": point.shear,
                        "torque_Nm": point.torque,
                        "load_N": point.load,
                        "option": name,
                        "friction": friction,
                        "reduction": reduction,
                        "weights_from": source_model,
                    }


def sidmacib_variant(option: str, friction: bool, reduction: str) -> str:
    """Name of a variant of SiDMACIB in the tables."""
    return f"{option}-{'friction' if friction else 'frictionless'}-{reduction}"


def published_rows(study: Study, published: Published) -> Iterator[dict[str, Any]]:
    """The paper's pure-shear capacities, for the samples that it has."""
    for sample in published.samples(study):
        joint = study.joint(sample)
        for mesh in study.meshes:
            value = published.dem_pure_shear(joint.locks, mesh)
            values = {"sidmacib": published.numbers["limit_pure_shear"][joint.locks], "3dec": value}
            for variant, shear in values.items():
                if shear is not None:
                    yield {
                        "model": "published",
                        "variant": variant,
                        "sample": sample,
                        "locks": joint.locks,
                        "mesh_m": mesh,
                        "eccentricity_m": 0.0,
                        "shear_N": float(shear),
                        "torque_Nm": 0.0,
                        "load_N": float(shear),
                    }


def main() -> None:
    """Command line: the table to write, the study as JSON, the weights, and the cases."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("capacity", type=Path)
    parser.add_argument("study", type=Study.model_validate_json)
    parser.add_argument("weights", type=Path)
    parser.add_argument("cases", type=Path, nargs="+", help="folder of each case")
    arguments = parser.parse_args()
    rows = [model_row(read_case(path)) for path in arguments.cases]
    rows += sidmacib_rows(arguments.study, pd.read_csv(arguments.weights))
    rows += published_rows(arguments.study, read_published())
    write_table(pd.DataFrame(rows, columns=list(COLUMNS)), arguments.capacity)


if __name__ == "__main__":
    main()
