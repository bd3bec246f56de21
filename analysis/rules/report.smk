# The report of a study: its joints and structures, from the inputs that other rules have added.
from analysis.report.files import FILES as PAGE_FILES
from workflow.planning.results_folder import REPORT

SHOWN_STRUCTURES = {  # one case of each, whatever its model
    case.name: case.to_json() for case in reversed(STRUCTURES.cases.values())
}


rule report:
    input:
        **REPORT_INPUTS,
        plan=plan("report"),
    output:
        page=shown(REPORT),
    log:
        below("logs/report.log"),
    group:
        "tables"
    resources:
        **asks("report"),
    params:
        step="analysis.report.page",
        study=lambda wildcards: STUDY.pieces_json() if STUDY.samples else None,
        structures=lambda wildcards: STUDY.structures_json() if STUDY.structures else None,
        configuration=STUDY.model_dump_json(exclude={"results"}),
        cases=[*reversed(SHOWN_STRUCTURES.values())],
        files=PAGE_FILES,
    message:
        "Write the report"
    shell:
        STEP
