"""Sensitivity of the first failure: Sobol indices of the law over a sampling's ranges.

A load is proportional to the bonds' strength, whose span is about its scatter in masonry.
"""

from collections.abc import Callable
from dataclasses import replace
from itertools import product

import numpy as np
import pandas as pd
from scipy.stats import loguniform, sobol_indices, uniform

from sidmacib.joint.joint import Direction, Joint, UpperBody
from sidmacib.joint.loading import Loading
from sidmacib.mechanics.assembly import Floats
from sidmacib.rule.law import first_failure
from sidmacib.validation import dataclass_from
from workflow.results.tables import Table, write_table
from workflow.run.step import Arguments, Files, step
from workflow.sampling import Sampling, with_ratios

LOCKS = (5, 9)
RATIOS = (0.0, 0.3)  # e / a
DRAWS = 128  # a power of two, as Sobol sequences want
RATIO_NAMES = (
    *("a_over_b", "h_over_b", "H_over_b", "shear_over_normal", "dry_over_inner", "friction"),
)
COHESIONS = (1.0 / 1.5, 1.5)  # over the study's: a scatter of some 25 %
VARIED = (*RATIO_NAMES, "cohesion")
SENSITIVITY = Table(
    "sensitivity",
    (
        *("locks", "upper_body", "eccentricity_over_a", "parameter", "first_order", "total"),
        *("mean_over_T0", "variation"),
    ),
    ("locks", "upper_body", "eccentricity_over_a", "parameter"),
    digits=4,
)


def sensitivity_table(sampling: Sampling, base: Joint, draws: int = DRAWS) -> pd.DataFrame:
    """First-order and total index of each parameter, spread as in ``sampling``, for both bodies.

    ``friction`` is spread evenly from none to the most, the others in their logarithm.
    """
    spans = {name: getattr(sampling, name) for name in RATIO_NAMES} | {"cohesion": COHESIONS}
    spreads = [
        uniform(0.0, span[1]) if name == "friction" else loguniform(*span)
        for name, span in spans.items()
    ]
    rows = []
    for locks, body in product(LOCKS, (UpperBody.COLUMNS, UpperBody.MONOLITHIC)):
        loads = _loads(base, locks, body)
        indices = sobol_indices(
            func=loads, n=draws, dists=spreads, rng=np.random.default_rng(sampling.seed)
        )
        values = loads(np.array([spread.rvs(draws, random_state=1) for spread in spreads]))
        for direction, ratio in enumerate(RATIOS):
            for place, name in enumerate(VARIED):
                rows.append(
                    {
                        "locks": locks,
                        "upper_body": str(body),
                        "eccentricity_over_a": ratio,
                        "parameter": name,
                        "first_order": float(indices.first_order[direction, place]),
                        "total": float(indices.total_order[direction, place]),
                        "mean_over_T0": float(values[direction].mean()),
                        "variation": float(values[direction].std() / values[direction].mean()),
                    }
                )
    return pd.DataFrame(rows, columns=list(SENSITIVITY.columns))


def _loads(base: Joint, locks: int, body: UpperBody) -> Callable[[Floats], Floats]:
    """First failures over T0, shape (directions, N), of joints with parameters of shape (7, N)."""

    def loads(values: Floats) -> Floats:
        over = np.empty((len(RATIOS), values.shape[1]))
        for column, (*ratios, cohesion) in enumerate(values.T.tolist()):
            joint = with_ratios(replace(base, locks=locks, upper_body=body), *ratios)
            for row, ratio in enumerate(RATIOS):
                state = first_failure(joint, Loading(Direction(ratio)))
                over[row, column] = cohesion * state.load / joint.T0
        return over

    return loads


def run(arguments: Arguments, inputs: Files, outputs: Files) -> None:
    """Write the table."""
    sampling = dataclass_from(Sampling, arguments["sampling"])
    base = dataclass_from(Joint, arguments["base"])
    write_table(SENSITIVITY, sensitivity_table(sampling, base), outputs["sensitivity"])


if __name__ == "__main__":
    step(run)
