"""Effects of a joint's sizes and materials on its first failure, by the static model.

The model runs again with 1 % more and with 1 % less of each parameter, on the same cells. So an
effect includes what changes on the way: another node that fails first, a contact that opens.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from sidmacib.errors import CapacityError
from sidmacib.joint import AMOUNTS, Joint
from sidmacib.joint.loading import Loading, lateral_load, posed
from sidmacib.joint.parameters import PARAMETERS, value_at, with_fields
from sidmacib.joint.pieces import reassemble
from sidmacib.mechanics.assembly import Assembly, NodeLayout
from sidmacib.mechanics.solution import FirstFailure
from sidmacib.mechanics.static import static_first_failure

STEP = 0.01  # of a parameter, over itself, or over the size of one that is 0
# Increments of the load, where contacts slip, are so much smaller than those at which the first
# failure has converged. They are the same in all runs: another number of them changes it by 0.1 %.
FINER = 4
PRECISION = 1e-3  # of an effect, in %
CURVATURE = 0.05  # largest difference of the effects of more and of less, over them, without a kink


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
        return float(value_at(joint, self.places[0]))

    def put(self, joint: Joint, value: float) -> Joint:
        """``joint`` with another ``value``."""
        before = self.of(joint)
        values = {
            place: value * value_at(joint, place) / before if before else value
            for place in self.places
        }
        return with_fields(joint, values)


FIELDS = tuple(
    Field(
        place.replace(".", "_") if parameter.fields[1:] else parameter.name,
        (place,),
        parameter.number.unit,
        parameter.size,
    )
    for parameter in PARAMETERS.values()
    if parameter.size and parameter.number
    for place in parameter.fields
)


@dataclass(frozen=True)
class Effect:
    """The effect of a parameter on the first failure, see `Sensitivity.amount`.

    ``value``: of the parameter, in ``unit``. ``more`` and ``less``: change of the amount in % for
    1 % more or less; None of a value that is 0, and where the changed joint has no equilibrium.
    ``derivative``: of the amount, per unit, from both; at a value of 0, from more of it. None where
    more and less differ in size, as then another node fails first, or a contact opens or slides.
    """

    name: str
    unit: str
    value: float
    derivative: float | None
    more: float | None
    less: float | None

    @property
    def note(self) -> str:
        """Why there is no derivative, or on which side it is."""
        if self.derivative is not None:
            return "" if self.value else "for more"
        if self.more is None or self.less is None:
            return "unknown: the changed joint has no equilibrium"
        return "slopes for +1 % and -1 % differ; no derivative"


@dataclass(frozen=True)
class Sensitivity:
    """The first failure, ``shear`` in N and ``torque`` in N m, and all effects on it.

    ``faces``: names of the faces that fail there.
    """

    shear: float
    torque: float
    faces: tuple[str, ...]
    effects: tuple[Effect, ...]

    @property
    def amount(self) -> float:
        """The amount that is affected: V in N, or M in N m in pure torsion."""
        return self.shear or self.torque

    @property
    def unit(self) -> str:
        """The unit of `amount`."""
        return "N" if self.shear else "N m"


def sensitivity(
    joint: Joint,
    loading: Loading,
    mesh: float,
    nodes: NodeLayout = NodeLayout.LOBATTO,
    *,
    fields: Sequence[Field] | None = None,
    progress: Callable[[str], object] = str,
) -> Sensitivity:
    """Effect of each parameter on the first failure of ``joint``, by the static model.

    ``mesh`` in m: the largest cell; the number of cells does not change with the sizes. The loading
    keeps its e / a. At a value of 0, the effect is that of more. ``fields``: the parameters; None:
    all that the joint has. ``progress`` is told what is computed next. `sidmacib.CapacityError`
    where no bond fails first, and for elastic pieces; errors of `sidmacib.joint.loading.posed`.
    """
    if joint.elastic is not None:
        raise CapacityError("sensitivity: for rigid pieces only; elastic ones take minutes each")
    assembly, loads = posed(joint, loading, mesh, nodes)
    found = static_first_failure(assembly, loads)
    if not found.failing.any():
        raise CapacityError("sensitivity: pieces slide or rock before a bond fails")
    if not found.point.load > 0.0:
        raise CapacityError("sensitivity: a bond fails before the load is raised")
    fields = fields_of(joint) if fields is None else fields
    faces = np.unique(assembly.nodes.face[found.failing])
    first, effects = found, []
    if found.point.state.slip.any():
        first = static_first_failure(assembly, loads, increment=found.increment / FINER)
    for place, field in enumerate(fields, 1):
        progress(f"{place} of {len(fields)}: {field.name}")
        effects.append(_effect(joint, loading, assembly, field, first))
    return Sensitivity(
        float(found.point.load * loading.direction.shear),
        float(found.point.load * loading.direction.torque * joint.a),
        tuple(assembly.faces[face].name for face in faces.tolist()),
        tuple(effects),
    )


def _amount(joint: Joint, loading: Loading, load: float) -> float:
    """V (N), or M (N m) in pure torsion, of a ``load`` along its direction."""
    direction = loading.direction
    return float(load * (direction.shear or direction.torque * joint.a))


def _effect(
    joint: Joint, loading: Loading, assembly: Assembly, field: Field, first: FirstFailure
) -> Effect:
    value, base = field.of(joint), _amount(joint, loading, first.point.load)
    size = value or field.size

    def change(part: float) -> float | None:
        """Change of the amount, in %, for a change of the parameter by ``part`` of its size."""
        other = field.put(joint, value + part * size)
        again = reassemble(other, assembly)
        try:
            loads = lateral_load(other, again, loading)
            found = static_first_failure(again, loads, increment=first.increment)
        except CapacityError:
            return None
        changed = 100.0 * (_amount(other, loading, found.point.load) / base - 1.0)
        return changed if abs(changed) > PRECISION else 0.0

    more, less = change(STEP), change(-STEP) if value else None
    derivative = None
    if value and more is not None and less is not None:
        kink = max(CURVATURE * max(abs(more), abs(less)), PRECISION)
        if abs(more + less) <= kink:
            derivative = (more - less) / 2.0
    elif not value:
        derivative = more
    if derivative is not None:
        derivative *= base / (100.0 * STEP * size)
    return Effect(field.name, field.unit, value, derivative, more if value else None, less)


def fields_of(joint: Joint) -> tuple[Field, ...]:
    """All parameters that ``joint`` has."""
    kind = joint.hold_down.kind
    if kind not in AMOUNTS:
        return FIELDS
    pressing = Field(str(kind), ("hold_down.amount",), AMOUNTS[kind].unit, joint.T0 or 1.0)
    return *FIELDS, pressing
