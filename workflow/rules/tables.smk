# From the cases' results to tables, figures and summary, and what is made on request.
for job in JOBS.values():
    if "/" not in job.name:

        rule:
            name:
                job.name
            input:
                plan=PLANS[job.name],
                others=below(job.inputs),
            output:
                below(job.outputs),
            log:
                f"{RESULTS}/logs/{job.name}.log",
            message:
                job.message
            shell:
                RUN
