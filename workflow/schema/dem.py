"""The distinct-element model, and how its engines search for the peak."""

from typing import Annotated, Any

from sidmacib.quantities import Number
from workflow.engines.numerics import Numerics
from workflow.schema.section import Section, changes_to, section_of
from workflow.schema.values import Several, Share, Switch

_KEYS: Any = section_of(
    Numerics,
    tolerance=Annotated[float, Number(at_least=1e-5, at_most=0.0025)],
    guided=Switch,
    first_increment=Annotated[float, Number(above=0, at_most=1)],
    ramp_periods=Annotated[float, Number(at_least=1, at_most=1000)],
    hold_periods=Annotated[float, Number(at_least=1, at_most=100_000)],
    unbalanced_ratio=Annotated[float, Number(at_least=1e-9, at_most=0.01)],
    collapse_ratio=Annotated[float, Number(at_least=5, at_most=10_000)],
    damping=Share,
    time_step_ratio=Share,
    ranks=Annotated[int, Number(at_least=1, at_most=1024, whole=True)],
)


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

    engines: Annotated[tuple[str, ...], Several]
    time_limit: Annotated[float, Number(at_least=1, at_most=1e7, unit="s")] = 3600.0
    numerics: NumericsSection = NumericsSection()
