"""Numbers of `make structures` in docs/structures.md."""

import math
from pathlib import Path
from typing import Any

import pandas as pd

from studies.markdown import markdown, markdown_of, percent, signed

NONE = "–"
AXIS = {"x": "x", "y": "y", "xy30": "(√3, 1, 0)"}
WHERE = {
    "whiting": "Whiting 2009",
    "milankovitch": "Milankovitch 1907",
    "stockdale": "Stockdale 2018",
    "ferris": "linear programme in the plane",
}


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


def by_rbe(results: Path) -> str:
    """Critical tilts of limit analysis and of rigid-block equilibrium."""
    return markdown_of(
        _table(results, "tilts"),
        {
            "block, friction, axis": _case,
            "RBE, published": lambda row: _degrees(row.rbe_degrees),
            "pyramid of eight sides": lambda row: _degrees(row.pyramid_degrees, 2),
            "difference": lambda row: _apart(row.pyramid_degrees, row.rbe_degrees),
            "limit analysis, cone": lambda row: _degrees(row.limit_degrees, 2),
        },
    )


def within(results: Path) -> str:
    """Number of critical tilts that agree with published ones."""
    table = _table(results, "tilts")
    rows = []
    for what, ours, theirs, near in (
        ("static model, 3DEC", "static_degrees", "threedec_degrees", 1.5),
        ("YADE, 3DEC", "yade_degrees", "threedec_degrees", 0.5),
        ("LIGGGHTS, 3DEC", "liggghts_degrees", "threedec_degrees", 1.0),
        ("LIGGGHTS, YADE", "liggghts_degrees", "yade_degrees", 1.0),
        ("YADE, static model", "yade_degrees", "static_degrees", 0.5),
        (
            "relaxation with finite rotations, 3DEC",
            "finite_rotation_degrees",
            "threedec_degrees",
            1.5,
        ),
        ("static model, relaxation with small rotations", "static_degrees", "relaxed_degrees", 0.5),
        ("limit analysis with a pyramid, RBE", "pyramid_degrees", "rbe_degrees", 1.0),
        ("limit analysis with a cone, RBE", "limit_degrees", "rbe_degrees", 1.0),
    ):
        apart = (table[ours] - table[theirs]).abs().dropna()
        agree = f"{(apart <= near).sum()} of {len(apart)} within {near:g}°"
        rows.append([what, agree, f"{apart.max():.2f}°"])
    return markdown(["compared", "agree", "largest difference"], rows)


def changes(results: Path) -> str:
    """Effect of stiffness and nodes where the static model is far from 3DEC."""
    table = _table(results, "changes")
    wide = table.assign(case=[_case(row) for row in table.itertuples()]).pivot_table(
        index="change", columns="case", values="static_degrees", sort=False
    )
    rows = [[str(name), *(_degrees(each, 2) for each in row)] for name, row in wide.iterrows()]
    return markdown(["static model", *wide.columns], rows)


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


def verdicts(results: Path) -> str:
    """Samples of compas_cra: which stand upright, and where each turns over."""

    def words(value: Any) -> str:
        return value if isinstance(value, str) and value else NONE

    return markdown_of(
        _table(results, "verdicts"),
        {
            "sample": lambda row: row.sample,
            "blocks": lambda row: f"{row.blocks}",
            "interfaces": lambda row: f"{row.interfaces:,}",
            "μ": lambda row: f"{row.friction:g}",
            "RBE of compas_cra": lambda row: words(row.compas_cra_rbe),
            "pyramid": lambda row: words(row.pyramid),
            "limit": lambda row: words(row.limit),
            "static": lambda row: words(row.static),
            "tilt about": lambda row: row.about.replace("-", "−"),
            "limit, tilt": lambda row: _degrees(row.limit_degrees),
            "static, tilt": lambda row: _degrees(row.static_degrees),
        },
    )


BLOCKS = {
    "structures-within": within,
    "structures-threedec": by_threedec,
    "structures-rbe": by_rbe,
    "structures-changes": changes,
    "structures-shapes": shapes,
    "structures-verdicts": verdicts,
}
