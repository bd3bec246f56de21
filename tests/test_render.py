"""Rendered scripts, and the data and modules beside them."""

import ast
import sys
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
from joints import loaded
from processes import python
from stack import tilted_stack
from structures import on_ground

from sidmacib import Elastic, Joint
from sidmacib.engines import ENGINES, Engine, Numerics
from sidmacib.engines.render import DATA_FILE, MODULES, write_script
from sidmacib.engines.run import guide_of, run_engine
from sidmacib.engines.scripts.assembly import Guide, read_assembly
from sidmacib.problem import Problem
from sidmacib.structure.loads import acceleration


@pytest.fixture(params=ENGINES)
def engine(request: pytest.FixtureRequest) -> Engine:
    return ENGINES[request.param]


@pytest.fixture
def case() -> Problem:
    return loaded(Joint(3), 0.5, 0.02)


def written(engine: Engine, case: Problem, folder: Path, guide: Guide | None = None) -> Path:
    write_script(engine, *case, Numerics(), "three locks", folder, guide)
    return folder


def test_a_script_is_python_beside_its_modules_and_needs_none_of_this_project(
    engine: Engine, case: Problem, tmp_path: Path
) -> None:
    text = (written(engine, case, tmp_path) / engine.script).read_text()
    ast.parse(text)
    assert "{{" not in text and "{%" not in text
    assert "three locks" in text
    copied = list((tmp_path / MODULES.name).rglob("*.*"))
    assert {path.parent.name for path in copied} == {"scripts", engine.name}
    for path in copied:
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and node.level:
                folder = path.parents[node.level - 1]
                assert folder / f"{node.module.replace('.', '/')}.py" in copied
            elif isinstance(node, ast.ImportFrom):
                assert node.module and node.module.split(".")[0] in sys.stdlib_module_names


def test_the_modules_run_without_this_project(tmp_path: Path, case) -> None:
    folder = written(ENGINES["liggghts"], case, tmp_path)
    call = "import engines.liggghts.run, sys; print({'numpy', 'sidmacib'} & set(sys.modules))"
    found = python("-S", "-c", call, cwd=folder, check=True)
    assert found.stdout.strip() == "set()"


def test_a_script_reads_back_what_was_written(engine: Engine, tmp_path: Path) -> None:
    assembly, loads = tilted_stack(2)
    first, second = assembly.faces
    smooth = replace(first, material=replace(first.material, friction=0.1))
    assembly = replace(assembly, faces=(smooth, second))
    write_script(engine, assembly, loads, Numerics(), "stack", tmp_path)
    tree = ast.parse((tmp_path / engine.script).read_text())
    call = next(
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "read_assembly"
    )
    materials = ast.literal_eval(call.keywords[0].value)
    read = read_assembly(str(tmp_path / DATA_FILE), materials)
    # Two faces of one kind keep different materials.
    assert [face.material.friction for face in read.faces] == [0.1, 0.5]
    assert [face.material.friction for face in assembly.faces] == [0.1, 0.5]
    assert np.array([n.position_m for n in read.nodes]) == pytest.approx(assembly.nodes.position)
    assert [[*p.force_N, *p.moment_Nm] for p in read.pieces] == loads.permanent.tolist()
    assert [[*part.force, *part.moment_m] for part in read.loads] == loads.variable[1:].tolist()
    assert read.permanent_N == pytest.approx(loads.scale)


@pytest.mark.parametrize("key", [field.name for field in fields(Numerics)])
def test_an_engine_reads_the_numerics_that_change_its_script_and_no_others(
    engine: Engine, key: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sidmacib.engines.run.execute", lambda *_: None)
    value = getattr(Numerics(), key)
    other = not value if isinstance(value, bool) else type(value)(2 * value)

    joint = Joint(3, elastic=Elastic(1e10) if engine.elastic else None)
    problems = [loaded(joint, 0.5)]
    if not engine.elastic:
        blocks = on_ground(0.5)
        problems.append(Problem(blocks, acceleration(blocks, (1.0, 0.0, 0.0))))

    def scripts(numerics: Numerics) -> list[str]:
        found = []
        for problem in problems:
            run_engine(engine, problem, numerics, "what is tested", tmp_path, 1.0)
            found.append((tmp_path / engine.script).read_text())
        return found

    one, two = scripts(Numerics()), scripts(replace(Numerics(), **{key: other}))
    assert (one != two) == (key in engine.reads)


@pytest.mark.parametrize("name", [name for name in ENGINES if "guided" in ENGINES[name].reads])
def test_the_static_model_guides_the_search(name: str, case: Problem, tmp_path: Path) -> None:
    guide = guide_of(*case)
    assert guide is not None
    texts = [
        (written(ENGINES[name], case, tmp_path, each) / ENGINES[name].script).read_text()
        for each in (guide, None)
    ]
    assert f"first_failure_N={guide.first_failure_N}," in texts[0]
    assert f"peak_N={guide.peak_N}," in texts[0]
    assert "Guide" not in texts[1]
