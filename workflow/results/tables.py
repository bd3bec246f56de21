"""The study's tables: their columns, with units in the names and meanings, their keys and checks.

Every table is written and read here, as CSV with Parquet beside it. Numbers have ten digits. An
infinite eccentricity is pure torsion; a missing number is an empty cell. ``case`` is a case's
identity apart from model and variant: tables are joined on it. Meanings are for readers, and stand
in columns.yaml.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import yaml

DIGITS = 10
UNITS = ("_N", "_Nm", "_m", "_m2", "_Pa", "_degrees")


class TableError(ValueError):
    """An invalid table; the message names the table and the fault."""


@dataclass(frozen=True)
class Table:
    """The form of a table.

    ``columns``: in order; ``key``: columns that no two rows agree in; ``numbers``: those that are
    numbers, also where no row has one, beside those with a unit; ``more``: whether other columns
    may follow; ``digits``: number of significant digits.
    """

    name: str
    columns: tuple[str, ...]
    key: tuple[str, ...]
    numbers: tuple[str, ...] = ()
    more: bool = False
    digits: int = DIGITS

    def frame(self, rows: Iterable[Mapping[str, Any]]) -> pd.DataFrame:
        """The columns of the table in ``rows``, which may have more; numbers as numbers."""
        frame = pd.DataFrame(list(rows), columns=list(self.columns))
        for column in self.columns:
            if column.endswith(UNITS) or column in self.numbers:
                frame[column] = frame[column].astype(float)
        return frame


_CASE = ("model", "variant", "sample", "locks", "mesh_m", "eccentricity_m")
_SHARES = (
    *("peak_spread", "unbalanced_share", "difference_to_static"),
    *("mesh_error", "first_failure_mesh_error"),
)
ERRORS = ("misfit", "largest_unsafe_error", "largest_safe_error")

WEIGHTS = Table(
    "weights",
    (
        *("model", "locks", "mesh_m", "eccentricity_m", "lock", "block"),
        *("weight", "mean_shear_ratio", "max_shear_ratio"),
        *("variant", "sample", "eccentricity_over_a", "shear_x_N", "shear_y_N", "case"),
    ),
    ("model", "variant", "case", "lock"),
)
WEIGHT_SUMS = Table(
    "weight_sums",
    (*_CASE, "eccentricity_over_a", "weight_sum", "weight_sum_floor", "lower_weight_sum", "case"),
    ("model", "variant", "case"),
)
CASES = Table(
    "cases",
    (
        *("name", *_CASE, "nodes", "eccentricity_over_a", "shear_N", "torque_Nm", "load_N"),
        *("peak_N", "failed_load_N", "first_failure_load_N", "mode", "peak_spread"),
        *("unbalanced_share", "static_load_N", "difference_to_static", "mesh_error"),
        *("first_failure_mesh_error", "error", "versions", "case"),
    ),
    ("model", "variant", "case"),
    _SHARES,
)
MODELS = Table(
    "models",
    (
        *("model", "sample", "locks", "mesh_m", "eccentricity_m", "eccentricity_over_a"),
        *("load_N", "mesh_error", "first_failure_load_N", "peak_spread"),
        *("friction_share", "given_load_N"),
    ),
    ("model", "case"),
    more=True,  # displacements at given loads, and a weight for each lock
)
CAPACITY = Table(
    "capacity",
    (
        *("model", "variant", "locks", "mesh_m", "eccentricity_m", "shear_N", "torque_Nm"),
        *("sample", "eccentricity_over_a", "load_N", "peak_N", "failed_load_N"),
        *("first_failure_load_N", "unbalanced_share"),
        *("option", "friction", "reduction", "weights_from", "case", "mode"),
        *("peak_spread", "difference_to_static", "mesh_error", "first_failure_mesh_error", "error"),
    ),
    ("model", "variant", "weights_from", "case"),
)
VARIANTS = Table(
    "variants",
    (
        *("model", "variant", "sample", "locks", "mesh_m", "case", "failure", "upper_body"),
        *("young_Pa", "stiffness_ratio", "fracture_energy_J_m2", "eccentricity_m"),
        *("eccentricity_over_a", "load_N", "load_over_T0", "lower_weight_sum", "mesh_error"),
        *("directions", "option", *ERRORS),
    ),
    ("model", "variant", "case"),
)
SAMPLINGS = Table(  # loads over T0
    "samplings",
    (
        *("sampling", "number", "eccentricity_over_a", "locks", "push", "upper_body", "failure"),
        *("a_over_b", "h_over_b", "H_over_b", "shear_over_normal", "dry_over_inner", "friction"),
        *("pressure_over_cohesion", "plate", "stiffness_ratio", "energy_ratio"),
        *("first_failure", "peak", "mode", "first_failure_mesh_error", "peak_mesh_error"),
        *("unbalanced_share", "limit", "weight_sum", "lower_weight_sum", "error"),
    ),
    ("sampling", "number", "eccentricity_over_a"),
)
MEASURED = Table(
    "measured",
    (
        *("number", "specimen", "sample", "eccentricity_over_a", "measured_shear_N"),
        *("measured_torque_Nm", "measured_load_N", "model", "variant", "load_N", "difference"),
    ),
    ("number", "model", "variant"),
)
DEMANDS = Table(
    "demands",
    (
        *("sample", "required_shear_N", "required_torque_Nm", "carried", "open", "factor"),
        *("decides", "verdict"),
    ),
    ("sample",),
    ("factor",),
)
ENVELOPES = Table(
    "envelopes",
    ("sample", "option", "friction", "vertex", "shear_N", "torque_Nm"),
    ("sample", "option", "friction", "vertex"),
)
FIT = Table(
    "fit",
    (
        *("model", "sample", "locks", "mesh_m", "option", "friction", "reduction"),
        *(*ERRORS, "rank", "directions", "largest_mesh_error"),
    ),
    ("model", "sample", "mesh_m", "option", "friction", "reduction"),
)
BEST_FIT = Table(
    "best_fit",
    (
        *("model", "sample", "locks", "mesh_m", "friction"),
        *("distance_over_a", "distance_m", "strength_per_lock_N", "locks_that_count", *ERRORS),
    ),
    ("model", "sample", "mesh_m", "friction"),
    digits=6,  # of a fit that ends where the unknowns change by less than 1e-6
)
VALIDATION = Table(
    "validation",
    (
        *("quantity", "locks", "mesh_m", "published", "computed", "relative_difference"),
        *("absolute_difference", "mesh_error", "model", "sample", "friction", "setting", "note"),
    ),
    ("quantity", "mesh_m", "model", "sample"),
)


MOTION = ("move_x_m", "move_y_m", "move_z_m", "turn_x", "turn_y", "turn_z")
_STRUCTURE = ("structure", "load", "variant", "model")
STRUCTURES = Table(
    "structures",
    (
        *(*_STRUCTURE, "blocks", "interfaces", "nodes", "load_N", "load_over_weight", "weight_N"),
        *("counts", "because", "peak_N", "first_failure_load_N", "failed_load_N"),
        *("tilt_degrees", "peak_tilt_degrees", "first_failure_tilt_degrees", "failed_tilt_degrees"),
        *("first_interface", "most_used_interface", "mode", "peak_spread"),
        *("mesh_error", "first_failure_mesh_error", "unbalanced_share"),
        *("static_load_N", "static_tilt_degrees", "difference_to_static"),
        *("note", "input_notes", "refused", "error", "versions", "case"),
    ),
    _STRUCTURE,
    (*_SHARES, "load_over_weight", "nodes", "blocks", "interfaces"),
)
VERDICTS = Table(
    "verdicts",
    (
        *("structure", "load", "variant", "required_N", "carried", "open", "factor", "decides"),
        *("first_failure_factor", "peak_factor", "limit_factor", "governs", "verdict"),
    ),
    ("structure", "load", "variant"),
    ("factor", "first_failure_factor", "peak_factor", "limit_factor"),
)
MEASURED_STRUCTURES = Table(
    "measured_structures",
    (
        *("structure", "number", "load", "variant", "specimen", "measured_load_N", "scatter"),
        *("model", "counts", "load_N", "measured_over_load", "source"),
    ),
    ("structure", "number", "model"),
    ("scatter", "measured_over_load"),
)
INTERFACES = Table(
    "interfaces",
    (
        *(*_STRUCTURE, "interface", "kind", "area_m2", "friction", "cohesion_Pa"),
        *("tensile_strength_Pa", "normal_N", "shear_N", "torsion_Nm", "bending_Nm"),
        *("eccentricity", "utilisation", "mode", "bonded_share", "fails_at"),
        *("force_x_N", "force_y_N", "force_z_N", "at_x_m", "at_y_m", "at_z_m", "case"),
    ),
    (*_STRUCTURE, "interface"),
    ("friction", "eccentricity", "utilisation", "bonded_share", "fails_at"),
)
BLOCKS = Table(
    "blocks",
    (
        *(*_STRUCTURE, "block", "fixed", "weight_N", "x_m", "y_m", "z_m", "motion"),
        *(*MOTION, "case"),
    ),
    (*_STRUCTURE, "block"),
    MOTION,
)
SUPPORTS = Table(
    "supports",
    (
        *("structure", "load", "variant", "answer", "reaction_N", "reaction_Nm"),
        *("movement_m", "movement_degrees", "note"),
    ),
    ("structure", "load", "variant", "answer"),
)
EARTHQUAKES = Table(
    "earthquakes",
    (
        *("structure", "record", "factor", "peak_acceleration_m_s2", "peak_velocity_m_s", "falls"),
        *("first_block", "falls_at_s", "displacement_m", "rotation_degrees"),
        *("last_displacement_m", "last_rotation_degrees", "note", "error", "model", "case"),
    ),
    ("structure", "record", "factor"),
    ("peak_acceleration_m_s2", "peak_velocity_m_s", "falls_at_s"),
)
FRAGILITY = Table(
    "fragility",
    (
        *("structure", "intensity", "motions", "falls", "median", "dispersion"),
        *("median_low", "median_high", "note"),
    ),
    ("structure", "intensity"),
    ("median", "dispersion", "median_low", "median_high"),
)
TABLES = tuple(each for each in globals().values() if isinstance(each, Table))
MORE: Mapping[str, Sequence[str]] = {  # columns of a table that may follow those it must have
    MODELS.name: ("displacement_at_<share>_percent_m", "weight_lock<number>", "case"),
}


@cache
def meanings() -> tuple[Mapping[str, str], Mapping[str, Mapping[str, str]]]:
    """Meanings of columns by name, and by table those of columns that mean something else there."""
    path = Path(__file__).with_name("columns.yaml")
    read = yaml.safe_load(path.read_text(encoding="utf-8"))
    return read["meanings"], read["exceptions"]


def meaning(table: Table, column: str) -> str:
    """The meaning of a ``column`` of a table; KeyError if it has none."""
    everywhere, exceptions = meanings()
    return exceptions.get(table.name, {}).get(column) or everywhere[column]


def columns_of(table: Table) -> tuple[str, ...]:
    """All columns of a table, those that may follow as well."""
    return *table.columns, *MORE.get(table.name, ())


def write_table(table: Table, rows: pd.DataFrame, path: Path) -> None:
    """Write ``rows`` as CSV and beside it as Parquet; `TableError` if they do not fit."""
    checked = _checked(table, rows)
    path.parent.mkdir(parents=True, exist_ok=True)
    checked.to_csv(path, index=False, float_format=f"%.{table.digits}g")
    checked.to_parquet(path.with_suffix(".parquet"), index=False)


def read_table(table: Table, path: Path) -> pd.DataFrame:
    """The rows that `write_table` wrote; `TableError` if they have other columns."""
    rows = pd.read_parquet(path.with_suffix(".parquet"))
    _require(table, rows)
    return rows


def read_tables(paths: Mapping[str, Path]) -> dict[str, pd.DataFrame]:
    """Those of the ``paths`` that are named after a table, read."""
    forms = {form.name: form for form in TABLES}
    return {name: read_table(forms[name], path) for name, path in paths.items() if name in forms}


def write_tables(tables: Mapping[str, pd.DataFrame], paths: Mapping[str, Path]) -> None:
    """Write each of the ``tables``, which are by name."""
    for form in TABLES:
        if form.name in tables:
            write_table(form, tables[form.name], paths[form.name])


def _require(table: Table, rows: pd.DataFrame) -> None:
    missing = [column for column in table.columns if column not in rows]
    unknown = [column for column in rows if column not in table.columns and not table.more]
    if missing or unknown:
        raise TableError(
            f"{table.name}: "
            + "; ".join(
                f"{words} {', '.join(names)}"
                for words, names in (("no column", missing), ("unknown column", unknown))
                if names
            )
        )


def _checked(table: Table, rows: pd.DataFrame) -> pd.DataFrame:
    """``rows`` with the columns in order and the numbers rounded, both as ``table`` says."""
    _require(table, rows)
    others = [column for column in rows if column not in table.columns]
    rows = rows[[*table.columns, *others]].reset_index(drop=True)
    if (twice := rows.duplicated(list(table.key))).any():
        place = rows.loc[twice, list(table.key)].iloc[0].to_dict()
        raise TableError(f"{table.name}: more than one row for {place}")
    for column in rows.select_dtypes("float"):
        values = rows[column].to_numpy(dtype=float)
        if np.isinf(values).any() and not column.startswith("eccentricity"):
            raise TableError(f"{table.name}: {column} is infinite; it must be finite")
        rows[column] = [v if math.isnan(v) else float(f"{v:.{table.digits}g}") for v in values]
    return rows
