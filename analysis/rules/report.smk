# The report of a study: its joints and structures, from the inputs that other rules have added.
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


rule report:
    input:
        **REPORT_INPUTS,
    output:
        page=shown(REPORT),
    log:
        below("logs/report.log"),
    group:
        "tables"
    params:
        study=lambda wildcards: STUDY.part("variants") if STUDY.samples else None,
        structures=lambda wildcards: STUDY.structures_json() if STUDY.structures else None,
        configuration=lambda wildcards: STUDY.model_dump_json(exclude={"results"}),
        cases=lambda wildcards: [*reversed(SHOWN_STRUCTURES.values())],
        code=code("analysis.report.page", StructureSubject.modules, PAGE_FILES),
    message:
        "Write the report"
    script:
        "../report/page.py"
