# Jobs of which there are many of a kind: one for each case of an engine, or for each batch of a model
# that is solved in this process, or of a sampling.
OF_A_KIND = {}
for job in JOBS.values():
    if "/" in job.name:
        OF_A_KIND.setdefault(job.name.partition("/")[0], {})[job.name.partition("/")[2]] = job

for model, jobs in OF_A_KIND.items():
    first = next(iter(jobs.values()))
    outputs = [name.replace(first.name, f"{model}/{{job}}") for name in first.outputs]

    rule:
        name:
            model
        input:
            plan=lambda wildcards, model=model: PLANS[f"{model}/{wildcards.job}"],
            others=lambda wildcards, model=model: below(JOBS[f"{model}/{wildcards.job}"].inputs),
        output:
            below(outputs),
        log:
            f"{RESULTS}/logs/{model}/{{job}}.log",
        wildcard_constraints:
            job="|".join(map(re.escape, jobs)),
        group:
            "cases" if all(job.needs.short for job in jobs.values()) else None
        threads: max(job.threads for job in jobs.values())
        resources:
            mem_mb=lambda wildcards, attempt, model=model: memory(
                f"{model}/{wildcards.job}", attempt
            ),
            runtime=lambda wildcards, attempt, model=model: minutes(
                f"{model}/{wildcards.job}", attempt
            ),
            last_try=lambda wildcards, attempt: last_try(attempt),
            abreast=1,
        message:
            f"{model}: {{wildcards.job}}"
        shell:
            RUN


# A case that was solved in a batch has a folder of its own where one asks for it.
BATCH_OF = {
    case: job for job in JOBS.values() if job.step == "workflow.steps.solve" for case in job.finds
}
for model in {model for model, _ in BATCH_OF}:

    rule:
        name:
            f"{model}_case"
        input:
            plan=lambda wildcards, model=model: PLANS[BATCH_OF[model, wildcards.case].name],
            records=lambda wildcards, model=model: below(
                BATCH_OF[model, wildcards.case].outputs[:1]
            ),
        output:
            f"{RESULTS}/cases/{model}/{{case}}/result.json",
        log:
            f"{RESULTS}/logs/{model}/{{case}}.files.log",
        wildcard_constraints:
            case="|".join(re.escape(case) for own, case in BATCH_OF if own == model),
        message:
            f"{model}: files of {{wildcards.case}}"
        shell:
            f"PYTHONPATH={shlex.quote(CHECKOUT)} exec {shlex.quote(sys.executable)}"
            " -m workflow.steps.case_files {input.plan:q} {input.records:q} {output:q}"
            " > {log:q} 2>&1"
