"""Loads that were measured on the samples of a study, and where they come from."""

import math
from typing import Annotated, Any, Self

from pydantic import BeforeValidator, model_validator

from sidmacib.quantities import FORMULA, Number, shown
from sidmacib.reading import Section
from workflow.schema.values import Eccentricity, Name

LONGEST = 500  # letters of a source


def words(value: Any) -> str:
    """Text in one line."""
    text = " ".join(value.split()) if isinstance(value, str) else ""
    if not text or len(text) > LONGEST or not text.isprintable():
        raise ValueError(
            f"{shown(value)} is not allowed; it must be text of at most {LONGEST} letters"
        )
    return text


def cell(value: Any) -> str:
    """Text in one line that no spreadsheet takes for a formula."""
    text = words(value)
    if text.startswith(FORMULA):
        raise ValueError(
            f"{shown(value)} is not allowed; it must not begin with {' '.join(FORMULA)}, as a "
            "spreadsheet would take it for a formula"
        )
    return text


Words = Annotated[str, BeforeValidator(words)]
_Cell = Annotated[str, BeforeValidator(cell)]
_Force = Annotated[float, Number(above=0, unit="N")]
_Torque = Annotated[float, Number(above=0, unit="N m")]


class MeasuredLoad(Section):
    """A measured load: its shear V (N) or its torque M (N m), at an eccentricity e / a."""

    sample: Name
    eccentricity: Eccentricity
    shear: _Force | None = None
    torque: _Torque | None = None
    specimen: _Cell | None = None

    @model_validator(mode="after")
    def _one_of_both(self) -> Self:
        needed = "torque" if math.isinf(self.eccentricity) else "shear"
        if needed == "shear" and self.eccentricity > 0.0 and self.shear is None:
            needed = "torque"
        other = {"shear": "torque", "torque": "shear"}[needed]
        if getattr(self, needed) is None or getattr(self, other) is not None:
            raise ValueError(
                "one of shear (N) and torque (N m) must be given, shear alone where the "
                "eccentricity is 0, torque alone in torsion"
            )
        return self

    def components(self, a: float) -> tuple[float, float]:
        """Shear (N) and torque (N m), where locks are ``a`` (m) long."""
        if math.isinf(self.eccentricity):
            return 0.0, self.torque or 0.0
        arm = self.eccentricity * a
        shear = self.shear if self.shear is not None else (self.torque or 0.0) / arm
        return shear, shear * arm


class MeasuredSection(Section):
    """Measured loads of one campaign; ``source``: where they stand, ``digitised``: how read."""

    source: Words
    digitised: Words
    loads: tuple[MeasuredLoad, ...]
