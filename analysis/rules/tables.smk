# Tables from the results of the cases.
PUBLISHED = ("analysis/published.yaml",)


# Not in a group: Snakemake looks at all inputs of a group again whenever one of them is made.
rule collect:
    input:
        records=records_of(JointSubject.kind),
    output:
        weights=shown("tables/weights.csv"),
        weight_sums=shown("tables/weight_sums.csv"),
        cases=shown("tables/cases.csv"),
        models=shown("tables/models.csv"),
    log:
        below("logs/collect.log"),
    params:
        cases=[case.id for case in JOBS.joints.values()],
        code=code("analysis.tables.collect", JointSubject.modules),
    message:
        "Collect the cases' results"
    script:
        "../tables/collect.py"


rule capacity:
    input:
        cases=rules.collect.output.cases,
        weights=rules.collect.output.weights,
    output:
        capacity=shown("tables/capacity.csv"),
        envelopes=shown("tables/envelopes.csv"),
    log:
        below("logs/capacity.log"),
    group:
        "tables"
    params:
        study=lambda wildcards: STUDY.tables_json(),
        code=code("analysis.tables.capacity", files=PUBLISHED),
    message:
        "Solve SiDMACIB and tabulate all capacities"
    script:
        "../tables/capacity.py"


rule fit:
    input:
        capacity=rules.capacity.output.capacity,
    output:
        fit=shown("tables/fit.csv"),
        best_fit=shown("tables/best_fit.csv"),
    log:
        below("logs/fit.log"),
    group:
        "tables"
    params:
        study=lambda wildcards: STUDY.tables_json(),
        code=code("analysis.tables.fit"),
    message:
        "Fit SiDMACIB to the detailed models"
    script:
        "../tables/fit.py"


rule variants:
    input:
        capacity=rules.capacity.output.capacity,
        weight_sums=rules.collect.output.weight_sums,
    output:
        variants=shown("tables/variants.csv"),
    log:
        below("logs/variants.log"),
    group:
        "tables"
    params:
        study=lambda wildcards: STUDY.pieces_json(),
        code=code("analysis.tables.variants"),
    message:
        "Compare the variants with the reference"
    script:
        "../tables/variants.py"


rule validation:
    input:
        capacity=rules.capacity.output.capacity,
        weights=rules.collect.output.weights,
        fit=rules.fit.output.fit,
    output:
        validation=shown("tables/validation.csv"),
    log:
        below("logs/validation.log"),
    group:
        "tables"
    params:
        study=lambda wildcards: STUDY.tables_json(),
        code=code("analysis.tables.validation", files=PUBLISHED),
    message:
        "Compare with the published numbers"
    script:
        "../tables/validation.py"
