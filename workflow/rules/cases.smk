# From a case's parameters to results: a pair of rules for each engine, with a job for each case, and
# one rule and job for all cases of each model that needs no engine.


def sources(*names):
    """Source files that a step is made of: editing one runs the step again."""
    return [f"{SOURCES}/{name}" for name in names]


MODEL_SOURCES = sources(
    *(f"sidmacib/{name}.py" for name in ("joint", "discretisation", "loading", "equilibrium"))
)


SOLVER_SOURCES = MODEL_SOURCES + sources(
    *(f"sidmacib/{name}.py" for name in ("capacity", "contact_law", "limit", "springs", "static")),
    *(f"workflow/{name}.py" for name in ("cases", "results", "solve", "solvers", "study")),
)


for engine in ENGINES.values():
    folder = case_folder(RESULTS, engine.name, "{case}")

    rule:
        name:
            f"render_{engine.name}"
        input:
            code=MODEL_SOURCES
            + sources(
                "sidmacib/contact_law.py",
                "sidmacib/springs.py",
                "sidmacib/vibration.py",
                "workflow/cases.py",
                "workflow/render.py",
                "workflow/study.py",
                f"templates/{engine.template}",
                "templates/joint.py.j2",
                "templates/results.py.j2",
            ),
        output:
            script=f"{folder}/{engine.script}",
            joint=f"{folder}/joint.json",
            case=f"{folder}/case.json",
        log:
            f"{RESULTS}/logs/{engine.name}/{{case}}.render.log",
        params:
            case=lambda wildcards, engine=engine: CASES[
                engine.name, wildcards.case
            ].model_dump_json(),
            folder=subpath(output.script, parent=True),
        message:
            "Render {wildcards.case}"
        shell:
            f"{PYTHON} -m workflow.render {{params.case:q}} {{params.folder:q}} > {{log:q}} 2>&1"

    rule:
        name:
            engine.name
        input:
            code=sources(*(f"workflow/{name}.py" for name in ("engines", "execute", "results"))),
            script=getattr(rules, f"render_{engine.name}").output.script,
            joint=getattr(rules, f"render_{engine.name}").output.joint,
        output:
            result=f"{folder}/result.json",
            history=f"{folder}/history.csv",
            nodes=f"{folder}/nodes.csv",
        log:
            f"{RESULTS}/logs/{engine.name}/{{case}}.log",
        benchmark:
            f"{RESULTS}/benchmarks/{engine.name}/{{case}}.tsv"
        threads: lambda wildcards, engine=engine: CASES[engine.name, wildcards.case].numerics.ranks
        resources:  # not params: another limit does not change results
            time_limit=int(STUDY.dem.time_limit),
        params:
            folder=subpath(output.result, parent=True),
            engine=engine.name,
        message:
            f"Run {engine.name} on {{wildcards.case}}"
        shell:
            f"{PYTHON} -m workflow.execute {{params.engine}} {{params.folder:q}}"
            " --time-limit {resources.time_limit} > {log:q} 2>&1"


for model in STUDY.models:
    OWN_FOLDERS = [case_folder(RESULTS, model, name) for own, name in CASES if own == model]

    rule:
        name:
            model
        input:
            code=SOLVER_SOURCES,
        output:
            expand("{folder}/{file}", folder=OWN_FOLDERS, file=CASE_FILES),
        log:
            f"{RESULTS}/logs/{model}.log",
        benchmark:
            f"{RESULTS}/benchmarks/{model}.tsv"
        params:
            model=model,
            study=STUDY.pieces_json(),
            results=RESULTS,
        message:
            f"Solve all cases of {model}"
        shell:
            f"{PYTHON} -m workflow.solve {{params.model}} {{params.study:q}} {{params.results:q}}"
            " > {log:q} 2>&1"
