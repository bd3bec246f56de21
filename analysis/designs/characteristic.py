"""What is left of the first failure if the strength of locks scatters: the characteristic load."""

from collections.abc import Mapping
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import pandas as pd

from sidmacib.chain.scatter import FIFTH_PERCENTILE, scatter
from sidmacib.joint import Direction, Joint, UpperBody
from workflow.plain import read_plain
from workflow.results.tables import CHARACTERISTIC, write_table

LOCKS = (3, 5, 9, 15)
RATIOS = (0.0, 0.3)  # e / a
VARIATIONS = (0.1, 0.2, 0.3)


def characteristic_table(base: Joint) -> pd.DataFrame:
    """Mean and 5 % quantile of the first failure over the law's, for joints like ``base``."""
    rows = []
    for locks, body, ratio in product(LOCKS, (UpperBody.COLUMNS, UpperBody.MONOLITHIC), RATIOS):
        joint = replace(base, locks=locks, upper_body=body)
        for variation in VARIATIONS:
            own = scatter(joint, Direction(ratio), variation)
            rows.append(
                {
                    "locks": locks,
                    "upper_body": str(body),
                    "eccentricity_over_a": ratio,
                    "variation": variation,
                    "law_N": own.load,
                    "median_over_law": own.quantile(0.5) / own.load,
                    "characteristic_over_law": own.quantile(FIFTH_PERCENTILE) / own.load,
                }
            )
    return pd.DataFrame(rows, columns=list(CHARACTERISTIC.columns))


def run(
    arguments: Mapping[str, Any], inputs: Mapping[str, Path], outputs: Mapping[str, Path]
) -> None:
    """Write the table."""
    base = read_plain(Joint, arguments["base"])
    write_table(CHARACTERISTIC, characteristic_table(base), outputs["characteristic"])
