"""The registry of models: what each can do, and how its results are obtained.

To add a model, add an entry to `MODELS`. Light to import: a model's code is loaded when it is
used.
"""

import importlib
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum, auto

from sidmacib.mechanics.assembly import Assembly, Loads
from workflow.engines import ENGINES, Engine
from workflow.outcome import Outcome


class Obtained(StrEnum):
    """How a model's results are obtained."""

    SOLVED = auto()  # in this process, many cases in one batch
    ENGINE = auto()  # by an external program, one job for each case
    RETURNED = auto()  # by a program that somebody runs elsewhere
    RULE = auto()  # capacities of the abstracted joint, joint by joint, where tables are made
    LAW = auto()  # capacities of the chain of springs, in the same place


class Ability(StrEnum):
    """What a model can take into account, or can give."""

    BRITTLE = auto()  # inner faces that lose their strength where it is reached
    SOFTENING = auto()  # inner faces that lose it as they move on
    DUCTILE = auto()  # inner faces that keep it
    TWO_STIFFNESSES = auto()  # inner faces whose normal and shear stiffness differ
    FRICTION = auto()  # on dry faces
    PROGRESSIVE = auto()  # follows failure from node to node up to the peak
    NUMERICS = auto()  # has settings of its own for the search, dem.numerics
    RIGID = auto()  # pieces
    ELASTIC = auto()  # pieces
    JOINED = auto()  # columns without the compliance of a joint
    SHARED = auto()  # a load that does not act on the whole lateral face
    RANKS = auto()  # runs one case on several processes
    STRESSES = auto()  # gives them at all nodes
    DISPLACEMENTS = auto()  # gives the one that the load does work on
    FIRST_FAILURE = auto()  # gives the load at which the first node fails


@dataclass(frozen=True)
class Need:
    """What a study asks of its models: an ability, because ``key`` has this ``value``.

    ``allowed``: the value that models without the ability can do.
    """

    ability: Ability
    key: str
    value: str
    allowed: str


@dataclass(frozen=True)
class Model:
    """A model of the joint. ``module``: where its ``solve`` is, if it is solved in this process.

    ``ignores``: keys of dem.numerics that have no effect on it.
    """

    name: str
    obtained: Obtained
    abilities: frozenset[Ability]
    module: str | None = None
    ignores: frozenset[str] = frozenset()

    def refusal(self, needs: Iterable[Need]) -> str | None:
        """Why the model cannot do all that is needed, in one line; None if it can."""
        for need in needs:
            if need.ability not in self.abilities:
                return (
                    f"{need.key}: {need.value} is not possible with {self.name}; "
                    f"it must be {need.allowed}"
                )
        return None

    def solve(self, assembly: Assembly, loads: Loads) -> Outcome:
        """What the model finds for ``assembly`` under ``loads``.

        Raises `sidmacib.errors.CapacityError` where it has no answer, and TypeError if it is not
        solved in this process.
        """
        if self.module is None:
            raise TypeError(f"{self.name} is not solved in this process")
        return importlib.import_module(self.module).solve(assembly, loads)


def _of_engine(engine: Engine) -> Model:
    lacks = {
        Ability.DUCTILE: engine.brittle_only,
        Ability.TWO_STIFFNESSES: engine.one_stiffness,
        Ability.RANKS: not engine.shares_out,
        Ability.PROGRESSIVE: engine.first_failure_only,
        Ability.SOFTENING: True,
        Ability.RIGID: engine.elastic,
        Ability.ELASTIC: not engine.elastic,
        Ability.JOINED: not engine.elastic,
    }
    can = frozenset(ability for ability in Ability if not lacks.get(ability, False))
    return Model(engine.name, Obtained.ENGINE, can, ignores=frozenset(engine.ignores))


WITNESS = "static"  # every engine is compared with it, on the same nodes
_OF_THE_PIECES = {
    *(Ability.BRITTLE, Ability.TWO_STIFFNESSES, Ability.STRESSES),
    *(Ability.RIGID, Ability.ELASTIC, Ability.JOINED, Ability.SHARED),
}

MODELS = {
    model.name: model
    for model in (
        *map(_of_engine, ENGINES.values()),
        Model(
            "static",
            Obtained.SOLVED,
            frozenset(
                {
                    *(*_OF_THE_PIECES, Ability.FRICTION, Ability.PROGRESSIVE),
                    *(Ability.SOFTENING, Ability.DUCTILE),
                    *(Ability.DISPLACEMENTS, Ability.FIRST_FAILURE),
                }
            ),
            module="workflow.solvers.static",
        ),
        Model(
            "limit",
            Obtained.SOLVED,
            frozenset({*_OF_THE_PIECES, Ability.DUCTILE}),
            module="workflow.solvers.limit",
        ),
        Model(
            "3dec",
            Obtained.RETURNED,
            frozenset({*_OF_THE_PIECES, Ability.FRICTION, Ability.PROGRESSIVE}),
        ),
        *(
            Model(
                name,
                Obtained.LAW,
                frozenset(
                    {
                        *(Ability.BRITTLE, Ability.SOFTENING, Ability.DUCTILE),
                        *(Ability.TWO_STIFFNESSES, Ability.FRICTION),
                        *(Ability.RIGID, Ability.ELASTIC),
                    }
                ),
            )
            for name in ("law", "safe")
        ),
        Model(
            "sidmacib",
            Obtained.RULE,
            frozenset(
                {
                    *(Ability.BRITTLE, Ability.SOFTENING, Ability.DUCTILE),
                    *(Ability.TWO_STIFFNESSES, Ability.FRICTION, Ability.SHARED),
                    *(Ability.RIGID, Ability.ELASTIC, Ability.JOINED),
                }
            ),
        ),
    )
}


def obtained_by(way: Obtained) -> tuple[str, ...]:
    """Names of the models whose results are obtained in one ``way``."""
    return tuple(name for name, model in MODELS.items() if model.obtained is way)


def first_failure_only(name: str) -> bool:
    """Whether a model finds the first failure and goes no further: that is no peak."""
    can = MODELS[name].abilities
    return Ability.FIRST_FAILURE in can and Ability.PROGRESSIVE not in can


def detailed(names: Iterable[str]) -> tuple[str, ...]:
    """Those of ``names`` that follow progressive failure; SiDMACIB is compared with them."""
    return tuple(name for name in names if Ability.PROGRESSIVE in MODELS[name].abilities)
