"""Summary of the earthquakes of a study: at which intensity structures fall."""

import math
from collections.abc import Iterator, Mapping
from typing import Any

import pandas as pd

from analysis.tables.earthquakes import CONFIDENCE, INTENSITIES, known


def lines(fragilities: pd.DataFrame) -> Iterator[tuple[str, str]]:
    """Each structure, and its fragility in words."""
    for name, rows in fragilities.groupby("structure", sort=False):
        first = rows.iloc[0]
        words = f"{first['falls']} of {first['motions']} motions bring it down"
        yield str(name), "; ".join([words, *map(_words, rows.to_dict("records"))])


def _words(row: Mapping[str, Any]) -> str:
    words, unit = INTENSITIES[row["intensity"]]
    name, _, measure = words.removesuffix(")").partition(" (")
    low, high, half = (row[each] / unit for each in ("median_low", "median_high", "median"))
    between = f"{low:.3g} to {high:.3g} {measure}"
    if math.isnan(half):
        found = f"by {name}" if math.isnan(low) else f"it falls at a {name} of {between}"
    else:
        interval = "" if math.isnan(low) else f" ({between} with {100 * CONFIDENCE:g} %)"
        found = f"half do at a {name} of {half:.3g} {measure}{interval}"
        found += f", dispersion {row['dispersion']:.2f}"
    return f"{found}, {row['note']}" if row["note"] else found


def summary(fragilities: pd.DataFrame, earthquakes: pd.DataFrame) -> str:
    """Fragilities in words, a line each."""
    found = ["Earthquakes: the intensity at which structures fall"]
    found += [f"{name}: {words}" for name, words in lines(fragilities)]
    if open_ones := len(earthquakes) - len(known(earthquakes)):
        found.append(f"{open_ones} motions are open or have no result, see tables/earthquakes.csv")
    return "\n".join([*found, ""])
