"""The models of a study: SiDMACIB on contact points, and the engines' distinct elements."""

from collections.abc import Mapping
from typing import Annotated, Any, Self

from pydantic import BeforeValidator, Field, model_validator

from sidmacib.contact_points.options import OPTIONS, READY_OPTIONS, REDUCTIONS, ContactOption
from sidmacib.engines.engine import Numerics
from sidmacib.quantities import Number, Part, one_of, shown
from sidmacib.reading import Section, Some, changes_to, section_of
from workflow.schema.values import Name

_KEYS: Any = section_of(Numerics)


class NumericsSection(_KEYS):
    """The keys of `Numerics`."""

    def numerics(self) -> Numerics:
        """The section as the engines take it."""
        return Numerics(**self.model_dump())


_CHANGES: Any = changes_to(NumericsSection)


class NumericsChanges(_CHANGES):
    """Changes to the numerics; None means no change."""


class DemSection(Section):
    """Engines by name, the longest time for one case (s), and the engines' numerics."""

    engines: tuple[str, ...]
    time_limit: Annotated[float, Number(at_least=1, at_most=1e7, unit="s")] = 3600.0
    numerics: NumericsSection = NumericsSection()


class OptionSection(Section):
    """Contact points of a lock: positions over a, and shares of its strength."""

    positions: Annotated[tuple[Annotated[float, Number(at_least=-0.5, at_most=0.5)], ...], Some]
    portions: Annotated[tuple[Part, ...], Some]

    @model_validator(mode="after")
    def _fits(self) -> Self:
        self.contact_option()
        return self

    def contact_option(self) -> ContactOption:
        """The section as the models take it; ValueError if positions and portions do not match."""
        return ContactOption(self.positions, self.portions)


_READY = {
    name: OptionSection(positions=option.positions, portions=option.portions)
    for name, option in READY_OPTIONS.items()
}


def _with_ready(value: Any) -> Any:
    """Options with those given only by name replaced by their definitions."""
    if isinstance(value, list | tuple):
        if twice := [name for number, name in enumerate(value) if name in value[:number]]:
            raise ValueError(f"{shown(twice[0])} appears twice; each name must appear only once")
        value = dict.fromkeys(map(_ready_name, value))
    if not isinstance(value, Mapping):
        return value
    return {
        name: _READY[_ready_name(name)] if option is None else option
        for name, option in value.items()
    }


def _ready_name(name: Any) -> str:
    if not isinstance(name, str) or name not in _READY:
        raise ValueError(
            f"{shown(name)} needs positions and portions; without them it must be one of "
            f"{', '.join(_READY)}"
        )
    return name


class SidmacibSection(Section):
    """The overload on the upper block (N), contact points, and rules for which locks count."""

    overload: Annotated[float, Number(at_least=0, unit="N")] = 1000.0
    options: Annotated[
        dict[Name, OptionSection],
        Some,
        BeforeValidator(
            _with_ready, json_schema_input_type=list[Name] | dict[Name, OptionSection | None]
        ),
    ] = Field(default={name: _READY[name] for name in OPTIONS})
    reductions: Annotated[tuple[Annotated[str, one_of(REDUCTIONS)], ...], Some] = tuple(REDUCTIONS)
