# Included if the study has samplings: batches of their joints, and a table of all batches.
from sidmacib.validation import plain
from workflow.jobs import sampling_resources

JOINTS = 64  # per batch of a sampling
BATCHES = {  # the numbers of the joints of each batch, by sampling and number of the batch
    (name, f"{number:04}"): range(start, min(start + JOINTS, sampling.joints))
    for name, sampling in STUDY.samplings.items()
    for number, start in enumerate(range(0, sampling.joints, JOINTS))
}
OF_SAMPLINGS = [below(f"sampling/{name}-{batch}.parquet") for name, batch in BATCHES]


def sampling_of(wildcards):
    return STUDY.samplings[wildcards.sampling]


def joints_of(wildcards):
    return BATCHES[wildcards.sampling, wildcards.batch]


JOINTS_OF_BATCH = {  # parameters of a step for the joints of a batch
    "name": lambda wildcards: wildcards.sampling,
    "sampling": lambda wildcards: sampling_of(wildcards).parameters(),
    "base": lambda wildcards: plain(STUDY.base_joint),
    "start": lambda wildcards: joints_of(wildcards).start,
    "stop": lambda wildcards: joints_of(wildcards).stop,
    "eccentricities": lambda wildcards: sampling_of(wildcards).eccentricities
    or STUDY.eccentricities,
}


rule sampling:
    output:
        joints=below("sampling/{sampling}-{batch}.parquet"),
    log:
        below("logs/sampling/{sampling}-{batch}.log"),
    benchmark:
        below("benchmarks/sampling/{sampling}-{batch}.tsv")
    wildcard_constraints:
        sampling=one_of(STUDY.samplings),
        batch="[0-9]+",
    group:
        "cases"
    resources:
        **asks(lambda wildcards: sampling_resources(len(joints_of(wildcards)))),
    params:
        **JOINTS_OF_BATCH,
        cells=lambda wildcards: sampling_of(wildcards).cells,
        limited=lambda wildcards: sampling_of(wildcards).limited,
        code=code("workflow.sampling", JointSubject.modules),
    message:
        "sampling: {wildcards.sampling}-{wildcards.batch}"
    script:
        "../sampling.py"


rule samplings:
    input:
        batches=OF_SAMPLINGS,
    output:
        samplings=shown("tables/samplings.csv"),
    log:
        below("logs/samplings.log"),
    group:
        "tables"
    params:
        code=code("workflow.sampling"),
    message:
        "Join the batches of the samplings"
    script:
        "../sampling.py"
