"""How models and options are named and coloured: the same in figures, report and explorer."""

from dataclasses import dataclass

from sidmacib.contact_points.options import OPTIONS

BLUE, VERMILION, GREEN, PURPLE, SKY, ORANGE, OCHRE, BLACK, GREY = (
    *("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#8a6d00", "#000000"),
    "#9aa0aa",
)
SERIES = (BLUE, ORANGE, GREEN, PURPLE, SKY, VERMILION, BLACK)  # of what is no model, in turn


@dataclass(frozen=True)
class Look:
    """What people call a model, and its colour."""

    name: str
    colour: str


_MODELS = {
    "static": Look("static model", BLUE),
    "limit": Look("limit analysis", SKY),
    "yade": Look("YADE", VERMILION),
    "liggghts": Look("LIGGGHTS", ORANGE),
    "calculix": Look("CalculiX", PURPLE),
    "3dec": Look("3DEC", BLACK),
    "law": Look("law", OCHRE),
    "safe": Look("safe rule", GREEN),
    "sidmacib": Look("SiDMACIB", PURPLE),
}
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
    return _MODELS.get(model, Look(model, GREY))


def rule_name(reduction: str) -> str:
    """A reduction of SiDMACIB in words; its own name if there are none."""
    return _RULES.get(reduction, reduction)


def option_name(option: str) -> str:
    """An option for SiDMACIB's contact points in words."""
    return option.replace("option", "Option ") if option in _OPTIONS else option


def option_colour(option: str) -> str:
    """Colour of an option for SiDMACIB's contact points; grey for one of a study's own."""
    return _OPTIONS.get(option, GREY)
