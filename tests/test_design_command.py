"""The key ``design`` of a structure's file, and the command that answers it."""

import json
import re
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from command_runner import run as command
from conftest import ROOT
from structures import read_structure

from sidmacib import InfeasibleError, limit_load, static_peak
from sidmacib.design.blocking import conflict, order_of
from sidmacib.design.designed import design_of
from sidmacib.design.direction import RowSearch, choice_of
from sidmacib.design.file import designed, read_task, task_of
from sidmacib.structure.files.structure_file import structure_of
from sidmacib.structure.structure import refined


def two_blocks() -> dict[str, Any]:
    """A block on a base; one lock would do in limit analysis, not in the static model."""
    force = {"block": "block", "at": [0.2, 0, 0.05], "direction": [0, 1, 0]}
    return {
        "blocks": {
            "base": {"low": [0, 0, -0.3], "high": [0.4, 0.6, 0], "fixed": True},
            "block": {"low": [0, 0, 0], "high": [0.4, 0.6, 0.3]},
        },
        "interfaces": {"friction": 0.3},
        "design": {
            "locks": {"width": 0.05, "height": 0.02},
            "cases": {"push": {"force": force, "newtons": 2000}},
        },
    }


def run(path: Path, *more: str) -> tuple[int, dict[str, Any]]:
    result = command("design", str(path), "--quiet", "--format", "json", *more)
    assert "Traceback" not in result.output
    return result.exit_code, json.loads(result.stdout)


def test_strength_is_raised_until_the_static_model_carries_the_cases() -> None:
    notes: list[str] = []
    found = design_of(task_of(two_blocks()), notes.append)
    assert found.passes
    assert (found.cost, found.bound) == (2.0, 1.0)
    assert max(found.demand.values()) > 1.0
    assert any("static, peak carries 0.9" in note for note in notes)


def test_permanent_loads_press_the_joints_of_a_design() -> None:
    """Friction alone then carries the push: 0.3 times 1413 N and 12,000 N."""
    given = two_blocks()
    task = task_of({**given, "permanent": [{"surcharge": {"pascals": 50_000}}]})
    found = design_of(task, lambda _: None)
    assert found.passes
    assert found.cost == 0.0
    assert designed(task, found.choice)["permanent"] == [{"surcharge": {"pascals": 50_000}}]


def test_the_command_says_no_and_why_where_a_check_fails(path: Path) -> None:
    given = two_blocks()
    given["design"]["raised"] = 0
    path.write_text(yaml.safe_dump(given))
    code, answer = run(path)
    assert code == 1
    words = "FAIL: the best design found, of 1 load-bearing locks in 1 of 1 interfaces"
    assert answer["verdict"] == "no" and answer["answer"].startswith(words)
    assert "static, peak, push: 0.9" in answer["answer"]
    assert "first failure" not in answer["answer"]


@pytest.mark.long
@pytest.mark.parametrize(("length", "placed"), [(1.2, False), (0.6, True)])
def test_a_block_is_not_pushed_along_grooves_that_are_closed(length: float, placed: bool) -> None:
    """Locks along x in a base that goes on behind the block at both ends, or at one."""
    given = two_blocks()
    given["blocks"] = {  # and a roof without friction
        "base": {"low": [-0.4, 0, -0.3], "high": [length, 0.6, 0], "fixed": True},
        "roof": {"low": [-0.4, 0, 0.3], "high": [1.2, 0.6, 0.5], "fixed": True},
        "block": {"low": [0.2, 0, 0], "high": [0.6, 0.6, 0.3]},
    }
    given["interfaces"]["friction"] = 0.0
    given["design"] |= {"angles": [0], "between": [["base", "block"]]}
    task = task_of(given)
    if placed:
        (along,) = design_of(task).order.steps.values()
        assert along == pytest.approx((-1.0, 0.0, 0.0))
    else:
        with pytest.raises(InfeasibleError, match="leave every block a way to its place"):
            design_of(task)


def test_the_static_model_decides_less_its_mesh_error() -> None:
    design = design_of(task_of(two_blocks()))
    (check,) = (check for check in design.checks if check.decides and "static" in check.model)
    plain = designed(design.task, design.choice)
    problem = structure_of(plain)
    fine = static_peak(refined(problem.assembly), problem.loads)
    assert check.factor is not None and check.factor < fine.peak.load / 2000.0
    assert "less its mesh error" in check.note


def test_what_is_written_is_a_structure_with_the_factors_of_the_checks(path: Path) -> None:
    path.write_text(yaml.safe_dump(two_blocks()))
    output = path.with_name("designed.yaml")
    code, answer = run(path, "--output", str(output))
    assert code == 0
    assert answer["answer"].startswith("PASS: 2 load-bearing locks")
    problem = read_structure(output)
    assert len(problem.assembly.pieces) == 2 + 5
    (limit,) = [row for row in answer["checks"] if row["model"] == "limit"]
    assert limit_load(*problem, friction=True).load == pytest.approx(2000 * limit["factor"])
    (row,) = answer["locks"]
    assert 0.0 < row["utilisation"] < 1.0
    (step,) = answer["order_of_placing"]
    assert (step["block"], step["moves_along"]) == ("block", "0 0 -1")


@pytest.mark.study
def test_rows_get_more_locks_where_no_greater_load_can_be_demanded() -> None:
    """Weight decides in the design's model, and the static model breaks one lock in each row."""
    found = design_of(read_task(ROOT / "tests/cases/design_exists.yaml"))
    assert found.passes
    assert [row and row.working for row in found.choice] == [2, 2]
    assert found.cost == 4.0
    least = min(check.factor or 0.0 for check in found.checks if check.decides)
    assert least == pytest.approx(1.012, abs=2e-3)
    factors = {(check.case, check.model): check.factor for check in found.checks}
    for case in ("px", "py"):
        peak, first = (factors[case, f"static, {end}"] for end in ("peak", "first failure"))
        assert peak is not None and first is not None and peak >= first


def test_the_first_failure_may_decide() -> None:
    given = two_blocks()
    given["design"]["first_failure"] = True
    found = design_of(task_of(given))
    deciding = {check.model for check in found.checks if check.decides}
    assert "static, first failure" in deciding
    assert "static, peak" not in deciding


def test_more_than_there_is_room_for_is_refused_with_the_largest_factor() -> None:
    given = two_blocks()
    given["design"]["cases"]["push"]["newtons"] = 100_000
    words = r'even with every possible lock, load case "push" reaches a factor of 0\.\d+ '
    with pytest.raises(InfeasibleError, match=words):
        design_of(task_of(given))


@pytest.mark.long
def test_rows_that_lock_a_block_in_are_refused_and_no_others_are_missed() -> None:
    """A block between a floor and two walls, pushed so that all want locks that block it in."""
    given = two_blocks()
    given["blocks"]["wall"] = {"low": [0.4, 0, 0], "high": [0.6, 0.6, 0.3], "fixed": True}
    given["blocks"]["other"] = {"low": [-0.2, 0, 0], "high": [0, 0.6, 0.3], "fixed": True}
    given["interfaces"]["friction"] = 0.0
    at = {"block": "block", "at": [0.2, 0.3, 0.15]}
    given["design"]["cases"] = {
        "up": {"force": {**at, "direction": [0, 0, 1]}, "newtons": 3500},
        "side": {"force": {**at, "direction": [0, 1, 0]}, "newtons": 2500},
    }
    given["design"]["locks"]["most"] = 2
    given["design"] |= {"angles": [0, 90], "buildable": False, "raised": 0}
    task = task_of(given)
    structure = task.structure
    free = design_of(task)
    assert free.order.stuck
    assert conflict(structure.assembly, structure.sites, free.choice)
    # Whatever carries both pushes locks the block in.
    search, carrying = RowSearch(structure, 1.0), 0
    options = [
        [None, *(k for k, s in enumerate(structure.site_of) if s == site)]
        for site in range(len(structure.sites))
    ]
    for numbers in product(*options):
        taken = np.zeros(len(structure.layouts))
        taken[[k for k in numbers if k is not None]] = 1.0
        if structure.costs @ taken >= free.cost and search.carries(taken):
            carrying += 1
            choice = choice_of(structure, taken)
            assert order_of(structure.assembly, structure.sites, choice).stuck
    assert carrying > 3
    given["design"]["buildable"] = True
    with pytest.raises(InfeasibleError, match="leave every block a way"):
        design_of(task_of(given))


@pytest.mark.parametrize(
    ("keys", "value", "words"),
    [
        ("cases", {}, "design.cases: an empty mapping is not allowed"),
        ("cases.push.newtons", -1, "design.cases.push.newtons: -1 is not allowed"),
        ("cases.push.over_weight", 1, "design.cases.push: must have either newtons or"),
        ("cases.push.tilt", 1, "design.cases.push.tilt: unknown key"),
        ("cases.push.force.block", "x", "design.cases.push.force.block: 'x' is"),
        ("locks.width", 0, "design.locks.width.1: 0 is not allowed"),
        (
            "locks.height",
            0.6,
            "design.locks.height: 0.6 .* less than 0.6 m, as base is 0.3 m deep there",
        ),
        ("locks.width", [], "design.locks.width: an empty list"),
        ("locks.inner", {"cohesion": 0}, "design.locks.cohesion: 0.0 is not allowed"),
        (
            "locks.width",
            0.3,
            "design: no dry interface of two convex blocks has room for the locks",
        ),
        ("angles", "all", "design.angles: 'all' is not allowed; it must be a list"),
        ("runs", [[0, 0, 0]], "design.runs.1: "),
        ("weights", {"number": 0}, "design.weights: one must be more than 0"),
        ("factor", 0, "design.factor: 0 is not allowed"),
        ("buildable", "yes", "design.buildable: 'yes' is not allowed"),
        ("between", [["base", "x"]], "design.between: 'base and x' is not allowed"),
        ("option", "option9", "design.option: 'option9' is not allowed"),
        ("most", 3, "design.most: unknown key"),
    ],
)
def test_a_fault_names_its_key(path: Path, keys: str, value: Any, words: str) -> None:
    given = two_blocks()
    inside, (*outer, last) = given["design"], keys.split(".")
    for key in outer:
        inside = inside[key]
    inside[last] = value
    path.write_text(yaml.safe_dump(given))
    result = command("design", str(path))
    assert result.exit_code == 2
    assert re.fullmatch(f"Error: {words}.*\n", result.stderr)


def test_a_file_with_locks_or_without_a_design_is_refused() -> None:
    given = two_blocks()
    with pytest.raises(ValueError, match=r"^locks: must not be there"):
        task_of(given | {"locks": []})
    del given["design"]
    with pytest.raises(ValueError, match=r"^design: missing"):
        task_of(given)


def test_a_design_follows_the_blocks_as_a_verdict_does(tmp_path: Path) -> None:
    """A tower that rigid blocks would let carry 1256 N; its foot gives way at 1123 N."""
    law = {"height": 0.02, "width": 0.05, "most": 8}
    inner = {"cohesion": 8e4, "tensile_strength": 3.7e5}
    cases = {"push": {"acceleration": [1, 0, 0], "newtons": 1200}}
    given = {
        "blocks": {
            "base": {"low": [-1, 0, -1], "high": [1, 1, 0], "fixed": True},
            "block": {"low": [-0.2, 0, 0], "high": [0.2, 0.4, 4]},
        },
        "interfaces": {"friction": 0.6},
        "design": {"cases": cases, "locks": {**law, "inner": inner}},
    }
    path = tmp_path / "tower.yaml"
    path.write_text(json.dumps(given))
    found = command("design", str(path))
    assert found.exit_code == 1
    assert "FAIL" in found.output and "static, peak, push: 0.93" in found.output
