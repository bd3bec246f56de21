"""Numbers of `make attack`: the worst joints that an optimiser found for the safe rule."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

import pandas as pd

from studies.attack.search import MORE, MORE_LOCKS, SPACES
from studies.markdown import markdown

HEAD = [
    *("space", "joints", "answered", "not solved"),
    *("safe / first failure", "safe / peak, on other nodes"),
]


def worst(results: Path, *, elastic: bool) -> str:
    """A row for each space of ``elastic`` or of rigid blocks: the worst of all starts.

    FileNotFoundError if the table has none of these spaces.
    """
    path = results / "tables/attack.csv"
    table = pd.read_csv(path)
    names = [space.name for space in SPACES if space.elastic is elastic]
    table = table[table["space"].isin(names)]
    if table.empty:
        blocks = "elastic" if elastic else "rigid"
        raise FileNotFoundError(None, None, f"the attack on {blocks} blocks in {path}")
    rows = []
    for space, group in table.groupby("space", sort=False):
        peaks = group.filter(regex=r"^safe_over_peak_\d+$").max(numeric_only=True)
        longer = group[[MORE.format(n) for n in MORE_LOCKS]].max() if elastic else []
        rows.append(
            [
                str(space),
                f"{group['evaluations'].sum():,}",
                f"{group['answered'].sum():,}",
                f"{group['unsolved'].sum():,}",
                f"{group['safe_over_first_failure'].max():.3f}",
                ", ".join(f"{value:.3f}" for value in peaks),
                *(f"{value:.3f}" for value in longer),
            ]
        )
    more = [f"{number} locks" for number in MORE_LOCKS] if elastic else []
    return markdown([*HEAD, *more], rows)


BLOCKS: dict[str, Callable[[Path], str]] = {
    "attack": partial(worst, elastic=False),
    "attack-elastic": partial(worst, elastic=True),
}
