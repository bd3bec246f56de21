"""What code a step runs is read from the code; what importing costs."""

import json
import re
from pathlib import Path
from typing import Any

import pytest
from conftest import a_case
from joints import sawn
from processes import ROOT, python
from small import COARSE

import sidmacib
from sidmacib import Direction, Elastic, Loading
from sidmacib.engines import ENGINES
from sidmacib.engines.render import sources
from sidmacib.models import MODELS
from workflow import step as module
from workflow.case import JointSubject
from workflow.configuration import read_study
from workflow.jobs import case_jobs
from workflow.step import closure, code_digest, source

TRACE = """
import importlib, json, pathlib, sys
opened = set()
sys.addaudithook(
    lambda event, args: opened.add(str(args[0])) if event == "open" and args[0] else None
)
name, arguments, outputs, root = json.loads(sys.argv[1])
outputs = {key: pathlib.Path(path) for key, path in outputs.items()}
assert importlib.import_module(name).run(arguments, {}, outputs) is None
print("\\n".join(sorted(
    name for name, m in sys.modules.items()
    if (getattr(m, "__file__", None) or "").startswith(root + "/") and ".venv" not in m.__file__
)))
print("--")
print("\\n".join(sorted(name for name in opened if name.startswith(root + "/"))))
"""


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A project of five modules."""
    monkeypatch.setattr(module, "ROOT", tmp_path)
    for name in ("_imports", "_functions", "_code_digest", "closure", "source"):
        monkeypatch.setattr(module, name, getattr(module, name).__wrapped__)
    (tmp_path / "workflow").mkdir()
    for name, text in {
        "__init__": "",
        "a": "import workflow.b",
        "b": "def f():\n    from . import c\n",
        "c": "import numpy",
        "e": 'm = importlib.import_module("workflow.c").x',
        "d": "import numpy",
    }.items():
        (tmp_path / f"workflow/{name}.py").write_text(text)
    return tmp_path


@pytest.mark.usefixtures("project")
@pytest.mark.parametrize(("name", "known"), [("a", "abc"), ("e", "ce")])
def test_imports_are_followed_everywhere(name: str, known: str) -> None:
    assert module.closure(f"workflow.{name}") == {"workflow", *(f"workflow.{n}" for n in known)}


def test_an_edit_changes_the_digest_of_what_runs_it_and_of_nothing_else(project: Path) -> None:
    before = {name: module.code_digest([f"workflow.{name}"]) for name in "abcd"}
    (project / "workflow/c.py").write_text("import numpy\nx = 1")
    changed = {name for name in "abcd" if module.code_digest([f"workflow.{name}"]) != before[name]}
    assert changed == {"a", "b", "c"}


def test_a_comment_an_empty_line_and_the_order_of_a_set_do_not_change_the_digest(
    project: Path,
) -> None:
    text = 'def f(x):\n    return x in {"one", "two", "three"}'
    digests = set()
    for lines in (text, f"# why\n\n{text}  # what for\n"):
        (project / "workflow/c.py").write_text(lines)
        for seed in "12":
            code = "import workflow.step as s; print(s.code_digest(['workflow.c']))"
            place = f"import pathlib, sys; sys.path.insert(0, {str(ROOT)!r})"
            root = f"s.ROOT = pathlib.Path({str(project)!r})"
            asked = f"{place}; {code.replace('; ', f'; {root}; ', 1)}"
            digests.add(python("-c", asked, check=True, PYTHONHASHSEED=seed).stdout)
    assert len(digests) == 1


def test_models_do_not_depend_on_each_other_nor_on_the_schema_or_the_figures() -> None:
    static, limit = closure("sidmacib.models.static"), closure("sidmacib.models.limit")
    assert "sidmacib.mechanics.elastic" in static  # imported where it is needed
    assert "sidmacib.mechanics.limit" not in static
    assert "sidmacib.mechanics.limit" in closure("sidmacib.models.structure_static")
    assert "sidmacib.mechanics.static" not in limit
    for step in ("workflow.engine", "workflow.solve"):
        assert not any(name.startswith(("workflow.schema", "analysis")) for name in closure(step))
    assert code_digest(["sidmacib.models.static"]) != code_digest(["sidmacib.models.limit"])


def test_engines_do_not_depend_on_each_others_scripts_and_templates() -> None:
    yade, liggghts = (sources(ENGINES[name]) for name in ("yade", "liggghts"))
    assert "templates/yade.py.j2" in yade[1]
    assert "templates/liggghts.py.j2" not in yade[1]
    assert not any("liggghts" in name for name in yade[0])
    assert not any("yade" in name for name in liggghts[0])


RULE = re.compile(r"^rule (\w+):\n((?:\n| +.*\n)+)", re.MULTILINE)
RULES = {  # text of each rule that has a script, and the folder of its file
    match[1]: (path.parent, match[2])
    for path in ROOT.rglob("*.smk")
    if ".venv" not in path.parts
    for match in RULE.finditer(path.read_text())
}


@pytest.mark.parametrize("rule", RULES)
def test_a_rule_runs_again_when_what_its_script_imports_is_edited(rule: str) -> None:
    folder, text = RULES[rule]
    (script,) = re.findall(r'script:\n +"(.*)"', text)
    (step,) = re.findall(r'code=(?:lambda wildcards: )?code\(\s*"([\w.]+)"', text)
    assert source(step) == (folder / script).resolve()


@pytest.mark.long
@pytest.mark.parametrize("model", ["static", "limit"])
def test_what_a_run_imports_and_reads_is_in_its_closure(tmp_path: Path, model: str) -> None:
    study = read_study(COARSE | {"eccentricities": [0], "models": ["static", "limit"]})
    cases = [case.to_json() for case in case_jobs(study).batches[f"cases/{model}/batch"]]
    arguments = {"cases": cases, "module": MODELS[model].module}
    outputs = {name: f"{tmp_path}/{name}" for name in ("records", "nodes", "history")}
    modules = (str(MODELS[model].module), *JointSubject.modules)
    _assert_covered("workflow.solve", arguments, outputs, modules, ())


def _assert_covered(
    step: str,
    arguments: dict[str, Any],
    outputs: dict[str, str],
    modules: tuple[str, ...],
    files: tuple[str, ...],
) -> None:
    """Run a step and hold what it imports and opens against what its digest is made of."""
    asked = json.dumps([step, arguments, outputs, str(ROOT)])
    found = python("-c", TRACE, asked, check=True, PYTHONPATH=str(ROOT)).stdout
    imported, _, opened = found.partition("--")
    known = frozenset[str]().union(*map(closure, (step, *modules)))
    assert {name for name in imported.split() if name.split(".")[0] in module.PACKAGES} <= known
    data = {
        str(Path(name).relative_to(ROOT))
        for name in opened.split()
        if not name.endswith((".py", ".pyi", ".pyc", ".nbi", ".nbc"))
        and "/.venv/" not in name
        and "__pycache__" not in name
    }
    assert data <= set(files)


@pytest.mark.engine
@pytest.mark.parametrize("model", ENGINES)
def test_what_an_engines_job_imports_and_reads_is_in_closure(tmp_path: Path, model: str) -> None:
    joint = sawn(2, elastic=Elastic(1e10) if ENGINES[model].elastic else None)
    case = a_case(model, joint, Loading(Direction(0.0)), 0.04)
    arguments = {"case": case.to_json(), "time_limit": 300.0, "last_try": 1}
    outputs = {"record": f"{tmp_path}/record.json", "result": f"{tmp_path}/result.json"}
    modules, files = sources(ENGINES[model])
    _assert_covered("workflow.engine", arguments, outputs, (*modules, *JointSubject.modules), files)


# --- what importing the package costs, and what it offers ----------------------------------------
SOLVERS = {"cvxpy", "numba", "matplotlib", "pandas", "scipy"}
HEAVY = SOLVERS | {"highspy", "clarabel", "pyarrow", "pydantic", "snakemake", "jinja2", "yaml"}
DESCRIPTION = (
    *("errors", "joint", "joint.pieces", "joint.loading", "validation"),
    "contact_points",
    *("mechanics.assembly", "mechanics.equilibrium", "mechanics.contact_law"),
)


def loaded_by(code: str) -> set[str]:
    """Top-level modules that are loaded once ``code`` has run in a new interpreter."""
    show = "import sys; print(*{name.partition('.')[0] for name in sys.modules})"
    return set(python("-c", f"{code}\n{show}", check=True).stdout.split())


@pytest.mark.parametrize(
    "code",
    [
        "import sidmacib; sidmacib.Joint; sidmacib.assemble; sidmacib.ContactOption",
        "; ".join(f"import sidmacib.{name}" for name in DESCRIPTION),
        "import sidmacib; dir(sidmacib)",
    ],
)
def test_describing_a_joint_loads_nothing_heavier_than_numpy(code: str) -> None:
    assert loaded_by(code) & HEAVY == set()


@pytest.mark.parametrize("module", ["workflow.cases", "workflow.case", "sidmacib.models"])
def test_planning_imports_no_solver_and_no_table(module: str) -> None:
    found = loaded_by(f"import {module}")
    assert not found & (SOLVERS | {"pyarrow", "jinja2"})
    assert module != "workflow.case" or "pydantic" not in found


@pytest.mark.long
@pytest.mark.parametrize(
    ("arguments", "seconds", "allowed"),
    [
        (["--help"], 0.4, set()),
        (["capacity", "-m", "safe", "-m", "law"], 1.0, {"scipy", "numba"}),
    ],
)
def test_a_quick_answer_loads_no_solver_of_others(
    arguments: list[str], seconds: float, allowed: set[str]
) -> None:
    code = (
        "import sys, time\nfrom sidmacib.command.main import main\n"
        "try: main(sys.argv[1:])\nexcept SystemExit as end: assert not end.code\n"
        "print(time.process_time(), *{m.partition('.')[0] for m in sys.modules}, file=sys.stderr)"
    )
    found = python("-c", code, *arguments, check=True, PYTHONPATH=str(ROOT))
    time, *loaded = found.stderr.split()
    assert SOLVERS & {*loaded} <= allowed
    assert float(time) < 4.0 * seconds  # a busy machine takes longer


@pytest.mark.long
def test_only_what_compiled_code_prints_meanwhile_is_dropped() -> None:
    code = """import ctypes
from sidmacib.mechanics.optimisation import silent
c = ctypes.CDLL(None)
print("before")
with silent():
    c.printf(b"noise in the buffer\\n")
    c.puts(b"more noise")
print("after")
c.puts(b"heard again")
"""
    printed = python("-c", code, check=True).stdout
    assert set(printed.split("\n")) == {"before", "after", "heard again", ""}


def test_every_public_name_is_there_and_listed() -> None:
    assert set(sidmacib.__all__) <= set(dir(sidmacib))
    for name in sidmacib.__all__:
        assert getattr(sidmacib, name) is not None


@pytest.mark.study
def test_type_checkers_know_the_types_of_public_names(tmp_path: Path) -> None:
    (tmp_path / "user.py").write_text(
        "import sidmacib\nfrom sidmacib import Joint, assemble, limit_load\n"
        + "".join(f"sidmacib.{name}\n" for name in sidmacib.__all__)
        + "reveal_type(assemble(Joint(3), 0.02))\nreveal_type(sidmacib.Direction(0.5).shear)\n"
    )
    strict = ("--strict", "--config-file=", "user.py", "--cache-dir", ".cache")
    skipped = ("--follow-imports=silent", "--ignore-missing-imports")
    found = python("-m", "mypy", *strict, *skipped, cwd=tmp_path, MYPYPATH=str(ROOT)).stdout
    assert 'Revealed type is "sidmacib.mechanics.assembly.Assembly"' in found
    assert 'float"' in found
    assert "error" not in found
