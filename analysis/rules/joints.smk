# Joints: tables from the results of the cases, figures and summary; check that every case has a result.
from analysis.figures.catalogue import drawn_files, figures_of

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
        code=code("analysis.tables.fit"),
    message:
        "Compare the variants with the reference"
    script:
        "../tables/fit.py"


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


if STUDY.measured is not None:

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
            code=code("analysis.tables.validation"),
        message:
            "Compare measured loads with the models"
        script:
            "../tables/validation.py"


FIGURES = figures_of(STUDY, DETAILED, JOBS.joints.values())
STRESSES = {  # by figure, the record of the case whose stresses it shows
    name: RECORDS[figure.case.folder] for name, figure in FIGURES.items() if figure.case is not None
}


rule figures:
    input:
        **STRESSES,
        capacity=rules.capacity.output.capacity,
        validation=rules.validation.output.validation,
        models=rules.collect.output.models,
        envelopes=rules.capacity.output.envelopes,
        variants=rules.variants.output.variants,
    output:
        figures=[shown(name) for name in drawn_files(FIGURES)],
    log:
        below("logs/figures.log"),
    group:
        "tables"
    params:
        study=lambda wildcards: STUDY.figures_json(),
        detailed_models=DETAILED,
        code=code("analysis.figures.draw", JointSubject.modules, PUBLISHED),
    message:
        "Draw the figures"
    script:
        "../figures/draw.py"


rule summary:
    input:
        validation=rules.validation.output.validation,
        fit=rules.fit.output.fit,
        best_fit=rules.fit.output.best_fit,
        capacity=rules.capacity.output.capacity,
        cases=rules.collect.output.cases,
    output:
        summary=below("summary.txt"),
    log:
        below("logs/summary.log"),
    group:
        "tables"
    params:
        results=lambda wildcards: STUDY.results,
        meshes=STUDY.meshes,
        ductile=[
            name
            for name, change in STUDY.every_variant.items()
            if change.assembly(STUDY.assembly).failure == "ductile"
        ],
        code=code("analysis.summary.summary"),
    message:
        "Write the summary"
    script:
        "../summary/summary.py"


# Not in a group: a failing group loses all its outputs, and this rule fails if a case has no result.
rule complete:
    input:
        cases=rules.collect.output.cases,
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


REPORT_INPUTS |= {
    "validation": rules.validation.output.validation,
    "capacity": rules.capacity.output.capacity,
    "weights": rules.collect.output.weights,
    "cases": rules.collect.output.cases,
    "fit": rules.fit.output.fit,
    "best_fit": rules.fit.output.best_fit,
    "variants": rules.variants.output.variants,
    "summary": rules.summary.output.summary,
}
