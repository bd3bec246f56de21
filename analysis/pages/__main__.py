"""Write numbers of a study's tables into pages.

    python -m analysis.pages results-locks docs/law.md

A block stands between <!-- numbers: name --> and <!-- end -->; what was there is replaced.
"""

import sys
from pathlib import Path

from analysis.pages.blocks import filled


def main() -> None:
    """Fill the pages that are named on the command line."""
    results, *pages = map(Path, sys.argv[1:])
    for page in pages:
        page.write_text(filled(page.read_text(), results))


if __name__ == "__main__":
    main()
