"""What holds the joint down, as the configuration spells it."""

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BeforeValidator, PlainSerializer

from sidmacib.hold_down import Hold, HoldDown
from workflow.schema.values import Number, shown

_NAMED = {str(kind): HoldDown(kind) for kind in (Hold.PLATE, Hold.WEIGHT)}
_GIVEN = {str(Hold.FORCE): "N", str(Hold.PRESSURE): "Pa"}


def hold_down(value: Any) -> HoldDown:
    """The hold-down that ``value`` spells: a name, or what is given in its unit."""
    if isinstance(value, HoldDown):
        return value
    if isinstance(value, str) and value in _NAMED:
        return _NAMED[value]
    if isinstance(value, Mapping) and len(value) == 1:
        ((kind, amount),) = value.items()
        if kind in _GIVEN:
            try:
                return HoldDown(Hold(kind), Number(at_least=0, unit=_GIVEN[kind])(amount))
            except ValueError as error:
                raise ValueError(f"{kind}: {error}") from None
    told = f"a mapping of {', '.join(map(shown, value))}" if isinstance(value, Mapping) else ""
    raise ValueError(
        f"{told or shown(value)} is not allowed; it must be {', '.join(_NAMED)}, "
        + " or ".join(f"{{{kind}: a number ({unit})}}" for kind, unit in _GIVEN.items())
    )


def _spelled(value: HoldDown) -> str | dict[str, float]:
    kind = str(value.kind)
    return {kind: value.amount} if kind in _GIVEN else kind


HeldDown = Annotated[
    HoldDown, BeforeValidator(hold_down), PlainSerializer(_spelled, when_used="json")
]
