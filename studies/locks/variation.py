"""Joints that vary: Sobol indices of the law, scatter of strength, sizes that are not printed.

Sensitivity of the first failure: Sobol indices of the law over a sampling's ranges. A load is
proportional to the bonds' strength, whose span is about its scatter in masonry. The paper prints
a b = 0.003 m2: the law gives the number of locks that work over the spans of a, h and H that such
joints may have, with friction as printed and as fitted.
"""

from collections.abc import Callable
from dataclasses import replace
from itertools import product

import numpy as np
import pandas as pd
from scipy.stats import loguniform, sobol_indices, uniform

from sidmacib.joint import Direction, Joint, UpperBody
from sidmacib.joint.loading import Loading
from sidmacib.mechanics.assembly import Floats
from sidmacib.rule import first_failure, law
from sidmacib.rule.reliability import FIFTH_PERCENTILE, scatter
from sidmacib.validation import dataclass_from
from workflow.results.tables import Table, write_table
from workflow.sampling import with_ratios
from workflow.schema.sections import SamplingSection
from workflow.step import Arguments, Files, step

BODIES = (UpperBody.COLUMNS, UpperBody.MONOLITHIC)
SENSITIVITY_LOCKS = (5, 9)
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
SCATTERED_LOCKS = (3, 5, 9, 15)
VARIATIONS = (0.1, 0.2, 0.3)  # coefficients of variation of a lock's strength
LOCKS = (3, 5, 7, 15)
AREA = 0.003  # a b in m2; Table 1 of the paper
SLENDERNESS = (0.8, 1.2, 2.0, 3.0)  # a / b
HEIGHTS = (0.08, 0.16, 0.3, 0.6)  # h / b
BODY_HEIGHTS = (0.4, 0.54, 1.0, 2.0)  # H / b
FRICTIONS = (0.005, 0.3)
CHARACTERISTIC = Table(
    "characteristic",
    (
        *("locks", "upper_body", "eccentricity_over_a", "variation", "law_N"),
        *("median_over_law", "characteristic_over_law"),
    ),
    ("locks", "upper_body", "eccentricity_over_a", "variation"),
    digits=4,
)
ASSUMED_SIZES = Table(
    "assumed_sizes",
    (
        *("locks", "friction", "half", "sizes", "working_at_assumed_sizes", "least_working"),
        *("median_working", "most_working", "unsafe_share_of_half"),
    ),
    ("locks", "friction"),
    digits=4,
)


def sensitivity_table(sampling: SamplingSection, base: Joint, draws: int = DRAWS) -> pd.DataFrame:
    """First-order and total index of each parameter, spread as in ``sampling``, for both bodies.

    ``friction`` is spread evenly from none to the most, the others in their logarithm.
    """
    spans = {name: getattr(sampling, name) for name in RATIO_NAMES} | {"cohesion": COHESIONS}
    spreads = [
        uniform(0.0, span[1]) if name == "friction" else loguniform(*span)
        for name, span in spans.items()
    ]
    rows = []
    for locks, body in product(SENSITIVITY_LOCKS, BODIES):
        loads = _loads(base, locks, body)
        indices = sobol_indices(
            func=loads, n=draws, dists=spreads, rng=np.random.default_rng(sampling.seed)
        )
        values = loads(np.array([spread.rvs(draws, random_state=1) for spread in spreads]))
        for direction, ratio in enumerate(RATIOS):
            mean = float(values[direction].mean())
            found = pd.DataFrame(
                {
                    "locks": locks,
                    "upper_body": str(body),
                    "eccentricity_over_a": ratio,
                    "parameter": VARIED,
                    "first_order": indices.first_order[direction],
                    "total": indices.total_order[direction],
                    "mean_over_T0": mean,
                    "variation": float(values[direction].std()) / mean,
                }
            )
            rows.append(found)
    return pd.concat(rows)


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


def characteristic_table(base: Joint) -> pd.DataFrame:
    """Median and 5 % quantile of the first failure over the law's, for joints like ``base``."""
    rows = []
    for locks, body, ratio, variation in product(SCATTERED_LOCKS, BODIES, RATIOS, VARIATIONS):
        joint = replace(base, locks=locks, upper_body=body)
        first = scatter(joint, Direction(ratio), variation)
        rows.append(
            {
                "locks": locks,
                "upper_body": str(body),
                "eccentricity_over_a": ratio,
                "variation": variation,
                "law_N": first.load,
                "median_over_law": first.quantile(0.5) / first.load,
                "characteristic_over_law": first.quantile(FIFTH_PERCENTILE) / first.load,
            }
        )
    return pd.DataFrame(rows)


def assumed_sizes_table(base: Joint) -> pd.DataFrame:
    """Locks that work in pure shear over all sizes, and (n - 1) / 2, by locks and friction."""
    rows = []
    for locks, friction in product(LOCKS, FRICTIONS):
        joint = replace(base, locks=locks, dry=replace(base.dry, friction=friction))
        working = np.array(
            [
                _working(replace(joint, a=ratio * b, b=b, h=h * b, H=height * b))
                for ratio, h, height in product(SLENDERNESS, HEIGHTS, BODY_HEIGHTS)
                for b in [(AREA / ratio) ** 0.5]  # a b is as printed
            ]
        )
        half = (locks - 1) / 2
        rows.append(
            {
                "locks": locks,
                "friction": friction,
                "half": half,
                "sizes": len(working),
                "working_at_assumed_sizes": _working(joint),
                "least_working": float(working.min()),
                "median_working": float(np.median(working)),
                "most_working": float(working.max()),
                "unsafe_share_of_half": float((working < 0.99 * half).mean()),
            }
        )
    return pd.DataFrame(rows)


def _working(joint: Joint) -> float:
    return law(joint, Direction(0.0)).load / joint.T0


def run(arguments: Arguments, inputs: Files, outputs: Files) -> None:
    """Write the tables."""
    sampling = SamplingSection.model_validate_json(arguments["sampling"])
    base = dataclass_from(Joint, arguments["base"])
    write_table(SENSITIVITY, sensitivity_table(sampling, base), outputs["sensitivity"])
    write_table(CHARACTERISTIC, characteristic_table(base), outputs["characteristic"])
    write_table(ASSUMED_SIZES, assumed_sizes_table(base), outputs["assumed_sizes"])


if __name__ == "__main__":
    step(run)
