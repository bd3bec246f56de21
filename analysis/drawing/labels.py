"""Names and colours of models, options and rules in figures, report and explorer."""

from dataclasses import dataclass

from sidmacib.contact_points.options import OPTIONS
from sidmacib.drawing import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION
from sidmacib.models import MODELS

SERIES = (BLUE, ORANGE, GREEN, PURPLE, SKY, VERMILION, BLACK)  # of what is no model, in turn


@dataclass(frozen=True)
class Label:
    """The name of a model in figures and pages, and its colour."""

    name: str
    colour: str


PUBLISHED = Label("published (3DEC)", BLACK)
_RULES = {
    "none": "every lock counts",
    "half": "(n - 1) / 2 locks count",
    "floor_of_sum": "sum of weights, rounded down",
    "lower_sum": "lower locks count by their weights",
    "per_lock": "each lock counts by its weight",
}
_OPTIONS = dict(zip(OPTIONS, (ORANGE, SKY, PURPLE, "#2f4b7c"), strict=True))


def label_of(model: str) -> Label:
    """The label of a model; an unknown model keeps its name and is grey."""
    known = MODELS.get(model)
    return Label(known.label, known.colour) if known else Label(model, GREY)


def rule_name(reduction: str) -> str:
    """A reduction of SiDMACIB in words; unknown reductions keep their name."""
    return _RULES.get(reduction, reduction)


def option_name(option: str) -> str:
    """A contact-point option of SiDMACIB in words; the options of a study keep their name."""
    return option.replace("option", "Option ") if option in _OPTIONS else option


def option_colour(option: str) -> str:
    """The colour of a contact-point option of SiDMACIB; grey for the options of a study."""
    return _OPTIONS.get(option, GREY)
