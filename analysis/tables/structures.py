"""Tables of the structures of a study: capacities by model, interfaces and blocks."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pandas as pd

from sidmacib.structure.analysis.tilt import tilt_of_load
from workflow.models import REFERENCE_MODEL, first_failure_only
from workflow.results.tables import BLOCKS, INTERFACES, STRUCTURES, Table, write_table
from workflow.structures.record import (
    InterfaceRow,
    StructureRecord,
    read_structure_records,
)

LOADS = ("load_N", "failed_load_N", "first_failure_load_N")
NEXT_TO_NOTHING = 0.01  # of the largest force of an interface, as in the report
IDENTITY = ("structure", "load", "variant", "model")
MOTION = ("move_x_m", "move_y_m", "move_z_m", "turn_x", "turn_y", "turn_z")


def structures_table(records: Sequence[StructureRecord]) -> pd.DataFrame:
    """One row for each case; differences are to the static model of the same structure and load."""
    static = {each.physics: each for each in records if each.model == REFERENCE_MODEL}
    rows = [_row(record, static.get(record.physics)) for record in records]
    return _typed(STRUCTURES, rows)


def _row(record: StructureRecord, static: StructureRecord | None) -> dict[str, Any]:
    row = {name: getattr(record, name) for name in STRUCTURES.columns if hasattr(record, name)}
    load, weight = record.load_N, record.weight_N
    compared = None if record.model == REFERENCE_MODEL or static is None else static.load_N
    if static is not None and first_failure_only(record.model):
        compared = static.first_failure_load_N
    if record.tilts and weight:
        row |= {
            name.replace("load_N", "tilt_degrees"): row.get(name)
            and tilt_of_load(row[name], weight)
            for name in LOADS
        } | dict.fromkeys(LOADS)
    return {
        **row,
        "load_over_weight": None if load is None or record.tilts or not weight else load / weight,
        "most_used_interface": most_used(record.interfaces),
        "blocks": sum(not block.fixed for block in record.blocks) or None,
        "interfaces": len(record.interfaces) or None,
        "difference_to_static": load / compared - 1.0 if load is not None and compared else None,
        "versions": ", ".join(f"{k} {v}" for k, v in sorted(record.versions.items())) or None,
        "case": record.name,
    }


def most_used(interfaces: Iterable[InterfaceRow]) -> str | None:
    """The interface with the largest utilisation among those that carry a force.

    What carries next to nothing may be at its limit without a meaning. None where all are dry: at
    their peak several slide or turn.
    """
    interfaces = tuple(interfaces)
    if not any(each.bonded_share for each in interfaces):
        return None
    carried = {each: math.hypot(each.normal_N, each.shear_N) for each in interfaces}
    least = NEXT_TO_NOTHING * max(carried.values(), default=0.0)
    used = {
        each.interface: each.utilisation
        for each, force in carried.items()
        if each.utilisation and force > least
    }
    return max(used, key=lambda name: used[name]) if used else None


def interfaces_table(records: Iterable[StructureRecord]) -> pd.DataFrame:
    """One row for each interface of each case that gives forces."""
    rows = [
        {**_identity(record), **asdict(interface)}
        for record in records
        for interface in record.interfaces
    ]
    return _typed(INTERFACES, rows)


def blocks_table(records: Iterable[StructureRecord]) -> pd.DataFrame:
    """One row for each block, or part of one, of each case that has a result."""
    return _typed(BLOCKS, [*_blocks(records)])


def _blocks(records: Iterable[StructureRecord]) -> Iterator[dict[str, Any]]:
    for record in records:
        for block in record.blocks:
            row = asdict(block)
            move = row.pop("move") or (math.nan,) * len(MOTION)
            yield {**_identity(record), **row, **dict(zip(MOTION, move, strict=True))}


def _identity(record: StructureRecord) -> dict[str, Any]:
    return {**{name: getattr(record, name) for name in IDENTITY}, "case": record.name}


def _typed(table: Table, rows: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """``rows`` with numbers as numbers, also in columns that no row fills."""
    frame = pd.DataFrame(rows, columns=list(table.columns))
    for column in table.columns:
        if column.endswith(("_N", "_Nm", "_m", "_m2", "_Pa", "_degrees")) or column in NUMBERS:
            frame[column] = frame[column].astype(float)
    return frame


NUMBERS = (
    *("load_over_weight", "peak_spread", "unbalanced_share", "difference_to_static"),
    *("mesh_error", "first_failure_mesh_error"),
    *(
        "eccentricity",
        "utilisation",
        "bonded_share",
        "fails_at",
        "friction",
        "nodes",
        "blocks",
        "interfaces",
    ),
    *MOTION,
)


def run(
    arguments: Mapping[str, Any], inputs: Mapping[str, list[Path]], outputs: Mapping[str, Path]
) -> None:
    """Read all records and write the tables, in the order of the study's cases."""
    found = {record.id: record for record in read_structure_records(inputs["records"])}
    records = [found[model, name] for model, name in arguments["cases"]]  # type: ignore[index]
    write_table(STRUCTURES, structures_table(records), outputs["structures"])
    write_table(INTERFACES, interfaces_table(records), outputs["interfaces"])
    write_table(BLOCKS, blocks_table(records), outputs["blocks"])
