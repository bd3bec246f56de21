"""Write synthetic ground motions that fit the elastic spectrum of EN 1998-1 into a folder.

``pip install reqpy-m``, then ``python -m studies.time.records studies/time/records``: noise in an
envelope that rises and decays, fitted by REQPY's wavelets (Montejo, doi:10.1177/8755293020970981).
Type 1, ground type B, 0.25 g, damping 5 %: 3.2.2.2 of EN 1998-1:2004.
"""

import sys
from pathlib import Path

import numpy as np
import reqpy_M as reqpy

COUNT, STEP, LENGTH = 5, 0.01, 10.0  # s
GROUND, SOIL, TB, TC, TD = 0.25, 1.2, 0.15, 0.5, 2.0  # a_g over g, S, periods in s
RISE, DECAY = 1.5, 6.0  # s


def spectrum(period: np.ndarray) -> np.ndarray:
    """Elastic response spectrum of acceleration over g at periods (s)."""
    up = 1.0 + period / TB * 1.5
    flat = np.full_like(period, 2.5)
    down = 2.5 * TC / period
    last = 2.5 * TC * TD / period**2
    shape = np.select([period < TB, period < TC, period < TD], [up, flat, down], last)
    return GROUND * SOIL * shape


def record(seed: int) -> np.ndarray:
    """Accelerations over g."""
    time = np.arange(0.0, LENGTH, STEP)
    rise = np.clip(time / RISE, 0.0, 1.0) ** 2
    noise = np.random.default_rng(seed).standard_normal(len(time))
    start = noise * rise * np.exp(-np.clip(time - DECAY, 0.0, None))
    periods = np.geomspace(0.02, 4.0, 200)
    found = reqpy.generate_single_component_compatible_record(
        start, 1.0 / STEP, periods, spectrum(periods), T1PSA=0.05, T2PSA=2.0
    )
    return found["sc"]


def main(folder: Path) -> None:
    """Write all records: time (s) and acceleration (m/s2)."""
    for number in range(1, COUNT + 1):
        values = 9.81 * record(number)
        rows = [f"{STEP * k:.2f} {a:.4f}" for k, a in enumerate(values)]
        head = "# time (s), acceleration (m/s2); synthetic, EN 1998-1 type 1, ground B, 0.25 g"
        (folder / f"synthetic{number}.txt").write_text("\n".join([head, *rows, ""]))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
