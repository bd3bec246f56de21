# Included if the study has samplings: batches of their joints, and a table of all batches.
import json
from dataclasses import asdict

from workflow.jobs import sampling_resources

JOINTS = 64  # per batch of a sampling
STARTS = {  # the first joint of each batch, by sampling and number of the batch
    (name, f"{number:04}"): start
    for name, sampling in STUDY.samplings.items()
    for number, start in enumerate(range(0, sampling.joints, JOINTS))
}
OF_SAMPLINGS = [below(f"sampling/{name}-{batch}.parquet") for name, batch in STARTS]


def sampling_of(wildcards):
    return STUDY.samplings[wildcards.sampling]


def first_joint(wildcards):
    return STARTS[wildcards.sampling, wildcards.batch]


def joint_after(wildcards):
    """The first joint after a batch."""
    return min(first_joint(wildcards) + JOINTS, sampling_of(wildcards).joints)


def of_joints(wildcards):
    return sampling_resources(joint_after(wildcards) - first_joint(wildcards))


def plain(value):
    """A dataclass as plain data."""
    return json.loads(json.dumps(asdict(value)))


JOINTS_OF_BATCH = {  # parameters of a step for the joints of a batch
    "name": lambda wildcards: wildcards.sampling,
    "sampling": lambda wildcards: sampling_of(wildcards).parameters(),
    "base": lambda wildcards: plain(STUDY.base_joint),
    "start": first_joint,
    "stop": joint_after,
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
        **asks(of_joints),
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
