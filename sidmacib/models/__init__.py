"""The registry of models. To add one, add an entry to `MODELS`.

Light to import: a model's code is loaded when it is used.
"""

from collections.abc import Iterable

from sidmacib.drawing import BLACK, BLUE, GREEN, GREY, OCHRE, PURPLE, SKY
from sidmacib.engines import ENGINES
from sidmacib.model import Ability, ClosedForm, FirstFailureLaw, Model, ReturnedModel, SolvedModel

REFERENCE_MODEL = "static"  # every engine is compared with it, on the same nodes
_OF_THE_PIECES = {
    *(Ability.BRITTLE, Ability.TWO_STIFFNESSES, Ability.STRESSES),
    *(Ability.RIGID, Ability.ELASTIC, Ability.JOINED, Ability.SHARED, Ability.BOND_FRICTION),
}
_OF_ANY_FAILURE = {
    *(Ability.BRITTLE, Ability.SOFTENING, Ability.DUCTILE, Ability.TWO_STIFFNESSES),
    *(Ability.FRICTION, Ability.RIGID, Ability.ELASTIC),
}
_ALL: tuple[Model, ...] = (
    *ENGINES.values(),
    SolvedModel(
        name="static",
        label="static model",
        colour=BLUE,
        abilities=frozenset(
            {
                *(*_OF_THE_PIECES, Ability.FRICTION, Ability.PROGRESSIVE),
                *(Ability.SOFTENING, Ability.DUCTILE),
                *(Ability.DISPLACEMENTS, Ability.FIRST_FAILURE),
            }
        ),
        module="sidmacib.models.static",
        structures="sidmacib.models.structure_static",
    ),
    SolvedModel(
        name="limit",
        label="limit analysis",
        colour=SKY,
        abilities=frozenset({*_OF_THE_PIECES, Ability.DUCTILE, Ability.CONDENSED}),
        module="sidmacib.models.limit",
        structures="sidmacib.models.structure_limit",
    ),
    ReturnedModel(
        name="3dec",
        label="3DEC",
        colour=BLACK,
        abilities=frozenset(
            {*_OF_THE_PIECES, Ability.FRICTION, Ability.PROGRESSIVE} - {Ability.BOND_FRICTION}
        ),
    ),
    FirstFailureLaw(name="law", label="law", colour=OCHRE, abilities=frozenset(_OF_ANY_FAILURE)),
    FirstFailureLaw(
        name="safe",
        label="safe rule",
        colour=GREEN,
        abilities=frozenset(_OF_ANY_FAILURE),
    ),
    FirstFailureLaw(
        name="characteristic",
        label="characteristic resistance",
        colour=GREY,
        abilities=frozenset(_OF_ANY_FAILURE),
    ),
    FirstFailureLaw(
        name="design",
        label="design resistance",
        colour=BLACK,
        abilities=frozenset(_OF_ANY_FAILURE),
    ),
    ClosedForm(
        name="sidmacib",
        label="SiDMACIB",
        colour=PURPLE,
        abilities=frozenset(  # the friction of bonds is not counted
            {*_OF_ANY_FAILURE, Ability.SHARED, Ability.JOINED, Ability.BOND_FRICTION}
        ),
    ),
)
MODELS = {model.name: model for model in _ALL}
# Names of the models whose results are obtained in the same way.
SOLVED = tuple(model.name for model in _ALL if isinstance(model, SolvedModel))
RETURNED = tuple(model.name for model in _ALL if isinstance(model, ReturnedModel))
LAWS = tuple(model.name for model in _ALL if isinstance(model, FirstFailureLaw))
RESISTANCES = "characteristic", "design"  # of strengths that scatter, and with a partial factor
CLOSED_FORM = tuple(model.name for model in _ALL if isinstance(model, ClosedForm))


def first_failure_only(name: str) -> bool:
    """Whether a model stops at the first failure, which is not a peak."""
    return MODELS[name].first_failure_only


def detailed(names: Iterable[str]) -> tuple[str, ...]:
    """Those of ``names`` that follow progressive failure; SiDMACIB is compared with them."""
    return tuple(name for name in names if Ability.PROGRESSIVE in MODELS[name].abilities)
