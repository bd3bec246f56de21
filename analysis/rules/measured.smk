# Included if the study has measured loads.
rule measured:
    input:
        plan=plan("measured"),
        capacity=rules.capacity.output.capacity,
    output:
        measured=shown("tables/measured.csv"),
    log:
        below("logs/measured.log"),
    group:
        "tables"
    resources:
        **asks("measured"),
    params:
        step="analysis.tables.measured",
        study=lambda wildcards: STUDY.measured_json(),
    message:
        "Compare measured loads with the models"
    shell:
        STEP
