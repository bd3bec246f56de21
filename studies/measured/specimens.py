"""Number of specimens that decide between columns and one piece.

    .venv/bin/python -m studies.measured.specimens results-measured/tables/specimens.csv

A laboratory that breaks joints of n locks, and joints of three from the same batch, measures the
ratio of their loads, in which the strength of the bonds cancels. The models predict two ratios. The
number of specimens is that of a two-sided test of the mean logarithm of the ratio, with normal
quantiles, for scattering strengths of the locks (`sidmacib.rule.reliability`).
"""

import argparse
import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import pandas as pd
from scipy.stats import norm

from sidmacib.joint import Direction, Joint, UpperBody
from sidmacib.mechanics.assembly import Elastic
from sidmacib.rule.reliability import scatter
from studies.markdown import direction as named
from studies.markdown import markdown_of
from workflow.results.tables import Table, write_table

REFERENCE_LOCKS = 3  # locks of the joint that others are compared with
LOCKS = (5, 7, 9, 11)
RATIOS = (0.0, 0.5, math.inf)  # e / a
VARIATION = 0.2  # of the locks' strengths, standard deviation over mean
SAWN = Joint(3, upper_body=UpperBody.COLUMNS)
WHOLE = Joint(3, upper_body=UpperBody.MONOLITHIC, elastic=Elastic(1e10))  # one piece that bends; Pa
SIGNIFICANCE, POWER = 0.05, 0.8  # of the test: of deciding without a difference, and with one
LEAST = 3  # specimens: fewer tell nothing of their scatter
SPECIMENS = Table(
    "specimens",
    (
        *("locks", "eccentricity_over_a", "columns_over_three", "one_piece_over_three"),
        *("log_deviation", "specimens"),
    ),
    ("locks", "eccentricity_over_a"),
    digits=4,
)


class Load(NamedTuple):
    """First failure at mean strength (N), and the standard deviation of its logarithm."""

    mean: float
    deviation: float


def specimens(difference: float, deviation: float) -> int:
    """Specimens of each of two kinds whose mean logarithms differ by ``difference``.

    ``deviation``: the standard deviation of the difference of one specimen of each kind. At least
    `LEAST`.
    """
    needed = (norm.isf(SIGNIFICANCE / 2) + norm.isf(1.0 - POWER)) * deviation / difference
    return max(LEAST, math.ceil(needed**2))


def rows() -> Iterator[tuple[float, ...]]:
    """A row of `SPECIMENS` for each number of locks and eccentricity."""
    for locks in LOCKS:
        for ratio in RATIOS:
            loads = {
                n: [_load(replace(joint, locks=n), Direction(ratio)) for joint in (SAWN, WHOLE)]
                for n in (REFERENCE_LOCKS, locks)
            }
            columns, whole = (
                many.mean / three.mean
                for three, many in zip(loads[REFERENCE_LOCKS], loads[locks], strict=True)
            )
            # Of the model whose loads scatter more.
            deviation = math.hypot(*(max(one.deviation for one in each) for each in loads.values()))
            count = specimens(math.log(whole / columns), deviation)
            yield locks, ratio, columns, whole, deviation, count


def _load(joint: Joint, direction: Direction) -> Load:
    found = scatter(joint, direction, VARIATION)
    sigma = norm.cdf(1.0)
    return Load(found.load, math.log(found.quantile(sigma) / found.quantile(1.0 - sigma)) / 2)


def in_markdown(results: Path) -> str:
    """The table for a page."""
    return markdown_of(
        pd.read_csv(results / "tables/specimens.csv"),
        {
            "locks": lambda row: str(row.locks),
            "e / a": lambda row: named(row.eccentricity_over_a),
            "columns, over 3 locks": lambda row: f"{row.columns_over_three:.2f}",
            "one piece, over 3 locks": lambda row: f"{row.one_piece_over_three:.2f}",
            "specimens of each": lambda row: str(row.specimens),
        },
    )


BLOCKS = {"specimens": in_markdown}


def main() -> None:
    """Command line: write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("table", type=Path)
    path = parser.parse_args().table
    path.parent.mkdir(parents=True, exist_ok=True)
    write_table(SPECIMENS, pd.DataFrame(rows(), columns=list(SPECIMENS.columns)), path)
    print(f"Table: {path}")


if __name__ == "__main__":
    main()
