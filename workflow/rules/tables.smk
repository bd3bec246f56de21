# From the cases' results to tables, figures and summary, and what is made on request.
CAPTIONS = {  # of what Snakemake's own report has, by the ending of a file
    ".csv": ("Tables", "table.rst"),
    ".png": ("Figures", "figure.rst"),
    ".html": ("Report", "report.rst"),
}


def in_report(names):
    """Paths of results; those that Snakemake's report shows are marked with category and caption."""
    for path in below(names):
        category, caption = CAPTIONS.get(Path(path).suffix, (None, None))
        if category is None:
            yield path
        else:
            yield report(
                path,
                category=category,
                caption=f"{CHECKOUT}/workflow/captions/{caption}",
                labels={"file": Path(path).name},
            )


for job in JOBS.values():
    if "/" not in job.name:

        rule:
            name:
                job.name
            input:
                plan=PLANS[job.name],
                others=below(job.inputs),
            output:
                list(in_report(job.outputs)),
            log:
                f"{RESULTS}/logs/{job.name}.log",
            group:
                # A group that fails loses all that it made, and this one may: it says what failed.
                None if job.name == "complete" else "tables"
            resources:
                mem_mb=lambda wildcards, attempt, name=job.name: memory(name, attempt),
                runtime=lambda wildcards, attempt, name=job.name: minutes(name, attempt),
                last_try=lambda wildcards, attempt: last_try(attempt),
                abreast=1,
            message:
                job.message
            shell:
                RUN
