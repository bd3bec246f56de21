"""Tables of what ground motions do to structures: of each case, and of fragility.

Fragility is a lognormal distribution, fitted by maximum likelihood (Baker, Earthquake Spectra 31,
2015, doi:10.1193/021113EQS025M).
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
from scipy.optimize import minimize
from scipy.stats import norm

from sidmacib.mechanics.assembly import GRAVITY, Floats
from workflow.results import read_records
from workflow.results.earthquake_part import EarthquakeRecord
from workflow.results.tables import EARTHQUAKES, FRAGILITY, write_tables
from workflow.step import Arguments, FileLists, Files, step

INTENSITIES = {  # columns of the table: names, and what a number is divided by for people
    "peak_acceleration_m_s2": ("peak ground acceleration (g)", GRAVITY),
    "peak_velocity_m_s": ("peak ground velocity (m/s)", 1.0),
}
SAME = 1e-9  # of the largest intensity: they differ by less
CONFIDENCE = 0.90  # of the interval of a median
FLATTEST = 5.0  # dispersion: a larger one says that falls do not depend on the intensity


def earthquakes_table(records: Sequence[EarthquakeRecord]) -> pd.DataFrame:
    """A row for each record and factor."""
    return EARTHQUAKES.frame({**each.columns(), "case": each.name} for each in records)


def fragility_table(earthquakes: pd.DataFrame) -> pd.DataFrame:
    """A row for each structure and measure of intensity; cases that are open do not count."""
    return FRAGILITY.frame(
        {"structure": structure, "intensity": name, **fragility(known(rows), name)}
        for structure, rows in earthquakes.groupby("structure", sort=False)
        for name in INTENSITIES
    )


def known(earthquakes: pd.DataFrame) -> pd.DataFrame:
    """The rows with an answer that is not open."""
    return earthquakes[earthquakes["falls"].notna()]


def fragility(rows: pd.DataFrame, intensity: str) -> dict[str, Any]:
    """The median intensity at which a structure falls, its dispersion, and an interval.

    The dispersion is the standard deviation of the logarithm. The interval holds the median with
    `CONFIDENCE`; motions that are multiples of one record count as dependent. Where all that falls
    is above all that stands the interval is what lies between.
    """
    rows = rows[rows[intensity] > 0.0]  # no motion says nothing
    x, fell = rows[intensity].to_numpy(float), rows["falls"].to_numpy(bool)
    found: dict[str, Any] = {"motions": len(rows), "falls": int(fell.sum()), "note": ""}
    if note := _without_fit(x, fell):
        return {**found, "note": f"{note}: no fit"}
    least, most = float(x[fell].min()), float(x[~fell].max())
    if least >= most:
        note = "no motion that stands is above one that falls: no fit"
        return {**found, "median_low": most, "median_high": least, "note": note}
    (median, dispersion), share = _fitted(np.log(x), fell, rows["record"].to_numpy())
    if not 0.0 < dispersion < FLATTEST:
        return {**found, "note": "falls do not depend on this intensity: no fit"}
    found |= {"median": math.exp(median), "dispersion": dispersion}
    if share is None:
        return {**found, "note": "of one record: no interval"}
    reach = float(norm.ppf(0.5 + 0.5 * CONFIDENCE)) * share
    ends = math.exp(median - reach), math.exp(median + reach)
    return {**found, "median_low": ends[0], "median_high": ends[1]}


def _without_fit(x: Floats, fell: Any) -> str:
    """Why intensities ``x``, some of which ``fell`` a structure, tell nothing, or nothing."""
    if not len(x):
        return "no answer"
    if fell.all():
        return "all fall"
    if not fell.any():
        return "none falls"
    return "one intensity" if np.ptp(x) < SAME * x.max() else ""


def _fitted(x: Floats, fell: Floats, records: Any) -> tuple[tuple[float, float], float | None]:
    """Mean and standard deviation of the logarithm ``x`` at which structures fall.

    With the standard error of the mean, robust to dependence within ``records``; None of one.
    """
    terms = np.column_stack([np.ones_like(x), x])
    sign = np.where(fell, 1.0, -1.0)

    def unlikely(line: Floats) -> float:
        return -float(norm.logcdf(sign * (terms @ line)).sum())

    def scores(line: Floats) -> Floats:
        reach = sign * (terms @ line)
        return (sign * np.exp(norm.logpdf(reach) - norm.logcdf(reach)))[:, None] * terms

    spread = max(float(x.std()), 1e-6)
    start = np.array([-x.mean(), 1.0]) / spread
    best = minimize(unlikely, start, jac=lambda line: -scores(line).sum(axis=0), method="BFGS").x
    place, slope = map(float, best)
    if slope <= 0.0:
        return (math.nan, math.inf), None
    each, names = scores(best), np.unique(records)
    if len(names) < 2:
        return (-place / slope, 1.0 / slope), None
    clusters = np.array([each[records == name].sum(axis=0) for name in names])
    reach = terms @ best
    weight = np.exp(2.0 * norm.logpdf(reach) - norm.logcdf(reach) - norm.logsf(reach))
    bread = np.linalg.inv(terms.T @ (weight[:, None] * terms))
    few = len(names) / (len(names) - 1.0)
    gradient = np.array([-1.0 / slope, place / slope**2])
    variance = few * gradient @ bread @ clusters.T @ clusters @ bread @ gradient
    return (-place / slope, 1.0 / slope), math.sqrt(variance)


def run(arguments: Arguments, inputs: FileLists, outputs: Files) -> None:
    """Write both tables."""
    earthquakes = earthquakes_table(read_records(inputs["records"]))
    tables = {"earthquakes": earthquakes, "fragility": fragility_table(earthquakes)}
    write_tables(tables, outputs)


if __name__ == "__main__":
    step(run)
