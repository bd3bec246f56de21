# The cases: each engine case is a job, solved cases run in batches, those of 3DEC are read.
from sidmacib.engines import ENGINES
from sidmacib.engines.render import sources
from sidmacib.models import MODELS
from workflow.planning.resources import engine_resources, solved_resources

IN_ENGINES = list(dict.fromkeys(engine for engine, _ in CASES.engines))


def case_in_engine(wildcards):
    return CASES.engines[wildcards.engine, wildcards.case]


def batch(wildcards):
    return CASES.batches[wildcards.model, wildcards.batch]


def of_engine(wildcards):
    return engine_resources(case_in_engine(wildcards), STUDY.dem.time_limit)


def of_batch(wildcards):
    return solved_resources(batch(wildcards))


@functools.cache
def group_of(model):
    """Cases of a model share jobs of the cluster if all of them are short."""
    limit = STUDY.dem.time_limit
    engines = (
        engine_resources(case, limit) for (name, _), case in CASES.engines.items() if name == model
    )
    solved = (
        solved_resources(cases) for (name, _), cases in CASES.batches.items() if name == model
    )
    return "cases" if all(each.short for each in (*engines, *solved)) else None


rule engine:
    output:
        record=below("cases/{engine}/{case}/record.json"),
        result=below("cases/{engine}/{case}/result.json"),
    log:
        below("logs/{engine}/{case}.log"),
    benchmark:
        below("benchmarks/{engine}/{case}.tsv")
    wildcard_constraints:
        engine=one_of(IN_ENGINES),
        case=one_of(case for _, case in CASES.engines),
    group:
        lambda wildcards: group_of(wildcards.engine)
    threads: lambda wildcards: case_in_engine(wildcards).numerics.ranks
    resources:
        **asks(of_engine),
        time_limit=TIME_LIMIT,
    params:
        case=lambda wildcards: case_in_engine(wildcards).to_json(),
        code=lambda wildcards: code("workflow.steps.engine", *sources(ENGINES[wildcards.engine])),
        versions=lambda wildcards: ENGINES[wildcards.engine].versions(),
    message:
        "{wildcards.engine}: {wildcards.case}"
    script:
        "../steps/engine.py"


rule solve:
    output:
        records=below("cases/{model}/{batch}/records.jsonl"),
        nodes=below("cases/{model}/{batch}/nodes.parquet"),
        history=below("cases/{model}/{batch}/history.parquet"),
    log:
        below("logs/{model}/{batch}.log"),
    benchmark:
        below("benchmarks/{model}/{batch}.tsv")
    wildcard_constraints:
        model=one_of(model for model, _ in CASES.batches),
        batch=one_of(batch for _, batch in CASES.batches),
    group:
        lambda wildcards: group_of(wildcards.model)
    resources:
        **asks(of_batch),
    params:
        cases=lambda wildcards: [case.to_json() for case in batch(wildcards)],
        module=lambda wildcards: MODELS[wildcards.model].module,
        code=lambda wildcards: code("workflow.steps.solve", (MODELS[wildcards.model].module,)),
    message:
        "{wildcards.model}: {wildcards.batch}"
    script:
        "../steps/solve.py"


rule returned:
    input:
        printed=below("decks/{program}/{case}/results.txt"),
    output:
        record=below("cases/{program}/{case}/record.json"),
    log:
        below("logs/{program}/{case}.log"),
    wildcard_constraints:
        program=one_of(program for program, _ in CASES.returned),
        case=one_of(case for _, case in CASES.returned),
    group:
        "cases"
    params:
        case=lambda wildcards: CASES.returned[wildcards.program, wildcards.case].to_json(),
        code=code("workflow.steps.returned"),
    message:
        "{wildcards.program}: {wildcards.case}"
    script:
        "../steps/returned.py"


RECORDS = {  # where the record of a case is
    **{case: below(f"{case.folder}/record.json") for case in (*CASES.engines, *CASES.returned)},
    **{
        case.id: below(f"cases/{model}/{name}/records.jsonl")
        for (model, name), cases in CASES.batches.items()
        for case in cases
    },
}
OF_CASES = [
    *dict.fromkeys(RECORDS.values()),
    *(  # what no table reads but figures of stresses do
        below(f"cases/{model}/{name}/{kind}.parquet")
        for model, name in CASES.batches
        for kind in ("nodes", "history")
    ),
]
