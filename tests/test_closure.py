"""What code a step runs is read from the code."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT
from workflow.planning.snakefile import plan_of

from workflow.configuration import read_study
from workflow.engines import ENGINES
from workflow.run import closure as module
from workflow.run.closure import closure, code_digest

TRACE = """
import sys
opened = set()
sys.addaudithook(
    lambda event, args: opened.add(str(args[0])) if event == "open" and args[0] else None
)
from workflow.run.job import run_job
import json, pathlib
run_job(json.loads(pathlib.Path(sys.argv[1]).read_text()))
print("\\n".join(sorted(
    name for name, m in sys.modules.items()
    if (getattr(m, "__file__", None) or "").startswith(sys.argv[2] + "/")
    and ".venv" not in m.__file__
)))
print("--")
print("\\n".join(sorted(name for name in opened if name.startswith(sys.argv[2] + "/"))))
"""


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A project of four modules."""
    monkeypatch.setattr(module, "ROOT", tmp_path)
    for name in ("_imports", "_tree", "_tree_digest", "_content_digest", "closure", "source"):
        monkeypatch.setattr(module, name, getattr(module, name).__wrapped__)
    (tmp_path / "workflow").mkdir()
    for name, text in {
        "__init__": "",
        "a": "import workflow.b",
        "b": "def f():\n    from . import c\n",
        "c": "import numpy",
        "d": "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    import workflow.c\n",
    }.items():
        (tmp_path / f"workflow/{name}.py").write_text(text)
    return tmp_path


def test_imports_are_followed_into_functions_and_relative_ones(project: Path) -> None:
    assert module.closure("workflow.a") == {"workflow", "workflow.a", "workflow.b", "workflow.c"}


def test_imports_for_type_checkers_do_not_count(project: Path) -> None:
    assert module.closure("workflow.d") == {"workflow", "workflow.d"}


def test_an_edit_changes_the_digest_of_what_runs_it_and_of_nothing_else(project: Path) -> None:
    before = {name: module.code_digest([f"workflow.{name}"]) for name in "abcd"}
    (project / "workflow/c.py").write_text("import numpy\nx = 1")
    changed = {name for name in "abcd" if module.code_digest([f"workflow.{name}"]) != before[name]}
    assert changed == {"a", "b", "c"}


def test_a_comment_changes_nothing(project: Path) -> None:
    before = module.code_digest(["workflow.a"])
    (project / "workflow/c.py").write_text("# why\n\nimport  numpy\n")
    assert module.code_digest(["workflow.a"]) == before


def test_data_files_count_by_content(project: Path) -> None:
    (project / "data.yaml").write_text("a: 1")
    before = module.code_digest(["workflow.a"], ["data.yaml"])
    (project / "data.yaml").write_text("a: 2")
    assert module.code_digest(["workflow.a"], ["data.yaml"]) != before


def test_models_do_not_depend_on_each_other_nor_on_the_schema_or_the_figures() -> None:
    static, limit = closure("workflow.solvers.static"), closure("workflow.solvers.limit")
    assert "sidmacib.mechanics.limit" not in static
    assert "sidmacib.mechanics.static.model" not in limit
    for step in ("workflow.steps.engine", "workflow.steps.solve"):
        assert not any(name.startswith(("workflow.schema", "analysis")) for name in closure(step))
    assert code_digest(["workflow.solvers.static"]) != code_digest(["workflow.solvers.limit"])


def test_engines_do_not_depend_on_each_others_scripts_and_templates() -> None:
    study = read_study({"samples": {"n3": {"locks": 3}}, "meshes": [0.03], "eccentricities": [0]})
    jobs = plan_of(study).jobs
    yade, liggghts = (jobs[f"{name}/n3-mesh0.03-e0a"] for name in ("yade", "liggghts"))
    assert "templates/yade.py.j2" in yade.files
    assert "templates/liggghts.py.j2" not in yade.files
    assert not any("liggghts" in name for name in yade.modules)
    assert not any("yade" in name for name in liggghts.modules)


@pytest.mark.parametrize("model", ["static", "limit"])
def test_what_a_run_imports_and_reads_is_in_its_closure(tmp_path: Path, model: str) -> None:
    study = read_study(
        {
            "samples": {"n3": {"locks": 3}},
            "meshes": [0.03],
            "eccentricities": [0],
            "models": ["static", "limit"],
            "dem": {"engines": []},
            "results": str(tmp_path),
        }
    )
    job = plan_of(study).jobs[f"{model}/batch"]
    _assert_covered(job, tmp_path)


def _assert_covered(job, results: Path) -> None:
    plan = results / "plan.json"
    plan.write_text(json.dumps(job.plan(job.digest(), results)))
    found = subprocess.run(
        [sys.executable, "-c", TRACE, str(plan), str(ROOT)],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=True,
        timeout=300,
    ).stdout
    modules, _, files = found.partition("--")
    known = closure("workflow.run.job") | closure(job.step)
    known = known.union(*map(closure, job.modules))
    run = {name for name in modules.split() if name.split(".")[0] in module.PACKAGES}
    assert run <= known
    data = {
        str(Path(name).relative_to(ROOT))
        for name in files.split()
        if not name.endswith((".py", ".pyc", ".nbi", ".nbc"))
        and "/.venv/" not in name
        and "__pycache__" not in name
    }
    assert data <= set(job.files)


@pytest.mark.engine
@pytest.mark.parametrize("model", ENGINES)
def test_what_an_engines_job_imports_and_reads_is_in_its_closure(
    tmp_path: Path, model: str
) -> None:
    study = read_study(
        {
            "samples": {"n2": {"locks": 2}},
            "meshes": [0.04],
            "eccentricities": [0],
            "sidmacib": {"reductions": ["none"]},
            "assembly": {"pieces": "elastic" if ENGINES[model].elastic else "rigid"},
            "dem": {"engines": [model]},
            "results": str(tmp_path),
        }
    )
    _assert_covered(plan_of(study).jobs[f"{model}/n2-mesh0.04-e0a"], tmp_path)
