# Of a study with designs: batches of their joints, solved and asked the law of, and tables of them.
from dataclasses import asdict

from workflow.needs import design_needs

JOINTS = 64  # of a design in a batch
BASE = asdict(STUDY.base_joint)
STARTS = {  # the first joint of each batch, by design and number of the batch
    (name, f"{number:04}"): start
    for name, design in STUDY.designs.items()
    for number, start in enumerate(range(0, design.joints, JOINTS))
}
WILDCARDS["design"] = WILDCARDS["law"] = [
    {"design": design, "batch": batch} for design, batch in STARTS
]


def joints(wildcards):
    """The first joint of a batch, and the one behind its last."""
    start = STARTS[wildcards.design, wildcards.batch]
    return start, min(start + JOINTS, STUDY.designs[wildcards.design].joints)


def design_params(step, *asked, **more):
    """Parameters of a step for a batch of joints; ``asked``: keys of the design that it is given."""

    def directions(wildcards):
        design = STUDY.designs[wildcards.design]
        ratios = design.eccentricities or STUDY.eccentricities
        return {"eccentricities": ratios, **{key: getattr(design, key) for key in asked}}

    return {
        "step": step,
        "design": lambda wildcards: asdict(STUDY.designs[wildcards.design].design()),
        "base": BASE,
        "start": lambda wildcards: joints(wildcards)[0],
        "stop": lambda wildcards: joints(wildcards)[1],
        "asked": directions,
        "needs": lambda wildcards: design_needs(joints(wildcards)[1] - joints(wildcards)[0]),
        **more,
    }


rule design:
    input:
        plan=plan("designs/{design}-{batch}"),
    output:
        joints=below("designs/{design}-{batch}.parquet"),
    log:
        below("logs/designs/{design}-{batch}.log"),
    wildcard_constraints:
        design=one_of(STUDY.designs),
        batch="[0-9]+",
    group:
        "cases"
    resources:
        **asks("designs/{design}-{batch}"),
    params:
        **design_params(
            "workflow.steps.design",
            "cells",
            "limited",
            modules=("workflow.solvers.static", "workflow.solvers.limit"),
        ),
    message:
        "designs: {wildcards.design}-{wildcards.batch}"
    shell:
        STEP


rule law:
    input:
        plan=plan("law/{design}-{batch}"),
    output:
        joints=below("law/{design}-{batch}.parquet"),
    log:
        below("logs/law/{design}-{batch}.log"),
    wildcard_constraints:
        design=one_of(STUDY.designs),
        batch="[0-9]+",
    group:
        "cases"
    resources:
        **asks("law/{design}-{batch}"),
    params:
        **design_params("workflow.steps.law"),
    message:
        "law: {wildcards.design}-{wildcards.batch}"
    shell:
        STEP


rule points:
    input:
        plan=plan("points"),
        solved=of_jobs(rules.design.rule),
        law=of_jobs(rules.law.rule),
    output:
        points=shown("tables/points.csv"),
    log:
        below("logs/points.log"),
    group:
        "tables"
    resources:
        **asks("points"),
    params:
        step="analysis.designs.points",
        designs=[design for design, _ in STARTS],
    message:
        "Put the designs' batches together"
    shell:
        STEP


rule errors:
    input:
        plan=plan("errors"),
        points=rules.points.output.points,
    output:
        law=shown("tables/law.csv"),
        rules=shown("tables/rules.csv"),
    log:
        below("logs/errors.log"),
    group:
        "tables"
    resources:
        **asks("errors"),
    params:
        step="analysis.designs.errors",
    message:
        "Compare law and rules with the static model"
    shell:
        STEP


rule interaction:
    input:
        plan=plan("interaction"),
        points=rules.points.output.points,
    output:
        interaction=shown("tables/interaction.csv"),
    log:
        below("logs/interaction.log"),
    group:
        "tables"
    resources:
        **asks("interaction"),
    params:
        step="analysis.designs.interaction",
    message:
        "Compare interaction curves with the static model"
    shell:
        STEP


rule bonds:
    input:
        plan=plan("bonds"),
        points=rules.points.output.points,
    output:
        bonds=shown("tables/bonds.csv"),
    log:
        below("logs/bonds.log"),
    group:
        "tables"
    resources:
        **asks("bonds"),
    params:
        step="analysis.designs.bonds",
    message:
        "Tabulate what softening bonds add"
    shell:
        STEP


rule freedoms:
    input:
        plan=plan("freedoms"),
        points=rules.points.output.points,
    output:
        freedoms=shown("tables/freedoms.csv"),
    log:
        below("logs/freedoms.log"),
    group:
        "tables"
    resources:
        **asks("freedoms"),
    params:
        step="analysis.designs.freedoms",
    message:
        "Fit contact points to the designs' peaks"
    shell:
        STEP


rule sensitivity:
    input:
        plan=plan("sensitivity"),
    output:
        sensitivity=shown("tables/sensitivity.csv"),
    log:
        below("logs/sensitivity.log"),
    group:
        "tables"
    resources:
        **asks("sensitivity"),
    params:
        step="analysis.designs.sensitivity",
        design=asdict(next(iter(STUDY.designs.values())).design()),
        base=BASE,
    message:
        "Find the parameters that the first failure depends on"
    shell:
        STEP


rule characteristic:
    input:
        plan=plan("characteristic"),
    output:
        characteristic=shown("tables/characteristic.csv"),
    log:
        below("logs/characteristic.log"),
    group:
        "tables"
    resources:
        **asks("characteristic"),
    params:
        step="analysis.designs.characteristic",
        base=BASE,
    message:
        "Tabulate the effect of scattered strength"
    shell:
        STEP


rule assumed_sizes:
    input:
        plan=plan("assumed_sizes"),
    output:
        assumed_sizes=shown("tables/assumed_sizes.csv"),
    log:
        below("logs/assumed_sizes.log"),
    group:
        "tables"
    resources:
        **asks("assumed_sizes"),
    params:
        step="analysis.designs.assumed_sizes",
        base=BASE,
    message:
        "Tabulate the effect of the assumed sizes"
    shell:
        STEP


rule law_figures:
    input:
        plan=plan("law_figures"),
        points=rules.points.output.points,
    output:
        figures=[
            shown(name)
            for name in drawn_files(("law", "law_margins", "law_rules", "law_nomogram"))
        ],
    log:
        below("logs/law_figures.log"),
    group:
        "tables"
    resources:
        **asks("law_figures"),
    params:
        step="analysis.figures.law",
    message:
        "Draw the law"
    shell:
        STEP


OF_DESIGNS = [
    *of_jobs(rules.design.rule),
    *of_jobs(rules.law.rule),
    *rules.points.output,
    *rules.errors.output,
    *rules.interaction.output,
    *rules.bonds.output,
    *rules.freedoms.output,
    *rules.sensitivity.output,
    *rules.characteristic.output,
    *rules.assumed_sizes.output,
    *rules.law_figures.output,
]
