"""Which pairs of blocks a law or locks are for: named, all, or by a rule.

A rule may name the blocks by patterns, their materials, and the direction of their interfaces; all
that it has must hold.
"""

from collections.abc import Callable, Sequence
from fnmatch import fnmatchcase
from typing import Any

import numpy as np

from sidmacib.quantities import shown
from sidmacib.structure.blocks import Block
from sidmacib.structure.files.sections import Rule
from sidmacib.structure.interfaces import Interface

Pair = frozenset[str]  # names of two blocks


class Selection:
    """The pairs of ``blocks`` that touch, for rules to choose from.

    ``found``: their interfaces, which are looked for when a rule needs them first.
    """

    def __init__(self, blocks: Sequence[Block], find: Callable[[], tuple[Interface, ...]]) -> None:
        self.blocks, self._find = blocks, find
        self.found: tuple[Interface, ...] | None = None

    def pairs(self, key: str, between: "str | tuple[str, str] | Rule") -> list[Pair]:
        """The pairs that a file's ``between`` stands for: two names, all, or a rule.

        ValueError, which begins with ``key``, for a rule that no pair fits.
        """
        if isinstance(between, Rule):
            return self._by_rule(key, between)
        return [frozenset(between)] if isinstance(between, tuple) else list(self._normals())

    def _normals(self) -> dict[Pair, list[np.ndarray]]:
        """The normals of each pair's interfaces, in the order of the interfaces."""
        if self.found is None:
            self.found = self._find()
        normals: dict[Pair, list[np.ndarray]] = {}
        for each in self.found:
            pair = frozenset((self.blocks[each.below].name, self.blocks[each.above].name))
            normals.setdefault(pair, []).append(each.axes[0])
        return normals

    def _by_rule(self, key: str, rule: Rule) -> list[Pair]:
        made_of = {block.name: block.material for block in self.blocks}
        normals = self._normals()
        chosen = list(normals)
        if rule.blocks:
            chosen = [pair for pair in chosen if _fit(sorted(pair), rule.blocks, fnmatchcase)]
        if rule.materials:
            known = sorted({of for of in made_of.values() if of is not None})
            for name in rule.materials:
                if name not in known:
                    allowed = ", ".join(known) or "that of a block, none of which has any"
                    raise ValueError(
                        f"{key}.materials: {shown(name)} is not allowed; it must be {allowed}"
                    )
            chosen = [
                pair
                for pair in chosen
                if _fit([made_of[name] for name in sorted(pair)], rule.materials, str.__eq__)
            ]
        if rule.normal:  # either way, and of every interface
            axis = np.array(rule.normal) / np.linalg.norm(rule.normal)
            least = np.cos(np.radians(rule.within)) - 1e-9
            chosen = [p for p in chosen if all(abs(float(n @ axis)) >= least for n in normals[p])]
        if not chosen:
            raise ValueError(f"{key}: fits no two blocks that touch")
        return chosen


def _fit(pair: Sequence[Any], texts: tuple[str, str], fits: Callable[[Any, str], bool]) -> bool:
    """Whether the two of a ``pair`` fit two ``texts``, in either order."""
    one, other = pair
    return any(fits(one, first) and fits(other, last) for first, last in (texts, texts[::-1]))
