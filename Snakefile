# The whole study: `snakemake`. One case: `snakemake results/cases/yade/n3-mesh0.02-e0.1a/result.json`.
# Another study: `snakemake --configfile my.yaml --config results=my-results`.
import os
import re
import shlex
import sys
from pathlib import Path

# The code that runs is this checkout's, wherever it is called from and whatever is installed.
CHECKOUT = str(workflow.basedir)
sys.path.insert(0, CHECKOUT)

from workflow.configuration import ConfigError, load_configuration, read_study
from workflow.kills import LAST_TRY, RETRIES, forget, was_killed
from workflow.lock import LockedError, lock
from workflow.plan import plan_of, planned, prepared

# A study of one's own is not mixed with this one. Snakemake has read the files too; ours is the reader
# that lets nothing pass in silence.
CONFIG = workflow.config_settings.config or {}
FILES = [Path(path) for path in workflow.config_settings.configfiles]
try:
    for path in reversed(FILES or [Path(CHECKOUT, "config.yaml")]):
        CONFIG = load_configuration(path, CONFIG)
    STUDY = read_study(CONFIG)
    PLAN = plan_of(STUDY)
except ConfigError as error:
    path = FILES[0] if FILES else Path(CHECKOUT, "config.yaml")
    sys.exit(f"Error in the configuration: {error.of(path)}")

RESULTS = STUDY.results
if workflow.is_main_process and not workflow.dryrun:
    try:
        LOCK = lock(Path(RESULTS))
    except LockedError as error:
        sys.exit(str(error))
JOBS = PLAN.jobs
# Jobs on other machines read this file too: they take the plans as they are.
if workflow.is_main_process:
    PLANS = prepared(JOBS.values(), Path(RESULTS), retry=bool(os.environ.get("RETRY")))
    if not workflow.dryrun:
        forget(Path(RESULTS))
else:
    PLANS = planned(Path(RESULTS))
PLANS = {name: str(path) for name, path in PLANS.items()}


def tried(job, attempt):
    """Which try to ask for more for: the first unless the job was killed."""
    return attempt if was_killed(Path(RESULTS), job) else 1


def memory(job, attempt):
    """MB that a job asks of a cluster."""
    return JOBS[job].needs.megabytes(tried(job, attempt))


def minutes(job, attempt):
    """Time that a job asks of a cluster."""
    return JOBS[job].needs.minutes(tried(job, attempt))


def last_try(attempt):
    """Whether a job that is killed is not tried again: 1 or 0, as in the job's environment."""
    return int(workflow.is_main_process or attempt > RETRIES)


# `exec`: a job ends with Snakemake, not only with the shell between them. A job is one thread: those
# of linear algebra on small matrices only wait for each other.
RUN = (
    f"{LAST_TRY}={{resources.last_try}} OPENBLAS_NUM_THREADS=1 PYTHONUTF8=1 PYTHONPATH={shlex.quote(CHECKOUT)} "
    f"exec {shlex.quote(sys.executable)} -m workflow.job "
    "{input.plan:q} > {log:q} 2>&1"
)


def below(names):
    """Paths of results, whose ``names`` are below the results' folder."""
    return [f"{RESULTS}/{name}" for name in names]


include: "workflow/rules/cases.smk"
include: "workflow/rules/tables.smk"


rule all:
    default_target: True
    input:
        below(PLAN.outputs()),
