"""What a joint carries after the law, and what a designer may count on.

``law`` is the best estimate of the first failure, on which all models agree. ``safe`` is less by
`SAFETY`, and counts on friction above and below the locks only up to `COUNTED`. Both refuse what
lies outside the spans of the study in docs/law.md: nobody has looked there.
"""

from dataclasses import dataclass
from functools import lru_cache

from sidmacib.chain.failure import first_failure
from sidmacib.errors import CapacityError
from sidmacib.joint import Direction, Joint
from sidmacib.loading import Loading, Push
from sidmacib.mechanics.assembly import GRAVITY
from sidmacib.validation import refused, require_positive

SAFETY = 1.05
ROUGHEST = 0.5  # friction for design: of rougher joints a few slide before any bond fails
COUNTED = {True: 1.5, False: 1.0}  # times what is carried without that friction: a plate or none
SPANS = {  # of the study that law and rule were held against
    "locks": (2.0, 31.0),
    "a / b": (0.5, 3.0),
    "h / b": (0.06, 0.6),
    "H / b": (0.3, 3.0),
    "shear over normal stiffness of inner faces": (0.003, 3.0),
    "normal stiffness of dry over inner faces": (0.03, 30.0),
    "friction": (0.0, 0.8),
}
STRETCH = 1e-9  # of a span, for rounding
SOFTEST = 5.0  # E over Kn b of pieces that bend
LEAST_TENSION = 4.6  # tensile strength over cohesion of the study
FARTHEST_OF_TWO = 0.5  # e / a: beyond it the force leaves the only dry face of two locks


@dataclass(frozen=True)
class LawCapacity:
    """A load along its direction (N), its shear V (N) and its torque M (N m)."""

    load: float
    shear: float
    torque: float


def law(joint: Joint, direction: Direction, push: Push = Push.PLUS_Y) -> LawCapacity:
    """The load at which ``joint`` first fails, from the chain of springs.

    ValueError outside the law's validity, `CapacityError` if nothing carries the load.
    """
    require_covered(joint, direction)
    return _capacity(joint, direction, _first_load(joint, direction, push))


def safe(joint: Joint, direction: Direction, push: Push = Push.PLUS_Y) -> LawCapacity:
    """A load that ``joint`` carries: for design. The same errors as `law`.

    Friction above and below the locks comes from a body that tilts against its plate, or from what
    presses it. With the one it counts for half as much as all else, with the other not at all.
    ValueError too if the friction is more than `ROUGHEST`, `CapacityError` if the joint may tip.
    """
    if joint.dry.friction > ROUGHEST:
        raise refused(
            "friction", _short(joint.dry.friction), f"at most {ROUGHEST:g} for the safe rule"
        )
    rough = law(joint, direction, push).load
    without = _first_load(joint, direction, push, standing=False)
    counted = COUNTED[joint.pressing_force is None]
    load = min(rough, counted * without) / SAFETY
    _require_no_tipping(joint, load * direction.shear)
    return _capacity(joint, direction, load)


def spans_of(joint: Joint) -> dict[str, float]:
    """The parameters of ``joint`` that the study spans."""
    inner, dry = joint.inner, joint.dry
    values = (
        joint.locks,
        *(size / joint.b for size in (joint.a, joint.h, joint.H)),
        inner.shear_stiffness / inner.normal_stiffness,
        dry.normal_stiffness / inner.normal_stiffness,
        dry.friction,
    )
    return dict(zip(SPANS, map(float, values), strict=True))


def require_covered(joint: Joint, direction: Direction) -> None:
    """ValueError if ``joint`` lies outside of what the law was held against.

    `CapacityError` where the direction leaves the only dry face of two locks.
    """
    for name, value in spans_of(joint).items():
        low, high = SPANS[name]
        if not low * (1.0 - STRETCH) <= value <= high * (1.0 + STRETCH):
            raise refused(
                name, _short(value), f"from {low:g} to {high:g}, as in the study of the law"
            )
    if (ratio := joint.stiffness_ratio) < SOFTEST * (1.0 - STRETCH):
        raise refused("E / (Kn b)", _short(ratio), f"at least {SOFTEST:g}, or rigid")
    require_positive(cohesion=joint.inner.cohesion)
    tension = joint.inner.tensile_strength / joint.inner.cohesion
    if tension < LEAST_TENSION:
        raise refused(
            "tensile strength over cohesion", _short(tension), f"at least {LEAST_TENSION:g}"
        )
    if joint.locks == 2 and direction.eccentricity > FARTHEST_OF_TWO:
        raise CapacityError(
            f"law: two locks do not carry an eccentricity of {direction.eccentricity:g} a; it must "
            f"be at most {FARTHEST_OF_TWO:g} a, within their only dry face"
        )


def _short(value: float) -> float:
    short = float(f"{value:.4g}")
    return int(short) if short.is_integer() else short


def _require_no_tipping(joint: Joint, shear: float) -> None:
    """`CapacityError` if ``shear`` (N) may tip a joint that no plate holds down.

    It acts at half the height, and what presses the joint, at half its length.
    """
    if joint.pressing_force is None:
        return
    weight = joint.density * GRAVITY * joint.a * joint.total_width * joint.H
    most = (joint.pressing_force + weight) * joint.total_width / (joint.H + joint.h)
    if shear > most:
        raise CapacityError(
            f"safe: V of {shear:.4g} N may tip the joint, which what presses it prevents up to "
            f"{most:.4g} N; use the static model, or a plate"
        )


@lru_cache(maxsize=256)  # the safe rule asks for what the law was asked for
def _first_load(joint: Joint, direction: Direction, push: Push, standing: bool = True) -> float:
    return first_failure(joint, Loading(direction, push=push), standing).load


def _capacity(joint: Joint, direction: Direction, load: float) -> LawCapacity:
    return LawCapacity(load, load * direction.shear, load * direction.torque * joint.a)


RULES = {"law": law, "safe": safe}  # models of their own in studies
