"""The registry of models. To add one, add an entry to `MODELS`.

Light to import: a model's code is loaded when it is used.
"""

from collections.abc import Iterable

from sidmacib.drawing import BLACK, BLUE, GREEN, GREY, OCHRE, PURPLE, SKY
from sidmacib.engines import ENGINES
from sidmacib.model import Ability, ClosedForm, FirstFailureLaw, Model, ReturnedModel, SolvedModel

REFERENCE_MODEL = "static"  # every engine is compared with it, on the same nodes
_OF_THE_PIECES = frozenset(
    {
        *(Ability.BRITTLE, Ability.TWO_STIFFNESSES, Ability.BOND_FRICTION),
        *(Ability.RIGID, Ability.ELASTIC, Ability.JOINED, Ability.SHARED),
    }
)
_OF_ANY_FAILURE = frozenset(
    {
        *(Ability.BRITTLE, Ability.SOFTENING, Ability.DUCTILE, Ability.TWO_STIFFNESSES),
        *(Ability.FRICTION, Ability.RIGID, Ability.ELASTIC),
    }
)
_RULES = (  # name, label, colour
    ("law", "law", OCHRE),
    ("safe", "safe rule", GREEN),
    ("characteristic", "characteristic resistance", GREY),
    ("design", "design resistance", BLACK),
)
_ALL: tuple[Model, ...] = (
    *ENGINES.values(),
    SolvedModel(
        name="static",
        label="static model",
        colour=BLUE,
        abilities=_OF_THE_PIECES | _OF_ANY_FAILURE | {Ability.PROGRESSIVE, Ability.FIRST_FAILURE},
        module="sidmacib.models.static",
        structures="sidmacib.models.structure_static",
    ),
    SolvedModel(
        name="limit",
        label="limit analysis",
        colour=SKY,
        abilities=_OF_THE_PIECES | {Ability.DUCTILE, Ability.CONDENSED},
        module="sidmacib.models.limit",
        structures="sidmacib.models.structure_limit",
    ),
    ReturnedModel(
        name="3dec",
        label="3DEC",
        colour=BLACK,
        abilities=_OF_THE_PIECES | {Ability.FRICTION, Ability.PROGRESSIVE},
    ),
    *(
        FirstFailureLaw(name=name, label=label, colour=colour, abilities=_OF_ANY_FAILURE)
        for name, label, colour in _RULES
    ),
    ClosedForm(
        name="sidmacib",
        label="SiDMACIB",
        colour=PURPLE,
        # The friction of bonds is not counted.
        abilities=_OF_ANY_FAILURE | {Ability.SHARED, Ability.JOINED, Ability.BOND_FRICTION},
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
