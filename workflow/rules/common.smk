# Shared by all rules: paths of files, what rules look up by wildcards, cluster resources, the command of a step.
import functools
import os
import re
import shlex

from snakemake.io import strip_wildcard_constraints

from workflow.planning.batches import Batch
from workflow.run.attempts import LAST_TRY, RETRIES, forget, was_killed
from workflow.planning.results_folder import LockedError, lock
from workflow.planning.plan import compared, planned, prepared

CAPTIONS = {  # of files in the report of Snakemake, by suffix
    ".csv": ("Tables", "table.rst"),
    ".png": ("Figures", "figure.rst"),
    ".html": ("Report", "report.rst"),
}
LOCKS = []  # of the results folder, held until this process ends
REPORT_INPUTS = {}  # tables and summaries of the report, by name
WILDCARDS = {}  # of all jobs of each rule with wildcards, by the rule's name


def below(name):
    """Path of a result from its ``name`` below the results folder."""
    return f"{RESULTS}/{name}"


def shown(name):
    """Path of a result, marked for the report of Snakemake if its type can be shown there."""
    if (suffix := Path(name).suffix) not in CAPTIONS:
        return below(name)
    category, caption = CAPTIONS[suffix]
    return report(
        below(name),
        category=category,
        caption=f"{CHECKOUT}/workflow/captions/{caption}",
        labels={"file": Path(name).name},
    )


def one_of(names):
    """A wildcard that is one of these ``names``."""
    return "|".join(map(re.escape, sorted(set(names)))) or "(?!)"


@functools.cache
def plans():
    """The plan of each job by its name; nothing is written before a run begins.

    Jobs on other machines read the existing plans.
    """
    if not workflow.is_main_process:
        return planned(Path(RESULTS))
    retry = bool(os.environ.get("RETRY"))
    if workflow.executor_plugin is None or workflow.dryrun:  # as with --rulegraph or --dry-run
        return compared(PLAN.jobs.values(), Path(RESULTS), workflow.snakemake_tmp_dir, retry)
    try:
        LOCKS.append(lock(Path(RESULTS)))
    except LockedError as error:
        sys.exit(str(error))
    forget(Path(RESULTS))
    return prepared(PLAN.jobs.values(), Path(RESULTS), retry)


def plan(name):
    """The plan of a job; it is newer than the results of a job that must run again."""
    return lambda wildcards: str(plans()[name.format(**dict(wildcards.items()))])


def asks(name):
    """Cluster resources of a job: memory (MB), time (min), a place of its group's `abreast`.

    It requests more if it was killed before. ``last_try``: 1 if a killed job is not tried again,
    otherwise 0, as in its environment.
    """

    def requested(wildcards, attempt):
        job = name.format(**dict(wildcards.items()))
        return PLAN.jobs[job].resources, attempt if was_killed(Path(RESULTS), job) else 1

    def mem_mb(wildcards, attempt):
        asked, tried = requested(wildcards, attempt)
        return asked.megabytes(tried)

    def runtime(wildcards, attempt):
        asked, tried = requested(wildcards, attempt)
        return asked.minutes(tried)

    def last_try(wildcards, attempt):
        return int(workflow.is_main_process or attempt > RETRIES)

    return {"mem_mb": mem_mb, "runtime": runtime, "last_try": last_try, "abreast": 1}


def case_in_engine(wildcards):
    return CASES.engines[wildcards.engine, wildcards.case]


@functools.cache
def guided_cases(engine):
    wanted = (case for case in CASES.engines.values() if case.model == engine)
    return [case for case in wanted if ENGINES[engine].wants_guide(case.numerics)]


def batch(wildcards):
    return CASES.batches[wildcards.model, wildcards.batch]


@functools.cache
def group_of(model):
    """Cases of a model share jobs of the cluster if all of them are short."""
    jobs = (job for name, job in PLAN.jobs.items() if name.startswith(f"{model}/"))
    return "cases" if all(job.resources.short for job in jobs) else None


def sampling_of(wildcards):
    return STUDY.samplings[wildcards.sampling]


def first_joint(wildcards):
    return STARTS[wildcards.sampling, wildcards.batch]


def joint_after(wildcards):
    """The first joint after a batch."""
    return min(first_joint(wildcards) + JOINTS, sampling_of(wildcards).joints)


def structure_in_engine(wildcards):
    return IN_ENGINES[wildcards.engine, wildcards.case]


def cases_of_structure(wildcards):
    return Batch(STRUCTURES.solved[wildcards.model, wildcards.structure])


def of_jobs(rule, *outputs):
    """The ``outputs`` of all jobs of a ``rule`` that has wildcards; all of them if none is named."""
    paths = [getattr(rule.output, name) for name in outputs] or list(rule.output)
    patterns = [strip_wildcard_constraints(path) for path in paths]
    return [pattern.format(**job) for job in WILDCARDS[rule.name] for pattern in patterns]


# `exec`: a job ends with Snakemake, not only with the shell between them. A job has one thread,
# because threads of linear algebra on small matrices mostly wait for each other.
PYTHON = f"PYTHONPATH={shlex.quote(CHECKOUT)} exec {shlex.quote(sys.executable)}"
STEP = (
    f"{LAST_TRY}={{resources.last_try}} OPENBLAS_NUM_THREADS=1 PYTHONUTF8=1 {PYTHON}"
    " -m workflow.run.job {input.plan:q} > {log:q} 2>&1"
)
