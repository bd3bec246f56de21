"""Two variants beside each other: in what they differ, and what each of them carries."""

from collections.abc import Mapping
from typing import Any

from sidmacib.quantities import four_digits

Figure = float | str | None
Figures = Mapping[str, Figure]
EQUAL = 1e-9  # of the larger of two numbers
MOST_INPUTS = 20  # that are told


def compared(inputs: tuple[Figures, Figures], results: tuple[Figures, Figures]) -> list[list[Any]]:
    """Lines: name, kept, shown, difference, and that in percent of what is kept.

    ``inputs`` and ``results`` of the variant that is shown, and of the one that is kept: inputs
    only where they differ, the first `MOST_INPUTS` of them.
    """
    lines = [_line(name, *pair) for name, pair in _paired(*inputs).items() if _differ(*pair)]
    if (more := len(lines) - MOST_INPUTS) > 0:
        lines[MOST_INPUTS:] = [[f"and {more} more", "", "", "", ""]]
    return lines + [_line(name, *pair) for name, pair in _paired(*results).items()]


def _paired(shown: Figures, kept: Figures) -> dict[str, tuple[Figure, Figure]]:
    return {name: (kept.get(name), shown.get(name)) for name in {**shown, **kept}}


def _differ(one: Figure, other: Figure) -> bool:
    if isinstance(one, str | None) or isinstance(other, str | None):
        return one != other
    return abs(other - one) > EQUAL * max(abs(one), abs(other))


def _line(name: str, kept: Figure, shown: Figure) -> list[Any]:
    given = ["\N{EN DASH}" if value is None else value for value in (kept, shown)]
    if isinstance(kept, str | None) or isinstance(shown, str | None):
        return [name, *given, "", ""]
    change = 0.0 if four_digits(kept) == four_digits(shown) else shown - kept
    share = _signed(f"{round(100.0 * change / abs(kept), 1) + 0.0:.1f} %") if kept else ""
    return [name, *given, _signed(four_digits(change)), share]


def _signed(text: str) -> str:
    if text.startswith("-"):
        return text.replace("-", "\N{MINUS SIGN}", 1)
    return f"+{text}" if text.strip("0. %") else text
