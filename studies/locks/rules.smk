# The law for the joints of the samplings, and its tables and figures.
from dataclasses import asdict

WILDCARDS["law"] = OF_SAMPLINGS


rule law:
    input:
        plan=plan("law/{sampling}-{batch}"),
    output:
        joints=below("law/{sampling}-{batch}.parquet"),
    log:
        below("logs/law/{sampling}-{batch}.log"),
    wildcard_constraints:
        sampling=one_of(STUDY.samplings),
        batch="[0-9]+",
    group:
        "cases"
    resources:
        **asks("law/{sampling}-{batch}"),
    params:
        **JOINTS_OF_BATCH,
        step="studies.locks.law",
    message:
        "law: {wildcards.sampling}-{wildcards.batch}"
    shell:
        STEP


rule points:
    input:
        plan=plan("points"),
        samplings=rules.samplings.output.samplings,
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
        step="studies.locks.points",
    message:
        "Tabulate the law with the static model"
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
        step="studies.locks.errors",
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
        step="studies.locks.interaction",
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
        step="studies.locks.bonds",
    message:
        "Compare peaks with first failures, by kind of bond"
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
        step="studies.locks.freedoms",
    message:
        "Fit contact points of SiDMACIB to the peaks"
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
        step="studies.locks.sensitivity",
        sampling=asdict(next(iter(STUDY.samplings.values())).sampling()),
        base=asdict(STUDY.base_joint),
    message:
        "Find the parameters that the first failure depends on"
    shell:
        STEP


rule paper_joint:
    input:
        plan=plan("paper_joint"),
    output:
        characteristic=shown("tables/characteristic.csv"),
        assumed_sizes=shown("tables/assumed_sizes.csv"),
    log:
        below("logs/paper_joint.log"),
    group:
        "tables"
    resources:
        **asks("paper_joint"),
    params:
        step="studies.locks.paper_joint",
        base=asdict(STUDY.base_joint),
    message:
        "Vary strength and sizes of the joint of the paper"
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
        step="studies.locks.figures",
    message:
        "Draw the law"
    shell:
        STEP


OF_CAMPAIGN = [
    *of_jobs(rules.law.rule),
    *rules.points.output,
    *rules.errors.output,
    *rules.interaction.output,
    *rules.bonds.output,
    *rules.freedoms.output,
    *rules.sensitivity.output,
    *rules.paper_joint.output,
    *rules.law_figures.output,
]
