# Files that are not part of a study and are made only when requested by name.
from workflow.threedec import DECK, deck_folder


rule decks:
    input:
        plan=plan("decks"),
    output:
        decks=[below(f"{deck_folder(name)}/{DECK}") for name in CASES.decks],
    log:
        below("logs/decks.log"),
    resources:
        **asks("decks"),
    params:
        step="workflow.steps.decks",
        cases=lambda wildcards: [case.to_json() for case in CASES.decks.values()],
        files=("templates/3dec.dat.j2",),
    message:
        "Write decks for 3DEC"
    shell:
        STEP


BATCH_OF = CASES.batch_of


# A separate folder for a case that was solved in a batch, made on request.
rule case_files:
    input:
        plan=lambda wildcards: plans()[
            f"{wildcards.model}/{BATCH_OF[wildcards.model, wildcards.case]}"
        ],
        records=lambda wildcards: RECORDS[wildcards.model, wildcards.case],
    output:
        result=below("cases/{model}/{case}/result.json"),
    log:
        below("logs/{model}/{case}.files.log"),
    wildcard_constraints:
        model=one_of(model for model, _ in BATCH_OF),
        case=one_of(case for _, case in BATCH_OF),
    message:
        "{wildcards.model}: files of {wildcards.case}"
    shell:
        PYTHON + " -m workflow.steps.case_files {input.plan:q} {input.records:q} {output:q}"
        " > {log:q} 2>&1"
