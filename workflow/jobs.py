"""The jobs that make up a study: each with its arguments, its code, and what it reads and writes.

Snakemake orders and runs them; what each one depends on is worked out here, so that it can be
compared with the receipt of what was made before.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from analysis.figures.catalogue import figure_files, figures_of
from analysis.report.parts import FILES as REPORT_FILES
from analysis.report.parts import REPORT
from analysis.report.parts import TABLES as REPORT_TABLES
from sidmacib.mechanics.assembly import Failure
from workflow.case import Case
from workflow.closure import code_digest, described
from workflow.engines import ENGINES, Engine
from workflow.engines.render import sources
from workflow.models import MODELS, Obtained, detailed
from workflow.needs import Needs, engine_needs, solved_needs
from workflow.receipts import digest_of
from workflow.results.files import BATCH_FILES, OUTPUTS, RECORD, case_folder
from workflow.schema import Study
from workflow.threedec import DECK, deck_folder

# A batch, on average, is at most so large: start-up counts little then, and little is lost with it.
BATCH, BATCH_TIME = 512, 120.0  # cases, s
LEAST_LIMIT, STUCK = 3600.0, 30.0  # s, and over the time it should take: more is no job's
RUNNER = "workflow.job"
TABLES = ("weights", "weight_sums", "cases", "models")  # collected from the cases' records


@dataclass(frozen=True)
class Job:
    """One process of a study.

    ``step``: the module whose ``run`` does the work; ``modules``, ``files``: what else it runs or
    reads, beyond its imports. ``arguments``: plain data, all of which the results depend on;
    ``settings``: plain data that they do not depend on. ``inputs``, ``outputs``: paths below the
    results folder; ``others``: outputs that exist only if the job has a result. ``versions``: of
    the programs that it starts. ``finds``: model and name of the cases whose records are in the
    first output. ``needs``: what it asks of a cluster.
    """

    name: str
    step: str
    message: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    arguments: Mapping[str, Any]
    others: tuple[str, ...] = ()
    modules: tuple[str, ...] = ()
    files: tuple[str, ...] = ()
    versions: Mapping[str, str] = field(default_factory=dict)
    settings: Mapping[str, Any] = field(default_factory=dict)
    finds: tuple[tuple[str, str], ...] = ()
    threads: int = 1
    needs: Needs = field(default_factory=Needs)

    @property
    def receipt(self) -> str:
        """Path of its receipt, below the results folder."""
        return f".receipts/{self.name}.json"

    @property
    def made(self) -> tuple[str, ...]:
        """All files that it makes where it has a result."""
        return (*self.outputs, *self.others)

    @property
    def receipted(self) -> tuple[frozenset[str], ...]:
        """Which files its receipt may name: those of a result, or of a case that has none."""
        whole = frozenset(self.made)
        return (whole, frozenset(self.outputs)) if self.finds else (whole,)

    @property
    def time_limit(self) -> float:
        """Time (s) after which it is stuck; an engine's own limit, if it has one, comes before."""
        own = float(self.settings.get("time_limit", 0.0))
        return own + max(LEAST_LIMIT, STUCK * self.needs.time)

    @property
    def runs(self) -> tuple[str, ...]:
        """Modules that it starts from; what they import runs too."""
        return RUNNER, self.step, *self.modules

    def code(self) -> str:
        """Digest of the code that it runs."""
        return code_digest(self.runs, self.files)

    def digest(self) -> str:
        """Digest of everything that its results depend on, except its inputs."""
        return digest_of([self.name, self.code(), dict(self.arguments), dict(self.versions)])

    def plan(self, digest: str, results: Path) -> dict[str, Any]:
        """Everything that `workflow.job` needs to know, as plain data."""
        return {
            "name": self.name,
            "digest": digest,
            "step": self.step,
            "code": described(self.runs, self.files),
            "results": str(results),
            "inputs": self.inputs,
            "outputs": self.outputs,
            "others": self.others,
            "receipt": self.receipt,
            "arguments": dict(self.arguments),
            "settings": dict(self.settings),
            "time_limit": self.time_limit,
        }


def case_jobs(study: Study, cases: Iterable[Case]) -> dict[str, Job]:
    """The jobs that find the results of ``cases``, by name."""
    by_model: dict[str, list[Case]] = {}
    for case in cases:
        by_model.setdefault(case.model, []).append(case)
    jobs: list[Job] = []
    for name, own in by_model.items():
        obtained = MODELS[name].obtained
        if obtained is Obtained.ENGINE:
            jobs += (_engine_job(case, study.dem.time_limit) for case in own)
        elif obtained is Obtained.SOLVED:
            jobs += (_batch_job(name, key, batch) for key, batch in batches(own).items())
        elif obtained is Obtained.RETURNED:
            jobs += map(_returned_job, own)
    return {job.name: job for job in jobs}


def _engine_job(case: Case, time_limit: float) -> Job:
    engine = ENGINES[case.model]
    folder = case_folder(case.model, case.name)
    modules, files = sources(engine)
    return Job(
        name=f"{case.model}/{case.name}",
        step="workflow.steps.engine",
        message=f"Run {case.model} on {case.name}",
        inputs=(),
        outputs=(f"{folder}/{RECORD}", f"{folder}/result.json"),
        others=tuple(f"{folder}/{name}" for name in OUTPUTS if name != "result.json"),
        arguments={"case": case.to_json()},
        modules=modules,
        files=files,
        versions=versions(engine),
        settings={"time_limit": time_limit},
        finds=((case.model, case.name),),
        threads=case.numerics.ranks if case.numerics else 1,
        needs=engine_needs(case, time_limit),
    )


def versions(engine: Engine) -> dict[str, str]:
    """The version of an engine; empty if it is not installed."""
    return {} if engine.missing() else {engine.name: engine.version()}


def batches(cases: list[Case]) -> dict[str, list[Case]]:
    """Cases in batches, by the first bits of their digests.

    So adding or changing a case moves no other case to another batch, unless there is so much to do
    that another bit is needed.
    """
    bits, time = 0, solved_needs(cases).time
    while len(cases) > BATCH << bits or time > BATCH_TIME * 2**bits:
        bits += 1
    found: dict[str, list[Case]] = {}
    for case in cases:
        found.setdefault(_batch_name(case.digest(), bits), []).append(case)
    return dict(sorted(found.items()))


def _batch_name(digest: str, bits: int) -> str:
    """A name made from the first ``bits`` of a hexadecimal ``digest``."""
    if bits == 0:
        return "batch"
    digits = -(-bits // 4)
    number = int(digest[:digits], 16) >> (4 * digits - bits)
    return f"batch-{number:0{digits}x}"


def _batch_job(model: str, batch: str, cases: list[Case]) -> Job:
    module = MODELS[model].module
    assert module is not None, f"{model} is not solved in this process"
    return Job(
        name=f"{model}/{batch}",
        step="workflow.steps.solve",
        message=f"Solve {len(cases)} cases of {model}",
        inputs=(),
        outputs=tuple(f"cases/{model}/{batch}/{name}" for name in BATCH_FILES),
        arguments={"module": module, "cases": [case.to_json() for case in cases]},
        modules=(module,),
        needs=solved_needs(cases),
        finds=tuple((case.model, case.name) for case in cases),
    )


def _returned_job(case: Case) -> Job:
    folder = case_folder(case.model, case.name)
    return Job(
        name=f"{case.model}/{case.name}",
        step="workflow.steps.returned",
        message=f"Read what {case.model} printed for {case.name}",
        inputs=(f"decks/{case.model}/{case.name}/results.txt",),
        outputs=(f"{folder}/{RECORD}",),
        arguments={"case": case.to_json()},
        finds=((case.model, case.name),),
    )


def deck_job(cases: Iterable[Case]) -> dict[str, Job]:
    """The job that writes decks for ``cases``, by its name."""
    cases = list(cases)
    job = Job(
        name="decks",
        step="workflow.steps.decks",
        message=f"Write {len(cases)} decks for 3DEC",
        inputs=(),
        outputs=tuple(f"{deck_folder(case.name)}/{DECK}" for case in cases),
        arguments={"cases": [case.to_json() for case in cases]},
        files=("templates/3dec.dat.j2",),
    )
    return {job.name: job}


def table_jobs(study: Study, cases: Iterable[Case], found: Mapping[str, Job]) -> dict[str, Job]:
    """The jobs from the results of ``cases``, which the jobs ``found`` make, to the summary."""
    cases = list(cases)
    records = tuple(job.outputs[0] for job in found.values())
    detailed_models = detailed(study.model_names)
    tables = study.tables_json()
    tables_of = [f"tables/{name}.csv" for name in TABLES]
    weights, sums, of_cases, models = tables_of
    published = ("analysis/published.yaml",)
    home = {case: job.outputs[0] for job in found.values() for case in job.finds}
    shown = {
        name: home[spec.case.model, spec.case.name]
        for name, spec in figures_of(study, detailed_models).items()
        if spec.case is not None
    }
    stresses = tuple(dict.fromkeys(shown.values()))
    jobs: tuple[Job, ...] = (
        Job(
            name="collect",
            step="analysis.collect",
            message="Collect the cases' results",
            inputs=records,
            outputs=tuple(tables_of),
            arguments={"cases": [(case.model, case.name) for case in cases]},
        ),
        Job(
            name="capacity",
            step="analysis.capacity",
            message="Solve SiDMACIB and tabulate all capacities",
            inputs=(of_cases, weights),
            outputs=("tables/capacity.csv", "tables/envelopes.csv"),
            arguments={"study": tables},
            files=published,
        ),
        Job(
            name="fit",
            step="analysis.free_fit",
            message="Fit SiDMACIB to the detailed models",
            inputs=("tables/capacity.csv",),
            outputs=("tables/fit.csv", "tables/best_fit.csv"),
            arguments={"study": tables},
        ),
        Job(
            name="variants",
            step="analysis.variants",
            message="Tell what each variant changes",
            inputs=("tables/capacity.csv", sums),
            outputs=("tables/variants.csv",),
            arguments={"study": study.pieces_json()},
        ),
        Job(
            name="validation",
            step="analysis.validation",
            message="Compare with the published numbers",
            inputs=("tables/capacity.csv", weights, "tables/fit.csv"),
            outputs=("tables/validation.csv",),
            arguments={"study": tables},
            files=published,
        ),
        Job(
            name="figures",
            step="analysis.figures.draw",
            message="Draw the figures",
            inputs=(
                *("tables/capacity.csv", "tables/validation.csv", models, "tables/envelopes.csv"),
                *("tables/variants.csv", *stresses),
            ),
            outputs=tuple(figure_files(study, detailed_models)),
            arguments={
                "study": study.figures_json(),
                "detailed_models": detailed_models,
                "records": {name: 5 + stresses.index(path) for name, path in shown.items()},
            },
            files=published,
        ),
        Job(
            name="summary",
            step="analysis.summary",
            message="Sum up",
            inputs=(
                *("tables/validation.csv", "tables/fit.csv", "tables/best_fit.csv"),
                *("tables/capacity.csv", of_cases),
            ),
            outputs=("summary.txt",),
            arguments={
                "results": study.results,
                "meshes": study.meshes,
                "ductile": [
                    name
                    for name, change in study.every_variant.items()
                    if change.assembly(study.assembly).failure is Failure.DUCTILE
                ],
            },
        ),
        Job(
            name="report",
            step="analysis.report.page",
            message="Write the report",
            inputs=(*(f"tables/{name}.csv" for name in REPORT_TABLES), "summary.txt"),
            outputs=(REPORT,),
            arguments={"study": study.pieces_json()},
            files=REPORT_FILES,
        ),
        Job(
            name="complete",
            step="analysis.complete",
            message="Check that every case has a result",
            inputs=(of_cases, "summary.txt"),
            outputs=(".complete",),
            arguments={},
        ),
    )
    if study.measured is not None:
        jobs = (
            *jobs,
            Job(
                name="measured",
                step="analysis.measured",
                message="Put measured loads beside the models",
                inputs=("tables/capacity.csv",),
                outputs=("tables/measured.csv",),
                arguments={"study": study.measured_json()},
            ),
        )
    return {job.name: replace(job, others=parquet_beside(job.outputs)) for job in jobs}


def parquet_beside(outputs: Iterable[str]) -> tuple[str, ...]:
    """The same tables as Parquet, beside those in CSV."""
    return tuple(name[:-3] + "parquet" for name in outputs if name.endswith(".csv"))
