# Shared by all rules: paths of results, digests of the code that scripts run, cluster resources.
import functools
import math
import os
import re
import shlex

from workflow.step import NOTE, code_digest, noted
from workflow.command import lock, set_back

CAPTIONS = {  # of files in the report of Snakemake, by suffix
    ".csv": ("Tables", "table.rst"),
    ".png": ("Figures", "figure.rst"),
    ".html": ("Report", "report.rst"),
}
SHOWN_TABLES = {}  # those that the summary and the report are made from, by name
RETRIES = 2  # as in profiles/slurm
TIME_LIMIT = math.ceil(STUDY.dem.time_limit)  # s, of an engine in each case
NOTES = "notes"  # folder of what was asked of each job
NOTED = {}  # their paths
LOCKS = []  # of the results folder, held until this process ends
if workflow.is_main_process:
    set_back(Path(RESULTS))

# A limit for clusters: with it, Snakemake polls once a second for each job that has ended.
if workflow.executor_plugin and workflow.executor_plugin.common_settings.local_exec:
    workflow.scheduling_settings.max_jobs_per_timespan = None
# A script is a child of Snakemake itself, not of a shell, and ends with it; ^C waits while it loads
# (`workflow.step`).
shell.prefix("exec env --block-signal=INT ")
# Snakemake writes it into a command of the shell as it is, with the blanks of its path.
sys.executable = shlex.quote(sys.executable)
PATHS = filter(None, (CHECKOUT, os.environ.get("PYTHONPATH")))
os.environ |= {"PYTHONPATH": os.pathsep.join(PATHS), "PYTHONUTF8": "1"}
os.environ |= {"OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "Agg"}


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
def code(step, modules=(), files=()):
    """Digest of the code that a step runs: an edited module, though only imported, is noticed."""
    return code_digest((step, *modules), files)


def asks(resources_of):
    """Cluster resources of a job: memory (MB), time (min), a place of its group's `abreast`.

    A further attempt asks for more. ``last_try``: 1 if a job that is killed is not tried again.
    """

    def mem_mb(wildcards, attempt):
        return resources_of(wildcards).megabytes(attempt)

    def runtime(wildcards, attempt):
        return resources_of(wildcards).minutes(attempt)

    def last_try(wildcards, attempt):
        return int(workflow.is_main_process or attempt > RETRIES)

    return {"mem_mb": mem_mb, "runtime": runtime, "last_try": last_try, "abreast": 1}


def note_all(rules):
    """Give each job of ``rules`` an input more: a file below the results that says what it asks.

    Snakemake's own notes of parameters and code are in the working directory, by paths as typed;
    without them it looks at times of files only. These are with the results: one is written again,
    and so newer than its outputs, where what is asked has changed.
    """
    for each in rules:
        if each.params:
            params = dict(each.params.items())
            each.set_input(**{NOTE: functools.partial(_note, each.name, params)})


def _note(name, params, wildcards):
    # In a folder of its own: in those that it has looked into Snakemake takes no file for there
    # that was written since.
    path = below(os.path.join(NOTES, name, *wildcards, NOTE))
    if workflow.is_main_process and path not in NOTED:
        asked = {key: of(wildcards) if callable(of) else of for key, of in params.items()}
        runs = workflow.executor_plugin is not None and not workflow.dryrun  # not only looked at
        NOTED[path] = noted(Path(path), asked, runs)
    return NOTED.get(path, path)


onstart:
    LOCKS.append(lock(Path(RESULTS)))
