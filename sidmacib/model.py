"""Definition of a model: name, label, colour, abilities and refusals."""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum, auto


class Ability(StrEnum):
    """A feature that a model can take into account, or a result that it can give."""

    BRITTLE = auto()  # inner faces that lose their strength where it is reached
    SOFTENING = auto()  # inner faces that lose it as they move on
    DUCTILE = auto()  # inner faces that keep it
    TWO_STIFFNESSES = auto()  # inner faces whose normal and shear stiffness differ
    FRICTION = auto()  # on dry faces
    BOND_FRICTION = auto()  # in bonds, other than after they have failed
    PROGRESSIVE = auto()  # follows failure from node to node up to the peak
    RIGID = auto()  # pieces
    ELASTIC = auto()  # pieces
    JOINED = auto()  # columns without the compliance of a joint
    SHARED = auto()  # a load that does not act on the whole lateral face
    CONDENSED = auto()  # contact points in place of locks
    FIRST_FAILURE = auto()  # gives the load at which the first node fails


@dataclass(frozen=True)
class Requirement:
    """A requirement of a study on its models: an ability, because ``key`` has this ``value``.

    ``allowed``: the value that models without the ability can do.
    """

    ability: Ability
    key: str
    value: str
    allowed: str


@dataclass(frozen=True, kw_only=True)
class Model:
    """A model of the joint; ``label``, ``colour``: in figures, report and explorer."""

    name: str
    label: str
    colour: str
    abilities: frozenset[Ability]

    @property
    def first_failure_only(self) -> bool:
        """Whether it stops at the first failure, which is not a peak."""
        can = self.abilities
        return Ability.FIRST_FAILURE in can and Ability.PROGRESSIVE not in can

    def refusal(self, requirements: Iterable[Requirement]) -> str | None:
        """The first requirement that the model does not meet, as one line; None if all are met."""
        for each in requirements:
            if each.ability not in self.abilities:
                return (
                    f"{each.key}: {each.value} is not allowed with {self.name}; "
                    f"it must be {each.allowed}"
                )
        return None


@dataclass(frozen=True, kw_only=True)
class SolvedModel(Model):
    """A model that is solved in this process, many cases in one batch.

    ``module``: where its ``solve`` is, which is loaded when it is used and turns a `Problem` into
    an `Outcome`, or raises `sidmacib.errors.CapacityError`; ``structures``: the same for structures
    of blocks.
    """

    module: str
    structures: str


class ReturnedModel(Model):
    """A program that is run elsewhere; its results are read when they come back."""


class ClosedForm(Model):
    """A rule without pieces: its capacities are tabulated, and there is nothing to run."""


class FirstFailureLaw(ClosedForm):
    """The law of the first failure, or the safe rule: one load for each direction."""
