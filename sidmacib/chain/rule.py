"""What a joint carries after the law, and what a designer may count on.

``law`` is the best estimate of the first failure, on which all models agree. ``safe`` is less by
`SAFETY` and by what a finer mesh changes. Both refuse what lies outside `SPANS`, the dimensionless
groups that the answer depends on: `make attack` looks for the worst joint inside of them, and
the rule was not tested outside.
"""

import math
from dataclasses import dataclass

from sidmacib.chain.failure import FINE, FINEST, first_failure
from sidmacib.errors import CapacityError
from sidmacib.joint import Direction, Joint, UpperBody
from sidmacib.loading import Loading, Push
from sidmacib.mechanics.assembly import GRAVITY
from sidmacib.validation import refused, require_positive

SAFETY, SAFETY_THAT_BENDS = 1.06, 1.12
STIFF = "stiffness of a dry face over a root, Kd h / (Ks b)"
STIFFER = 10.0  # than this: the safe rule looks at a third mesh
SPANS = {
    "locks": (2.0, 31.0),
    "a / b": (0.5, 3.0),
    "h / b": (0.06, 0.6),
    "H / b": (0.3, 3.0),
    "shear over normal stiffness of inner faces": (0.003, 3.0),
    "normal stiffness of dry over inner faces": (0.03, 30.0),
    "shear over normal stiffness of dry faces": (0.1, 10.0),
    STIFF: (0.0, 30.0),
    "friction": (0.0, 0.8),
    "tensile strength over cohesion": (1.0, 50.0),
    "weight of the upper block per area over cohesion": (0.0, 1.0),
    "force on top per area over cohesion": (0.0, 10.0),
    "locks of blocks that bend": (0.0, 15.0),
    "E / (Kn b)": (5.0, math.inf),  # rigid pieces have inf
    "Poisson's ratio": (0.0, 0.4),
}
STRETCH = 1e-9  # of a span, for rounding
# Of one rigid piece: rougher ones in torsion may snap from one equilibrium to another before a bond
# fails, at less than half the first failure.
ROUGHEST, TORSION = 0.5, 1.0  # friction, e / a
FARTHEST_OF_TWO = 0.5  # e / a: beyond it the force leaves the only dry face of two locks


@dataclass(frozen=True)
class LawCapacity:
    """A load along its direction (N), its shear V (N) and its torque M (N m)."""

    load: float
    shear: float
    torque: float


def law(joint: Joint, direction: Direction, push: Push = Push.PLUS_Y) -> LawCapacity:
    """The load at which ``joint`` first fails, by the static model on coarse nodes.

    ValueError outside `SPANS`, `CapacityError` if nothing carries the load or if the joint slides
    or rocks before a bond fails.
    """
    require_covered(joint, direction)
    load = first_failure(joint, Loading(direction, push=push)).load
    return _capacity(joint, direction, load)


def safe(joint: Joint, direction: Direction, push: Push = Push.PLUS_Y) -> LawCapacity:
    """A load that ``joint`` carries: for design. The same errors as `law`.

    `CapacityError` too if the joint would overturn but for friction between the locks, and for one
    rigid piece in torsion with a friction above `ROUGHEST`.

    Of rigid pieces the first failure is found on two meshes with two increments of the load, on
    three meshes where dry faces are more than `STIFFER` times as stiff as roots. What lies between
    the highest and the lowest is taken off the lowest: joints that are about to rock depend on the
    mesh, and rough ones on the increments, by more than `SAFETY` covers. Blocks that bend are
    solved on one mesh; `SAFETY_THAT_BENDS` covers its error as well.
    """
    _require_no_snap(joint, direction)
    load = law(joint, direction, push).load
    if joint.elastic is not None:
        return _designed(joint, direction, load / SAFETY_THAT_BENDS)
    meshes = (FINE, FINEST) if spans_of(joint)[STIFF] > STIFFER else (FINE,)
    loading = Loading(direction, push=push)
    loads = (load, *(first_failure(joint, loading, mesh).load for mesh in meshes))
    least = min(loads) - (max(loads) - min(loads))
    if least <= 0.0:
        raise CapacityError(
            f"safe: the first failure is not known: from {min(loads):.4g} to {max(loads):.4g} N, "
            "depending on the mesh; use the static model"
        )
    return _designed(joint, direction, least / SAFETY)


def spans_of(joint: Joint) -> dict[str, float]:
    """The dimensionless groups of ``joint``, in the order of `SPANS`."""
    inner, dry, block = joint.inner, joint.dry, joint.elastic
    require_positive(cohesion=inner.cohesion)
    top = joint.a * joint.total_width
    values = (
        joint.locks,
        *(size / joint.b for size in (joint.a, joint.h, joint.H)),
        inner.shear_stiffness / inner.normal_stiffness,
        dry.normal_stiffness / inner.normal_stiffness,
        dry.shear_stiffness / dry.normal_stiffness,
        dry.normal_stiffness * joint.h / (inner.shear_stiffness * joint.b),
        dry.friction,
        inner.tensile_strength / inner.cohesion,
        joint.density * GRAVITY * (joint.h + joint.H) / inner.cohesion,
        (joint.pressing_force or 0.0) / (top * inner.cohesion),
        joint.locks if block else 0,
        joint.stiffness_ratio,
        block.poisson if block else 0.0,
    )
    return dict(zip(SPANS, map(float, values), strict=True))


def require_covered(joint: Joint, direction: Direction) -> None:
    """ValueError if ``joint`` lies outside `SPANS`.

    `CapacityError` where the direction leaves the only dry face of two locks.
    """
    for name, value in spans_of(joint).items():
        low, high = SPANS[name]
        if not low * (1.0 - STRETCH) <= value <= high * (1.0 + STRETCH):
            allowed = (
                f"at least {low:g}, or rigid" if math.isinf(high) else f"from {low:g} to {high:g}"
            )
            raise refused(
                name,
                _short(value),
                f"{allowed}: not tested beyond; use the static model",
            )
    if joint.locks == 2 and abs(direction.eccentricity) > FARTHEST_OF_TWO:
        raise CapacityError(
            f"law: two locks do not carry an eccentricity of {direction.eccentricity:g} a; it must "
            f"be at most {FARTHEST_OF_TWO:g} a to either side, within their only dry face"
        )


def _short(value: float) -> float:
    short = float(f"{value:.4g}")
    return int(short) if short.is_integer() else short


def _require_no_snap(joint: Joint, direction: Direction) -> None:
    rigid = joint.upper_body is UpperBody.MONOLITHIC and joint.elastic is None
    if rigid and joint.dry.friction > ROUGHEST and abs(direction.eccentricity) > TORSION:
        raise CapacityError(
            f"safe: one rigid piece with a friction of {joint.dry.friction:g}, loaded at "
            f"{direction.eccentricity:g} a, may slide before a bond fails; design with a friction "
            f"of at most {ROUGHEST:g}, give the block its Young's modulus, or use the static model"
        )


def _designed(joint: Joint, direction: Direction, load: float) -> LawCapacity:
    """The capacity at ``load`` (N); `CapacityError` if it may overturn a joint without a plate.

    V acts at half the height, and what presses the joint, at half its length.
    """
    found = _capacity(joint, direction, load)
    if joint.pressing_force is not None:
        weight = joint.density * GRAVITY * joint.a * joint.total_width * joint.H
        most = (joint.pressing_force + weight) * joint.total_width / (joint.H + joint.h)
        if abs(found.shear) > most:
            raise CapacityError(
                f"safe: V of {found.shear:.4g} N may overturn the joint; its weight and what "
                f"presses it prevent that up to {most:.4g} N; use the static model, or a plate"
            )
    return found


def _capacity(joint: Joint, direction: Direction, load: float) -> LawCapacity:
    return LawCapacity(load, load * direction.shear, load * direction.torque * joint.a)


RULES = {"law": law, "safe": safe}  # models of their own in studies
