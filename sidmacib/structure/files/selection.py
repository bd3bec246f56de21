"""Which pairs of blocks a law or locks are for: named, all, or by a rule.

A rule may name the blocks by patterns, their materials, and the direction of their interfaces; all
that it has must hold.
"""

from collections.abc import Callable, Mapping, Sequence
from fnmatch import fnmatchcase
from typing import Any

import numpy as np

from sidmacib.quantities import Number, shown
from sidmacib.structure.blocks import Block
from sidmacib.structure.interfaces import Interface
from sidmacib.validation import require_direction

Pair = frozenset[str]  # names of two blocks
ALL = "all"  # pairs of blocks that touch
RULE = ("blocks", "materials", "normal", "within")
WITHIN = 10.0  # degrees, by default, between an interface's normal and that of a rule
_ANGLE = Number(at_least=0, at_most=90, unit="degrees")


class Selection:
    """The pairs of ``blocks`` that touch, for rules to choose from.

    ``found``: their interfaces, which are looked for when a rule needs them first.
    """

    def __init__(self, blocks: Sequence[Block], find: Callable[[], tuple[Interface, ...]]) -> None:
        self.blocks, self._find = blocks, find
        self.found: tuple[Interface, ...] | None = None

    def pairs(self, key: str, value: Any) -> list[Pair]:
        """The pairs that a file's ``value`` stands for: two names, `all`, or a rule.

        ValueError, which begins with ``key``, for any other, and for a rule that no pair fits.
        """
        if value == ALL:
            return list(self._normals())
        if isinstance(value, dict):
            return self._by_rule(key, value)
        if not isinstance(value, list):
            allowed = f"a list of two blocks, {ALL}, or a rule with {', '.join(RULE)}"
            raise ValueError(f"{key}: {shown(value)} is not allowed; it must be {allowed}")
        if len(value) != 2:
            raise ValueError(f"{key}: must be a list of two blocks")
        return [frozenset(map(str, value))]

    def _normals(self) -> dict[Pair, list[np.ndarray]]:
        """The normals of each pair's interfaces, in the order of the interfaces."""
        if self.found is None:
            self.found = self._find()
        normals: dict[Pair, list[np.ndarray]] = {}
        for each in self.found:
            pair = frozenset((self.blocks[each.below].name, self.blocks[each.above].name))
            normals.setdefault(pair, []).append(each.axes[0])
        return normals

    def _by_rule(self, key: str, rule: Mapping[Any, Any]) -> list[Pair]:
        for name in rule:
            if name not in RULE:
                valid = ", ".join(RULE)
                raise ValueError(f"{key}: unknown key {shown(name)}; valid keys: {valid}")
        if not rule.keys() - {"within"}:
            raise ValueError(f"{key}: must have blocks, materials or normal")
        made_of = {block.name: block.material for block in self.blocks}
        chosen = list(self._normals())
        if "blocks" in rule:
            patterns = _two(f"{key}.blocks", rule["blocks"])
            chosen = [pair for pair in chosen if _fit(sorted(pair), patterns, fnmatchcase)]
        if "materials" in rule:
            names = _two(f"{key}.materials", rule["materials"])
            known = sorted({of for of in made_of.values() if of is not None})
            for name in names:
                if name not in known:
                    allowed = ", ".join(known) or "that of a block, none of which has any"
                    raise ValueError(
                        f"{key}.materials: {shown(name)} is not allowed; it must be {allowed}"
                    )
            chosen = [
                pair
                for pair in chosen
                if _fit([made_of[name] for name in sorted(pair)], names, lambda a, b: a == b)
            ]
        if "normal" in rule:
            chosen = self._along(key, rule, chosen)
        if not chosen:
            raise ValueError(f"{key}: fits no two blocks that touch")
        return chosen

    def _along(self, key: str, rule: Mapping[Any, Any], chosen: list[Pair]) -> list[Pair]:
        """Those of which every interface has the normal of a ``rule``, either way."""
        normal = rule["normal"]
        if not isinstance(normal, list):
            raise ValueError(f"{key}.normal: must be a list of three numbers")
        try:
            require_direction(normal=normal)
            within = _ANGLE.read(rule.get("within", WITHIN))
        except ValueError as error:
            name = "" if str(error).startswith("normal") else "within: "
            raise ValueError(f"{key}.{name}{error}") from None
        axis = np.array(normal, float) / np.linalg.norm(normal)
        least = np.cos(np.radians(within)) - 1e-9
        normals = self._normals()
        return [p for p in chosen if all(abs(float(n @ axis)) >= least for n in normals[p])]


def _two(key: str, value: Any) -> tuple[str, str]:
    """One text for both blocks of a pair, or a list of two."""
    both = value if isinstance(value, list) else [value, value]
    if len(both) != 2 or not all(isinstance(each, str) for each in both):
        raise ValueError(
            f"{key}: {shown(value)} is not allowed; it must be a text or two in a list"
        )
    return both[0], both[1]


def _fit(pair: Sequence[Any], texts: tuple[str, str], fits: Callable[[Any, str], bool]) -> bool:
    """Whether the two of a ``pair`` fit two ``texts``, in either order."""
    one, other = pair
    return any(fits(one, first) and fits(other, last) for first, last in (texts, texts[::-1]))
