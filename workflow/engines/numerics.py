"""How an engine searches the peak."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Numerics:
    """How the peak is searched; all numbers are pure.

    ``tolerance``: last load increment over the peak. ``guided``: whether the static model tells
    where to look first. ``first_increment``: over the loads' scale, where it does not.
    ``ramp_periods``, ``hold_periods``: time in which the whole load is raised, and of the longest
    wait for equilibrium after an increment, over the unbroken assembly's longest natural period.
    ``unbalanced_ratio``: mean unbalanced force on a piece over the load. ``collapse_ratio``:
    displacement over that of the unbroken assembly under the same load. ``damping``: share of the
    unbalanced force that is taken out, of engines that do not ignore it. ``time_step_ratio``: over
    the largest stable time step. ``ranks``: processes for one case, where an engine can share it.
    """

    tolerance: float = 0.001
    guided: bool = True
    first_increment: float = 0.05
    ramp_periods: float = 40.0
    hold_periods: float = 400.0
    unbalanced_ratio: float = 1e-4
    collapse_ratio: float = 200.0
    damping: float = 0.4
    time_step_ratio: float = 0.4
    ranks: int = 1
