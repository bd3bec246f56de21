# Included if the study has structures: their cases, tables and summary.
from workflow.engines import ENGINES
from workflow.engines.render import sources
from workflow.models import MODELS
from workflow.planning.resources import structure_resources

WILDCARDS |= {
    "structure_engine": [
        {"engine": case.model, "case": case.name} for case in STRUCTURES.engines.values()
    ],
    "structure_solve": [
        {"model": model, "structure": structure} for model, structure in STRUCTURES.solved
    ],
}
IN_ENGINES = {(case.model, case.name): case for case in STRUCTURES.engines.values()}


rule structure_engine:
    input:
        plan=plan("structures/{engine}/{case}"),
    output:
        record=below("structures/{engine}/{case}/record.json"),
    log:
        below("logs/structures/{engine}/{case}.log"),
    wildcard_constraints:
        engine=one_of(engine for engine, _ in IN_ENGINES),
        case=one_of(case for _, case in IN_ENGINES),
    threads: lambda wildcards: structure_in_engine(wildcards).numerics.ranks
    resources:
        **asks("structures/{engine}/{case}"),
    params:
        step="workflow.steps.structure_engine",
        case=structure_in_engine,
        settings={"time_limit": STUDY.dem.time_limit},
        modules=lambda wildcards: sources(ENGINES[wildcards.engine])[0],
        files=lambda wildcards: sources(ENGINES[wildcards.engine])[1],
        versions=lambda wildcards: ENGINES[wildcards.engine].versions(),
        resources=lambda wildcards: structure_resources(1, STUDY.dem.time_limit),
    message:
        "{wildcards.engine}: {wildcards.case}"
    shell:
        STEP


rule structure_solve:
    input:
        plan=plan("structures/{model}/{structure}"),
    output:
        records=below("structures/{model}/{structure}/records.jsonl"),
    log:
        below("logs/structures/{model}/{structure}.log"),
    wildcard_constraints:
        model=one_of(model for model, _ in STRUCTURES.solved),
        structure=one_of(structure for _, structure in STRUCTURES.solved),
    resources:
        **asks("structures/{model}/{structure}"),
    params:
        step="workflow.steps.structure_solve",
        cases=cases_of_structure,
        module=lambda wildcards: MODELS[wildcards.model].structures,
        modules=lambda wildcards: (MODELS[wildcards.model].structures,),
        resources=lambda wildcards: structure_resources(len(cases_of_structure(wildcards).cases)),
    message:
        "{wildcards.model}: {wildcards.structure}"
    shell:
        STEP


OF_STRUCTURES = [
    pattern.format(**job)
    for rule, pattern in (
        ("structure_engine", below("structures/{engine}/{case}/record.json")),
        ("structure_solve", below("structures/{model}/{structure}/records.jsonl")),
    )
    for job in WILDCARDS[rule]
]


# Not in a group: Snakemake looks at all inputs of a group again whenever one of them is made.
rule structure_tables:
    input:
        plan=plan("structure_tables"),
        records=OF_STRUCTURES,
    output:
        structures=shown("tables/structures.csv"),
        interfaces=shown("tables/interfaces.csv"),
        blocks=shown("tables/blocks.csv"),
    log:
        below("logs/structure_tables.log"),
    resources:
        **asks("structure_tables"),
    params:
        step="analysis.tables.structures",
        cases=[list(case) for case in STRUCTURES.cases],
    message:
        "Tabulate the structures"
    shell:
        STEP


# Not in a group: Snakemake looks at all inputs of a group again whenever one of them is made.
rule structure_vtk:
    input:
        plan=plan("structure_vtk"),
        records=OF_STRUCTURES,
    output:
        files=[
            below(f"structures/vtk/{case.name}-{case.model}-{part}.vtu")
            for case in STRUCTURES.cases.values()
            for part in ("blocks", "interfaces")
        ],
    log:
        below("logs/structure_vtk.log"),
    resources:
        **asks("structure_vtk"),
    params:
        step="analysis.structure_vtk",
        cases=Batch(tuple(STRUCTURES.cases.values())),
    message:
        "Write the structures for ParaView"
    shell:
        STEP


rule structure_summary:
    input:
        plan=plan("structure_summary"),
        structures=rules.structure_tables.output.structures,
    output:
        summary=below("structures.txt"),
    log:
        below("logs/structure_summary.log"),
    group:
        "tables"
    resources:
        **asks("structure_summary"),
    params:
        step="analysis.summary.structures",
        results=lambda wildcards: STUDY.results,
    message:
        "Write the summary of the structures"
    shell:
        STEP


# Not in a group, for the same reason as the rule `complete` of joints.
rule structures_complete:
    input:
        plan=plan("structures_complete"),
        structures=rules.structure_tables.output.structures,
        summary=rules.structure_summary.output.summary,
    output:
        mark=below(".structures_complete"),
    log:
        below("logs/structures_complete.log"),
    resources:
        **asks("structures_complete"),
    params:
        step="analysis.summary.structures_complete",
    message:
        "Check that every case has a result"
    shell:
        STEP


STRUCTURE_FILES = [
    *OF_STRUCTURES,
    *rules.structure_tables.output,
    *rules.structure_vtk.output,
    *rules.structure_summary.output,
    *rules.structures_complete.output,
]
REPORT_INPUTS |= {
    **dict(rules.structure_tables.output.items()),
    "structure_summary": rules.structure_summary.output.summary,
}
