"""Which pairs of blocks a law or locks are for: named, all, or by a rule.

A rule may name the blocks by patterns, their materials, and the direction of their interfaces; all
that it has must hold.
"""

from collections.abc import Callable, Mapping, Sequence
from fnmatch import fnmatchcase
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import BeforeValidator, model_validator

from sidmacib.mechanics.assembly import Floats
from sidmacib.quantities import Number, shown
from sidmacib.reading import Keys, Way
from sidmacib.structure.blocks import Block
from sidmacib.structure.interfaces import Interface
from sidmacib.structure.structure import Pair

_Angle = Annotated[float, Number(at_least=0, at_most=90, unit="degrees")]


def _two(value: Any) -> tuple[str, str]:
    """One text for both blocks of a pair, or a list of two."""
    both = value if isinstance(value, list | tuple) else [value, value]
    if len(both) != 2 or not all(isinstance(each, str) for each in both):
        raise ValueError(f"{shown(value)} is not allowed; it must be a text or two in a list")
    return both[0], both[1]


_Two = Annotated[
    tuple[str, str], BeforeValidator(_two, json_schema_input_type=str | tuple[str, str])
]


class Rule(Keys):
    """Pairs of blocks that touch: all that a rule has must hold."""

    blocks: _Two | None = None
    """a pattern for both names, such as `"arch-*"`, or a list of two"""
    materials: _Two | None = None
    """a material of both blocks, or a list of two"""
    normal: Way | None = None
    """direction that the interface is perpendicular to, either way"""
    within: _Angle = 10.0
    """degrees between `normal` and that of the interface"""

    @model_validator(mode="after")
    def _chooses(self) -> Self:
        if not self.model_fields_set - {"within"}:
            raise ValueError("must have blocks, materials or normal")
        return self


def _between(value: Any) -> Any:
    if isinstance(value, Mapping):
        return Rule.model_validate(value)
    if isinstance(value, list | tuple):
        return two_blocks(value)
    if value != "all" and not isinstance(value, Rule):
        allowed = f"a list of two blocks, all, or a rule with {', '.join(Rule.model_fields)}"
        raise ValueError(f"{shown(value)} is not allowed; it must be {allowed}")
    return value


def two_blocks(value: Any) -> tuple[str, str]:
    """The names of two blocks; ValueError."""
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise ValueError(f"{shown(value)} is not allowed; it must be a list of two blocks")
    return str(value[0]), str(value[1])


Between = Annotated[Literal["all"] | tuple[str, str] | Rule, BeforeValidator(_between)]


def chosen_pairs(
    key: str,
    between: "str | tuple[str, str] | Rule",
    blocks: Sequence[Block],
    found: Sequence[Interface],
) -> list[Pair]:
    """The pairs of ``blocks`` that a file's ``between`` stands for: two names, all, or a rule.

    All and rules choose among those that touch in the interfaces ``found``, in their order.
    ValueError, which begins with ``key``, for a rule that no pair fits.
    """
    if isinstance(between, tuple):
        return [frozenset(between)]
    normals: dict[Pair, list[Floats]] = {}
    for each in found:
        normals.setdefault(each.pair(blocks), []).append(each.axes[0])
    chosen = list(normals)
    if not isinstance(between, Rule):
        return chosen
    if between.blocks:
        chosen = [pair for pair in chosen if _fit(sorted(pair), between.blocks, fnmatchcase)]
    if of := between.materials:
        made_of = {block.name: block.material for block in blocks}
        known = sorted({each for each in made_of.values() if each is not None})
        for name in of:
            if name not in known:
                allowed = ", ".join(known) or "that of a block, none of which has any"
                words = f"{shown(name)} is not allowed; it must be {allowed}"
                raise ValueError(f"{key}.materials: {words}")
        chosen = [p for p in chosen if _fit([made_of[n] for n in sorted(p)], of, str.__eq__)]
    if between.normal:  # either way, and of every interface
        axis = np.array(between.normal) / np.linalg.norm(between.normal)
        least = np.cos(np.radians(between.within)) - 1e-9
        chosen = [p for p in chosen if all(abs(float(n @ axis)) >= least for n in normals[p])]
    if not chosen:
        raise ValueError(f"{key}: fits no two blocks that touch")
    return chosen


def _fit(pair: Sequence[Any], texts: tuple[str, str], fits: Callable[[Any, str], bool]) -> bool:
    """Whether the two of a ``pair`` fit two ``texts``, in either order."""
    one, other = pair
    return any(fits(one, first) and fits(other, last) for first, last in (texts, texts[::-1]))
