"""The keys of a structure's file for loads: permanent ones, one that is raised, load cases."""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated, Any, ClassVar, Self

import numpy as np
from pydantic import BeforeValidator, model_validator

from sidmacib.joint.parameters import beyond
from sidmacib.mechanics.assembly import GRAVITY, Assembly, Floats
from sidmacib.mechanics.loads import Loads
from sidmacib.quantities import Density, Newtons, Number, Span
from sidmacib.reading import Keys, Some, Text, Vector, Way
from sidmacib.structure.analysis.tilt import LEVEL, tilting
from sidmacib.structure.blocks import Block
from sidmacib.structure.files.vehicle import MOVING, VehicleSection
from sidmacib.structure.interfaces import NEAR
from sidmacib.structure.loads import (
    Permanent,
    acceleration,
    force_at,
    free_weight,
    permanent_force,
    support_moves,
)
from sidmacib.structure.pressures import pressing
from sidmacib.validation import refused

_Level = Annotated[float, Number(unit="m")]
_Within = Annotated[float, Number(at_least=0, at_most=90, unit="degrees")]
_Range = Annotated[tuple[float, float], Span(Number(unit="m"))]
WATER, SOIL = 1000.0, 1800.0  # kg/m3
EARTH = Number(unit="kg/m3", likely=(500.0, math.inf))  # below are kN/m3 and t/m3
STEEP = 15.0  # coefficient of earth pressure: a larger one is doubted
OUTSIDE = 0.01  # of a block, over its size: a force that is further away is doubted


class _Permanent(Keys):
    gamma_g: Annotated[float, Number(above=0, at_most=10)] | None = None
    """its own partial factor, in place of `--gamma-g`; it counts without that too"""


class ForceSection(Keys):
    """A force on one block."""

    block: Text
    """its name"""
    at: Vector
    """the point where it acts"""
    direction: Way


class PermanentForceSection(_Permanent, ForceSection):
    """A force on one block that always acts."""

    newtons: Newtons
    """its size, N"""

    def on(self, assembly: Assembly, _: float) -> Permanent:
        """The load on ``assembly``; ValueError that names the key."""
        return permanent_force(assembly, self.block, self.at, self.direction, self.newtons)


def _patterns(value: Any) -> Any:
    return (value,) if isinstance(value, str) else value


class _OnSides(_Permanent):
    blocks: Annotated[
        tuple[Text, ...],
        Some,
        BeforeValidator(_patterns, json_schema_input_type=Text | tuple[Text, ...]),
    ] = ("*",)
    """names or patterns of free blocks, by default all"""
    x: _Range | None = None
    """only between these two coordinates"""
    y: _Range | None = None
    """likewise"""
    z: _Range | None = None
    """likewise"""

    def on(self: Any, assembly: Assembly, near: float) -> Permanent:
        """The load on ``assembly``; ValueError that names the key."""
        given = {axis: getattr(self, name) for axis, name in enumerate("xyz")}
        bounds = {axis: each for axis, each in given.items() if each is not None}
        if "level" in type(self).model_fields:
            low, high = bounds.get(2, (-math.inf, self.level))
            bounds[2] = low, min(high, self.level)
        sides = self.blocks, self.side, self.within, bounds
        return pressing(assembly, *sides, self._pressure, self._along(), near)

    def _pressure(self: Any, at: Floats) -> Floats:
        """The pressure (Pa) at points, (K, 3) in m."""
        return np.full(len(at), self.pascals)

    def _along(self) -> Floats | None:
        """The direction in which it acts; None: against each face."""
        return None


class PressureSection(_OnSides):
    """A pressure on the sides of blocks that touch nothing; it pushes against each face."""

    side: Way
    """direction in which the faces look outwards"""
    pascals: Annotated[float, Number(unit="Pa")]
    """the pressure, Pa; suction if it is negative"""
    within: _Within = 10.0
    """degrees between `side` and the outward normals of the faces; 90: all that look that way"""


class SurchargeSection(_OnSides):
    """A load on all faces that look upwards and touch nothing, by plan area; it acts downwards."""

    pascals: Annotated[float, Number(above=0, unit="Pa")]
    """the load per m² of plan, Pa"""

    side: ClassVar = (0.0, 0.0, 1.0)
    within: ClassVar = 90.0

    def _along(self) -> Floats:
        return np.array([0.0, 0.0, -1.0])


class WaterSection(_OnSides):
    """Water that stands in front of blocks: it pushes against each face below its level.

    In joints there is none.
    """

    side: Way
    """direction in which the faces look outwards"""
    level: _Level
    """height z of its surface, m"""
    density: Density = WATER
    within: _Within = 10.0
    """degrees between `side` and the outward normals of the faces; 90: all that look that way"""

    def _pressure(self, at: Floats) -> Floats:
        return np.asarray(GRAVITY * self.density * (self.level - at[:, 2]))


class EarthSection(_OnSides):
    """Earth behind blocks: a horizontal pressure that grows with depth, without wall friction.

    `coefficient` times the vertical stress, that of the weight above and of `surcharge`, against
    `side`, on the area across it.
    """

    side: Way
    """horizontal direction in which the faces look outwards, at the earth"""
    level: _Level
    """height z of its surface, m"""
    coefficient: Annotated[float, Number(above=0)]
    """of earth pressure, such as Rankine's (1 - sin φ) / (1 + sin φ)"""
    density: Density = SOIL
    surcharge: Annotated[float, Number(at_least=0, unit="Pa")] = 0.0
    """vertical load on its surface, Pa"""
    within: _Within = 10.0
    """degrees between `side` and the outward normals of the faces; 90: all that look that way"""

    @model_validator(mode="after")
    def _is_level(self) -> Self:
        if abs(self.side[2]) > LEVEL * float(np.linalg.norm(self.side)):
            raise ValueError(f"side: {list(self.side)} is not allowed; it must be horizontal")
        return self

    def _pressure(self, at: Floats) -> Floats:
        vertical = GRAVITY * self.density * (self.level - at[:, 2]) + self.surcharge
        return np.asarray(self.coefficient * vertical)

    def _along(self) -> Floats:
        return -np.array(self.side) / np.linalg.norm(self.side)


class PermanentSection(Keys):
    """A load that always acts beside weight: one of the keys is needed. Its direction is fixed."""

    force: PermanentForceSection | None = None
    """a force on one block"""
    pressure: PressureSection | None = None
    """a pressure on sides of blocks"""
    surcharge: SurchargeSection | None = None
    """a load on top of blocks"""
    earth: EarthSection | None = None
    """earth pressure"""
    water: WaterSection | None = None
    """water pressure"""

    @model_validator(mode="after")
    def _is_one(self) -> Self:
        if len(self.model_fields_set) != 1:
            raise ValueError(f"must have one key, {', '.join(PermanentSection.model_fields)}")
        return self


def permanent_on(
    assembly: Assembly,
    given: Sequence[PermanentSection],
    near: float = NEAR,
    key: str = "permanent",
    gamma_g: float = 1.0,
) -> Permanent:
    """All loads of a list ``given`` at ``key``; ValueError that names one.

    Those with a factor of their own over ``gamma_g``, which all are to be multiplied by.
    """
    whole = Permanent.none(len(assembly.pieces))
    for number, each in enumerate(given, start=1):
        (kind,) = each.model_fields_set
        load = getattr(each, kind)
        try:
            whole += load.on(assembly, near).times((load.gamma_g or gamma_g) / gamma_g)
        except ValueError as error:
            words = f"{'.' if str(error).startswith('block: ') else ': '}{error}"
            raise ValueError(f"{key}.{number}.{kind}{words}") from None
    return whole


class TiltSection(Keys):
    """Gravity that turns about an axis, by the right-hand rule; other permanent loads stay."""

    axis: Way

    @model_validator(mode="after")
    def _is_not_vertical(self) -> Self:
        if math.hypot(*self.axis[:2]) <= LEVEL * math.hypot(*self.axis):
            raise refused("axis", list(self.axis), "a direction that is not vertical")
        return self


class SupportSection(Keys):
    """A support that moves: one of displacement and rotation is needed."""

    block: Text
    """the name of a fixed block"""
    displacement: Way | None = None
    """the direction in which it settles or spreads; the result is in m"""
    rotation: Way | None = None
    """the axis about which it turns, by the right-hand rule; the result is in degrees"""
    about: Vector | None = None
    """a point of this axis, by default the block's centroid"""

    @model_validator(mode="after")
    def _is_one(self) -> Self:
        if len(self.model_fields_set & {"displacement", "rotation"}) != 1:
            raise ValueError("must have either displacement or rotation")
        if self.about and not self.rotation:
            raise ValueError("about: must not be given beside displacement")
        return self


class _Pushed(Keys):
    acceleration: Way | None = None
    """direction of forces in proportion to the masses; the result is their sum"""
    force: ForceSection | None = None
    """a force on one block"""

    def on(self, assembly: Assembly, beside: Permanent | None, key: str = "load") -> Loads:
        """Weight of ``assembly``, permanent loads ``beside`` it, and this load.

        ValueError that names the ``key`` that it stands at.
        """
        if self.acceleration:
            return acceleration(assembly, self.acceleration, beside)
        assert self.force
        force = self.force
        try:
            return force_at(assembly, force.block, force.at, force.direction, beside)
        except ValueError as error:
            raise ValueError(f"{key}.force.{error}") from None


class _Raised(_Pushed):
    tilt: TiltSection | None = None
    """gravity that turns"""
    support: SupportSection | None = None
    """a support that moves; for `multilock assembly` and studies"""
    vehicle: VehicleSection | None = None
    """axles that move over the blocks; for `multilock assembly`"""


class _Amount(Keys):
    newtons: Newtons | None = None
    """how much is to be carried, N: whether it is, `multilock assembly` and studies say"""
    over_weight: Annotated[float, Number(above=0)] | None = None
    """or that over the weight of what can move"""

    def amount(self, assembly: Assembly | None) -> float | None:
        """What is to be carried, in N; None if the file does not say.

        ``assembly``: needed for an amount over the weight.
        """
        if self.over_weight is not None:
            assert assembly is not None, "it is over the weight"
            return self.over_weight * free_weight(assembly)
        return self.newtons


class LoadSection(_Amount, _Raised):
    """Permanent loads always act. One load is raised, gravity turns, or something moves."""

    @model_validator(mode="after")
    def _is_one(self) -> Self:
        amounts = self.model_fields_set & {"newtons", "over_weight"}
        if len(self.model_fields_set - amounts) != 1:
            raise ValueError("must have one key, acceleration, force, tilt, support or vehicle")
        if len(amounts) == 2:
            raise ValueError("must have either newtons or over_weight")
        moves = self.model_fields_set & {"tilt", "support", "vehicle"}
        if amounts and moves:
            raise ValueError(f"{amounts.pop()}: must not be given beside {moves.pop()}")
        return self

    def on(self, assembly: Assembly, beside: Permanent | None, key: str = "load") -> Loads:
        """As of a load case; or gravity turns, or a support moves. ValueError of a vehicle."""
        if self.vehicle:
            raise ValueError(f"{key}.{MOVING}")
        if self.tilt:
            return tilting(assembly, self.tilt.axis, beside)
        if not (moves := self.support):
            return super().on(assembly, beside, key)
        try:
            return support_moves(
                assembly, moves.block, moves.displacement, moves.rotation, moves.about, beside
            )
        except ValueError as error:
            raise ValueError(f"{key}.support.{error}") from None


class CaseSection(_Amount, _Pushed):
    """A load case: a direction or a force, and how much of it is to be carried."""

    @model_validator(mode="after")
    def _has_one_of_each(self) -> Self:
        if "vehicle" in self.model_fields_set:
            if others := self.model_fields_set - {"vehicle", "permanent"}:
                raise ValueError(f"{min(others)}: must not be given beside vehicle")
            return self
        for one, other in (("acceleration", "force"), ("newtons", "over_weight")):
            if (getattr(self, one) is None) == (getattr(self, other) is None):
                raise ValueError(f"must have either {one} or {other}")
        return self


class LoadCaseSection(CaseSection):
    """A load case with permanent loads of its own, beside those of all cases."""

    vehicle: VehicleSection | None = None
    """axles that move over the blocks, in place of a direction or a force; one case a position"""
    permanent: tuple[PermanentSection, ...] = ()
    """as under `permanent` of the file"""


def load_warnings(assembly: Assembly, pushed: Mapping[str, Any]) -> Iterator[str]:
    """One line each for what looks wrong in loads, by their keys."""
    named = {piece.name: piece for piece in assembly.pieces if isinstance(piece, Block)}
    for key, each in pushed.items():
        for kind in each.model_fields_set if isinstance(each, PermanentSection) else ():
            if (factor := getattr(each, kind).gamma_g) is not None:
                yield f"{key}.{kind}: is multiplied by its own gamma_g, {factor:g}"
        if each.force and each.force.block in named:
            block, at = named[each.force.block], np.array(each.force.at)
            apart = np.maximum(block.places.min(axis=0) - at, at - block.places.max(axis=0))
            away = float(np.linalg.norm(np.maximum(apart, 0.0)))
            if away > OUTSIDE * block.size:
                yield f"{key}.force.at: is {away:.3g} m outside of block {block.name}"
        if isinstance(each, PermanentSection) and (earth := each.earth):
            yield from beyond([(f"{key}.earth.density", earth.density, EARTH)])
            if earth.coefficient > STEEP:
                yield (
                    f"{key}.earth.coefficient: {earth.coefficient:g} is very large; of an angle of "
                    "friction of 30 degrees it is 0.333 (active) or 3 (passive)"
                )
