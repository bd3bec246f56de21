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
from sidmacib.mechanics.assembly import Assembly
from sidmacib.mechanics.loads import Loads
from sidmacib.mechanics.rigid import RigidSolver
from sidmacib.problem import Problem
from sidmacib.structure.analysis.limit import limit_tilt
from sidmacib.structure.analysis.tilt import (
    LARGEST,
    static_tilt,
    tilting,
    turned,
)
from studies.markdown import markdown, markdown_of, percent, signed
from studies.structures.other_methods import (
    STABLE,
    UNSTABLE,
    pyramid_tilt,
    rbe_verdict,
    relaxed_tilt,
)
from studies.structures.shapes import (
    ABOUT,
    AXES,
    SAMPLES,
    Sample,
    answers,
    fetched,
    pushed_walls,
    sample_structure,
)

PUBLISHED = Path(__file__).parent / "published.yaml"
TYPES = ("type-a", "type-b", "type-c", "type-d")
FRICTIONS = (0.2, 0.84)
TIME_LIMIT = 600.0  # s, of an engine's run
NONE = "–"
AXIS = {"x": "x", "y": "y", "xy30": "(√3, 1, 0)"}
WHERE = {
    "whiting": "Whiting 2009",
    "milankovitch": "Milankovitch 1907",
    "stockdale": "Stockdale 2018",
    "ferris": "linear programme in the plane",
}


def main() -> None:
    """Make the tables."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--results", type=Path, default=Path("results-structures"))
    results: Path = parser.parse_args().results
    published = yaml.safe_load(PUBLISHED.read_text(encoding="utf-8"))
    samples = fetched(results)
    known = (*answers(published["shapes"]), *pushed_walls(published["shapes"]))
    _write(results, "shapes", map(vars, known))
    _write(results, "tilts", tilt_rows(samples, published["tilts"]))
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
                tilt = tilting(model, AXES[axis])
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


def engine_tilt(name: str, model: Assembly, tilt: Loads) -> float:
    """The critical tilt (degrees) after an engine."""
    problem = Problem(model, tilt)
    found = engine_outcome(ENGINES[name], problem, time_limit=TIME_LIMIT)
    return tilt.raised.value(found.path[-1].load)


def verdict_rows(samples: Path) -> Iterator[dict[str, Any]]:
    """Whether each sample stands, and where it ceases to when gravity turns about its axis."""
    for sample in SAMPLES:
        model = sample_structure(samples, sample)
        tilt = tilting(model, ABOUT[sample.about])
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


def _stands(model: Assembly, tilt: Loads) -> bool:
    """Whether the static model has an equilibrium before gravity turns."""
    try:
        RigidSolver(model, turned(tilt, 0.0)).start()
    except NoEquilibriumError:
        return False
    return True


def _angle(critical: Callable[[Assembly, Loads], Any], model: Assembly, tilt: Loads) -> float:
    """The ``critical`` tilt after a model, degrees; NaN if nothing stands upright."""
    try:
        return float(critical(model, tilt).angle)
    except UnboundedError:
        return LARGEST
    except (InfeasibleError, NoEquilibriumError):
        return math.nan


# --- numbers of docs/structures.md ---------------------------------------------------------------
def _table(results: Path, name: str) -> pd.DataFrame:
    return pd.read_csv(results / f"tables/{name}.csv")


def _degrees(value: float, digits: int = 1) -> str:
    return NONE if math.isnan(value) else f"{value:.{digits}f}"


def _apart(one: float, other: float) -> str:
    return NONE if math.isnan(one - other) else signed(f"{one - other:+.1f}")


def _case(row: Any) -> str:
    return f"{row.sample}, μ = {row.friction:g}, {AXIS[row.axis]}"


def by_threedec(results: Path) -> str:
    """Critical tilts of the static model and of 3DEC."""
    return markdown_of(
        _table(results, "tilts"),
        {
            "block, friction, axis": _case,
            "3DEC, published": lambda row: _degrees(row.threedec_degrees),
            "static": lambda row: _degrees(row.static_degrees, 2),
            "difference": lambda row: _apart(row.static_degrees, row.threedec_degrees),
            "YADE": lambda row: _degrees(row.yade_degrees, 2),
            "LIGGGHTS": lambda row: _degrees(row.liggghts_degrees, 2),
            "ends by": lambda row: row.motion,
            "relaxation, small rotations": lambda row: _degrees(row.relaxed_degrees, 2),
            "relaxation, finite rotations": lambda row: _degrees(row.finite_rotation_degrees, 2),
        },
    )


def within(results: Path) -> str:
    """Number of critical tilts that agree with published ones."""
    table = _table(results, "tilts")
    rows = []
    for what, ours, theirs, near in (
        ("static model, 3DEC", "static", "threedec", 0.5),
        ("YADE, 3DEC", "yade", "threedec", 0.5),
        ("LIGGGHTS, 3DEC", "liggghts", "threedec", 1.0),
        ("LIGGGHTS, YADE", "liggghts", "yade", 1.0),
        ("YADE, static model", "yade", "static", 0.5),
        ("relaxation with finite rotations, 3DEC", "finite_rotation", "threedec", 1.5),
        ("static model, relaxation with finite rotations", "static", "finite_rotation", 0.5),
        ("limit analysis with a pyramid, RBE", "pyramid", "rbe", 1.0),
        ("limit analysis with a cone, RBE", "limit", "rbe", 1.0),
    ):
        apart = (table[f"{ours}_degrees"] - table[f"{theirs}_degrees"]).abs().dropna()
        agree = f"{(apart <= near).sum()} of {len(apart)} within {near:g}°"
        rows.append([what, agree, f"{apart.max():.2f}°"])
    return markdown(["compared", "agree", "largest difference"], rows)


def shapes(results: Path) -> str:
    """Arches, stacks and walls."""

    def number(value: float) -> str:
        return NONE if math.isnan(value) else f"{value:.5g}"

    return markdown_of(
        _table(results, "shapes"),
        {
            "structure": lambda row: row.name,
            "unit": lambda row: NONE if isinstance(row.unit, float) else row.unit,
            "known": lambda row: number(row.known),
            "from": lambda row: WHERE.get(row.source, row.source),
            "limit analysis": lambda row: number(row.limit),
            "difference": lambda row: percent(row.limit / row.known - 1.0, 2),
            "static": lambda row: number(row.static),
        },
    )


BLOCKS = {
    "structures-within": within,
    "structures-threedec": by_threedec,
    "structures-shapes": shapes,
}


if __name__ == "__main__":
    main()
