# Files that are not part of a study and are made only when requested by name.
from workflow.threedec import DECK, deck_folder

BATCH_OF = {
    case.id: case
    for cases in JOBS.batches.values()
    for case in cases
    if case.subject.kind == JointSubject.kind
}


rule decks:
    input:
        template=f"{CHECKOUT}/templates/3dec.dat.j2",
    output:
        decks=[below(f"{deck_folder(name)}/{DECK}") for name in JOBS.decks],
    log:
        below("logs/decks.log"),
    params:
        cases=lambda wildcards: [case.to_json() for case in JOBS.decks.values()],
        code=code("workflow.steps.decks"),
    message:
        "Write decks for 3DEC"
    script:
        "../steps/decks.py"


# A separate folder for a case that was solved in a batch, made on request.
rule case_files:
    input:
        records=lambda wildcards: RECORDS[f"cases/{wildcards.model}/{wildcards.case}"],
    output:
        result=below("cases/{model}/{case}/result.json"),
    log:
        below("logs/cases/{model}/{case}.files.log"),
    wildcard_constraints:
        model=one_of(model for model, _ in BATCH_OF),
        case=one_of(case for _, case in BATCH_OF),
    params:
        case=lambda wildcards: BATCH_OF[wildcards.model, wildcards.case].to_json(),
        code=code("workflow.steps.case_files", JointSubject.modules),
    message:
        "{wildcards.model}: files of {wildcards.case}"
    script:
        "../steps/case_files.py"
