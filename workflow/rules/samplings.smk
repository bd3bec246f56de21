# Included if the study has samplings: batches of their joints, and a table of all batches.
from dataclasses import asdict

from workflow.planning.resources import sampling_resources

JOINTS = 64  # per batch of a sampling
STARTS = {  # the first joint of each batch, by sampling and number of the batch
    (name, f"{number:04}"): start
    for name, sampling in STUDY.samplings.items()
    for number, start in enumerate(range(0, sampling.joints, JOINTS))
}
OF_SAMPLINGS = [{"sampling": sampling, "batch": batch} for sampling, batch in STARTS]
WILDCARDS["sampling"] = OF_SAMPLINGS


JOINTS_OF_BATCH = {  # parameters of a step for the joints of a batch
    "name": lambda wildcards: wildcards.sampling,
    "sampling": lambda wildcards: asdict(sampling_of(wildcards).sampling()),
    "base": asdict(STUDY.base_joint),
    "start": first_joint,
    "stop": joint_after,
    "eccentricities": lambda wildcards: sampling_of(wildcards).eccentricities
    or STUDY.eccentricities,
    "resources": lambda wildcards: sampling_resources(
        joint_after(wildcards) - first_joint(wildcards)
    ),
}


rule sampling:
    input:
        plan=plan("sampling/{sampling}-{batch}"),
    output:
        joints=below("sampling/{sampling}-{batch}.parquet"),
    log:
        below("logs/sampling/{sampling}-{batch}.log"),
    wildcard_constraints:
        sampling=one_of(STUDY.samplings),
        batch="[0-9]+",
    group:
        "cases"
    resources:
        **asks("sampling/{sampling}-{batch}"),
    params:
        **JOINTS_OF_BATCH,
        step="workflow.steps.sampling",
        cells=lambda wildcards: sampling_of(wildcards).cells,
        limited=lambda wildcards: sampling_of(wildcards).limited,
        modules=("workflow.solvers.static", "workflow.solvers.limit"),
    message:
        "sampling: {wildcards.sampling}-{wildcards.batch}"
    shell:
        STEP


rule samplings:
    input:
        plan=plan("samplings"),
        batches=of_jobs(rules.sampling.rule),
    output:
        samplings=shown("tables/samplings.csv"),
    log:
        below("logs/samplings.log"),
    group:
        "tables"
    resources:
        **asks("samplings"),
    params:
        step="analysis.tables.samplings",
    message:
        "Join the batches of the samplings"
    shell:
        STEP
