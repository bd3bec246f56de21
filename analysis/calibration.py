"""Which geometry fits the published numbers, by the static model.

The paper's text gives a * b only. Peaks and weights in pure shear depend on two ratios: the height
share h / (h + H), which is the share of the load that acts on lock 1, and (h + H) / b, the lever of
the rocking moment. The length a against b shows in the shape of the V-M curve, which the paper
describes in words: concave, two nearly straight parts, turning at about two thirds.
"""

import argparse
import math
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import yaml

from analysis.reading import CaseResult, Published, read_published
from analysis.weights import lock_weights
from sidmacib.mechanics.assembly import Floats
from sidmacib.pieces import lock_faces
from workflow.cases import cases_of
from workflow.configuration import read_study
from workflow.results import write_table
from workflow.schema import Study
from workflow.schema.geometry import GeometrySection
from workflow.solve import node_table, solve_case

PEAK_SCALE = 0.01  # -, of a peak: published ones differ by up to 0.6 % between meshes
WEIGHT_SCALE = 0.02  # -, of a weight: printed with two digits, as mean stresses at one instant
ANGLES = np.linspace(0.0, 90.0, 19)  # degrees in the (V, M / a) plane
SIZES = ("a_m", "b_m", "h_m", "H_m")


def geometries(study: Study, published: Published) -> Iterator[GeometrySection]:
    """The grid of ``study.calibration``, with the published a * b; the study's own at the end."""
    grid = study.calibration
    area = published.numbers["sample"]["T0"] / study.materials.inner.cohesion
    for a, share, ratio in product(grid.a, grid.height_share, grid.height_over_b):
        b = area / a
        yield GeometrySection(a=a, b=b, h=share * ratio * b, H=(1.0 - share) * ratio * b)
    yield study.geometry


def static_results(
    study: Study, samples: Mapping[str, int], geometry: GeometrySection, ratios: Floats
) -> Iterator[CaseResult]:
    """The static model of ``samples`` of a geometry, e / a being ``ratios``; without histories."""
    own = read_study(
        {
            "samples": {name: {"locks": locks} for name, locks in samples.items()},
            "geometry": geometry.model_dump(),
            "materials": study.materials.model_dump(),
            "meshes": [study.calibration.mesh],
            "eccentricities": [float(ratio) for ratio in ratios],
            "models": ["static"],
            "dem": {"engines": []},
        }
    )
    for case in cases_of(own).values():
        model, outcome = solve_case(case)
        peak = outcome.path[-1]
        loads = (peak.load, outcome.failed_load, outcome.first_failure_load)
        nodes = node_table(model, peak)
        nodes["lock"] = nodes["face"].map(lock_faces(case.joint)).fillna(0).astype(int)
        yield CaseResult(case, *loads, nodes, pd.DataFrame())


@dataclass(frozen=True)
class Misfit:
    """Root mean square of the differences over their scales, with the weights in each order."""

    printed: float
    swapped: float

    @classmethod
    def of(
        cls,
        peaks: Mapping[int, float],
        weights: Mapping[int, list[float]],
        published: Published,
        mesh: float,
    ) -> "Misfit":
        """Peaks (N) and weights in pure shear, by number of locks, against the published ones."""
        printed: list[float] = []
        swapped: list[float] = []
        for locks, peak in peaks.items():
            first, second, *others = published.numbers["weights"][locks]
            value = published.dem_pure_shear(locks, mesh)
            assert value is not None, f"no published peak at mesh {mesh:g} m"
            for pair, found in (((first, second), printed), ((second, first), swapped)):
                found.append((peak / value - 1.0) / PEAK_SCALE)
                differences = np.subtract(weights[locks], [*pair, *others])
                found.extend((differences / WEIGHT_SCALE).tolist())
        return cls(*(float(np.sqrt(np.mean(np.square(own)))) for own in (printed, swapped)))


def misfit_map(study: Study, published: Published) -> pd.DataFrame:
    """One row for each geometry: peaks and weights in pure shear, and the misfit."""
    rows = []
    for geometry in geometries(study, published):
        results = list(static_results(study, published.samples(study), geometry, np.zeros(1)))
        peaks = {r.case.joint.locks: r.peak_load for r in results}
        weights = {r.case.joint.locks: lock_weights(r)["weight"].to_list() for r in results}
        rows.append(
            size_columns(geometry)
            | misfit_columns(peaks, weights, published, study.calibration.mesh)
        )
    return pd.DataFrame(rows)


def misfit_columns(
    peaks: Mapping[int, float],
    weights: Mapping[int, list[float]],
    published: Published,
    mesh: float,
) -> dict[str, float]:
    """Misfits, peaks and weights of a geometry as columns of a table."""
    misfit = Misfit.of(peaks, weights, published, mesh)
    return (
        {"misfit_swapped": misfit.swapped, "misfit_printed": misfit.printed}
        | {f"peak_n{locks}_N": peak for locks, peak in peaks.items()}
        | {
            f"weight_n{locks}_lock{lock}": weight
            for locks, own in weights.items()
            for lock, weight in enumerate(own, start=1)
        }
    )


def size_columns(geometry: GeometrySection) -> dict[str, float]:
    """Sizes of a geometry, and the two ratios that pure shear depends on."""
    height = geometry.h + geometry.H
    sizes = (geometry.a, geometry.b, geometry.h, geometry.H)
    ratios = {"height_share": geometry.h / height, "height_over_b": height / geometry.b}
    return dict(zip(SIZES, sizes, strict=True)) | ratios


@dataclass(frozen=True)
class TwoParts:
    """A curve as two straight parts, in V and M over their largest values.

    ``turn``: share of the curve's length, from pure shear on, where they meet; ``slopes``: -dM/dV
    of both; ``residual``: root mean square distance from the curve.
    """

    turn: float
    slopes: tuple[float, float]
    residual: float

    @classmethod
    def of(cls, points: Floats) -> "TwoParts":
        """The closest two straight parts to ``points`` (V, M) from pure shear on, (N, 2)."""
        scaled = points / points.max(axis=0)
        length = length_along(scaled)
        place = length / length[-1]
        fits = []
        for turn in np.linspace(0.1, 0.9, 81):
            base = np.column_stack([np.interp(place, [0.0, turn, 1.0], row) for row in np.eye(3)])
            knots = np.linalg.lstsq(base, scaled, rcond=None)[0]
            residual = float(np.sqrt(np.mean(np.sum((base @ knots - scaled) ** 2, axis=1))))
            fits.append((residual, float(turn), knots))
        residual, turn, knots = min(fits, key=lambda fit: fit[0])
        first, second = np.diff(knots, axis=0)
        slopes = (float(-first[1] / first[0]), float(-second[1] / second[0]))
        return cls(turn, slopes, residual)


def length_along(points: Floats) -> Floats:
    """Length of a curve from its first point to each of ``points``, (N, 2); shape (N,)."""
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])


def curve_table(
    study: Study, samples: Mapping[str, int], geometries: list[GeometrySection]
) -> pd.DataFrame:
    """V-M curves of some geometries, and their two straight parts, one row per point."""
    ratios = np.array([math.inf if g == 90.0 else math.tan(math.radians(g)) for g in ANGLES])
    rows: list[dict[str, Any]] = []
    for geometry in geometries:
        results = list(static_results(study, samples, geometry, ratios))
        for locks in dict.fromkeys(r.case.joint.locks for r in results):
            own = [r for r in results if r.case.joint.locks == locks]
            parts = TwoParts.of(np.array([(r.shear, r.torque) for r in own]))
            shape = {
                "turn_from_shear": parts.turn,
                "slope_near_shear": parts.slopes[0],
                "slope_near_torsion": parts.slopes[1],
                "residual": parts.residual,
            }
            rows += [
                size_columns(geometry)
                | {"locks": locks, "shear_N": r.shear, "torque_Nm": r.torque}
                | shape
                for r in own
            ]
    return pd.DataFrame(rows)


def best_rows(table: pd.DataFrame) -> pd.DataFrame:
    """The best geometry of each length a, by the misfit with swapped weights, best first."""
    best = table.loc[table.groupby("a_m")["misfit_swapped"].idxmin()]
    return best.sort_values("misfit_swapped")


def geometry_of(row: pd.Series) -> GeometrySection:
    """The geometry of a row of `misfit_map`."""
    return GeometrySection(a=row["a_m"], b=row["b_m"], h=row["h_m"], H=row["H_m"])


def confirmation(
    study: Study, samples: Mapping[str, int], chosen: list[GeometrySection], results: str
) -> dict[str, Any]:
    """Configuration of a study of pure shear on ``chosen`` geometries, for the engines to run.

    Samples are named by rank; rank 0 is the study's own geometry.
    """
    return {
        "results": results,
        "samples": {
            f"rank{rank}_{name}": {"locks": locks, **geometry.model_dump()}
            for rank, geometry in enumerate(chosen)
            for name, locks in samples.items()
        },
        "materials": study.materials.model_dump(),
        "meshes": [study.calibration.mesh],
        "eccentricities": [0],
        "models": ["static"],
        "dem": study.dem.model_dump(mode="json"),
    }


def main() -> None:
    """Command line: the study as JSON, the folder of the confirmation, and files to write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("study", type=Study.model_validate_json)
    parser.add_argument("results")
    parser.add_argument("output", type=Path, nargs=3, help="map, curves, configuration")
    arguments = parser.parse_args()
    study, published = arguments.study, read_published()
    samples = published.samples(study)
    if any(published.dem_pure_shear(n, study.calibration.mesh) is None for n in samples.values()):
        sys.exit(f"calibration.mesh: got {study.calibration.mesh:g} m, allowed is a published one")
    if not samples:
        sys.exit("samples: none of them is published, so there is nothing to calibrate with")
    shortest = min(min(g.a, g.b) for g in geometries(study, published))
    if shortest <= study.calibration.mesh:
        sys.exit(
            f"calibration.mesh: got {study.calibration.mesh:g} m, allowed is less than "
            f"{shortest:g} m, the shortest side of a lock in calibration.a"
        )
    table = misfit_map(study, published)
    best = [geometry_of(row) for _, row in best_rows(table.iloc[:-1]).iterrows()]
    config = confirmation(
        study, samples, [study.geometry, *best[: study.calibration.confirmed]], arguments.results
    )
    write_table(table, arguments.output[0])
    write_table(curve_table(study, samples, [study.geometry, *best]), arguments.output[1])
    arguments.output[2].write_text(yaml.safe_dump(config, sort_keys=False))


if __name__ == "__main__":
    main()
