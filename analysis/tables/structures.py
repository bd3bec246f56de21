"""Tables of the structures of a study: capacities by model, interfaces, blocks, moving supports."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, replace
from typing import Any

import pandas as pd

from sidmacib.answers.answer import Answer
from sidmacib.answers.structure_paths import counting, without_other_meshes
from sidmacib.answers.verdict import Verdict, governing, verdict
from sidmacib.engines import ENGINES
from sidmacib.engines.curve import yade_answer
from sidmacib.errors import (
    CapacityError,
    InfeasibleError,
    NoEquilibriumError,
    NoStiffnessError,
    UnboundedError,
)
from sidmacib.mesh_error import DIGITS
from sidmacib.models import MODELS, REFERENCE_MODEL, first_failure_only
from sidmacib.problem import DRY_PEAK, FIRST_FAILURE, PEAK, Counts, Failures, Problem
from sidmacib.structure.analysis.forces import most_used
from sidmacib.structure.analysis.supports import support_answers
from sidmacib.structure.loads import SupportMotion
from workflow.case import StructureSubject
from workflow.results import read_records, rounded_or_none
from workflow.results.structure_part import StructureRecord
from workflow.results.tables import (
    BLOCKS,
    INTERFACES,
    MEASURED_STRUCTURES,
    MOTION,
    STRUCTURES,
    SUPPORTS,
    VERDICTS,
    write_tables,
)
from workflow.schema import MeasuredStructure
from workflow.step import Arguments, FileLists, Files, step

TILTS = {
    "load_N": "tilt_degrees",
    "peak_N": "peak_tilt_degrees",
    "first_failure_load_N": "first_failure_tilt_degrees",
    "failed_load_N": "failed_tilt_degrees",
    "static_load_N": "static_tilt_degrees",
}
RAISED = {
    each.__name__: each
    for each in (InfeasibleError, NoEquilibriumError, NoStiffnessError, UnboundedError)
}


def structures_table(records: Sequence[StructureRecord]) -> pd.DataFrame:
    """One row for each case; differences are to the static model of the same structure and load.

    On the same cells: of what counts, which the static model decides for engines.
    """
    static = {each.physics: each for each in records if each.model == REFERENCE_MODEL}
    rows = [_row(counted(record, static.get(record.physics)), static) for record in records]
    return STRUCTURES.frame(rows)


def counted(record: StructureRecord, static: StructureRecord | None) -> StructureRecord:
    """The ``record`` of an engine with the load that counts by the ``static`` model.

    An engine has one mesh, which shows nothing of how far its peak depends on it: its mesh errors
    are those of the static model on the same cells.
    """
    if record.peak_N is None or record.part.counts is not None:
        return record
    failures = Failures(record.first_failure_load_N or record.peak_N, record.peak_N)
    if static is not None and (known := static.part).counts is not None:
        because = (known.because or "").partition("; ")[0]  # the rest is of the static model alone
        counts = Counts(known.counts == PEAK, because)
        first = _on_given(
            known.first_failure_mesh_error, known.given_first_failure_N, static.first_failure_load_N
        )
        error = (
            _on_given(known.mesh_error, known.given_peak_N, static.peak_N) if counts.peak else first
        )
    else:
        counts = without_other_meshes(failures)
        error = first = None
    part = replace(
        record.part,
        counts=counts.name,
        because=counts.why,
        mesh_error=error,
        first_failure_mesh_error=first,
    )
    return replace(record, load_N=counting(failures, counts), part=part)


def _on_given(error: float | None, given: float | None, finest: float | None) -> float | None:
    """The mesh error on the cells of the file, from the one on the smallest cells."""
    if error is None or not given or not finest:
        return None
    return round(error + abs(given / finest - 1.0), DIGITS)


def _compared(record: StructureRecord, static: StructureRecord | None) -> float | None:
    """The load (N) of the static model to compare with: for an engine, on the same cells."""
    if record.model == REFERENCE_MODEL or static is None:
        return None
    counts = static.part.counts
    first = first_failure_only(record.model) or counts == FIRST_FAILURE
    if record.model not in ENGINES:
        return static.first_failure_load_N if first else static.peak_N
    first |= counts == DRY_PEAK  # an engine has the bonds, as on the cells of the file
    return static.part.given_first_failure_N if first else static.part.given_peak_N


def _row(record: StructureRecord, known: Mapping[str, StructureRecord]) -> dict[str, Any]:
    row, part = record.columns(), record.part
    load, weight = record.load_N, part.weight_N
    row["static_load_N"] = compared = _compared(record, known.get(record.physics))
    if part.tilts and weight:
        row |= {
            tilt: row[name] and math.degrees(row[name] / weight) for name, tilt in TILTS.items()
        } | dict.fromkeys(TILTS)
    return {
        **row,
        "load_over_weight": None if load is None or part.tilts or not weight else load / weight,
        "most_used_interface": most_used(part.interfaces),
        "blocks": sum(not block.fixed for block in part.blocks) or None,
        "interfaces": len(part.interfaces) or None,
        "difference_to_static": load / compared - 1.0 if load is not None and compared else None,
        "case": record.name,
    }


def _answer(record: StructureRecord | None, model: str) -> Answer:
    """The answer of a ``model`` that a ``record`` keeps, or why there is no result."""
    if record is None:
        error = CapacityError(f"{MODELS[model].label} is not in the study")
        return Answer(model=model, error=error)
    if record.load_N is None:
        words = (record.error or record.refused or "").removeprefix(f"{record.model}: ")
        return Answer(model=model, error=RAISED.get(record.raised or "", CapacityError)(words))
    part, peak, first = record.part, record.peak_N, record.first_failure_load_N
    peak = record.load_N if peak is None else peak
    return Answer(
        model=model,
        value=record.load_N,
        failures=Failures(peak if first is None else first, peak),
        counts=Counts(part.counts != FIRST_FAILURE, part.because or "", part.counts == DRY_PEAK),
        mesh_error=part.mesh_error,
        mode=record.mode,
        bounds=not part.bonded,
        notes=(part.note,) if part.note else (),
    )


def verdicts_table(records: Sequence[StructureRecord]) -> pd.DataFrame:
    """One row for each load that is to be carried, by the static model and limit analysis."""
    known = {each.folder: each for each in records}
    cases = {each.name: each for each in records if each.part.required_N is not None}
    groups: dict[tuple[str, str], list[tuple[StructureRecord, Verdict]]] = {}
    for each in cases.values():
        static, limit = (
            _answer(known.get(f"{each.kind}/{model}/{each.name}"), model)
            for model in (REFERENCE_MODEL, "limit")
        )
        found = verdict(each.part.required_N or 0.0, static, limit)
        groups.setdefault((each.part.structure, each.variant), []).append((each, found))
    return VERDICTS.frame(
        {
            **{"structure": record.part.structure, "load": record.part.load},
            **{"variant": record.variant, "required_N": found.newtons, "carried": found.passes},
            **{"open": found.open, "factor": found.factor, "decides": found.decides or None},
            "first_failure_factor": found.first,
            **{"peak_factor": found.peak, "limit_factor": found.limit},
            **{"governs": number == first, "verdict": found.reasons},
        }
        for group in groups.values()
        for first in [governing([found for _, found in group])]
        for number, (record, found) in enumerate(group)
    )


def measured_table(
    structures: pd.DataFrame, measured: Mapping[str, MeasuredStructure]
) -> pd.DataFrame:
    """One row for each measured load and model; ``structures``: the table, ``measured``: by name.

    A model without a result has an empty ratio.
    """
    rows: list[dict[str, Any]] = []
    names = ["structure", "load", "variant"]
    for structure, given in measured.items():
        for number, each in enumerate(given.loads, start=1):
            own = structures[structures[names].eq([structure, each.load, each.variant]).all(axis=1)]
            beside = own.assign(
                number=number,
                specimen=each.specimen,
                measured_load_N=each.newtons,
                scatter=given.scatter,
                measured_over_load=each.newtons / own["load_N"],
                source=given.source,
            )
            rows += beside.to_dict("records")
    return MEASURED_STRUCTURES.frame(rows)


def interfaces_table(records: Iterable[StructureRecord]) -> pd.DataFrame:
    """One row for each interface of each case that gives forces."""
    return INTERFACES.frame(
        {**_identity(record), **asdict(interface)}
        for record in records
        for interface in record.part.interfaces
    )


def blocks_table(records: Iterable[StructureRecord]) -> pd.DataFrame:
    """One row for each block, or part of one, of each case that has a result.

    Without a motion where the model gives none.
    """
    return BLOCKS.frame(
        {**_identity(record), **asdict(block), **dict(zip(MOTION, block.move or (), strict=False))}
        for record in records
        for block in record.part.blocks
    )


def _identity(record: StructureRecord) -> dict[str, Any]:
    part = record.part
    names = {"structure": part.structure, "load": part.load, "variant": record.variant}
    return {**names, "model": record.model, "case": record.name}


def run(arguments: Arguments, inputs: FileLists, outputs: Files) -> None:
    """Read all records and write the tables, in the order of the study's cases."""
    found = {record.folder: record for record in read_records(inputs["records"])}
    records = [found[case] for case in arguments["cases"]]
    tables = {
        "structures": structures_table(records),
        "interfaces": interfaces_table(records),
        "blocks": blocks_table(records),
    }
    if "verdicts" in outputs:
        tables["verdicts"] = verdicts_table(records)
    if "measured_structures" in outputs:
        measured = {
            name: MeasuredStructure.model_validate_json(text)
            for name, text in arguments["measured"].items()
        }
        tables["measured_structures"] = measured_table(tables["structures"], measured)
    write_tables(tables, outputs)


def support_rows(cases: Iterable[tuple[StructureSubject, str, bool]]) -> Iterator[dict[str, Any]]:
    """A row for each answer to a subject in a variant; where there is none, the note says why.

    The last of each case: whether YADE is asked.
    """
    for subject, variant, yade in cases:
        row = {"structure": subject.structure, "load": subject.load, "variant": variant}
        assembly, loads = subject.problem()
        assert isinstance(loads, SupportMotion)
        try:
            answers, _ = support_answers(assembly, loads)
            if yade:
                answers.append(yade_answer(Problem(assembly, loads)))
        except CapacityError as error:
            yield {**row, "answer": "none", "note": " ".join(str(error).split())}
            continue
        reaction, movement, unit = "reaction_N", "movement_m", 1.0
        if loads.turns:
            reaction, movement, unit = "reaction_Nm", "movement_degrees", math.degrees(1.0)
        for each in answers:
            yield {
                **row,
                "answer": each.answer,
                reaction: rounded_or_none(each.reaction),
                movement: None if each.movement is None else rounded_or_none(unit * each.movement),
                "note": each.note,
            }


def write_supports(arguments: Arguments, inputs: Files, outputs: Files) -> None:
    """Write that of supports; ``cases``: structure, load, description, variant, and if in YADE."""
    cases = [(StructureSubject(*of), variant, yade) for *of, variant, yade in arguments["cases"]]
    write_tables({"supports": SUPPORTS.frame(support_rows(cases))}, outputs)


if __name__ == "__main__":
    step(run, supports=write_supports)
