"""Parameters of an engine's search for the peak."""

from dataclasses import dataclass
from typing import Annotated

from sidmacib.quantities import Number, Share


@dataclass(frozen=True)
class Numerics:
    """Parameters of the search for the peak; all are dimensionless.

    The configuration takes keys, ranges and defaults of ``dem.numerics`` from here. Which of them
    an engine takes notice of is in its `reads`.
    """

    # last load increment over the peak
    tolerance: Annotated[float, Number(at_least=1e-5, at_most=0.0025)] = 0.001
    # whether the search starts near the result of the static model
    guided: bool = True
    # over the loads' scale, where it does not
    first_increment: Annotated[float, Number(above=0, at_most=1)] = 0.02
    # time in which the whole load is raised, and the longest wait for equilibrium after an
    # increment, both over the longest natural period of the unbroken assembly
    ramp_periods: Annotated[float, Number(at_least=1, at_most=1000)] = 40.0
    hold_periods: Annotated[float, Number(at_least=1, at_most=100_000)] = 4000.0
    # mean unbalanced force on a piece over the load; less is equilibrium
    unbalanced_ratio: Annotated[float, Number(at_least=1e-9, at_most=0.01)] = 1e-4
    # displacement since the last equilibrium over the mean size of pieces; what has moved further,
    # and moves ever faster, falls
    collapse_share: Annotated[float, Number(at_least=0.001, at_most=1)] = 0.04
    # share of the unbalanced force that is removed
    damping: Share = 0.4
    # over the largest stable time step
    time_step_ratio: Share = 0.4
    # processes for one case
    ranks: Annotated[int, Number(at_least=1, at_most=1024, whole=True)] = 1
