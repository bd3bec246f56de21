# Joints: tables from the results of the cases, and figures.
from analysis.figures import drawn_files, figures_of

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
        cases=[*JOBS.joints],
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
        **{"demands": shown("tables/demands.csv")} if STUDY.demand is not None else {},
        capacity=shown("tables/capacity.csv"),
        envelopes=shown("tables/envelopes.csv"),
    log:
        below("logs/capacity.log"),
    group:
        "tables"
    params:
        study=lambda wildcards: STUDY.part("demand"),
        code=code("analysis.tables.capacity", files=PUBLISHED),
    message:
        "Solve SiDMACIB and tabulate all capacities"
    script:
        "../tables/capacity.py"


rule comparisons:
    input:
        capacity=rules.capacity.output.capacity,
        weights=rules.collect.output.weights,
        weight_sums=rules.collect.output.weight_sums,
    output:
        **{"measured": shown("tables/measured.csv")} if STUDY.measured is not None else {},
        fit=shown("tables/fit.csv"),
        best_fit=shown("tables/best_fit.csv"),
        variants=shown("tables/variants.csv"),
        validation=shown("tables/validation.csv"),
    log:
        below("logs/comparisons.log"),
    group:
        "tables"
    params:
        study=lambda wildcards: STUDY.part("variants", "measured"),
        code=code("analysis.tables.comparisons", files=PUBLISHED),
    message:
        "Fit SiDMACIB, and compare variants, published and measured numbers"
    script:
        "../tables/comparisons.py"


FIGURES = figures_of(STUDY, JOBS.joints.values())
STRESSES = {  # by figure, the record of the case whose stresses it shows
    name: RECORDS[figure.case.folder] for name, figure in FIGURES.items() if figure.case is not None
}


rule figures:
    input:
        **STRESSES,
        capacity=rules.capacity.output.capacity,
        validation=rules.comparisons.output.validation,
        models=rules.collect.output.models,
        envelopes=rules.capacity.output.envelopes,
        variants=rules.comparisons.output.variants,
    output:
        figures=[shown(name) for name in drawn_files(FIGURES)],
    log:
        below("logs/figures.log"),
    group:
        "tables"
    params:
        study=lambda wildcards: STUDY.part("variants", "figures", "measured"),
        code=code("analysis.figures.draw", JointSubject.modules, PUBLISHED),
    message:
        "Draw the figures"
    script:
        "../figures/draw.py"


SHOWN_TABLES |= {
    "validation": rules.comparisons.output.validation,
    "capacity": rules.capacity.output.capacity,
    "weights": rules.collect.output.weights,
    "cases": rules.collect.output.cases,
    "fit": rules.comparisons.output.fit,
    "best_fit": rules.comparisons.output.best_fit,
    "variants": rules.comparisons.output.variants,
}
if STUDY.demand is not None:
    SHOWN_TABLES["demands"] = rules.capacity.output.demands
