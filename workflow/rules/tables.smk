# From the cases' results to the tables.
TABLES = f"{RESULTS}/tables"


def read_of(cases):
    """The files of ``cases`` that the analysis reads."""
    return [
        f"{case_folder(RESULTS, case.model, case.name)}/{name}"
        for case in cases
        for name in CASE_FILES
    ]


CASE_FOLDERS = [case_folder(RESULTS, case.model, case.name) for case in CASES.values()]


# Only what the tables depend on: other edits of the configuration do not run them again.
STUDY_JSON = STUDY.tables_json()
READING = sources(
    "analysis/reading.py",
    *(f"workflow/{name}.py" for name in ("cases", "configuration", "results", "study")),
)
LIMIT = MODEL_SOURCES + sources(
    *(f"sidmacib/{name}.py" for name in ("contact_points", "capacity", "revision"))
)


rule weights:
    input:
        read_of(CASES.values()),
        code=READING + sources("analysis/weights.py"),
    output:
        weights=f"{TABLES}/weights.csv",
        sums=f"{TABLES}/weight_sums.csv",
    log:
        f"{RESULTS}/logs/weights.log",
    params:
        cases=CASE_FOLDERS,
    message:
        "Read the locks' weights from the stresses"
    shell:
        f"{PYTHON} -m analysis.weights {{output:q}} {{params.cases:q}} > {{log:q}} 2>&1"


rule capacity:
    input:
        read_of(CASES.values()),
        code=READING
        + LIMIT
        + sources(
            *(f"analysis/{name}.py" for name in ("balance", "capacity", "weights")),
            "analysis/published.yaml",
        ),
        weights=rules.weights.output.weights,
    output:
        f"{TABLES}/capacity.csv",
    log:
        f"{RESULTS}/logs/capacity.log",
    params:
        study=STUDY_JSON,
        cases=CASE_FOLDERS,
    message:
        "Solve SiDMACIB and tabulate all capacities"
    shell:
        f"{PYTHON} -m analysis.capacity {{output:q}} {{params.study:q}} {{input.weights:q}}"
        " {params.cases:q} > {log:q} 2>&1"


rule models:
    input:
        read_of(CASES.values()),
        code=READING + sources("analysis/models.py", "analysis/weights.py"),
    output:
        f"{TABLES}/models.csv",
    log:
        f"{RESULTS}/logs/models.log",
    params:
        cases=CASE_FOLDERS,
    message:
        "Put the models beside each other"
    shell:
        f"{PYTHON} -m analysis.models {{output:q}} {{params.cases:q}} > {{log:q}} 2>&1"


rule fit:
    input:
        code=READING + LIMIT + sources("analysis/fit.py"),
        capacity=rules.capacity.output,
    output:
        fit=f"{TABLES}/fit.csv",
        best=f"{TABLES}/best_fit.csv",
    log:
        f"{RESULTS}/logs/fit.log",
    params:
        study=STUDY_JSON,
    message:
        "Fit SiDMACIB against the distinct elements"
    shell:
        f"{PYTHON} -m analysis.fit {{output:q}} {{params.study:q}} {{input.capacity:q}} > {{log:q}} 2>&1"


rule validation:
    input:
        code=READING
        + sources(
            *(f"analysis/{name}.py" for name in ("capacity", "fit", "validation")),
            "analysis/published.yaml",
        ),
        tables=[rules.capacity.output[0], rules.weights.output.weights, rules.fit.output.fit],
    output:
        f"{TABLES}/validation.csv",
    log:
        f"{RESULTS}/logs/validation.log",
    params:
        study=STUDY_JSON,
    message:
        "Compare with the published numbers"
    shell:
        f"{PYTHON} -m analysis.validation {{output:q}} {{params.study:q}} {{input.tables:q}}"
        " > {log:q} 2>&1"
