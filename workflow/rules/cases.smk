# The cases: each engine case is a job, solved cases run in batches, those of 3DEC are read.
from workflow.engines import ENGINES
from workflow.engines.render import sources
from workflow.models import MODELS
from workflow.planning.closure import code_digest
from workflow.planning.resources import engine_resources, solved_resources
from workflow.engines.scripts.records import OUTPUTS

GUIDES_CODE = code_digest(("workflow.engines.guide",))
WILDCARDS |= {
    "engine": [{"engine": engine, "case": case} for engine, case in CASES.engines],
    "guides": [
        {"engine": engine}
        for engine in dict.fromkeys(engine for engine, _ in CASES.engines)
        if guided_cases(engine)
    ],
    "solve": [{"model": model, "batch": batch} for model, batch in CASES.batches],
    "returned": [{"program": program, "case": case} for program, case in CASES.returned],
}


rule guides:
    input:
        plan=plan("guides/{engine}"),
    output:
        guides=below("cases/guides/{engine}.json"),
    log:
        below("logs/guides/{engine}.log"),
    wildcard_constraints:
        engine=one_of(engine for engine, _ in CASES.engines),
    # No case waits for it: one that does not find its guide there finds it itself.
    priority: 1
    resources:
        **asks("guides/{engine}"),
    params:
        step="workflow.steps.guides",
        cases=lambda wildcards: [case.to_json() for case in guided_cases(wildcards.engine)],
        code=GUIDES_CODE,
        resources=lambda wildcards: solved_resources(guided_cases(wildcards.engine)),
    message:
        "Find where {wildcards.engine} begins to search"
    shell:
        STEP


rule engine:
    input:
        plan=plan("{engine}/{case}"),
    output:
        record=below("cases/{engine}/{case}/record.json"),
        result=below("cases/{engine}/{case}/result.json"),
    log:
        below("logs/{engine}/{case}.log"),
    wildcard_constraints:
        engine=one_of(engine for engine, _ in CASES.engines),
        case=one_of(case for _, case in CASES.engines),
    group:
        lambda wildcards: group_of(wildcards.engine)
    threads: lambda wildcards: case_in_engine(wildcards).numerics.ranks
    resources:
        **asks("{engine}/{case}"),
    params:
        step="workflow.steps.engine",
        case=case_in_engine,
        settings={"time_limit": STUDY.dem.time_limit, "guides_code": GUIDES_CODE},
        # Written only if the engine has a result.
        also=[
            below(f"cases/{{engine}}/{{case}}/{name}") for name in OUTPUTS if name != "result.json"
        ],
        modules=lambda wildcards: (
            "workflow.engines.guide",
            *sources(ENGINES[wildcards.engine])[0],
        ),
        files=lambda wildcards: sources(ENGINES[wildcards.engine])[1],
        versions=lambda wildcards: ENGINES[wildcards.engine].versions(),
        resources=lambda wildcards: engine_resources(
            case_in_engine(wildcards), STUDY.dem.time_limit
        ),
    message:
        "{wildcards.engine}: {wildcards.case}"
    shell:
        STEP


rule solve:
    input:
        plan=plan("{model}/{batch}"),
    output:
        records=below("cases/{model}/{batch}/records.jsonl"),
        nodes=below("cases/{model}/{batch}/nodes.parquet"),
        history=below("cases/{model}/{batch}/history.parquet"),
    log:
        below("logs/{model}/{batch}.log"),
    wildcard_constraints:
        model=one_of(model for model, _ in CASES.batches),
        batch=one_of(batch for _, batch in CASES.batches),
    group:
        lambda wildcards: group_of(wildcards.model)
    resources:
        **asks("{model}/{batch}"),
    params:
        step="workflow.steps.solve",
        cases=batch,
        module=lambda wildcards: MODELS[wildcards.model].module,
        modules=lambda wildcards: (MODELS[wildcards.model].module,),
        resources=lambda wildcards: solved_resources(batch(wildcards).cases),
    message:
        "{wildcards.model}: {wildcards.batch}"
    shell:
        STEP


rule returned:
    input:
        plan=plan("{program}/{case}"),
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
    resources:
        **asks("{program}/{case}"),
    params:
        step="workflow.steps.returned",
        case=lambda wildcards: CASES.returned[wildcards.program, wildcards.case],
    message:
        "{wildcards.program}: {wildcards.case}"
    shell:
        STEP


RECORDS = {  # where the record of a case is
    **dict(zip(CASES.engines, of_jobs(rules.engine.rule, "record"))),
    **dict(zip(CASES.returned, of_jobs(rules.returned.rule, "record"))),
    **{
        case.id: path
        for batch, path in zip(CASES.batches.values(), of_jobs(rules.solve.rule, "records"))
        for case in batch.cases
    },
}
OF_CASES = [
    *of_jobs(rules.guides.rule),
    *of_jobs(rules.engine.rule),
    *of_jobs(rules.solve.rule),
    *of_jobs(rules.returned.rule),
]
