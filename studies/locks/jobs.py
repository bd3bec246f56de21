"""The jobs of the campaign: what the law says of each joint, and tables and figures of that."""

from collections.abc import Iterator
from dataclasses import asdict

from analysis.figures.catalogue import drawn_files
from workflow.jobs import Job
from workflow.sampling_jobs import TABLE, batches, table_job
from workflow.schema import Study

FIGURES = ("law", "law_margins", "law_rules", "law_nomogram")
POINTS = "tables/points.csv"
FROM_POINTS = {  # module: message, tables
    "errors": ("Compare law and rules with the static model", ("law", "rules")),
    "interaction": ("Compare curves through both ends with it", ("interaction",)),
    "bonds": ("Compare peaks with first failures, by kind of bond", ("bonds",)),
    "freedoms": ("Fit SiDMACIB's contact points to the peaks", ("freedoms",)),
}


def jobs(study: Study) -> Iterator[Job]:
    """All jobs beyond those that solve the study's samplings."""
    if not study.samplings:
        return
    answers = [
        batch.job("law", "studies.locks.law", "Ask the law of joints") for batch in batches(study)
    ]
    yield from answers
    yield table_job(
        "points",
        "studies.locks.points",
        "Put the law beside the static model",
        (TABLE, *(job.outputs[0] for job in answers)),
        (POINTS,),
    )
    for name, (message, tables) in FROM_POINTS.items():
        outputs = tuple(f"tables/{table}.csv" for table in tables)
        yield table_job(name, f"studies.locks.{name}", message, (POINTS,), outputs)
    yield table_job(
        "law_figures",
        "studies.locks.figures",
        "Draw the law",
        (POINTS,),
        tuple(drawn_files(FIGURES)),
    )
    base = asdict(study.base_joint)
    yield table_job(
        "sensitivity",
        "studies.locks.sensitivity",
        "Find which parameters the first failure depends on",
        (),
        ("tables/sensitivity.csv",),
        sampling=asdict(next(iter(study.samplings.values())).sampling()),
        base=base,
    )
    yield table_job(
        "paper_joint",
        "studies.locks.paper_joint",
        "Vary strength and sizes of the paper's joint",
        (),
        ("tables/characteristic.csv", "tables/assumed_sizes.csv"),
        base=base,
    )
