"""What the law covers: joints in a row that it was made for, and spans in which it was tested."""

import math
from dataclasses import fields

from sidmacib.joint import Joint, UpperBody
from sidmacib.mechanics.assembly import GRAVITY, Elastic, FaceMaterial, Kind
from sidmacib.validation import refused, require_positive

STIFF = "stiffness of a dry face over a root, Kd h / (Ks b)"
SPANS = {
    "locks": (2.0, 31.0),
    "a / b": (0.5, 12.0),
    "h / b": (0.06, 2.0),
    "H / b": (0.3, 6.0),
    "shear over normal stiffness of inner faces": (0.003, 3.0),
    "normal stiffness of dry over inner faces": (0.0005, 30.0),
    "shear over normal stiffness of dry faces": (0.1, 10.0),
    STIFF: (0.0, 30.0),
    "friction": (0.0, 0.8),
    "tensile strength over cohesion": (0.2, 50.0),
    "weight of the upper block per area over cohesion": (0.0, 1.0),
    "force on top per area over cohesion": (0.0, 10.0),
    "locks of elastic blocks": (0.0, 15.0),
    "E / (Kn b)": (5.0, math.inf),  # rigid pieces have inf
    "Poisson's ratio": (0.0, 0.4),
}
# Fields that the first failure depends on, or does not: a new one is refused until it stands here.
KNOWN: dict[type, set[str]] = {
    Joint: {"locks", "a", "b", "h", "H", "density", "inner", "dry", "failure", "upper_body"}
    | {"first", "different", "hold_down", "elastic"},
    FaceMaterial: {"normal_stiffness", "shear_stiffness", "friction", "cohesion"}
    | {"tensile_strength", "residual", "fracture_energy", "bond_friction"},
    Elastic: {"young", "poisson"},
}
STRETCH = 1e-9  # by which a span may be exceeded, for rounding


def require_row(joint: Joint) -> None:
    """ValueError if the law does not cover ``joint``."""
    for prefix, part in (("", joint), ("inner.", joint.inner), ("dry.", joint.dry)):
        _require_known(prefix, part)
    if joint.elastic is not None:
        _require_known("elastic.", joint.elastic)
    bond = joint.inner
    of_bond = bond.friction_in_bonds
    faults = (
        (joint.locks < 2, "locks", joint.locks, "at least 2"),
        (bool(joint.different), "different", "locks that differ", "none"),
        (joint.upper_body is UpperBody.JOINED, "upper_body", "joined", "columns or monolithic"),
        (bond.friction > 0.0, "inner.friction", f"{bond.friction:g}", "0"),
        (of_bond > 0.0, "inner.bond_friction", f"{of_bond:g}", "0"),
        (bond.cohesion == 0.0, "inner.cohesion", 0, "more than 0"),
        (bond.tensile_strength == 0.0, "inner.tensile_strength", 0, "more than 0"),
    )
    for wrong, name, value, allowed in faults:
        if wrong:
            raise ValueError(f"{name}: must be {allowed} for the law (got {value})")


def _require_known(prefix: str, part: Joint | FaceMaterial | Elastic) -> None:
    """ValueError if ``part`` has a field, not at its default, that the rule was not made for."""
    known = next(names for kind, names in KNOWN.items() if isinstance(part, kind))
    for each in fields(part):
        value = getattr(part, each.name)
        if each.name not in known and value != each.default:
            default = f"{each.default}, as the rule does not know it"
            raise refused(f"{prefix}{each.name}", value, default)


def spans_of(joint: Joint) -> dict[str, float]:
    """The dimensionless groups of ``joint``, in the order of `SPANS`."""
    inner, dry = joint.material_of(Kind.INNER), joint.material_of(Kind.DRY)
    block = joint.elastic
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


def require_covered(joint: Joint) -> None:
    """ValueError if ``joint`` lies outside `SPANS`."""
    for name, value in spans_of(joint).items():
        low, high = SPANS[name]
        if not low * (1.0 - STRETCH) <= value <= high * (1.0 + STRETCH):
            allowed = f"from {low:g} to {high:g}"
            if math.isinf(high):
                allowed = f"at least {low:g}, or rigid"
            short = float(f"{value:.4g}")
            shown = int(short) if short.is_integer() else short
            where = f"{allowed}, where the rule was tested; else use the static model"
            raise refused(name, shown, where)
