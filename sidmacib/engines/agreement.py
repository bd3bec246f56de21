"""Whether an engine agrees with the static model of the same pieces, loads and nodes."""

from sidmacib.problem import FIRST_FAILURE, PEAK, Failures

APART = 0.1  # of a load of the static model: what differs by more is said


def disagreement(peak: float | None, first: float | None, static: Failures) -> str:
    """In which load an engine differs from the ``static`` model, in words; nothing if in none.

    ``peak``, ``first``: those of the engine, None if it does not say; all loads in one unit. Of the
    static model, a load that is not known is nan. A peak below its first failure matters most, then
    the peak.
    """
    if peak is not None and peak < (1.0 - APART) * static.first:
        return _words(PEAK, peak, FIRST_FAILURE, static.first)
    for which, found, expected in ((PEAK, peak, static.peak), (FIRST_FAILURE, first, static.first)):
        if found is not None and abs(found - expected) > APART * expected:
            return _words(which, found, which, expected)
    return ""


def _words(which: str, found: float, other: str, expected: float) -> str:
    way = "below" if found < expected else "above"
    apart = f"{100.0 * abs(found / expected - 1.0):.0f} %" if expected else "far"
    return f"disagrees with the static model: {which} {apart} {way} its {other}"
