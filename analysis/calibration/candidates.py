"""Search for the geometry and friction that fit the published numbers, by the static model.

Of the geometry, the paper's text gives a * b only. Peaks and weights in pure shear depend on two
ratios: the height share h / (h + H), which is the share of the load that acts on lock 1, and
(h + H) / b, the lever of the rocking moment, which friction on the dry faces turns into load. The
ratio a / b shows in the shape of the V-M curve, which the paper describes in words: concave, two
nearly straight parts, turning at about two thirds.

The paper prints a friction coefficient of 0.3, but no geometry fits with it, so it is varied too.
That 3DEC, whose friction is an angle in degrees, was given 0.3 is a hypothesis, see
`read_as_degrees`.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from analysis.published import Published
from sidmacib.joint import Joint
from sidmacib.mechanics.assembly import Floats
from sidmacib.model import Ability
from sidmacib.models import MODELS
from workflow.configuration import ConfigError
from workflow.schema import Study

# Of a peak: published ones of a sample differ by 0.03 and 0.55 % between the meshes.
PEAK_SCALE = 0.005
WEIGHT_SCALE = 0.02  # -, of a weight: printed with two digits, as mean stresses at one instant
PEAK_AIM, WEIGHT_AIM = 0.005, 0.04  # largest differences of a joint that fits
ANGLES = np.linspace(0.0, 90.0, 19)  # degrees in the (V, M / a) plane


class Trial(NamedTuple):
    """Sizes of a joint (m), and the friction coefficient of its dry faces."""

    a: float
    b: float
    h: float
    H: float
    friction: float


def candidates(study: Study, published: Published) -> Iterator[Trial]:
    """The grid of ``study.calibration``, with the published a * b."""
    grid = study.calibration
    area = published.numbers["sample"]["T0"] / study.materials.inner.cohesion
    axes = (grid.a, grid.height_share, grid.height_over_b, grid.friction)
    for a, share, ratio, friction in product(*axes):
        b = area / a
        yield Trial(a, b, share * ratio * b, (1.0 - share) * ratio * b, friction)


def study_candidates(study: Study, published: Published) -> list[Trial]:
    """The joints of the study's published samples, each size and friction once."""
    joints = map(study.joint, published.samples(study))
    return list(dict.fromkeys(Trial(j.a, j.b, j.h, j.H, j.dry.friction) for j in joints))


def read_as_degrees(published: Published) -> float:
    """The friction coefficient if the printed one was given to 3DEC, which takes an angle."""
    return math.tan(math.radians(published.numbers["sample"]["friction"]))


def candidate_study(
    study: Study, locks: Sequence[int], chosen: Mapping[str, Trial]
) -> dict[str, Any]:
    """Configuration of a study of the static model in pure shear on ``chosen`` candidates.

    Its samples are called candidate_n and the number of locks.
    """
    return {
        "samples": {
            f"{name}_n{n}": {
                "locks": n,
                **{"a": each.a, "b": each.b, "h": each.h, "H": each.H},
                "dry": {"friction": each.friction},
            }
            for (name, each), n in product(chosen.items(), locks)
        },
        "materials": study.materials.model_dump(),
        "assembly": study.assembly.model_dump(mode="json"),
        "meshes": list(study.calibration.meshes),
        "nodes": str(study.nodes),
        "eccentricities": [0],
        "models": ["static"],
        "dem": {"engines": []},
    }


def curve_study(study: Study, locks: Sequence[int], chosen: Mapping[str, Trial]) -> dict[str, Any]:
    """The same in all directions, `ANGLES` apart."""
    ratios = [float(r) for r in np.tan(np.radians(ANGLES[:-1]))]
    return candidate_study(study, locks, chosen) | {"eccentricities": [*ratios, "torsion"]}


def engine_study(study: Study, locks: Sequence[int], chosen: Mapping[str, Trial]) -> dict[str, Any]:
    """The same in pure shear, in the study's engines as well that know rigid pieces."""
    able = [name for name in study.dem.engines if Ability.RIGID in MODELS[name].abilities]
    return candidate_study(study, locks, chosen) | {
        "dem": {**study.dem.model_dump(mode="json"), "engines": able}
    }


Place = tuple[int, float]  # number of locks, mesh (m)


def misfit_table(
    study: Study, cases: pd.DataFrame, weights: pd.DataFrame, published: Published
) -> pd.DataFrame:
    """One row for each candidate and model of a ``study`` that `candidate_study` describes.

    Sizes, friction, peaks and weights in pure shear, and the misfit.
    """
    keys = ["model", "sample", "mesh_m"]
    loads = cases.dropna(subset=["load_N"]).set_index(keys)["load_N"].to_dict()
    lists = weights.sort_values("lock").groupby(keys)["weight"].apply(list).to_dict()
    by_name: dict[str, list[str]] = {}
    for sample in study.samples:
        by_name.setdefault(sample.partition("_")[0], []).append(sample)
    rows = []
    for (name, samples), model in product(by_name.items(), cases["model"].unique()):
        at = {
            (study.samples[sample].locks, mesh): (model, sample, mesh)
            for sample, mesh in product(samples, study.meshes)
        }
        if not (loads.keys() & lists.keys()).issuperset(at.values()):
            continue  # a case without a result
        peaks, shares = ({to: known[key] for to, key in at.items()} for known in (loads, lists))
        sizes = size_columns(study.joint(samples[0]))
        rows.append(
            {"candidate": name, "model": model} | sizes | misfit_columns(peaks, shares, published)
        )
    return pd.DataFrame(rows)


def misfit_columns(
    peaks: Mapping[Place, float],
    weights: Mapping[Place, Sequence[float]],
    published: Published,
) -> dict[str, Any]:
    """Misfits of peaks (N) and weights, by number of locks and mesh, and both, as columns.

    ``misfit_swapped``, ``misfit_printed``: root mean square of the differences from the published
    ones over their scales, with the weights of the first two locks in each order. Every peak
    counts. The paper does not give the mesh of its weights: those at the finest one count in the
    misfit, and those at all meshes in the largest difference, swapped. ``fits``: whether all
    differences are within the targets.
    """
    finest = min(mesh for _, mesh in peaks)
    known = [published.dem_pure_shear(*at) for at in peaks]
    relative = np.array([*peaks.values()]) / np.array(known, dtype=float) - 1.0
    farthest, largest = float(np.abs(relative).max()), 0.0
    scaled = {name: [*(relative / PEAK_SCALE)] for name in ("swapped", "printed")}
    shown: dict[str, float] = {}
    for (locks, mesh), computed in weights.items():
        first, second, *others = published.numbers["weights"][locks]
        swapped = np.subtract(computed, [second, first, *others])
        largest = max(largest, float(np.abs(swapped).max()))
        if mesh == finest:
            scaled["swapped"] += [*(swapped / WEIGHT_SCALE)]
            scaled["printed"] += [*(np.subtract(computed, [first, second, *others]) / WEIGHT_SCALE)]
            shown |= {f"weight_n{locks}_lock{n}": each for n, each in enumerate(computed, start=1)}
    return {
        **{f"misfit_{name}": float(np.sqrt(np.mean(np.square(v)))) for name, v in scaled.items()},
        **{"largest_peak_difference": farthest, "largest_weight_difference": largest},
        "fits": farthest <= PEAK_AIM and largest <= WEIGHT_AIM,
        **{f"peak_n{locks}_mesh{mesh:g}_N": peak for (locks, mesh), peak in peaks.items()},
        **shown,
    }


def friction_table(table: pd.DataFrame) -> pd.DataFrame:
    """A row for each friction coefficient, from the grid of `misfit_table`.

    The row with the least misfit, whatever the geometry; how many geometries fit; and the least
    of the largest differences of a peak, for any weights.
    """
    groups = table.groupby("friction")
    best = table.loc[groups["misfit_swapped"].idxmin()].set_index("friction")
    best["geometries_that_fit"] = groups["fits"].sum()
    best["least_peak_difference"] = groups["largest_peak_difference"].min()
    return best.reset_index().drop(columns=["candidate", "model"])


def size_columns(joint: Joint) -> dict[str, float]:
    """Friction and sizes of a joint, and the two ratios that pure shear depends on."""
    height = joint.h + joint.H
    return {
        "friction": joint.dry.friction,
        **{"a_m": joint.a, "b_m": joint.b, "h_m": joint.h, "H_m": joint.H},
        "height_share": round(joint.h / height, 9),  # as in the grid
        "height_over_b": round(height / joint.b, 9),
    }


def curve_table(study: Study, cases: pd.DataFrame) -> pd.DataFrame:
    """V-M curves at the finest mesh of a ``study`` that `curve_study` describes, one row per point.

    Each row also has the two straight parts that are closest to the curve.
    """
    rows: list[dict[str, Any]] = []
    finest = cases[np.isclose(cases["mesh_m"], min(study.meshes))].dropna(subset=["load_N"])
    for sample, curve in finest.groupby("sample"):
        points = curve.sort_values("eccentricity_over_a")[["shear_N", "torque_Nm"]]
        joint = study.joint(str(sample))
        names = {"candidate": str(sample).partition("_")[0], **size_columns(joint)}
        names |= {"locks": joint.locks}
        shape = two_parts(points.to_numpy())
        rows += [names | point | shape for point in points.to_dict("records")]
    return pd.DataFrame(rows)


def best_trials(table: pd.DataFrame) -> list[Trial]:
    """The best candidate of each length a, by the misfit with swapped weights, best first."""
    best = table.loc[table.groupby("a_m")["misfit_swapped"].idxmin()].sort_values("misfit_swapped")
    sizes = best[["a_m", "b_m", "h_m", "H_m", "friction"]]
    return [Trial(*row) for row in sizes.to_numpy().tolist()]


def describe(table: pd.DataFrame, frictions: pd.DataFrame, published: Published) -> str:
    """The candidates, and what each friction coefficient comes to, in words."""
    peaks = [column for column in table if column.startswith("peak_")]
    printed, degrees = published.numbers["sample"]["friction"], read_as_degrees(published)
    lines = [
        f"Friction coefficients: least misfit over all geometries (as printed: {printed:g}; "
        f"hypothesis: given to 3DEC as {printed:g} degrees, {degrees:.4g})"
    ]
    for row in frictions.itertuples():
        lines.append(
            f"  {row.friction:8.4g}  misfit {row.misfit_swapped:.2f}, peaks within "
            f"{100 * row.largest_peak_difference:.2f} %, weights within "
            f"{row.largest_weight_difference:.3f}; {row.geometries_that_fit} geometries fit all "
            f"peaks to {100 * PEAK_AIM:g} % and all weights to {WEIGHT_AIM:g}; peaks alone "
            f"within {100 * row.least_peak_difference:.2f} %"
        )
    lines += ["", "Joints by misfit, pure shear (own: those of the study)"]
    for _, row in table.iterrows():
        sizes = ", ".join(f"{name} {row[f'{name}_m']:.4g}" for name in ("a", "b", "h", "H"))
        loads = ", ".join(f"{row[column]:.2f}" for column in peaks)
        lines.append(
            f"  {row['candidate']}  {sizes} m, friction {row['friction']:.4g}  {row['model']:8}  "
            f"peaks {loads} N  misfit {row['misfit_swapped']:.2f} (first two weights swapped), "
            f"{row['misfit_printed']:.1f} (as printed)"
        )
    return "\n".join([*lines, ""])


def check(study: Study, published: Published) -> list[int]:
    """Numbers of locks that are fitted; `ConfigError` if none can be."""
    locks = sorted(set(published.samples(study).values()))
    if not locks:
        raise ConfigError(
            "samples: none is a published sample; calibration needs one with the paper's strength, "
            "number of locks and load"
        )
    for mesh, n in product(study.calibration.meshes, locks):
        if published.dem_pure_shear(n, mesh) is None:
            raise ConfigError(
                f"calibration.meshes: {mesh:g} m is not allowed; each must be one of the paper's "
                "meshes, 0.02 or 0.005 m"
            )
    every = [*candidates(study, published), *study_candidates(study, published)]
    shortest = min(min(each.a, each.b) for each in every)
    coarsest = max(study.calibration.meshes)
    if shortest <= coarsest:
        raise ConfigError(
            f"calibration.meshes: {coarsest:g} m is too coarse; it must be less than "
            f"{shortest:g} m, the shortest side of a lock in calibration.a"
        )
    return locks


def two_parts(points: Floats) -> dict[str, float]:
    """The closest two straight parts to ``points`` (V, M) from pure shear on, (N, 2), as columns.

    In V and M over their largest values. ``turn_from_shear``: share of the curve's length where
    they meet; ``slope_…``: -dM/dV of both; ``residual``: root mean square distance from the curve.
    """
    scaled = points / points.max(axis=0)
    length = np.cumsum([0.0, *np.hypot(*np.diff(scaled, axis=0).T)])  # up to each point
    place = length / length[-1]
    fits = []
    for turn in np.linspace(0.1, 0.9, 81):
        base = np.column_stack([np.interp(place, [0.0, turn, 1.0], row) for row in np.eye(3)])
        knots = np.linalg.lstsq(base, scaled, rcond=None)[0]
        residual = float(np.sqrt(np.mean(np.sum((base @ knots - scaled) ** 2, axis=1))))
        fits.append((residual, float(turn), knots))
    residual, turn, knots = min(fits, key=lambda fit: fit[0])
    near_shear, near_torsion = (float(-part[1] / part[0]) for part in np.diff(knots, axis=0))
    slopes = {"slope_near_shear": near_shear, "slope_near_torsion": near_torsion}
    return {"turn_from_shear": turn, **slopes, "residual": residual}
