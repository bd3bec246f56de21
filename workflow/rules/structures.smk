# Included if the study has structures: their cases, tables and summary.
from sidmacib.engines import ENGINES
from sidmacib.engines.render import sources
from sidmacib.models import MODELS
from workflow.planning.resources import structure_resources

STRUCTURES_IN_ENGINES = {(case.model, case.name): case for case in STRUCTURES.engines.values()}


def structure_in_engine(wildcards):
    return STRUCTURES_IN_ENGINES[wildcards.engine, wildcards.case]


def cases_of_structure(wildcards):
    return STRUCTURES.solved[wildcards.model, wildcards.structure]


rule structure_engine:
    output:
        record=below("structures/{engine}/{case}/record.json"),
    log:
        below("logs/structures/{engine}/{case}.log"),
    benchmark:
        below("benchmarks/structures/{engine}/{case}.tsv")
    wildcard_constraints:
        engine=one_of(engine for engine, _ in STRUCTURES_IN_ENGINES),
        case=one_of(case for _, case in STRUCTURES_IN_ENGINES),
    threads: lambda wildcards: structure_in_engine(wildcards).numerics.ranks
    resources:
        **asks(lambda wildcards: structure_resources(1, STUDY.dem.time_limit)),
        time_limit=TIME_LIMIT,
    params:
        case=lambda wildcards: structure_in_engine(wildcards).to_json(),
        code=lambda wildcards: code(
            "workflow.steps.structure_engine", *sources(ENGINES[wildcards.engine])
        ),
        versions=lambda wildcards: ENGINES[wildcards.engine].versions(),
    message:
        "{wildcards.engine}: {wildcards.case}"
    script:
        "../steps/structure_engine.py"


rule structure_solve:
    output:
        records=below("structures/{model}/{structure}/records.jsonl"),
    log:
        below("logs/structures/{model}/{structure}.log"),
    benchmark:
        below("benchmarks/structures/{model}/{structure}.tsv")
    wildcard_constraints:
        model=one_of(model for model, _ in STRUCTURES.solved),
        structure=one_of(structure for _, structure in STRUCTURES.solved),
    resources:
        **asks(lambda wildcards: structure_resources(len(cases_of_structure(wildcards)))),
    params:
        cases=lambda wildcards: [case.to_json() for case in cases_of_structure(wildcards)],
        module=lambda wildcards: MODELS[wildcards.model].structures,
        code=lambda wildcards: code(
            "workflow.steps.structure_solve", (MODELS[wildcards.model].structures,)
        ),
    message:
        "{wildcards.model}: {wildcards.structure}"
    script:
        "../steps/structure_solve.py"


OF_STRUCTURES = [
    *(below(f"structures/{engine}/{case}/record.json") for engine, case in STRUCTURES_IN_ENGINES),
    *(below(f"structures/{model}/{name}/records.jsonl") for model, name in STRUCTURES.solved),
]


# Not in a group: Snakemake looks at all inputs of a group again whenever one of them is made.
rule structure_tables:
    input:
        records=OF_STRUCTURES,
    output:
        structures=shown("tables/structures.csv"),
        interfaces=shown("tables/interfaces.csv"),
        blocks=shown("tables/blocks.csv"),
    log:
        below("logs/structure_tables.log"),
    params:
        cases=[list(case) for case in STRUCTURES.cases],
        code=code("analysis.tables.structures"),
    message:
        "Tabulate the structures"
    script:
        "../../analysis/tables/structures.py"


# Not in a group: Snakemake looks at all inputs of a group again whenever one of them is made.
rule structure_vtk:
    input:
        records=OF_STRUCTURES,
    output:
        files=[
            below(f"structures/vtk/{case.name}-{case.model}-{part}.vtu")
            for case in STRUCTURES.cases.values()
            for part in ("blocks", "interfaces")
        ],
    log:
        below("logs/structure_vtk.log"),
    params:
        cases=lambda wildcards: [case.to_json() for case in STRUCTURES.cases.values()],
        code=code("analysis.structure_vtk"),
    message:
        "Write the structures for ParaView"
    script:
        "../../analysis/structure_vtk.py"


rule structure_summary:
    input:
        structures=rules.structure_tables.output.structures,
    output:
        summary=below("structures.txt"),
    log:
        below("logs/structure_summary.log"),
    group:
        "tables"
    params:
        results=lambda wildcards: STUDY.results,
        code=code("analysis.summary.structures"),
    message:
        "Write the summary of the structures"
    script:
        "../../analysis/summary/structures.py"


# Not in a group, for the same reason as the rule `complete` of joints.
rule structures_complete:
    input:
        structures=rules.structure_tables.output.structures,
        summary=rules.structure_summary.output.summary,
    output:
        mark=below(".structures_complete"),
    log:
        below("logs/structures_complete.log"),
    params:
        code=code("analysis.summary.complete"),
    message:
        "Check that every structure has a result"
    script:
        "../../analysis/summary/complete.py"


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
