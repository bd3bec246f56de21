"""A small change of a parameter of an assembly, for derivatives."""

from dataclasses import dataclass

from sidmacib.mechanics.assembly import Assembly, Loads


@dataclass(frozen=True)
class Change:
    """A small change of a parameter.

    ``before`` and ``after``: assembly and loads, with the same pieces, faces and number of nodes as
    those without the change. ``difference``: of the parameter between them. ``size``: of the
    parameter, 100 % of it.
    """

    before: tuple[Assembly, Loads]
    after: tuple[Assembly, Loads]
    difference: float
    size: float = 1.0
