# Tables from the results of the cases.
PUBLISHED = ("analysis/published.yaml",)


# Not in a group: Snakemake looks at all inputs of a group again whenever one of them is made.
rule collect:
    input:
        plan=plan("collect"),
        records=list(dict.fromkeys(RECORDS.values())),
    output:
        weights=shown("tables/weights.csv"),
        weight_sums=shown("tables/weight_sums.csv"),
        cases=shown("tables/cases.csv"),
        models=shown("tables/models.csv"),
    log:
        below("logs/collect.log"),
    resources:
        **asks("collect"),
    params:
        step="analysis.tables.collect",
        cases=[case.id for case in CASES.cases.values()],
    message:
        "Collect the cases' results"
    shell:
        STEP


rule capacity:
    input:
        plan=plan("capacity"),
        cases=rules.collect.output.cases,
        weights=rules.collect.output.weights,
    output:
        capacity=shown("tables/capacity.csv"),
        envelopes=shown("tables/envelopes.csv"),
    log:
        below("logs/capacity.log"),
    group:
        "tables"
    resources:
        **asks("capacity"),
    params:
        step="analysis.tables.capacity",
        study=lambda wildcards: STUDY.tables_json(),
        files=PUBLISHED,
    message:
        "Solve SiDMACIB and tabulate all capacities"
    shell:
        STEP


rule fit:
    input:
        plan=plan("fit"),
        capacity=rules.capacity.output.capacity,
    output:
        fit=shown("tables/fit.csv"),
        best_fit=shown("tables/best_fit.csv"),
    log:
        below("logs/fit.log"),
    group:
        "tables"
    resources:
        **asks("fit"),
    params:
        step="analysis.tables.fit",
        study=lambda wildcards: STUDY.tables_json(),
    message:
        "Fit SiDMACIB to the detailed models"
    shell:
        STEP


rule variants:
    input:
        plan=plan("variants"),
        capacity=rules.capacity.output.capacity,
        weight_sums=rules.collect.output.weight_sums,
    output:
        variants=shown("tables/variants.csv"),
    log:
        below("logs/variants.log"),
    group:
        "tables"
    resources:
        **asks("variants"),
    params:
        step="analysis.tables.variants",
        study=lambda wildcards: STUDY.pieces_json(),
    message:
        "Compare the variants with the reference"
    shell:
        STEP


rule validation:
    input:
        plan=plan("validation"),
        capacity=rules.capacity.output.capacity,
        weights=rules.collect.output.weights,
        fit=rules.fit.output.fit,
    output:
        validation=shown("tables/validation.csv"),
    log:
        below("logs/validation.log"),
    group:
        "tables"
    resources:
        **asks("validation"),
    params:
        step="analysis.tables.validation",
        study=lambda wildcards: STUDY.tables_json(),
        files=PUBLISHED,
    message:
        "Compare with the published numbers"
    shell:
        STEP
