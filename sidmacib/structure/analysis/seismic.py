r"""Verification of a mechanism for an earthquake by the displacement it can bear: Circolare 2019.

Circolare n. 7 of 21 January 2019 to the Italian code (NTC 2018), C8.7.1.2.1.3 to .8. The capacity
curve of the mechanism becomes that of an oscillator,

.. math::

    a = \frac{\alpha g}{e^* F_C}, \quad d = \frac{d_C}{e^*}, \quad
    e^* = \frac{(\sum P \delta)^2}{\sum P \, \sum P \delta^2}

where :math:`d_C` is the mean displacement by weight, P are the weights of the bodies that move (of
blocks that move as one), and :math:`\delta` their first displacements along the acceleration. It
bears 0.4 of the displacement :math:`d_0` at which a is 0. Blocks are rigid and stand on the ground.
"""

import math
from dataclasses import dataclass

import numpy as np

from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import GRAVITY, Assembly, Floats, Integers
from sidmacib.mechanics.loads import Loads
from sidmacib.structure.analysis.kinematics import (
    FURTHER,
    WEDGE,
    CapacityCurve,
    capacity_curve,
)
from sidmacib.structure.loads import StructureLoads, free_weight

CONFIDENCE = 1.35  # factor F_C where no compressive strength is taken into account
ULTIMATE = 0.4  # d_SLV over d_0
DAMPING = 0.08  # of the mechanism at SLV
BEHAVIOUR = 2.0  # factor q of the linear verification
LEVEL = 1e-9  # of an acceleration: its vertical part
STILL = 0.02  # of the largest displacement: less counts as none


@dataclass(frozen=True)
class Spectrum:
    """The elastic spectrum of EN 1998-1:2004, 3.2.2.2, and of NTC 2018, 3.2.3.2.

    ``ground``: the acceleration a_g on rock, m/s2; ``soil``: the factor S; ``amplification``: F_0;
    ``corners``: the periods T_B, T_C and T_D, s.
    """

    ground: float
    soil: float
    corners: tuple[float, float, float]
    amplification: float = 2.5

    def acceleration(self, period: float, damping: float) -> float:
        """S_e, m/s2, at a ``period`` (s)."""
        rise, flat, far = self.corners
        most = max(math.sqrt(10.0 / (5.0 + 100.0 * damping)), 0.55) * self.amplification
        if period < rise:
            shape = 1.0 + period / rise * (most - 1.0)
        else:
            shape = most * min(1.0, flat / period, flat * far / period**2)
        return self.ground * self.soil * shape

    def displacement(self, period: float, damping: float) -> float:
        """S_De, m, at a ``period`` (s)."""
        return self.acceleration(period, damping) * (period / (2.0 * math.pi)) ** 2


@dataclass(frozen=True, eq=False)
class SeismicCheck:
    """The oscillator of a mechanism under a ``spectrum``, which it bears or not.

    ``share``: of the mass that takes part, e*. ``acceleration`` (m/s2) over ``displacement`` (m) of
    the oscillator, both (K,).
    """

    spectrum: Spectrum
    curve: CapacityCurve
    share: float
    confidence: float
    acceleration: Floats
    displacement: Floats

    @property
    def start(self) -> float:
        """a_0, at which the mechanism begins, m/s2: equation C8.7.1.8."""
        return float(self.acceleration[0])

    @property
    def end(self) -> float:
        """d_0, m: where the acceleration is 0, or the curve ends before."""
        return float(self.displacement[-1])

    @property
    def ultimate(self) -> float:
        """d_SLV, m: C8.7.1.2.1.6."""
        return ULTIMATE * self.end

    @property
    def period(self) -> float:
        """T_SLV, s: equation C8.7.1.10."""
        there = float(np.interp(self.ultimate, self.displacement, self.acceleration))
        return 1.68 * math.pi * math.sqrt(self.ultimate / there)

    @property
    def demand(self) -> float:
        """The displacement that the spectrum asks for, m: C8.7.1.2.1.8."""
        return self.spectrum.displacement(self.period, DAMPING)

    @property
    def ratio(self) -> float:
        """What is borne over what is asked for."""
        return self.ultimate / self.demand

    @property
    def ground(self) -> float:
        """The ground acceleration a_g that the linear verification allows, m/s2: C8.7.1.2.1.7."""
        return BEHAVIOUR * self.start / self.spectrum.soil


def seismic_check(
    assembly: Assembly, loads: Loads, spectrum: Spectrum, confidence: float = CONFIDENCE
) -> SeismicCheck:
    """The verification of the mechanism of ``assembly`` under ``loads``, an acceleration.

    ``confidence``: the factor F_C. Errors of `capacity_curve`; `CapacityError` too where the blocks
    wedge, or slide without turning, or none moves along the acceleration, which must be level, and
    for permanent loads beside weight.
    """
    push = loads.variable[:, :3].sum(axis=0)
    if abs(push[2]) > LEVEL * np.linalg.norm(push):
        raise CapacityError("seismic: the acceleration must be horizontal")
    if isinstance(loads, StructureLoads) and loads.beside.wrenches.any():
        allowed = "give what is heavy as blocks"
        raise CapacityError(f"seismic: permanent loads beside weight have no mass; {allowed}")
    curve = capacity_curve(assembly, loads)
    if curve.path.end in (WEDGE, FURTHER):
        raise CapacityError(f"seismic: {curve.end}")
    if not curve.hinges:
        allowed = "move them in time, by a load with a duration"
        raise CapacityError(f"seismic: blocks slide, which this verification is not for; {allowed}")
    weight = np.array([piece.weight * (not piece.fixed) for piece in assembly.pieces])
    motion = curve.path.positions[0].motion
    along = motion[:, :3] @ (push / np.linalg.norm(push))
    bodies = _bodies(assembly, motion)
    P = np.bincount(bodies, weight)
    delta = np.bincount(bodies, weight * along) / np.where(P, P, 1.0)
    moving = np.abs(delta) > STILL * np.abs(delta).max()
    P, delta = P[moving], delta[moving]
    if not (first := float(P @ delta)) > 0.0:
        raise CapacityError("seismic: no block moves along the acceleration")
    share = first**2 / float(P.sum() * (P @ delta**2))
    # The displacement that goes with any point is the same multiple of its virtual displacement.
    mean = first / float(weight.sum())
    stretch = float(P @ delta**2) / (mean * first)
    return SeismicCheck(
        spectrum,
        curve,
        share,
        confidence,
        curve.load / free_weight(assembly) * GRAVITY / (share * confidence),
        curve.displacement * stretch,
    )


def _bodies(assembly: Assembly, motion: Floats) -> Integers:
    """Of each piece the number of the rigid body that it moves with, from its ``motion``, (P,).

    Pieces that move as one are one in the sums: how a wall is cut into blocks must not matter.
    """
    centre = np.array([piece.centre for piece in assembly.pieces])
    near = STILL * float(np.linalg.norm(motion[:, :3], axis=1).max())
    found, count = np.full(len(centre), -1), 0
    for k in range(len(centre)):
        if found[k] < 0:
            carried = motion[k, :3] + np.cross(motion[k, 3:], centre - centre[k])
            apart = np.linalg.norm(motion[:, :3] - carried, axis=1)
            turns = np.linalg.norm(motion[:, 3:] - motion[k, 3:], axis=1) * assembly.length
            found[(found < 0) & (apart < near) & (turns < near)] = count
            count += 1
    return found
