# Included if the study has structures: their tables and files for ParaView.
from sidmacib.engines import ENGINES
from sidmacib.engines.render import sources
from workflow.cases import support_cases

MEASURED_LOADS = {
    name: section.measured.model_dump_json()
    for name, section in STUDY.structures.items()
    if section.measured is not None
}
DEMANDED = any(case.subject.demands for case in JOBS.structures.values())


# Not in a group: Snakemake looks at all inputs of a group again whenever one of them is made.
rule structure_tables:
    input:
        records=records_of(StructureSubject.kind),
    output:
        **({"verdicts": shown("tables/verdicts.csv")} if DEMANDED else {}),
        **(
            {"measured_structures": shown("tables/measured_structures.csv")}
            if MEASURED_LOADS
            else {}
        ),
        structures=shown("tables/structures.csv"),
        interfaces=shown("tables/interfaces.csv"),
        blocks=shown("tables/blocks.csv"),
    log:
        below("logs/structure_tables.log"),
    params:
        cases=[*JOBS.structures],
        measured=MEASURED_LOADS,
        code=code("analysis.tables.structures", StructureSubject.modules),
    message:
        "Tabulate the structures"
    script:
        "../tables/structures.py"


# Not in a group: Snakemake looks at all inputs of a group again whenever one of them is made.
rule structure_vtk:
    input:
        records=records_of(StructureSubject.kind),
    output:
        files=[
            below(f"structures/vtk/{case.name}-{case.model}-{part}.vtu")
            for case in JOBS.structures.values()
            for part in ("blocks", "interfaces")
        ],
    log:
        below("logs/structure_vtk.log"),
    params:
        cases=lambda wildcards: [case.to_json() for case in JOBS.structures.values()],
        code=code("analysis.vtk", StructureSubject.modules),
    message:
        "Write the structures for ParaView"
    script:
        "../vtk.py"


MOVING_SUPPORTS = [*support_cases(STUDY)]
YADE_MODULES, YADE_FILES = sources(ENGINES["yade"])


rule supports:
    output:
        supports=shown("tables/supports.csv"),
    log:
        below("logs/supports.log"),
    params:
        cases=lambda wildcards: [
            [each.structure, each.load, each.description, variant, yade]
            for each, variant, yade in MOVING_SUPPORTS
        ],
        code=code(
            "analysis.tables.structures",
            (*StructureSubject.modules, *YADE_MODULES),
            YADE_FILES,
        ),
        versions=lambda wildcards: (
            ENGINES["yade"].versions() if any(yade for *_, yade in MOVING_SUPPORTS) else {}
        ),
    message:
        "Move the supports of structures"
    script:
        "../tables/structures.py"


STRUCTURE_FILES = [*rules.structure_tables.output, *rules.structure_vtk.output]
SHOWN_TABLES |= dict(rules.structure_tables.output.items())
if MOVING_SUPPORTS:
    STRUCTURE_FILES += rules.supports.output
    SHOWN_TABLES |= dict(rules.supports.output.items())
