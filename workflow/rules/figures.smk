# From the tables and stresses to the figures, and the summary at the end.
FIGURE_SPECS = figures_of(STUDY)


def case_shown(wildcards):
    case = FIGURE_SPECS[wildcards.figure].case
    return read_of([case] if case else [])


rule figure:
    input:
        code=LIMIT
        + READING
        + sources(
            "sidmacib/envelope.py",
            "analysis/weights.py",
            *(
                f"analysis/figures/{name}.py"
                for name in ("catalogue", "curves", "draw", "material")
            ),
            *(f"analysis/figures/{name}.py" for name in ("models", "side_by_side", "style")),
            "analysis/figures/stress_maps.py",
            "analysis/models.py",
            "analysis/published.yaml",
            "workflow/solvers.py",
        ),
        tables=[
            rules.capacity.output[0],
            rules.validation.output[0],
            rules.models.output[0],
        ],
        case=case_shown,
    output:
        png=f"{RESULTS}/figures/{{figure}}.png",
        pdf=f"{RESULTS}/figures/{{figure}}.pdf",
    log:
        f"{RESULTS}/logs/figures/{{figure}}.log",
    params:
        study=STUDY.figures_json(),
    message:
        "Draw {wildcards.figure}"
    shell:
        f"{PYTHON} -m analysis.figures.draw {{wildcards.figure:q}} {{params.study:q}}"
        " --tables {input.tables:q} --case {input.case:q} --output {output:q} > {log:q} 2>&1"


rule summary:
    input:
        expand(rules.figure.output, figure=FIGURE_SPECS),
        code=sources("analysis/summary.py", "analysis/fit.py"),
        tables=[
            rules.validation.output[0],
            rules.fit.output.fit,
            rules.fit.output.best,
            rules.capacity.output[0],
        ],
    output:
        f"{RESULTS}/summary.txt",
    log:
        f"{RESULTS}/logs/summary.log",
    params:
        results=RESULTS,
    message:
        "Sum up"
    shell:
        f"{PYTHON} -m analysis.summary {{output:q}} {{params.results:q}} {{input.tables:q}}"
        " > {log:q} 2>&1"
