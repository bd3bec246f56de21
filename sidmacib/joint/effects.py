"""How the first failure of a joint depends on its sizes and materials, by the static model."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from sidmacib.joint.hold_down import AMOUNTS
from sidmacib.joint.joint import Joint
from sidmacib.joint.loading import Loading, lateral_load, posed
from sidmacib.joint.pieces import reassemble
from sidmacib.mechanics.assembly import Assembly, Loads, NodeLayout
from sidmacib.mechanics.change import Change
from sidmacib.mechanics.static.sensitivity import Derivative, failure_derivatives

STEP = 1e-5  # of a parameter, over itself, in the differences of what is assembled


@dataclass(frozen=True)
class Field:
    """A parameter: its ``places`` in a joint, its unit, and its ``size`` where the value is 0.

    A place is a field, or a part and a field as in ``inner.cohesion``. Several keep their ratios.
    """

    name: str
    places: tuple[str, ...]
    unit: str
    size: float = 1.0

    def of(self, joint: Joint) -> float:
        """Its value in ``joint``, at the first place."""
        return _value(joint, self.places[0])

    def put(self, joint: Joint, value: float) -> Joint:
        """``joint`` with another ``value``."""
        before = self.of(joint)
        for place in self.places:
            part, _, field = place.rpartition(".")
            changed: dict[str, Any] = {
                field: value * _value(joint, place) / before if before else value
            }
            if part:
                changed = {part: replace(getattr(joint, part), **changed)}
            joint = replace(joint, **changed)
        return joint


def _value(joint: Joint, place: str) -> float:
    part, _, field = place.rpartition(".")
    return float(getattr(getattr(joint, part) if part else joint, field))


FIELDS = (
    *(Field(name, (name,), "m") for name in ("a", "b", "h", "H")),
    Field("cohesion", ("inner.cohesion",), "Pa"),
    Field("tensile_strength", ("inner.tensile_strength",), "Pa", 1e5),
    Field("normal_stiffness", ("inner.normal_stiffness",), "Pa/m"),
    Field("shear_stiffness", ("inner.shear_stiffness",), "Pa/m"),
    Field("bond_friction", ("inner.bond_friction",), ""),
    Field("dry_normal_stiffness", ("dry.normal_stiffness",), "Pa/m"),
    Field("dry_shear_stiffness", ("dry.shear_stiffness",), "Pa/m"),
    Field("friction", ("dry.friction",), ""),
    Field("density", ("density",), "kg/m3", 1e3),
)


@dataclass(frozen=True)
class Effect:
    """The effect of a parameter on the first failure.

    ``value``: of the parameter, in ``unit``. ``derivative``: of the load, in N per unit; at a value
    of 0, for more. ``more`` and ``less``: change of the load in % for 1 % more or less; None of a
    value that is 0. If they differ in size, contacts or the node that fails first depend on the
    direction of the change, and there is no ``derivative``.
    """

    name: str
    unit: str
    value: float
    derivative: float | None
    more: float | None
    less: float | None

    @property
    def note(self) -> str:
        """What there is to say of the derivative: why there is none, or on which side it is."""
        if self.derivative is not None:
            return "" if self.value else "for more"
        if self.more is None:
            return "unknown: nothing holds the pieces against the change"
        return "less and more differ"


@dataclass(frozen=True)
class Sensitivity:
    """The first failure, the ``load`` along the direction of loading in N, and all effects on it.

    ``faces``: names of the faces that fail there.
    """

    load: float
    faces: tuple[str, ...]
    effects: tuple[Effect, ...]


def sensitivity(
    joint: Joint,
    loading: Loading,
    mesh: float,
    nodes: NodeLayout = NodeLayout.LOBATTO,
    *,
    fields: Sequence[Field] | None = None,
) -> Sensitivity:
    """How the first failure of ``joint`` depends on each parameter, by the static model.

    ``mesh`` in m: the largest cell; the number of cells does not change with the sizes. The loading
    keeps its e / a. At a value of 0, the effect is that of more. ``fields``: the parameters; None:
    all that the joint has. `sidmacib.CapacityError` where no bond fails first, and for elastic
    pieces; errors of `sidmacib.joint.loading.posed`.
    """
    fields = fields_of(joint) if fields is None else fields
    assembly, loads = posed(joint, loading, mesh, nodes)
    changes = {each.name: _change(joint, loading, assembly, each) for each in fields}
    found = failure_derivatives(assembly, loads, changes)
    effects = tuple(_effect(joint, each, found.by[each.name], found.load) for each in fields)
    return Sensitivity(found.load, found.faces, effects)


def _effect(joint: Joint, field: Field, by: Derivative, load: float) -> Effect:
    value = field.of(joint)
    more, less = (
        None if side is None or not value else sign * side * value / load
        for side, sign in ((by.more, 1.0), (by.less, -1.0))
    )
    return Effect(field.name, field.unit, value, by.value, more, less)


def fields_of(joint: Joint) -> tuple[Field, ...]:
    """All parameters that ``joint`` has."""
    kind = joint.hold_down.kind
    if kind not in AMOUNTS:
        return FIELDS
    pressing = Field(str(kind), ("hold_down.amount",), AMOUNTS[kind].unit, joint.T0 or 1.0)
    return *FIELDS, pressing


def _change(joint: Joint, loading: Loading, assembly: Assembly, field: Field) -> Change:
    """``joint`` with a little less and a little more of a parameter; with no less than 0."""
    value = field.of(joint)
    size = value or field.size
    low, high = value * (1.0 - STEP), value + size * STEP

    def at(changed: float) -> tuple[Assembly, Loads]:
        other = field.put(joint, changed)
        again = reassemble(other, assembly)
        return again, lateral_load(other, again, loading)

    return Change(at(low), at(high), high - low, size, rises=not value)
