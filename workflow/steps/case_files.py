"""Write the files of one case that was solved in a batch, like those in an engine's folder."""

import json

import pandas as pd

from sidmacib.engines.scripts.records import HISTORY, NODES
from workflow.case import JointCase
from workflow.results.files import BATCH_HISTORY, BATCH_NODES, CASE, RECORD
from workflow.results.record import read_records, write_record
from workflow.run.step import Arguments, Files, step

LOADS = {
    "peak_load_N": "load_N",
    "failed_load_N": "failed_load_N",
    "first_failure_load_N": "first_failure_load_N",
    "mode": "mode",
    "peak_spread": "peak_spread",
    "error": "error",
}


def run(arguments: Arguments, inputs: Files, outputs: Files) -> None:
    """Write the description, nodes, history, loads and record of the case."""
    case, records, result = (
        JointCase.from_json(arguments["case"]),
        inputs["records"],
        outputs["result"],
    )
    folder = result.parent
    (record,) = (each for each in read_records([records]) if each.name == case.name)
    (folder / CASE).write_text(case.to_json())
    for source, target in ((BATCH_NODES, NODES), (BATCH_HISTORY, HISTORY)):
        rows = pd.read_parquet(records.with_name(source), filters=[("case", "==", case.name)])
        rows.drop(columns="case").to_csv(folder / target, index=False, float_format="%.10g")
    loads = {key: getattr(record, name) for key, name in LOADS.items()}
    result.write_text(json.dumps(loads, indent=1) + "\n")
    write_record(record, folder / RECORD)


if __name__ == "__main__":
    step(run)
