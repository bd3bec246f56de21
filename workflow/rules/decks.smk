# Decks for 3DEC, and results that came back from it.
rule decks:
    input:
        code=MODEL_SOURCES
        + sources(
            *(f"workflow/{name}.py" for name in ("cases", "render", "study", "threedec")),
            "templates/3dec.dat.j2",
        ),
    output:
        [f"{deck_folder(RESULTS, name)}/joint.dat" for name in decks(STUDY)],
    log:
        f"{RESULTS}/logs/decks.log",
    params:
        study=STUDY.pieces_json(),
        results=RESULTS,
    message:
        "Write decks for 3DEC"
    shell:
        f"{PYTHON} -m workflow.threedec write {{params.study:q}} {{params.results:q}} > {{log:q}} 2>&1"


rule read_3dec:
    input:
        code=MODEL_SOURCES
        + sources(*(f"workflow/{name}.py" for name in ("cases", "results", "study", "threedec"))),
        returned=f"{deck_folder(RESULTS, '{case}')}/results.txt",
    output:
        expand("{folder}/{file}", folder=case_folder(RESULTS, "3dec", "{case}"), file=CASE_FILES),
    log:
        f"{RESULTS}/logs/3dec/{{case}}.log",
    params:
        study=STUDY.pieces_json(),
        results=RESULTS,
    message:
        "Read what 3DEC printed for {wildcards.case}"
    shell:
        f"{PYTHON} -m workflow.threedec read {{params.study:q}} {{params.results:q}} {{wildcards.case}}"
        " > {log:q} 2>&1"
