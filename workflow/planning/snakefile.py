"""The jobs that the rules of the Snakefile declare.

A rule that runs a step names its inputs, outputs, parameters and log. With values for its wildcards
they make a job. Parameters that are not in `PARTS` are arguments of the step.
"""

from collections.abc import Iterable, Mapping
from functools import cache
from typing import Any

from snakemake import api
from snakemake.io import strip_wildcard_constraints
from snakemake.iocontainers import Wildcards

from workflow.joints.case import Case, CaseId
from workflow.planning.batches import Batch, CaseJobs
from workflow.planning.closure import ROOT
from workflow.planning.plan import Files, Job, Plan, flat
from workflow.schema import Study
from workflow.structures.case import StructureCase

PARTS = ("step", "modules", "files", "versions", "settings", "resources")  # no arguments of a step


def plan_of(study: Study) -> Plan:
    """All jobs of ``study``, from the rules of the Snakefile; nothing is written."""
    workflow = api.Workflow(
        config_settings=api.ConfigSettings(),
        resource_settings=api.ResourceSettings(cores=1),
        workflow_settings=api.WorkflowSettings(),
        storage_settings=api.StorageSettings(shared_fs_usage=frozenset()),  # no cache
        logger_manager=api.LoggerManager(api.logger, api.OutputSettings()),
    )
    try:
        workflow.study = study
        workflow.include(str(ROOT / "Snakefile"), overwrite_default_target=True)
        plan: Plan = workflow.globals["PLAN"]
    finally:
        workflow.tear_down()
    return plan


def plan_from(
    rules: Iterable[Any],
    study: Study,
    cases: CaseJobs,
    jobs_of: Mapping[str, Iterable[Any]],
    structures: Mapping[CaseId, StructureCase],
) -> Plan:
    """The plan that Snakemake's ``rules`` make up, of which the one named all has the results.

    ``jobs_of``: the wildcards of each job of a rule that has wildcards, by the rule's name;
    ``structures``: the cases of structures.
    """
    jobs: dict[str, Job] = {}
    wanted: set[str] = set()
    for rule in rules:
        if rule.name == "all":
            wanted |= {_below(study.results, path) for path in rule.input}
        if not hasattr(rule.params, "step"):
            continue
        for wildcards in jobs_of[rule.name] if rule.has_wildcards() else [{}]:
            job = _job(rule, dict(wildcards), study.results)
            jobs[job.name] = job
    made = {name: job for name, job in jobs.items() if wanted.issuperset(job.written)}
    return Plan(study, {**cases.cases, **structures}, jobs, made)


def _job(rule: Any, wildcards: dict[str, str], results: str) -> Job:
    """The job of a ``rule`` with these ``wildcards``."""
    given = Wildcards(fromdict=wildcards)
    params = {key: v(given) if callable(v) else v for key, v in rule.params.items()}
    inputs = _named(rule.input, wildcards, results)
    outputs = _named(rule.output, wildcards, results)
    (log,) = rule.log
    also = (*params.pop("also", ()), *parquet_beside(flat(outputs)))
    parts = {key: params.pop(key) for key in PARTS if key in params}
    return Job(
        name=_below(f"{results}/logs", _pattern(log).format(**wildcards)).removesuffix(".log"),
        inputs=inputs,
        outputs=outputs,
        also=tuple(_below(results, path.format(**wildcards)) for path in also),
        arguments={key: _plain(value) for key, value in params.items()},
        finds=tuple(case.id for value in params.values() for case in _cases(value)),
        **parts,
    )


def _named(files: Any, wildcards: dict[str, str], results: str) -> Files:
    """Inputs or outputs of a rule by name, below the results folder, but for the plan."""

    def filled(path: str) -> str:
        return _below(results, _pattern(path).format(**wildcards))

    return {
        name: filled(value) if isinstance(value, str) else tuple(map(filled, value))
        for name, value in files.items()
        if name != "plan"
    }


@cache
def _pattern(path: str) -> str:
    """A path with wildcards, without what they are constrained to."""
    return str(strip_wildcard_constraints(path))


def _below(results: str, path: str) -> str:
    return str(path).removeprefix(f"{results}/")


def _cases(value: Any) -> tuple[Case | StructureCase, ...]:
    if isinstance(value, Batch):
        return value.cases
    return (value,) if isinstance(value, Case | StructureCase) else ()


def _plain(value: Any) -> Any:
    """An argument as plain data."""
    if isinstance(value, Batch):
        return [case.to_json() for case in value.cases]
    return value.to_json() if isinstance(value, Case | StructureCase) else value


def parquet_beside(outputs: Iterable[str]) -> tuple[str, ...]:
    """The tables in Parquet that accompany those in CSV."""
    return tuple(name[:-3] + "parquet" for name in outputs if name.endswith(".csv"))
