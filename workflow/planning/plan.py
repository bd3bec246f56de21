"""The plan of a study: its jobs, and those that must run.

Snakemake orders and runs the jobs; what each one depends on is compared here with the receipt of
what it made before.
"""

import json
import os
import sys
import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from workflow.joints.case import Case, CaseId
from workflow.planning.closure import code_digest, described
from workflow.planning.receipts import STALE, digest_of, fault, read_receipt, write_whole
from workflow.planning.resources import Resources
from workflow.planning.results_folder import mended
from workflow.schema import Study
from workflow.structures.case import StructureCase

RUNNER = "workflow.run.job"
INDEX = ".plan/index.json"
CLOCKS_APART = 5.0  # s, at most, of the machines of a cluster
LEAST_LIMIT, STUCK = 3600.0, 30.0  # s, and over the time it should take: more is no job's

Files = Mapping[str, str | tuple[str, ...]]  # by name: a path, or several


@dataclass(frozen=True)
class Job:
    """One process of a study.

    ``step``: the module whose ``run`` does the work; ``modules``, ``files``: what else it runs or
    reads of this project, beyond its imports. ``arguments``: plain data, all of which the results
    depend on; ``settings``: plain data that they do not depend on. ``inputs``, ``outputs``: paths
    below the results folder, by name; ``also``: outputs that exist only if the job has a result.
    ``versions``: of the programs that it starts. ``finds``: the cases whose records are in
    the first output. ``resources``: what it asks of a cluster.
    """

    name: str
    step: str
    inputs: Files
    outputs: Files
    arguments: Mapping[str, Any]
    also: tuple[str, ...] = ()
    modules: tuple[str, ...] = ()
    files: tuple[str, ...] = ()
    versions: Mapping[str, str] = field(default_factory=dict)
    settings: Mapping[str, Any] = field(default_factory=dict)
    finds: tuple[CaseId, ...] = ()
    resources: Resources = field(default_factory=Resources)

    @property
    def receipt(self) -> str:
        """Path of its receipt, below the results folder."""
        return f".receipts/{self.name}.json"

    @property
    def written(self) -> tuple[str, ...]:
        """Paths of all its outputs."""
        return tuple(flat(self.outputs))

    @property
    def made(self) -> tuple[str, ...]:
        """All files that it makes where it has a result."""
        return (*self.written, *self.also)

    @property
    def receipted(self) -> tuple[frozenset[str], ...]:
        """Which files its receipt may name: those of a result, or of a case that has none."""
        whole = frozenset(self.made)
        return (whole, frozenset(self.written)) if self.finds else (whole,)

    @property
    def time_limit(self) -> float:
        """Time (s) after which the job is taken to be stuck; the limit of an engine is shorter."""
        limit = float(self.settings.get("time_limit", 0.0))
        return limit + max(LEAST_LIMIT, STUCK * self.resources.time)

    @property
    def runs(self) -> tuple[str, ...]:
        """Modules that it starts from; what they import runs too."""
        return RUNNER, self.step, *self.modules

    def digest(self) -> str:
        """Digest of everything that its results depend on, except the contents of its inputs."""
        code = code_digest(self.runs, self.files)
        inputs, versions = dict(self.inputs), dict(self.versions)
        return digest_of([self.name, code, inputs, dict(self.arguments), versions])

    def plan(self, digest: str, results: Path) -> dict[str, Any]:
        """Everything that `workflow.run.job` needs to know, as plain data."""
        return {
            "name": self.name,
            "digest": digest,
            "step": self.step,
            "code": described(self.runs, self.files),
            "results": str(results),
            "inputs": dict(self.inputs),
            "outputs": dict(self.outputs),
            "also": self.also,
            "receipt": self.receipt,
            "arguments": dict(self.arguments),
            "settings": dict(self.settings),
            "time_limit": self.time_limit,
        }


@dataclass(frozen=True)
class Plan:
    """The cases of a study, and its jobs by name.

    ``made``: the jobs whose results make up the study; the others run only on request.
    """

    study: Study
    cases: Mapping[CaseId, Case | StructureCase]
    jobs: Mapping[str, Job]
    made: Mapping[str, Job]


def flat(files: Files) -> Iterator[str]:
    """All paths in inputs or outputs, without their names."""
    for value in files.values():
        yield from (value,) if isinstance(value, str) else value


def files_of(job: Job, digest: str) -> tuple[str, ...]:
    """All that a job writes, or that is written for it, under a name that is known beforehand."""
    name = job.name
    of_run = (job.receipt, f"logs/{name}.log", f".times/{name}.json", f".begun/{name}.job")
    return (*job.made, *of_run, INDEX, str(plan_file(job, digest, Path())))


def plan_file(job: Job, digest: str, results: Path) -> Path:
    """Where the arguments of ``job`` are; ``digest``, of what its results depend on, names it."""
    return results / ".plan" / f"{job.name}-{digest[:16]}.json"


def why(job: Job, digest: str, results: Path, retry: bool = False) -> str | None:
    """Why a job must run (again), in a few words; None if its results are valid.

    ``retry``: a case that has no answer is tried again, too.
    """
    receipt = read_receipt(results / job.receipt)
    reason = fault(receipt, job.name, digest, results, job.receipted)
    if retry and reason is None and _without_result(job, results):
        return "retried on request"
    return reason


def compared(
    jobs: Iterable[Job], results: Path, folder: Path, retry: bool = False
) -> dict[str, Path]:
    """A file for each job, by name, that is newer than its results if they must be made again.

    For a dry run: nothing in ``results`` is changed, the two files are in ``folder``.
    """
    due, valid = folder / "due", folder / "valid"
    for path, moment in ((due, time.time() + 1e8), (valid, 0.0)):
        path.touch()
        os.utime(path, (moment, moment))
    return {job.name: due if why(job, job.digest(), results, retry) else valid for job in jobs}


def prepared(jobs: Iterable[Job], results: Path, retry: bool = False) -> dict[str, Path]:
    """Write the plan of each job and remove outdated results; returns the plans by job.

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
        reason = why(job, digest, results, retry)
        text = json.dumps(job.plan(digest, results), indent=1) + "\n"
        if not _holds(path, text):
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
            if reason is None:  # what it made is valid: it is not made again
                os.utime(path, (0, 0))
        elif reason == STALE:
            os.utime(path)
        if reason not in (None, STALE):
            for name in job.written:
                (results / name).unlink(missing_ok=True)
        for made in (path, *(results / name for name in job.written)):
            _date_back(made, now)
    index = {name: str(path) for name, path in plans.items()}
    write_whole(results / INDEX, json.dumps(index) + "\n")
    return plans


def planned(results: Path) -> dict[str, Path]:
    """The plans that `prepared` wrote, by job: for processes of the same run on other machines."""
    index = json.loads((results / INDEX).read_text())
    return {name: Path(path) for name, path in index.items()}


def _without_result(job: Job, results: Path) -> bool:
    """Whether a job of a case has ended without a result, with a reason."""
    try:
        lines = (results / job.written[0]).read_text().splitlines() if job.finds else []
        return any(json.loads(line)["error"] is not None for line in lines)
    except (OSError, ValueError, TypeError, KeyError, RecursionError):
        return False


def _date_back(path: Path, now: float) -> None:
    """Set a file's time to ``now`` (s) if it is later."""
    with suppress(FileNotFoundError):
        if path.stat().st_mtime > now + CLOCKS_APART:
            os.utime(path, (now, now))


def _holds(path: Path, text: str) -> bool:
    """Whether a plan file is complete and unchanged; otherwise it is written again."""
    try:
        return path.read_bytes() == text.encode()
    except OSError:
        return False
