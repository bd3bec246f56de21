# Included if the study has earthquakes: each record moves a structure at all factors; a table, and fragility.
from workflow.case import EarthquakeSubject

SHAKEN = [below(f"{job}/{BATCH_RECORDS}") for job in JOBS.earthquakes]


rule earthquake:
    output:
        records=below("{job}/records.jsonl"),
    log:
        below("logs/{job}.log"),
    benchmark:
        below("benchmarks/{job}.tsv")
    wildcard_constraints:
        job=one_of(JOBS.earthquakes),
    resources:
        **asks(lambda wildcards: solved_resources(JOBS.earthquakes[wildcards.job])),
    params:
        cases=lambda wildcards: [case.to_json() for case in JOBS.earthquakes[wildcards.job]],
        code=code("workflow.earthquakes", EarthquakeSubject.modules),
    message:
        "{wildcards.job}"
    script:
        "../earthquakes.py"


rule fragility:
    input:
        records=SHAKEN,
    output:
        earthquakes=shown("tables/earthquakes.csv"),
        fragility=shown("tables/fragility.csv"),
    log:
        below("logs/fragility.log"),
    group:
        "tables"
    params:
        code=code("analysis.tables.earthquakes", EarthquakeSubject.modules),
    message:
        "Tabulate the earthquakes, and fit fragility"
    script:
        "../../analysis/tables/earthquakes.py"


rule fragility_figures:
    input:
        **dict(rules.fragility.output.items()),
    output:
        figures=[
            shown(f"figures/fragility-{name}.{kind}")
            for name in STUDY.earthquakes
            for kind in ("png", "pdf")
        ],
    log:
        below("logs/fragility_figures.log"),
    group:
        "tables"
    params:
        code=code("analysis.figures.fragility"),
    message:
        "Draw fragility"
    script:
        "../../analysis/figures/fragility.py"


EARTHQUAKE_FILES = [*SHAKEN, *rules.fragility.output, *rules.fragility_figures.output]
SHOWN_TABLES |= dict(rules.fragility.output.items())
