"""The registry: models have the abilities that they state, and refuse the rest in one line."""

import importlib
import math
from dataclasses import fields, replace
from typing import Any

import pytest
from conftest import ROOT
from joints import loaded, sawn
from structures import CUBE, PUSH

from sidmacib.engines import ENGINES, Numerics
from sidmacib.joint import Direction, Joint
from sidmacib.joint.loading import Loading, posed
from sidmacib.model import Ability, Model, Requirement, SolvedModel
from sidmacib.models import (
    CLOSED_FORM,
    LAWS,
    MODELS,
    RESISTANCES,
    RETURNED,
    SOLVED,
    limit,
    static,
    structure_limit,
    structure_static,
)
from sidmacib.problem import Outcome
from sidmacib.structure.analysis.tilt import PRECISION
from sidmacib.structure.files.structure_file import structure_of

DUCTILE = Requirement(Ability.DUCTILE, "assembly.failure", "ductile", "brittle")
STIFF = Requirement(Ability.TWO_STIFFNESSES, "shear_stiffness", "5 Pa/m", "10 Pa/m")


def test_every_way_to_obtain_results_has_its_models() -> None:
    folders = {path.parent.name for path in (ROOT / "sidmacib/engines").glob("*/run.py")}
    assert {"yade", "liggghts", "calculix"} <= set(ENGINES) == folders
    assert SOLVED == ("static", "limit")
    assert RETURNED == ("3dec",)
    assert ("law", "safe", *RESISTANCES) == LAWS
    assert (*LAWS, "sidmacib") == CLOSED_FORM
    assert set(MODELS) == {*ENGINES, *SOLVED, *RETURNED, *CLOSED_FORM}


def test_a_refusal_names_key_value_and_what_is_allowed_and_is_the_first_of_several() -> None:
    model = Model(name="rule", label="", colour="", abilities=frozenset({Ability.BRITTLE}))
    assert model.refusal([]) is None
    brittle = Requirement(Ability.BRITTLE, "assembly.failure", "brittle", "ductile")
    assert model.refusal([brittle]) is None
    assert model.refusal([DUCTILE, STIFF]) == (
        "assembly.failure: ductile is not allowed with rule; it must be brittle"
    )
    words = "shear_stiffness: 5 Pa/m is not allowed with rule; it must be 10 Pa/m"
    assert model.refusal([STIFF]) == words


def test_engines_can_what_each_of_them_must() -> None:
    for name, engine in ENGINES.items():
        assert MODELS[name] is engine
        can = engine.abilities
        assert Ability.FIRST_FAILURE in can
        assert (Ability.ELASTIC in can) == engine.elastic == (Ability.RIGID not in can)
        assert (Ability.PROGRESSIVE in can) != engine.first_failure_only
        assert engine.reads <= {field.name for field in fields(Numerics)}
        assert engine.numerics(Numerics(ranks=3)).ranks == (3 if "ranks" in engine.reads else 1)


def solved(name: str, joint: Joint) -> Outcome:
    model = MODELS[name]
    assert isinstance(model, SolvedModel)
    found: Outcome = importlib.import_module(model.module).solve(loaded(joint, 0.5))
    return found


@pytest.mark.parametrize("name", SOLVED)
def test_a_solved_model_returns_what_its_abilities_promise(name: str) -> None:
    model, outcome = MODELS[name], solved(name, sawn(3))
    peak = outcome.path[-1]
    assert 0.0 < peak.load <= outcome.failed_load
    assert peak.force is not None
    assert peak.bonded is not None
    assert (peak.displacement is not None) == (name == "static")
    assert (outcome.first_failure_load is not None) == (Ability.FIRST_FAILURE in model.abilities)
    assert (len(outcome.path) > 1) == (Ability.PROGRESSIVE in model.abilities)
    smooth = solved(name, sawn(3, dry=replace(sawn(3).dry, friction=0.0))).path[-1].load
    assert (smooth == pytest.approx(peak.load, rel=1e-6)) is (
        Ability.FRICTION not in model.abilities
    )


# --- loads that are known not to be carried ------------------------------------------------------
BONDED = CUBE | {"interfaces": {"friction": 0.2, "cohesion": 2e3, "tensile_strength": 2e3}}
TILT = {"tilt": {"axis": [0, 1, 0]}}
STRUCTURES = {"static": structure_static.solve, "limit": structure_limit.solve}


@pytest.mark.parametrize("model", [static, limit], ids=["static", "limit"])
@pytest.mark.parametrize("ratio", [0.0, 0.3, math.inf])
def test_the_failed_load_of_a_joint_is_just_above_the_largest_that_is_carried(
    model: Any, ratio: float
) -> None:
    outcome = model.solve(posed(sawn(3), Loading(Direction(ratio)), 0.05))
    above = outcome.failed_load / outcome.path[-1].load - 1.0
    assert 0.0 <= above <= (1.1e-5 if model is static else 0.0)


@pytest.mark.parametrize("model", STRUCTURES)
@pytest.mark.parametrize("description", [CUBE, BONDED], ids=["dry", "bonded"])
@pytest.mark.parametrize(("load", "most"), [(PUSH, 1.1e-5), (TILT, 1.01 * PRECISION)])
def test_so_is_that_of_a_structure_that_is_pushed_or_tilted(
    model: str, description: dict[str, Any], load: dict[str, Any], most: float
) -> None:
    found = STRUCTURES[model](structure_of({**description, "load": load}))
    above = found.failed_load / found.path[-1].load - 1.0
    assert 0.0 <= above <= (most if model == "static" else 0.0)


@pytest.mark.parametrize("load", [PUSH, TILT], ids=["push", "tilt"])
def test_first_failures_and_broken_bonds_are_at_carried_loads(load: dict[str, Any]) -> None:
    found = structure_static.solve(structure_of({**BONDED, "load": load}))
    peak, first = found.path[-1].load, found.first_failure_load
    assert 0.0 < first <= peak
    assert all(broken == pytest.approx(first, rel=1e-4) for broken in found.broken_at.values())
    assert found.broken_at or load is TILT  # where the peak is the first failure, it has none
