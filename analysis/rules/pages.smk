# Figures and summary from the tables; check that every case has a result.
from analysis.figures.catalogue import drawn_files, figures_of

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
        code=code("analysis.summary.complete"),
    message:
        "Check that every case has a result"
    script:
        "../summary/complete.py"


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
