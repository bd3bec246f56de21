"""Blocks of numbers in a page: finding them, and filling them."""

import re
from pathlib import Path

from analysis.pages import attack, elastic, locks, published, scaling

BLOCK = re.compile(r"(<!-- numbers: ([\w-]+) -->\n)(?:.*?\n)??(<!-- end -->)", re.DOTALL)
MODULES = (published, elastic, locks, scaling, attack)
BLOCKS = {name: block for module in MODULES for name, block in module.BLOCKS.items()}


class PageError(ValueError):
    """A page asks for a block that there is not."""


def blocks_of(text: str) -> list[str]:
    """Names of the blocks in a page."""
    return [name for _, name, _ in BLOCK.findall(text)]


def filled(text: str, results: Path) -> str:
    """A page with its blocks made from the tables in ``results``; raises `PageError`."""

    def block(found: re.Match[str]) -> str:
        begin, name, end = found.groups()
        if name not in BLOCKS:
            raise PageError(f"{name}: no such numbers; there are {', '.join(BLOCKS)}")
        return f"{begin}{BLOCKS[name](results)}\n{end}"

    return BLOCK.sub(block, text)
