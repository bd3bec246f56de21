"""Direction of each slider for a larger first failure, by the static model."""

from dataclasses import replace
from functools import lru_cache

from analysis.explore.state import SLIDERS, Settings
from sidmacib.answers.joint import meshes
from sidmacib.errors import CapacityError
from sidmacib.joint.effects import FIELDS as OF_JOINTS
from sidmacib.joint.effects import Field, sensitivity
from sidmacib.joint.joint import Direction, Joint
from sidmacib.joint.loading import Loading

# What a slider changes; the tensile strength goes with the cohesion.
FIELDS = tuple(
    replace(each, places=(*each.places, "inner.tensile_strength"))
    if each.name == "cohesion"
    else each
    for each in OF_JOINTS
    if each.name in SLIDERS
)
PRESSURE = Field("pressure", ("hold_down.amount",), "Pa")


def effects(state: Settings) -> dict[str, str]:
    """Below each slider: an arrow, and the change of the first failure for 1 % more.

    Nothing of a slider at 0, and of blocks that bend, whose static model is not shown.
    """
    fields = (*FIELDS, PRESSURE) if state.pressure else FIELDS
    if not state.friction:
        fields = tuple(each for each in fields if each.name != "friction")
    return _effects(state.joint, state.eccentricity, fields)


@lru_cache(maxsize=512)
def _effects(joint: Joint, ratio: float, fields: tuple[Field, ...]) -> dict[str, str]:
    if joint.elastic is not None:
        return {}
    try:
        found = sensitivity(joint, Loading(Direction(ratio)), meshes(joint)[1], fields=fields)
    except CapacityError:
        return {}
    return {each.name: words(each.more) for each in found.effects if each.more is not None}


def words(more: float) -> str:
    """An arrow towards a larger load, and the change (%) for 1 % more; no arrow for none."""
    shown = f"{more:+.2f} %".replace("-", "\N{MINUS SIGN}")
    if float(f"{more:.2f}") == 0.0:
        return "0.00 %"
    return f"\N{RIGHTWARDS ARROW} {shown}" if more > 0.0 else f"\N{LEFTWARDS ARROW} {shown}"
