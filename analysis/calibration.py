"""Which geometry fits the published numbers, by the static model.

The paper's text gives a * b only. Peaks and weights in pure shear depend on two ratios: the height
share h / (h + H), which is the share of the load that acts on lock 1, and (h + H) / b, the lever of
the rocking moment. The length a against b shows in the shape of the V-M curve, which the paper
describes in words: concave, two nearly straight parts, turning at about two thirds.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from analysis.published import Published
from sidmacib.mechanics.assembly import Floats
from workflow.configuration import ConfigError
from workflow.models import MODELS, Ability
from workflow.schema import Study
from workflow.schema.geometry import GeometrySection as Geometry

PEAK_SCALE = 0.01  # -, of a peak: published ones differ by up to 0.6 % between meshes
WEIGHT_SCALE = 0.02  # -, of a weight: printed with two digits, as mean stresses at one instant
ANGLES = np.linspace(0.0, 90.0, 19)  # degrees in the (V, M / a) plane
SIZES = ("a_m", "b_m", "h_m", "H_m")


def geometries(study: Study, published: Published) -> Iterator[Geometry]:
    """The grid of ``study.calibration``, with the published a * b; at the end the study's own."""
    grid = study.calibration
    area = published.numbers["sample"]["T0"] / study.materials.inner.cohesion
    for a, share, ratio in product(grid.a, grid.height_share, grid.height_over_b):
        b = area / a
        yield Geometry(a=a, b=b, h=share * ratio * b, H=(1.0 - share) * ratio * b)
    yield study.geometry


def geometry_study(
    study: Study, samples: Mapping[str, int], chosen: Mapping[str, Geometry], results: str
) -> dict[str, Any]:
    """Configuration of a study of the static model in pure shear on ``chosen`` geometries.

    ``samples``: numbers of locks by name. The study's samples are called geometry_sample.
    """
    return {
        "results": results,
        "samples": {
            f"{name}_{sample}": {"locks": locks, **geometry.model_dump()}
            for name, geometry in chosen.items()
            for sample, locks in samples.items()
        },
        "materials": study.materials.model_dump(),
        "meshes": [study.calibration.mesh],
        "eccentricities": [0],
        "models": ["static"],
        "dem": {"engines": []},
    }


def curve_study(
    study: Study, samples: Mapping[str, int], chosen: Mapping[str, Geometry], results: str
) -> dict[str, Any]:
    """The same in all directions, `ANGLES` apart."""
    ratios = [float(r) for r in np.tan(np.radians(ANGLES[:-1]))]
    return geometry_study(study, samples, chosen, results) | {
        "eccentricities": [*ratios, "torsion"]
    }


def engine_study(
    study: Study, samples: Mapping[str, int], chosen: Mapping[str, Geometry], results: str
) -> dict[str, Any]:
    """The same in pure shear, in the study's engines as well that know rigid pieces."""
    able = [name for name in study.dem.engines if Ability.RIGID in MODELS[name].abilities]
    return geometry_study(study, samples, chosen, results) | {
        "dem": {**study.dem.model_dump(mode="json"), "engines": able}
    }


@dataclass(frozen=True)
class GeometryMisfit:
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
    ) -> "GeometryMisfit":
        """Of peaks (N) and weights in pure shear, by number of locks, from the published ones."""
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


def misfit_table(
    own: Study, cases: pd.DataFrame, weights: pd.DataFrame, published: Published
) -> pd.DataFrame:
    """One row for each geometry and model of ``own``, a study that `geometry_study` describes.

    Sizes, peaks and weights in pure shear, and the misfit.
    """
    (mesh,) = own.meshes
    loads = cases.set_index(["model", "sample"])["load_N"]
    shares = weights.sort_values("lock").groupby(["model", "sample"])["weight"].apply(list)
    rows = []
    for name in dict.fromkeys(sample.partition("_")[0] for sample in own.samples):
        samples = {n: s.locks for n, s in own.samples.items() if n.partition("_")[0] == name}
        joint = own.joint(next(iter(samples)))
        geometry = Geometry(a=joint.a, b=joint.b, h=joint.h, H=joint.H)
        for model in cases["model"].unique():
            if any((model, sample) not in shares.index for sample in samples):
                continue  # a case without a result
            peaks = {locks: float(loads[model, sample]) for sample, locks in samples.items()}
            lists = {locks: shares[model, sample] for sample, locks in samples.items()}
            rows.append(
                {"geometry": name, "model": model}
                | size_columns(geometry)
                | misfit_columns(peaks, lists, published, mesh)
            )
    return pd.DataFrame(rows)


def misfit_columns(
    peaks: Mapping[int, float],
    weights: Mapping[int, list[float]],
    published: Published,
    mesh: float,
) -> dict[str, float]:
    """Misfits, peaks and weights of a geometry as columns of a table."""
    misfit = GeometryMisfit.of(peaks, weights, published, mesh)
    return (
        {"misfit_swapped": misfit.swapped, "misfit_printed": misfit.printed}
        | {f"peak_n{locks}_N": peak for locks, peak in peaks.items()}
        | {
            f"weight_n{locks}_lock{lock}": weight
            for locks, own in weights.items()
            for lock, weight in enumerate(own, start=1)
        }
    )


def size_columns(geometry: Geometry) -> dict[str, float]:
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


def curve_table(own: Study, cases: pd.DataFrame) -> pd.DataFrame:
    """V-M curves of a study that `curve_study` describes, one row per point.

    Each has its closest two straight parts beside it.
    """
    rows: list[dict[str, Any]] = []
    ratio = cases["eccentricity_over_a"]
    for sample, curve in cases.assign(ratio=ratio).dropna(subset=["load_N"]).groupby("sample"):
        points = curve.sort_values("ratio")[["shear_N", "torque_Nm"]].to_numpy()
        joint = own.joint(str(sample))
        parts = TwoParts.of(points)
        shape = {
            "turn_from_shear": parts.turn,
            "slope_near_shear": parts.slopes[0],
            "slope_near_torsion": parts.slopes[1],
            "residual": parts.residual,
        }
        sizes = size_columns(Geometry(a=joint.a, b=joint.b, h=joint.h, H=joint.H))
        rows += [
            sizes | {"locks": joint.locks, "shear_N": shear, "torque_Nm": torque} | shape
            for shear, torque in points
        ]
    return pd.DataFrame(rows)


def best_rows(table: pd.DataFrame) -> pd.DataFrame:
    """The best geometry of each length a, by the misfit with swapped weights, best first."""
    best = table.loc[table.groupby("a_m")["misfit_swapped"].idxmin()]
    return best.sort_values("misfit_swapped")


def geometry_of(row: pd.Series) -> Geometry:
    """The geometry of a row of `misfit_table`."""
    return Geometry(a=row["a_m"], b=row["b_m"], h=row["h_m"], H=row["H_m"])


def describe(table: pd.DataFrame) -> str:
    """The geometries (rank 0 is the study's own) in words, one line for each and each model."""
    peaks = [column for column in table if column.startswith("peak_")]
    lines = ["Geometries by misfit (rank 0: the study's own), pure shear"]
    for _, row in table.iterrows():
        sizes = ", ".join(f"{name} {row[f'{name}_m']:.4g}" for name in ("a", "b", "h", "H"))
        loads = ", ".join(f"{row[column]:.1f}" for column in peaks)
        lines.append(
            f"  {row['geometry'].removeprefix('rank')}  {sizes} m  {row['model']:8}  peaks {loads} "
            f"N  misfit {row['misfit_swapped']:.2f} (first two weights swapped), "
            f"{row['misfit_printed']:.1f} (as printed)"
        )
    return "\n".join([*lines, ""])


def check(study: Study, published: Published) -> dict[str, int]:
    """Numbers of locks of the published samples, by name; `ConfigError` if none can be fitted."""
    samples = published.samples(study)
    mesh = study.calibration.mesh
    if not samples:
        raise ConfigError(
            "samples: none of them is published; calibration needs one with the paper's strength, "
            "friction, number of locks and load"
        )
    if any(published.dem_pure_shear(n, mesh) is None for n in samples.values()):
        raise ConfigError(
            f"calibration.mesh: {mesh:g} m is not allowed; it must be one of the paper's meshes, "
            "0.02 or 0.005 m"
        )
    shortest = min(min(g.a, g.b) for g in geometries(study, published))
    if shortest <= mesh:
        raise ConfigError(
            f"calibration.mesh: {mesh:g} m is too coarse; it must be less than {shortest:g} m, the "
            "shortest side of a lock in calibration.a"
        )
    return samples
