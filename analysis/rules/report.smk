# The summary and the report of joints and structures, from the inputs that other rules have added; check that every
# case has a result.
from workflow.command import REPORT

PAGE_FILES = (
    "workflow/results/columns.yaml",
    *(  # templates, styles and scripts
        f"{folder}/{path.name}"
        for folder in ("analysis/report", "sidmacib/scene")
        for path in Path(CHECKOUT, folder).iterdir()
        if path.suffix in (".css", ".j2", ".js")
    ),
)
SHOWN_STRUCTURES = {  # one case of each, whatever its model
    case.name: case.to_json() for case in reversed(JOBS.structures.values())
}


rule summary:
    input:
        **SHOWN_TABLES,
    output:
        summary=below("summary.txt"),
    log:
        below("logs/summary.log"),
    group:
        "tables"
    params:
        results=lambda wildcards: STUDY.results,
        meshes=STUDY.meshes,
        code=code("analysis.summary.summary"),
    message:
        "Write the summary"
    script:
        "../summary/summary.py"


# Not in a group: a failing group loses all its outputs, and this rule fails if a case has no result.
rule complete:
    input:
        **{
            name: path
            for name, path in SHOWN_TABLES.items()
            if name in ("cases", "structures", "earthquakes")
        },
        summary=rules.summary.output.summary,
    output:
        mark=below(".complete"),
    log:
        below("logs/complete.log"),
    params:
        code=code("analysis.summary.summary"),
    message:
        "Check that every case has a result"
    script:
        "../summary/summary.py"


rule report:
    input:
        **SHOWN_TABLES,
        summary=rules.summary.output.summary,
    output:
        page=shown(REPORT),
    log:
        below("logs/report.log"),
    group:
        "tables"
    params:
        study=lambda wildcards: STUDY.part("variants") if STUDY.samples else None,
        configuration=lambda wildcards: STUDY.model_dump_json(
            exclude={"results": True, "earthquakes": {"__all__": {"records"}}}
        ),
        cases=lambda wildcards: [*reversed(SHOWN_STRUCTURES.values())],
        code=code("analysis.report.page", StructureSubject.modules, PAGE_FILES),
    message:
        "Write the report"
    script:
        "../report/page.py"
