"""The keys of a structure's file for the spectrum of an earthquake."""

from typing import Annotated, Self

from pydantic import model_validator

from sidmacib.quantities import Number
from sidmacib.reading import Keys
from sidmacib.structure.analysis.seismic import CONFIDENCE, Spectrum
from sidmacib.structure.files.time_loads import Seconds


class SeismicSection(Keys):
    """The elastic spectrum that a mechanism is verified for."""

    ag: Annotated[float, Number(above=0, at_most=50, unit="m/s2")]
    """ground acceleration on rock, m/s2, or such as 0.15g"""
    S: Annotated[float, Number(above=0)] = 1.0
    """soil factor"""
    F0: Annotated[float, Number(above=1)] = 2.5
    """largest amplification"""
    TB: Seconds
    """period where the flat part begins, s"""
    TC: Seconds
    """period where it ends, s"""
    TD: Seconds
    """period from which the displacement is constant, s"""
    confidence: Annotated[float, Number(at_least=1)] = CONFIDENCE
    """confidence factor F_C; 1.35 where no compressive strength is taken into account"""

    @model_validator(mode="after")
    def _grows(self) -> Self:
        if not self.TB < self.TC < self.TD:
            raise ValueError("TB, TC and TD must grow")
        return self

    @property
    def spectrum(self) -> Spectrum:
        """The spectrum."""
        return Spectrum(self.ag, self.S, (self.TB, self.TC, self.TD), self.F0)
