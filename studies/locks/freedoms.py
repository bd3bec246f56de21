"""Fit of SiDMACIB's polygon to the peaks of sampled joints, by its free parameters.

Without friction, SiDMACIB's load is that of one lock times the number of locks that count, however
the strength is shared among the locks. So only that number and the contact points can be fitted to
the peaks in all directions. The number with the smallest largest misfit is known in closed form:
two over the sum of the largest and the smallest ratio of load to peak.
"""

from collections.abc import Sequence
from itertools import product

import numpy as np
import pandas as pd

from sidmacib.contact_points import OPTIONS, ContactOption
from sidmacib.mechanics.assembly import Floats
from studies.locks.tables import POINTS, brittle_odd_joints, by_locks, unit_loads
from workflow.results.tables import Table, read_table, write_table
from workflow.step import Arguments, Files, step

POSITIONS = np.linspace(0.02, 0.5, 25)  # of a pair's points, over a
ENDS = np.linspace(0.05, 0.5, 10)  # the same, beside a third point in the middle,
MIDDLES = np.linspace(0.1, 0.9, 9)  # and what that has of the strength
RULE, ONE, EACH, THIRD = "half with option4", "one pair for all", "own pair", "own three points"
FREEDOMS = Table(
    "freedoms",
    (
        *("sampling", "freedom", "upper_body", "locks", "joints", "mean_misfit"),
        *("misfit_95_percent", "locks_that_count", "position_over_a", "middle_share"),
    ),
    ("sampling", "freedom", "upper_body", "locks"),
    digits=4,
)


def fits(peaks: Floats, locks: Floats, ratios: Sequence[float]) -> dict[str, pd.DataFrame]:
    """Fit of ``peaks`` (N, D) over T0 with each freedom, for joints with so many ``locks``, (N,).

    A row for each joint. ``misfit``: the largest of load over peak, less 1, in all directions;
    ``locks``: that count; ``position``: of the outer points over a; ``middle``: strength of the
    middle point over the lock's.
    """

    def fixed(option: ContactOption) -> pd.DataFrame:
        ratio = unit_loads(option, ratios) / peaks
        most, least = ratio.max(axis=1), ratio.min(axis=1)
        return pd.DataFrame(
            {
                "misfit": (most - least) / (most + least),
                "locks": 2.0 / (most + least),
                "position": option.positions[-1],
                "middle": option.portions[1] if len(option.portions) == 3 else 0.0,
            }
        )

    half = (locks - 1.0) / 2.0
    rule = np.abs(unit_loads(OPTIONS["option4"], ratios) * half[:, None] / peaks - 1.0).max(axis=1)
    every = {RULE: pd.DataFrame({"misfit": rule, "locks": half, "position": 0.25, "middle": 0.0})}
    every |= {name: fixed(option) for name, option in OPTIONS.items()}
    pairs = [fixed(ContactOption.pair(position)) for position in POSITIONS.tolist()]
    triples = [
        fixed(ContactOption((-end, 0.0, end), ((1.0 - part) / 2.0, part, (1.0 - part) / 2.0)))
        for end, part in product(ENDS.tolist(), MIDDLES.tolist())
    ]
    every[ONE] = min(pairs, key=lambda each: float(each["misfit"].mean()))
    every[EACH] = _best(pairs)
    every[THIRD] = _best([*pairs, *triples])
    return every


def _best(fitted: Sequence[pd.DataFrame]) -> pd.DataFrame:
    """The fit of least misfit, joint by joint."""
    every = pd.concat(fitted).reset_index(names="joint")
    return every.loc[every.groupby("joint")["misfit"].idxmin()].reset_index(drop=True)


def freedoms_table(points: pd.DataFrame) -> pd.DataFrame:
    """Misfits by freedom, body and number of locks: odd joints under a plate, all directions."""
    rows = []
    for sampling, part in brittle_odd_joints(points).groupby("sampling", sort=True):
        peaks = part.pivot_table(
            index=["number", "upper_body", "locks"], columns="eccentricity_over_a", values="peak"
        ).dropna()
        ratios = [float(ratio) for ratio in peaks.columns]
        if len(ratios) < 3 or peaks.empty:  # two loads are always fitted
            continue
        joints = peaks.index.to_frame(index=False)
        fitted = fits(peaks.to_numpy(), joints["locks"].to_numpy(dtype=float), ratios)
        for (freedom, fit), ((body, locks), group) in product(fitted.items(), [*by_locks(joints)]):
            own = fit[group]
            if own.empty:
                continue
            rows.append(
                {
                    "sampling": sampling,
                    "freedom": freedom,
                    "upper_body": body,
                    "locks": locks,
                    "joints": len(own),
                    "mean_misfit": own["misfit"].mean(),
                    "misfit_95_percent": own["misfit"].quantile(0.95),
                    "locks_that_count": own["locks"].median(),
                    "position_over_a": own["position"].median(),
                    "middle_share": own["middle"].median(),
                }
            )
    return pd.DataFrame(rows, columns=list(FREEDOMS.columns))


def run(arguments: Arguments, inputs: Files, outputs: Files) -> None:
    """Write the table."""
    write_table(FREEDOMS, freedoms_table(read_table(POINTS, inputs["points"])), outputs["freedoms"])


if __name__ == "__main__":
    step(run)
