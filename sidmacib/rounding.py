"""Numbers without the rounding noise of processors, and as they are told."""

DIGITS = 10  # significant digits that are kept
LARGEST = 1e9  # number told without an exponent


def rounded(value: float) -> float:
    """``value`` to `DIGITS` significant digits; never -0."""
    return float(f"{value:.{DIGITS}g}") + 0.0


def clean(value: float, noise: float) -> float:
    """``value`` in multiples of ``noise``: the same on every machine."""
    return rounded(round(value / noise) * noise)


def four_digits(value: float) -> str:
    """``value`` in four digits, without an exponent up to `LARGEST`."""
    whole = 1e4 <= abs(value) < LARGEST
    return f"{value:.0f}" if whole else f"{value:.4g}"
