"""Comparison of structures with published results: the tables of docs/structures.md.

python -m studies.structures.compare --results results-structures
"""

import argparse
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import pandas as pd
import yaml

from sidmacib.engines import ENGINES
from sidmacib.engines.run import engine_outcome
from sidmacib.errors import InfeasibleError, NoEquilibriumError, UnboundedError
from sidmacib.mechanics.assembly import Assembly, NodeLayout
from sidmacib.mechanics.rigid import RigidSolver
from sidmacib.problem import Problem
from sidmacib.structure.analysis.limit import limit_tilt
from sidmacib.structure.analysis.tilt import (
    LARGEST,
    Tilt,
    static_tilt,
    tilt_of_load,
    tilting,
    turned,
)
from studies.structures.finite_rotation import relaxed_tilt
from studies.structures.rbe import STABLE, UNSTABLE, pyramid_tilt, rbe_verdict
from studies.structures.samples import ABOUT, AXES, SAMPLES, Sample, fetched, sample_structure
from studies.structures.shapes import answers, pushed_walls

PUBLISHED = Path(__file__).parent / "published.yaml"
TYPES = ("type-a", "type-b", "type-c", "type-d")
FRICTIONS = (0.2, 0.84)
CHANGES: dict[str, dict[str, Any]] = {  # of the static model, where it is far from 3DEC
    "as it is": {},
    "shear stiffness / 100": {"shear": 1e8},
    "shear stiffness x 10": {"shear": 1e11},
    "cells of 0.5 m": {"mesh": 0.5},
    "cells of 0.2 m": {"mesh": 0.2},
    "Lobatto nodes": {"nodes": NodeLayout.LOBATTO},
}
FAR = 1.5  # degrees
TIME_LIMIT = 600.0  # s, of an engine's run


def main() -> None:
    """Make the tables."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--results", type=Path, default=Path("results-structures"))
    results: Path = parser.parse_args().results
    published = yaml.safe_load(PUBLISHED.read_text(encoding="utf-8"))
    samples = fetched(results)
    known = (*answers(published["shapes"]), *pushed_walls(published["shapes"]))
    _write(results, "shapes", map(vars, known))
    tilts = list(tilt_rows(samples, published["tilts"]))
    _write(results, "tilts", tilts)
    _write(results, "changes", change_rows(samples, tilts))
    _write(results, "verdicts", verdict_rows(samples))


def _write(results: Path, name: str, rows: Iterable[Mapping[str, Any]]) -> None:
    """A table of ``rows``, with six digits."""
    path = results / "tables" / f"{name}.csv"
    path.parent.mkdir(parents=True, exist_ok=True)
    pd.DataFrame(list(rows)).to_csv(path, index=False, float_format="%.6g")
    print(path)


def tilt_rows(samples: Path, published: list[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """Critical tilts of one block between two fixed ones, with the ``published`` ones."""
    known = {(each["sample"], each["friction"], each["axis"]): each for each in published}
    for name in TYPES:
        for friction in FRICTIONS:
            model = sample_structure(samples, Sample(name, (0, 1), friction))
            for axis in AXES:
                values = known.get((name, friction, axis), {})
                tilt = Tilt(AXES[axis])
                static = static_tilt(model, tilt)
                yield {
                    "sample": name,
                    "friction": friction,
                    "axis": axis,
                    "threedec_degrees": values.get("threedec", math.nan),
                    "static_degrees": static.angle,
                    "motion": str(static.motion),
                    "yade_degrees": engine_tilt("yade", model, tilt),
                    "liggghts_degrees": engine_tilt("liggghts", model, tilt),
                    "relaxed_degrees": relaxed_tilt(model, tilt, finite=False),
                    "finite_rotation_degrees": relaxed_tilt(model, tilt, finite=True),
                    "rbe_degrees": values.get("rbe", math.nan),
                    "pyramid_degrees": pyramid_tilt(model, tilt),
                    "limit_degrees": limit_tilt(model, tilt).angle,
                }


def engine_tilt(name: str, model: Assembly, tilt: Tilt) -> float:
    """The critical tilt (degrees) after an engine."""
    problem = Problem(model, tilting(model, tilt))
    found = engine_outcome(ENGINES[name], problem, time_limit=TIME_LIMIT)
    return tilt_of_load(found.path[-1].load, problem.loads.scale)


def change_rows(samples: Path, tilts: list[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """Effect of stiffness and nodes on those critical tilts that are far from 3DEC's."""
    for row in tilts:
        if not abs(row["static_degrees"] - row["threedec_degrees"]) > FAR:  # or nan
            continue
        for what, change in CHANGES.items():
            sample = Sample(row["sample"], (0, 1), row["friction"])
            model = sample_structure(samples, sample, **change)
            angle = static_tilt(model, Tilt(AXES[row["axis"]])).angle
            keys = ("sample", "friction", "axis")
            yield {key: row[key] for key in keys} | {"change": what, "static_degrees": angle}


def verdict_rows(samples: Path) -> Iterator[dict[str, Any]]:
    """Whether each sample stands, and where it ceases to when gravity turns about its axis."""
    for sample in SAMPLES:
        tilt = Tilt(ABOUT[sample.about])
        model = sample_structure(samples, sample)
        limit = _angle(limit_tilt, model, tilt)
        static = _angle(static_tilt, model, tilt) if sample.small else math.nan
        pyramid = pyramid_tilt(model, tilt) if sample.small else math.nan
        rbe = rbe_verdict(samples / f"{sample.name}.json", sample)
        yield {
            "sample": sample.name,
            "blocks": len(model.pieces),
            "interfaces": len(model.faces),
            "friction": sample.friction,
            "compas_cra_rbe": rbe or "",
            "pyramid": UNSTABLE if pyramid is None else "" if math.isnan(pyramid) else STABLE,
            "limit": UNSTABLE if math.isnan(limit) else STABLE,
            "static": STABLE if _stands(model, tilt) else UNSTABLE,
            "about": sample.about,
            "limit_degrees": limit,
            "static_degrees": static,
        }


def _stands(model: Assembly, tilt: Tilt) -> bool:
    """Whether the static model has an equilibrium before gravity turns."""
    try:
        RigidSolver(model, turned(model, tilt, 0.0)).start()
    except NoEquilibriumError:
        return False
    return True


def _angle(critical: Callable[[Assembly, Tilt], Any], model: Assembly, tilt: Tilt) -> float:
    """The ``critical`` tilt after a model, degrees; NaN if nothing stands upright."""
    try:
        return float(critical(model, tilt).angle)
    except UnboundedError:
        return LARGEST
    except (InfeasibleError, NoEquilibriumError):
        return math.nan


if __name__ == "__main__":
    main()
