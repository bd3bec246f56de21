"""Numbers without the rounding noise of processors."""

DIGITS = 10  # significant digits that are kept


def rounded(value: float) -> float:
    """``value`` to `DIGITS` significant digits; never -0."""
    return float(f"{value:.{DIGITS}g}") + 0.0


def clean(value: float, noise: float) -> float:
    """``value`` in multiples of ``noise``: the same on every machine."""
    return rounded(round(value / noise) * noise)
