"""Joints that fill the space of their parameters evenly: a Sobol sequence, scrambled by a seed.

Any part of it can be made alone, so that batches know nothing of each other. Sizes are relative to
the width b of a lock, stiffnesses to the normal one of inner faces, pressures to the cohesion:
first failures in units of T0 depend on nothing else but the weight, which is small.
"""

import importlib
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from sidmacib.hold_down import HoldDown
from sidmacib.joint import Joint, UpperBody
from sidmacib.loading import Push
from sidmacib.mechanics.assembly import Elastic, Failure
from sidmacib.parameters import with_parameters
from sidmacib.quantities import Count, Number, Part, Span

Limits = tuple[float, float]
Ratios = Annotated[Limits, Span(Number(above=0))]
DIMENSIONS = 13
POISSON = 0.2


@dataclass(frozen=True)
class Design:
    """Spans of the parameters of ``joints`` joints; ratios are spread evenly in their logarithm.

    ``smooth``, ``one_piece``, ``pressed``: parts of the joints that have no friction, an upper
    body of one piece, and a given pressure on top instead of the fixed plate. ``stiffness_ratio``:
    E over Kn b of pieces that bend; None: rigid ones. ``energy_ratio``: of bonds that soften,
    fracture energy over what is stored at failure, tau2 / (2 Ks). Even joints are pushed both ways
    alike.
    """

    joints: Count
    seed: Annotated[int, Number(at_least=0, at_most=2**31, whole=True)] = 1
    failure: Failure = Failure.BRITTLE
    locks: Annotated[tuple[int, int], Span(Number(at_least=2, whole=True))] = (2, 31)
    a_over_b: Ratios = (0.5, 3.0)
    h_over_b: Ratios = (0.06, 0.6)
    H_over_b: Ratios = (0.3, 3.0)
    shear_over_normal: Ratios = (0.003, 3.0)
    dry_over_inner: Ratios = (0.03, 30.0)
    friction: Annotated[Limits, Span(Number(at_least=0))] = (0.0, 0.8)
    pressure_over_cohesion: Ratios = (0.03, 1.0)
    stiffness_ratio: Ratios | None = None
    energy_ratio: Ratios = (1.0, 1000.0)
    smooth: Part = 0.3
    one_piece: Part = 0.5
    pressed: Part = 0.2


@dataclass(frozen=True)
class Designed:
    """A joint of a design: its number from 0, and the direction of the push."""

    number: int
    joint: Joint
    push: Push


def designed(design: Design, base: Joint, start: int, stop: int) -> Iterator[Designed]:
    """The joints of ``design`` from ``start`` to before ``stop``, otherwise like ``base``."""
    # Imported where it is needed: it takes longer to import than a study to plan.
    qmc = importlib.import_module("scipy.stats.qmc")
    sequence = qmc.Sobol(DIMENSIONS, scramble=True, rng=np.random.default_rng(design.seed))
    places = sequence.random_base2(math.ceil(math.log2(design.joints)))  # these are balanced
    for number in range(start, min(stop, design.joints)):
        yield _joint(design, base, number, places[number].tolist())


def _joint(design: Design, base: Joint, number: int, place: list[float]) -> Designed:
    turn = iter(place)

    def ratio(span: Limits) -> float:
        return _between(span, next(turn))

    def part(share: float) -> bool:
        return next(turn) < share

    least, most = design.locks
    locks = min(int(least * ((most + 1) / least) ** next(turn)), most)
    spans = (
        *(design.a_over_b, design.h_over_b, design.H_over_b),
        *(design.shear_over_normal, design.dry_over_inner),
    )
    a, h, height, shear, dry = (ratio(span) for span in spans)
    rough = next(turn)
    low, largest = design.friction
    spread = max(rough - design.smooth, 0.0) / (1.0 - design.smooth or 1.0)
    friction = 0.0 if rough < design.smooth else low + spread * (largest - low)
    one_piece, pressed = part(design.one_piece), part(design.pressed)
    pressure = base.inner.cohesion * ratio(design.pressure_over_cohesion)
    push = Push.MINUS_Y if part(0.5) and locks % 2 == 0 else Push.PLUS_Y
    last = next(turn)
    sized = with_ratios(base, a, h, height, shear, dry, friction)
    energy = _energy(design, base, sized.inner.shear_stiffness, last)
    joint = replace(
        sized,
        locks=locks,
        inner=replace(sized.inner, fracture_energy=energy),
        failure=design.failure,
        upper_body=UpperBody.MONOLITHIC if one_piece else UpperBody.COLUMNS,
        hold_down=HoldDown.pressure(pressure) if pressed else HoldDown.plate(),
        elastic=_elastic(design, base, last),
    )
    return Designed(number, joint, push)


def with_ratios(
    base: Joint, a: float, h: float, height: float, shear: float, dry: float, friction: float
) -> Joint:
    """``base`` with other ratios: a, h and H over b, inner Ks and dry stiffness over inner Kn."""
    normal = base.inner.normal_stiffness
    ratios = {
        "a": base.b * a,
        "h": base.b * h,
        "H": base.b * height,
        "shear_stiffness": normal * shear,
        "dry_stiffness": normal * dry,
        "friction": friction,
    }
    return with_parameters(base, ratios)


def _between(span: Limits, place: float) -> float:
    """The value at ``place``, 0 to 1, of a ``span`` that is spread evenly in its logarithm."""
    low, high = np.log(span)
    return float(np.exp(low + place * (high - low)))


def _energy(design: Design, base: Joint, shear: float, place: float) -> float:
    """Fracture energy of bonds that soften, J/m2; 0 for others."""
    if design.failure is not Failure.SOFTENING:
        return 0.0
    ratio = _between(design.energy_ratio, place)
    return ratio * base.inner.cohesion**2 / (2.0 * shear)


def _elastic(design: Design, base: Joint, place: float) -> Elastic | None:
    """Material of pieces that bend."""
    if design.stiffness_ratio is None:
        return None
    ratio = _between(design.stiffness_ratio, place)
    return Elastic(ratio * base.inner.normal_stiffness * base.b, POISSON)
