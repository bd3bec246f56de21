"""The distinct-element model."""

from typing import Annotated

from pydantic import BeforeValidator

from workflow.schema.numerics import NumericsSection
from workflow.schema.section import Section
from workflow.schema.values import Number, Several


class DemSection(Section):
    """Engines by name, the longest time for one case (s), and the engines' numerics."""

    engines: Annotated[tuple[str, ...], Several]
    time_limit: Annotated[float, BeforeValidator(Number(at_least=1, at_most=1e7, unit="s"))] = (
        3600.0
    )
    numerics: NumericsSection = NumericsSection()
