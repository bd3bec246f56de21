"""How much hangs on the sizes that the paper does not print: what they make of its conclusions.

It prints a b = 0.003 m2. Over the spans of a, h and H that such joints may have, and with friction
as printed and as it fits, the law tells how many locks work.
"""

from collections.abc import Mapping
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from sidmacib.chain.rule import law
from sidmacib.joint import Direction, Joint
from workflow.plain import read_plain
from workflow.results.tables import ASSUMED_SIZES, write_table

LOCKS = (3, 5, 7, 15)
AREA = 0.003  # a b in m2; Table 1 of the paper
SLENDERNESS = (0.8, 1.2, 2.0, 3.0)  # a / b
HEIGHTS = (0.08, 0.16, 0.3, 0.6)  # h / b
BODIES = (0.4, 0.54, 1.0, 2.0)  # H / b
FRICTIONS = (0.005, 0.3)


def assumed_sizes_table(base: Joint) -> pd.DataFrame:
    """Locks that work in pure shear over all sizes, beside (n - 1) / 2, by locks and friction."""
    rows = []
    for locks, friction in product(LOCKS, FRICTIONS):
        working = np.array(
            [
                _working(replace(base, locks=locks), sizes, friction)
                for sizes in product(SLENDERNESS, HEIGHTS, BODIES)
            ]
        )
        assumed = replace(base, locks=locks, dry=replace(base.dry, friction=friction))
        rows.append(
            {
                "locks": locks,
                "friction": friction,
                "half": (locks - 1) / 2,
                "sizes": len(working),
                "working_at_assumed_sizes": law(assumed, Direction(0.0)).load / assumed.T0,
                "least_working": float(working.min()),
                "median_working": float(np.median(working)),
                "most_working": float(working.max()),
                "unsafe_share_of_half": float((working < 0.99 * (locks - 1) / 2).mean()),
            }
        )
    return pd.DataFrame(rows, columns=list(ASSUMED_SIZES.columns))


def _working(base: Joint, sizes: tuple[float, float, float], friction: float) -> float:
    slenderness, height, body = sizes
    b = (AREA / slenderness) ** 0.5
    joint = replace(
        base,
        a=slenderness * b,
        b=b,
        h=height * b,
        H=body * b,
        dry=replace(base.dry, friction=friction),
    )
    return law(joint, Direction(0.0)).load / joint.T0


def run(
    arguments: Mapping[str, Any], inputs: Mapping[str, Path], outputs: Mapping[str, Path]
) -> None:
    """Write the table."""
    base = read_plain(Joint, arguments["base"])
    write_table(ASSUMED_SIZES, assumed_sizes_table(base), outputs["assumed_sizes"])
