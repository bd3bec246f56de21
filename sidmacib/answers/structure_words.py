"""The answer of the static model for a structure in words."""

from sidmacib.problem import Counts
from sidmacib.quantities import four_digits


def load_words(load: float, weight: float | None) -> str:
    """A ``load`` (N) beside the ``weight`` (N) of the free blocks; degrees without one."""
    return (
        f"{load:.4g}°"
        if weight is None
        else f"{four_digits(load)} N, {load / weight:.3g} of the weight"
    )


def answer_words(load: float, weight: float | None, counts: Counts, mode: str | None) -> str:
    """What happens at the ``load`` that counts, and how the structure fails.

    Arguments as of `load_words`.
    """
    at = load_words(load, weight)
    if not counts.peak:
        return f"first bond failure at {at}; {counts}"
    return f"{'last equilibrium' if weight is None else 'peak'} at {at}; failure mode: {mode}"
