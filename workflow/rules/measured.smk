# Of a study that names measured loads.
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
        "Put measured loads beside the models"
    shell:
        STEP
