"""Samplings: joints that fill spans of their parameters evenly, by a seeded Sobol sequence.

Any part of a sampling can be made alone, so batches do not depend on each other. Sizes are relative
to the width b of a lock, stiffnesses to the normal stiffness of inner faces, pressures to the
cohesion: first failures over T0 depend on nothing else except the weight, which is small.
"""

import importlib
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np

from sidmacib.joint.joint import HoldDown, Joint, UpperBody
from sidmacib.joint.loading import Push
from sidmacib.joint.parameters import with_parameters
from sidmacib.mechanics.assembly import Elastic, Failure
from sidmacib.quantities import Count, Number, Part, Span
from sidmacib.validation import dataclass_from

Limits = tuple[float, float]
Ratios = Annotated[Limits, Span(Number(above=0))]
DIMENSIONS = 13
POISSON = 0.2


@dataclass(frozen=True)
class Sampling:
    """Spans of the parameters of ``joints`` joints; ratios are spread evenly in their logarithm.

    ``smooth``, ``one_piece``, ``pressed``: shares of the joints without friction, with an upper
    body of one piece, and with a given pressure on top instead of the fixed plate.
    ``stiffness_ratio``: E / (Kn b) of elastic pieces; None: rigid pieces. ``energy_ratio``: of
    bonds that soften, fracture energy over the energy stored at failure, tau_k^2 / (2 Ks). Half of
    the joints with an even number of locks are pushed along -y.
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
class SampledJoint:
    """A joint of a sampling: its number from 0, and the direction of the push."""

    number: int
    joint: Joint
    push: Push


def sampled_joints(
    sampling: Sampling, base: Joint, start: int, stop: int
) -> Iterator[SampledJoint]:
    """The joints of ``sampling`` from ``start`` to before ``stop``, otherwise like ``base``."""
    # Imported here: the import takes longer than planning a study.
    qmc = importlib.import_module("scipy.stats.qmc")
    sequence = qmc.Sobol(DIMENSIONS, scramble=True, rng=np.random.default_rng(sampling.seed))
    places = sequence.random_base2(math.ceil(math.log2(sampling.joints)))  # these are balanced
    for number in range(start, min(stop, sampling.joints)):
        yield _joint(sampling, base, number, places[number].tolist())


def joints_of(arguments: Mapping[str, Any]) -> Iterator[SampledJoint]:
    """The joints of a job's batch, from ``start`` to before ``stop``."""
    sampling = dataclass_from(Sampling, arguments["sampling"])
    base = dataclass_from(Joint, arguments["base"])
    return sampled_joints(sampling, base, arguments["start"], arguments["stop"])


def _joint(sampling: Sampling, base: Joint, number: int, place: list[float]) -> SampledJoint:
    turn = iter(place)

    def ratio(span: Limits) -> float:
        return _between(span, next(turn))

    def part(share: float) -> bool:
        return next(turn) < share

    least, most = sampling.locks
    locks = min(int(least * ((most + 1) / least) ** next(turn)), most)
    spans = (
        *(sampling.a_over_b, sampling.h_over_b, sampling.H_over_b),
        *(sampling.shear_over_normal, sampling.dry_over_inner),
    )
    a, h, height, shear, dry = (ratio(span) for span in spans)
    rough = next(turn)
    low, largest = sampling.friction
    spread = max(rough - sampling.smooth, 0.0) / (1.0 - sampling.smooth or 1.0)
    friction = 0.0 if rough < sampling.smooth else low + spread * (largest - low)
    one_piece, pressed = part(sampling.one_piece), part(sampling.pressed)
    pressure = base.inner.cohesion * ratio(sampling.pressure_over_cohesion)
    push = Push.MINUS_Y if part(0.5) and locks % 2 == 0 else Push.PLUS_Y
    last = next(turn)
    sized = with_ratios(base, a, h, height, shear, dry, friction)
    energy = _energy(sampling, base, sized.inner.shear_stiffness, last)
    joint = replace(
        sized,
        locks=locks,
        inner=replace(sized.inner, fracture_energy=energy),
        failure=sampling.failure,
        upper_body=UpperBody.MONOLITHIC if one_piece else UpperBody.COLUMNS,
        hold_down=HoldDown.pressure(pressure) if pressed else HoldDown.plate(),
        elastic=_elastic(sampling, base, last),
    )
    return SampledJoint(number, joint, push)


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


def _energy(sampling: Sampling, base: Joint, shear: float, place: float) -> float:
    """Fracture energy of bonds that soften, J/m2; 0 for other bonds."""
    if sampling.failure is not Failure.SOFTENING:
        return 0.0
    ratio = _between(sampling.energy_ratio, place)
    return ratio * base.inner.cohesion**2 / (2.0 * shear)


def _elastic(sampling: Sampling, base: Joint, place: float) -> Elastic | None:
    """Material of elastic pieces; None: rigid pieces."""
    if sampling.stiffness_ratio is None:
        return None
    ratio = _between(sampling.stiffness_ratio, place)
    return Elastic(ratio * base.inner.normal_stiffness * base.b, POISSON)
