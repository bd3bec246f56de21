"""Write numbers of a study's tables into pages.

    python -m studies.pages results-locks docs/law.md

A block stands between <!-- numbers: name --> and <!-- end -->; what was there is replaced, unless
its tables are not in the results.
"""

import re
import sys
from pathlib import Path

import studies.attack.page
import studies.designed_vault.all_layouts
import studies.elastic.page
import studies.layouts.page
import studies.locks.page
import studies.measured.specimens
import studies.published.page
import studies.run_times
import studies.structures.page

BLOCK = re.compile(r"(<!-- numbers: ([\w-]+) -->\n)(?:.*?\n)??(<!-- end -->)", re.DOTALL)
BLOCKS = {
    **studies.published.page.BLOCKS,
    **studies.elastic.page.BLOCKS,
    **studies.layouts.page.BLOCKS,
    **studies.locks.page.BLOCKS,
    **studies.attack.page.BLOCKS,
    **studies.designed_vault.all_layouts.BLOCKS,
    **studies.structures.page.BLOCKS,
    **studies.measured.specimens.BLOCKS,
    **studies.run_times.BLOCKS,
}


class PageError(ValueError):
    """A page names a block that does not exist."""


def blocks_of(text: str) -> list[str]:
    """Names of the blocks in a page."""
    return [name for _, name, _ in BLOCK.findall(text)]


def filled(text: str, results: Path) -> str:
    """A page with its blocks made from the tables in ``results``; raises `PageError`.

    A block whose table is not there stays as it is, and a line says so.
    """

    def block(match: re.Match[str]) -> str:
        begin, name, end = match.groups()
        if name not in BLOCKS:
            raise PageError(
                f"{name}: unknown block of numbers; it must be one of {', '.join(BLOCKS)}"
            )
        try:
            return f"{begin}{BLOCKS[name](results)}\n{end}"
        except FileNotFoundError as error:
            print(f"{name}: unchanged, as {error.filename} is missing", file=sys.stderr)
            return match[0]

    return BLOCK.sub(block, text)


def main() -> None:
    """Fill the pages that are named on the command line."""
    results, *pages = map(Path, sys.argv[1:])
    for page in pages:
        page.write_text(filled(page.read_text(), results))


if __name__ == "__main__":
    main()
