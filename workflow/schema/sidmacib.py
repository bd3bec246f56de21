"""SiDMACIB, the limit model on contact points."""

from typing import Annotated, Self

from pydantic import BeforeValidator, Field, model_validator

from sidmacib.contact_points import OPTIONS, ContactOption
from sidmacib.revision import REDUCTIONS
from workflow.schema.section import Section
from workflow.schema.values import Entries, Force, Name, Number, Some, shown


class OptionSection(Section):
    """Contact points of a lock: positions over a, and shares of its strength."""

    positions: Annotated[
        tuple[Annotated[float, BeforeValidator(Number(at_least=-0.5, at_most=0.5))], ...], Some
    ]
    portions: Annotated[
        tuple[Annotated[float, BeforeValidator(Number(at_least=0, at_most=1))], ...], Some
    ]

    @model_validator(mode="after")
    def _fits(self) -> Self:
        self.contact_option()
        return self

    def contact_option(self) -> ContactOption:
        """The section as the models take it; ValueError if positions and portions do not match."""
        return ContactOption(self.positions, self.portions)


def _reduction(name: object) -> object:
    if name not in [*REDUCTIONS]:
        raise ValueError(f"{shown(name)} is not allowed; it must be one of {', '.join(REDUCTIONS)}")
    return name


class SidmacibSection(Section):
    """The overload on the upper block (N), contact points, and rules for which locks count."""

    overload: Force = 1000.0
    options: Annotated[dict[Name, OptionSection], Entries] = Field(
        default={
            name: OptionSection(positions=option.positions, portions=option.portions)
            for name, option in OPTIONS.items()
        }
    )
    reductions: Annotated[tuple[Annotated[str, BeforeValidator(_reduction)], ...], Some] = tuple(
        REDUCTIONS
    )
