"""How an engine searches the peak."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Numerics:
    """How the peak is searched; all values are pure numbers.

    ``tolerance``: last load increment over the peak. ``first_increment``: over the loads' scale.
    ``ramp_periods``, ``hold_periods``: duration of an increment and of the longest wait for
    equilibrium after it, over the unbroken assembly's longest natural period. ``unbalanced_ratio``:
    mean unbalanced force on a piece over the load. ``collapse_ratio``: displacement over that of
    the unbroken assembly under the same load. ``damping``: share of the unbalanced force that is
    taken out, of engines that do not ignore it. ``time_step_ratio``: over the largest stable time
    step. ``ranks``: processes for one case, of engines that can share it out.
    """

    tolerance: float = 0.001
    first_increment: float = 0.05
    ramp_periods: float = 40.0
    hold_periods: float = 400.0
    unbalanced_ratio: float = 1e-4
    collapse_ratio: float = 200.0
    damping: float = 0.4
    time_step_ratio: float = 0.4
    ranks: int = 1
