"""How models, options and rules are named and coloured in figures, report and explorer."""

from dataclasses import dataclass

from sidmacib.contact_points.options import OPTIONS
from workflow.colours import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION
from workflow.models import MODELS

SERIES = (BLUE, ORANGE, GREEN, PURPLE, SKY, VERMILION, BLACK)  # of what is no model, in turn


@dataclass(frozen=True)
class Look:
    """What people call a model, and its colour."""

    name: str
    colour: str


PUBLISHED = Look("published (3DEC)", BLACK)
_RULES = {
    "none": "every lock counts",
    "half": "(n - 1) / 2 locks count",
    "floor_of_sum": "sum of weights, rounded down",
    "lower_sum": "lower locks count by their weights",
    "per_lock": "each lock counts by its weight",
}
_OPTIONS = dict(zip(OPTIONS, (ORANGE, SKY, PURPLE, "#2f4b7c"), strict=True))


def look_of(model: str) -> Look:
    """The look of a model; its own name and grey if it has none yet."""
    known = MODELS.get(model)
    return Look(known.label, known.colour) if known else Look(model, GREY)


def rule_name(reduction: str) -> str:
    """A reduction of SiDMACIB in words; its own name if there are none."""
    return _RULES.get(reduction, reduction)


def option_name(option: str) -> str:
    """An option for SiDMACIB's contact points in words."""
    return option.replace("option", "Option ") if option in _OPTIONS else option


def option_colour(option: str) -> str:
    """Colour of an option for SiDMACIB's contact points; grey for one of a study's own."""
    return _OPTIONS.get(option, GREY)
