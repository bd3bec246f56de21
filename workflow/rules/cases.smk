# The cases: each engine case is a job, solved cases run in batches, those of 3DEC are read. A job is
# named by its folder, such as cases/yade/n3-mesh0.02-e0a or structures/static/arch.
from sidmacib.engines import ENGINES
from sidmacib.engines.render import sources
from sidmacib.models import MODELS
from workflow.case import JointSubject, StructureSubject
from workflow.jobs import engine_resources, solved_resources
from workflow.results import BATCH_RECORDS, RECORD
from workflow.threedec import DECK, PRINTED, deck_folder


def engine_case(wildcards):
    return JOBS.engines[wildcards.job]


def batch(wildcards):
    return JOBS.batches[wildcards.job]


def engine_of(wildcards):
    return ENGINES[engine_case(wildcards).model]


def module_of(wildcards):
    """The module that solves a batch."""
    first = batch(wildcards)[0]
    model = MODELS[first.model]
    return model.module if first.subject.kind == JointSubject.kind else model.structures


def of_engine(case):
    return engine_resources(case, STUDY.dem.time_limit)


def engine_sources(wildcards):
    """What an engine's job runs beside its script: modules, and files."""
    modules, files = sources(engine_of(wildcards))
    return (*modules, *engine_case(wildcards).subject.modules), files


@functools.cache
def group_of(model):
    """Cases of a model, in its folder, share jobs of the cluster if all of them are short."""
    engines = (of_engine(case) for job, case in JOBS.engines.items() if job.startswith(model))
    solved = (
        solved_resources(cases) for job, cases in JOBS.batches.items() if job.startswith(model)
    )
    return "cases" if all(each.short for each in (*engines, *solved)) else None


def group_of_job(wildcards):
    return group_of(os.path.join(os.path.dirname(wildcards.job), ""))


rule engine:
    output:
        record=below("{job}/record.json"),
        result=below("{job}/result.json"),
    log:
        below("logs/{job}.log"),
    benchmark:
        below("benchmarks/{job}.tsv")
    wildcard_constraints:
        job=one_of(JOBS.engines),
    group:
        group_of_job
    threads: lambda wildcards: engine_case(wildcards).numerics.ranks
    resources:
        **asks(lambda wildcards: of_engine(engine_case(wildcards))),
        time_limit=TIME_LIMIT,
    params:
        case=lambda wildcards: engine_case(wildcards).to_json(),
        code=lambda wildcards: code("workflow.engine", *engine_sources(wildcards)),
        versions=lambda wildcards: engine_of(wildcards).versions(),
    message:
        "{wildcards.job}"
    script:
        "../engine.py"


rule solve:
    output:
        records=below("{job}/records.jsonl"),
        nodes=below("{job}/nodes.parquet"),
        history=below("{job}/history.parquet"),
    log:
        below("logs/{job}.log"),
    benchmark:
        below("benchmarks/{job}.tsv")
    wildcard_constraints:
        job=one_of(JOBS.batches),
    group:
        group_of_job
    resources:
        **asks(lambda wildcards: solved_resources(batch(wildcards))),
    params:
        cases=lambda wildcards: [case.to_json() for case in batch(wildcards)],
        module=module_of,
        code=lambda wildcards: code(
            "workflow.solve", (module_of(wildcards), *batch(wildcards)[0].subject.modules)
        ),
    message:
        "{wildcards.job}"
    script:
        "../solve.py"


rule returned:
    input:
        printed=lambda wildcards: below(
            f"{deck_folder(JOBS.returned[wildcards.job].name)}/{PRINTED}"
        ),
    output:
        record=below("{job}/record.json"),
    log:
        below("logs/{job}.log"),
    wildcard_constraints:
        job=one_of(JOBS.returned),
    group:
        "cases"
    params:
        case=lambda wildcards: JOBS.returned[wildcards.job].to_json(),
        code=code("workflow.threedec", JointSubject.modules),
    message:
        "{wildcards.job}"
    script:
        "../threedec.py"


RECORDS = {  # where the record of a case is, by the folder of the case
    **{job: below(f"{job}/{RECORD}") for job in (*JOBS.engines, *JOBS.returned)},
    **{
        case.folder: below(f"{job}/{BATCH_RECORDS}")
        for job, cases in JOBS.batches.items()
        for case in cases
    },
}
OF_CASES = [
    *dict.fromkeys(RECORDS.values()),
    *(  # what no table reads but figures of stresses do
        below(f"{job}/{kind}.parquet") for job in JOBS.batches for kind in ("nodes", "history")
    ),
]


def records_of(kind):
    """The files of the records of all cases of a kind, see `workflow.case`."""
    found = (path for folder, path in RECORDS.items() if folder.startswith(f"{kind}/"))
    return list(dict.fromkeys(found))


# Files that are made only when they are asked for by name.
if STUDY.samples:

    BATCH_OF = {
        case.folder: case
        for cases in JOBS.batches.values()
        for case in cases
        if case.subject.kind == JointSubject.kind
    }

    rule decks:
        input:
            template=f"{CHECKOUT}/templates/3dec.dat.j2",
        output:
            decks=[below(f"{deck_folder(name)}/{DECK}") for name in JOBS.decks],
        log:
            below("logs/decks.log"),
        params:
            cases=lambda wildcards: [case.to_json() for case in JOBS.decks.values()],
            code=code("workflow.threedec"),
        message:
            "Write decks for 3DEC"
        script:
            "../threedec.py"

    # A separate folder for a case that was solved in a batch.
    rule case_files:
        input:
            records=lambda wildcards: RECORDS[wildcards.job],
        output:
            result=below("{job}/result.json"),
        log:
            below("logs/{job}.files.log"),
        wildcard_constraints:
            job=one_of(BATCH_OF),
        params:
            case=lambda wildcards: BATCH_OF[wildcards.job].to_json(),
            code=code("workflow.solve", JointSubject.modules),
        message:
            "Files of {wildcards.job}"
        script:
            "../solve.py"
