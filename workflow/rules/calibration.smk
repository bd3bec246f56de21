# Which geometry fits the published numbers: see `make calibrate`. The confirmation between the two
# rules is a study of its own, whose configuration the first one writes.
CALIBRATION = f"{RESULTS}/calibration"


rule calibrate:
    input:
        code=SOLVER_SOURCES
        + READING
        + sources(
            *(f"analysis/{name}" for name in ("calibration.py", "weights.py", "published.yaml")),
        ),
    output:
        map=f"{CALIBRATION}/map.csv",
        curves=f"{CALIBRATION}/curves.csv",
        config=f"{CALIBRATION}/best.yaml",
    log:
        f"{RESULTS}/logs/calibration.log",
    params:
        study=STUDY.calibration_json(),
        folder=CALIBRATION,
    message:
        "Try geometries with the static model"
    shell:
        f"{PYTHON} -m analysis.calibration {{params.study:q}} {{params.folder:q}} {{output:q}}"
        " > {log:q} 2>&1"


rule calibration_figure:
    input:
        code=sources(
            "analysis/calibration.py",
            "analysis/figures/calibration.py",
            "analysis/figures/style.py",
        ),
        tables=[rules.calibrate.output.map, rules.calibrate.output.curves],
    output:
        png=f"{RESULTS}/figures/calibration.png",
        pdf=f"{RESULTS}/figures/calibration.pdf",
    log:
        f"{RESULTS}/logs/figures/calibration.log",
    message:
        "Draw the misfit map"
    shell:
        f"{PYTHON} -m analysis.figures.calibration {{input.tables:q}} {{output:q}} > {{log:q}} 2>&1"


rule confirmation:
    input:
        rules.calibration_figure.output,
        code=READING
        + sources(
            *(f"analysis/{name}.py" for name in ("calibration", "confirmation", "weights")),
            "analysis/published.yaml",
        ),
        config=rules.calibrate.output.config,
        tables=[f"{CALIBRATION}/tables/{name}.csv" for name in ("capacity", "weights")],
    output:
        table=f"{TABLES}/calibration.csv",
        summary=f"{CALIBRATION}/best.txt",
    log:
        f"{RESULTS}/logs/confirmation.log",
    message:
        "Compare the best geometries"
    shell:
        f"{PYTHON} -m analysis.confirmation {{output:q}} {{input.config:q}} {{input.tables:q}}"
        " > {log:q} 2>&1"
