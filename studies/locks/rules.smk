# The law for the joints of the samplings, and its tables and figures.
OF_LAW = [below(f"law/{name}-{batch}.parquet") for name, batch in BATCHES]


rule law:
    output:
        joints=below("law/{sampling}-{batch}.parquet"),
    log:
        below("logs/law/{sampling}-{batch}.log"),
    wildcard_constraints:
        sampling=one_of(STUDY.samplings),
        batch="[0-9]+",
    group:
        "cases"
    params:
        **JOINTS_OF_BATCH,
        code=code("studies.locks.law"),
    message:
        "law: {wildcards.sampling}-{wildcards.batch}"
    script:
        "law.py"


rule law_tables:
    input:
        samplings=rules.samplings.output.samplings,
        law=OF_LAW,
    output:
        points=shown("tables/points.csv"),
        law=shown("tables/law.csv"),
        rules=shown("tables/rules.csv"),
        interaction=shown("tables/interaction.csv"),
        bonds=shown("tables/bonds.csv"),
    log:
        below("logs/law_tables.log"),
    group:
        "tables"
    params:
        code=code("studies.locks.tables"),
    message:
        "Compare law, rules, interaction curves and kinds of bonds with the static model"
    script:
        "tables.py"


rule freedoms:
    input:
        points=rules.law_tables.output.points,
    output:
        freedoms=shown("tables/freedoms.csv"),
    log:
        below("logs/freedoms.log"),
    group:
        "tables"
    params:
        code=code("studies.locks.tables"),
    message:
        "Fit contact points of SiDMACIB to the peaks"
    script:
        "tables.py"


rule variation:
    output:
        sensitivity=shown("tables/sensitivity.csv"),
        characteristic=shown("tables/characteristic.csv"),
        assumed_sizes=shown("tables/assumed_sizes.csv"),
    log:
        below("logs/variation.log"),
    group:
        "tables"
    params:
        sampling=lambda wildcards: next(iter(STUDY.samplings.values())).parameters(),
        base=lambda wildcards: plain(STUDY.base_joint),
        code=code("studies.locks.variation"),
    message:
        "Find what the first failure depends on, and vary strength and sizes of the paper's joint"
    script:
        "variation.py"


rule law_figures:
    input:
        points=rules.law_tables.output.points,
    output:
        figures=[shown(name) for name in drawn_files(("law", "law_margins", "law_nomogram"))],
    log:
        below("logs/law_figures.log"),
    group:
        "tables"
    params:
        code=code("studies.locks.figures"),
    message:
        "Draw the law"
    script:
        "figures.py"


OF_CAMPAIGN = [
    *OF_LAW,
    *rules.law_tables.output,
    *rules.freedoms.output,
    *rules.variation.output,
    *rules.law_figures.output,
]
