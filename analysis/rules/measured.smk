# Included if the study has measured loads.
rule measured:
    input:
        capacity=rules.capacity.output.capacity,
    output:
        measured=shown("tables/measured.csv"),
    log:
        below("logs/measured.log"),
    group:
        "tables"
    params:
        study=lambda wildcards: STUDY.measured_json(),
        code=code("analysis.tables.measured"),
    message:
        "Compare measured loads with the models"
    script:
        "../tables/measured.py"
