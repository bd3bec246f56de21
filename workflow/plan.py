"""The plan of a study: its jobs, and which of them have to be done."""

import json
import os
import sys
import time
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from sidmacib.mechanics.assembly import Failure
from workflow.case import Case, case_name
from workflow.cases import cases_of, second_mesh
from workflow.engines import ENGINES
from workflow.jobs import Job, case_jobs, deck_job, table_jobs
from workflow.mending import mended
from workflow.models import MODELS, WITNESS, Ability
from workflow.receipts import STALE, fault, read_receipt, write_whole
from workflow.results.files import read_records
from workflow.results.record import ResultError
from workflow.sampling_jobs import sampling_jobs
from workflow.schema import Study
from workflow.threedec import RETURNED, deck_folder, decks

INDEX = ".plan/index.json"
CLOCKS_APART = 5.0  # s, at most, of the machines of a cluster


@dataclass(frozen=True)
class Plan:
    """The cases of a study by model and name, and its jobs by name.

    ``made``: the jobs whose results make up the study; ``extra``: those that run only on request.
    """

    study: Study
    cases: Mapping[tuple[str, str], Case]
    made: Mapping[str, Job]
    extra: Mapping[str, Job]

    @property
    def jobs(self) -> dict[str, Job]:
        """All jobs."""
        return {**self.made, **self.extra}

    def outputs(self) -> list[str]:
        """Paths, below the results folder, of everything that makes up the study."""
        return [name for job in self.made.values() for name in job.outputs]


def plan_of(study: Study) -> Plan:
    """All jobs of ``study``; results returned from 3DEC count like those of any other model."""
    cases = dict(cases_of(study))
    of_decks = decks(study)
    cases |= {
        (case.model, name): case
        for name, case in of_decks.items()
        if Path(study.results, deck_folder(name), RETURNED).is_file()
    }
    found = case_jobs(study, [*cases.values(), *witnesses(cases.values())])
    tables = table_jobs(study, cases.values(), found)
    made = {**found, **tables, **sampling_jobs(study)}
    return Plan(study, cases, made, deck_job(of_decks.values()))


def witnesses(cases: Iterable[Case]) -> list[Case]:
    """Cases of the static model that the study lacks, to compare every engine's case with.

    They are on the same nodes, and where an engine has one mesh only at another one too.
    """
    cases = list(cases)
    known = {case.physics() for case in cases if case.model == WITNESS}
    series: dict[str, dict[float, Case]] = {}
    able = MODELS[WITNESS].abilities
    for case in cases:
        ductile = case.joint.failure is Failure.DUCTILE
        if case.model not in ENGINES or (ductile and Ability.DUCTILE not in able):
            continue
        witness = replace(case, model=WITNESS, numerics=None)
        series.setdefault(case.series(), {}).setdefault(case.mesh, witness)
    for own in series.values():
        (case, *_) = own.values()
        if other := second_mesh(case.joint, own, case.nodes):
            name = case_name(case.sample, other, case.direction.eccentricity, case.variant)
            own[other] = replace(case, mesh=other, name=name)
    every = {case.physics(): case for own in series.values() for case in own.values()}
    return [case for physics, case in every.items() if physics not in known]


def files_of(job: Job, digest: str) -> tuple[str, ...]:
    """All that a job writes, or that is written for it, under a name that is known beforehand."""
    name = job.name
    of_run = (job.receipt, f"logs/{name}.log", f".times/{name}.json", f".begun/{name}.job")
    return (*job.made, *of_run, INDEX, str(plan_file(job, digest, Path())))


def plan_file(job: Job, digest: str, results: Path) -> Path:
    """Where the arguments of ``job`` are; ``digest``, of what its results depend on, names it."""
    return results / ".plan" / f"{job.name}-{digest[:16]}.json"


def prepared(jobs: Iterable[Job], results: Path, retry: bool = False) -> dict[str, Path]:
    """Write each job's plan, and remove what must be made again; returns the plans by job.

    Results that are not what their job made are removed. If they were made from something else, the
    plan's time is set to now: as it is an input of the job, Snakemake then runs the job again.
    Times in the future, of a clock that has jumped, become now: what is made from such a file would
    seem older than it for ever. What stands in the way of a file is removed, and named on stderr.
    ``retry``: make again what has no result, too.
    """
    plans: dict[str, Path] = {}
    now = time.time()
    found = [(job, job.digest()) for job in jobs]
    for line in mended(results, (name for each in found for name in files_of(*each))):
        print(line, file=sys.stderr)
    for job, digest in found:
        path = plans[job.name] = plan_file(job, digest, results)
        reason = fault(
            read_receipt(results / job.receipt), job.name, digest, results, job.receipted
        )
        if retry and reason is None and _without_result(job, results):
            reason = "to be tried again"
        text = json.dumps(job.plan(digest, results), indent=1) + "\n"
        if not _holds(path, text):
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
            if reason is None:  # what it made is valid: it is not made again
                os.utime(path, (0, 0))
        elif reason == STALE:
            os.utime(path)
        if reason not in (None, STALE):
            for name in job.outputs:
                (results / name).unlink(missing_ok=True)
        for made in (path, *(results / name for name in job.outputs)):
            _date_back(made, now)
    index = {name: str(path) for name, path in plans.items()}
    write_whole(_index(results), json.dumps(index) + "\n")
    return plans


def _without_result(job: Job, results: Path) -> bool:
    """Whether a job of a case has none, and has said why."""
    try:
        return bool(job.finds) and any(
            record.error is not None for record in read_records([results / job.outputs[0]])
        )
    except (OSError, ResultError):
        return False


def _date_back(path: Path, now: float) -> None:
    """Set a file's time to ``now`` (s) if it is later."""
    with suppress(FileNotFoundError):
        if path.stat().st_mtime > now + CLOCKS_APART:
            os.utime(path, (now, now))


def _holds(path: Path, text: str) -> bool:
    """Whether a file is there and whole: a plan that was cut or changed is written again."""
    try:
        return path.read_bytes() == text.encode()
    except OSError:
        return False


def planned(results: Path) -> dict[str, Path]:
    """The plans that `prepared` wrote, by job: for processes of the same run on other machines."""
    return {name: Path(path) for name, path in json.loads(_index(results).read_text()).items()}


def _index(results: Path) -> Path:
    return results / INDEX
