"""The distinct-element model, and how its engines search for the peak."""

from typing import Annotated, Any

from sidmacib.engines.engine import Numerics
from sidmacib.quantities import Number
from sidmacib.reading import Section, changes_to, section_of

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
