"""Which parameter the first failure hangs on: Sobol indices of the law over a design's spans.

A load is proportional to the bonds' strength, which is spread as much as it may scatter in masonry.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy.stats import loguniform, sobol_indices, uniform

from sidmacib.chain.failure import first_failure
from sidmacib.joint import Direction, Joint, UpperBody
from sidmacib.loading import Loading
from sidmacib.mechanics.assembly import Floats
from workflow.design import Design, with_ratios
from workflow.plain import read_plain
from workflow.results.tables import SENSITIVITY, write_table

LOCKS = (5, 9)
RATIOS = (0.0, 0.3)  # e / a
DRAWS = 128  # a power of two, as Sobol sequences want
RATIO_NAMES = (
    *("a_over_b", "h_over_b", "H_over_b", "shear_over_normal", "dry_over_inner", "friction"),
)
COHESIONS = (1.0 / 1.5, 1.5)  # over the design's: some 25 % of scatter
PARAMETERS = (*RATIO_NAMES, "cohesion")


def sensitivity_table(design: Design, base: Joint, draws: int = DRAWS) -> pd.DataFrame:
    """First-order and total index of each parameter, spread as in ``design``, for both bodies.

    ``friction`` is spread evenly from none to the most, the others in their logarithm.
    """
    spans = {name: getattr(design, name) for name in RATIO_NAMES} | {"cohesion": COHESIONS}
    spreads = [
        uniform(0.0, span[1]) if name == "friction" else loguniform(*span)
        for name, span in spans.items()
    ]
    rows = []
    for locks, body in product(LOCKS, (UpperBody.COLUMNS, UpperBody.MONOLITHIC)):
        loads = _loads(base, locks, body)
        found = sobol_indices(
            func=loads, n=draws, dists=spreads, rng=np.random.default_rng(design.seed)
        )
        values = loads(np.array([spread.rvs(draws, random_state=1) for spread in spreads]))
        for direction, ratio in enumerate(RATIOS):
            for place, name in enumerate(PARAMETERS):
                rows.append(
                    {
                        "locks": locks,
                        "upper_body": str(body),
                        "eccentricity_over_a": ratio,
                        "parameter": name,
                        "first_order": float(found.first_order[direction, place]),
                        "total": float(found.total_order[direction, place]),
                        "mean_over_T0": float(values[direction].mean()),
                        "variation": float(values[direction].std() / values[direction].mean()),
                    }
                )
    return pd.DataFrame(rows, columns=list(SENSITIVITY.columns))


def _loads(base: Joint, locks: int, body: UpperBody) -> Callable[[Floats], Floats]:
    """First failures over T0, shape (directions, N), of joints with parameters of shape (7, N)."""

    def loads(values: Floats) -> Floats:
        found = np.empty((len(RATIOS), values.shape[1]))
        for column, (*ratios, cohesion) in enumerate(values.T.tolist()):
            joint = with_ratios(replace(base, locks=locks, upper_body=body), *ratios)
            for row, ratio in enumerate(RATIOS):
                state = first_failure(joint, Loading(Direction(ratio)))
                found[row, column] = cohesion * state.load / joint.T0
        return found

    return loads


def run(
    arguments: Mapping[str, Any], inputs: Mapping[str, Path], outputs: Mapping[str, Path]
) -> None:
    """Write the table."""
    design, base = read_plain(Design, arguments["design"]), read_plain(Joint, arguments["base"])
    write_table(SENSITIVITY, sensitivity_table(design, base), outputs["sensitivity"])
