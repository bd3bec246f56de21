"""The keys of a structure's file for what acts in time: ground motions, blows, lost supports."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Self

import numpy as np
from pydantic import BeforeValidator, FiniteFloat, model_validator

from sidmacib.mechanics.assembly import Assembly
from sidmacib.quantities import Newtons, Number, Part, one_of
from sidmacib.reading import Keys, Some, Text, Way
from sidmacib.structure.files.loads import ForceSection
from sidmacib.structure.loads import Permanent, numbered, permanent_force, permanent_only
from sidmacib.structure.shaking import (
    UNITS,
    Accelerogram,
    Ground,
    Pulse,
    Shape,
    TimeLoads,
    accelerogram,
)
from sidmacib.validation import refused

Seconds = Annotated[float, Number(above=0, unit="s")]
MOST_STEPS = 10_000_000
_Speed = Annotated[float, Number(at_least=-1e3, at_most=1e3, unit="m/s")]


class PulseSection(Keys):
    """A pulse of the ground's acceleration."""

    shape: Shape = Shape.RECTANGLE
    """a rectangle, half a sine, or one cycle of a sine"""
    acceleration: Annotated[float, Number(above=0, at_most=1e3, unit="m/s2")]
    """the largest, m/s2, or such as 0.5g"""
    duration: Seconds
    """how long it lasts, s"""


class AccelerogramSection(Keys):
    """The values of a record."""

    time: Annotated[tuple[FiniteFloat, ...], Some]
    """s; they grow"""
    acceleration: Annotated[tuple[FiniteFloat, ...], Some]
    """at each time, linear in between"""

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if len(self.time) != len(self.acceleration):
            raise ValueError("must have as many times as accelerations")
        self.along((), 1.0)
        return self

    def along(self, direction: tuple[float, ...], factor: float) -> Accelerogram:
        """The motion along a unit ``direction``; ``factor``: m/s2 of an acceleration of 1."""
        rows = np.column_stack([self.time, self.acceleration])
        return Accelerogram.of(rows, factor, direction)


class GroundSection(Keys):
    """A motion of the ground along a direction: a pulse, or a record."""

    pulse: PulseSection | None = None
    record: Annotated[str, Some] | None = None
    """a file of columns of time (s) and acceleration, or of PEER (AT2)"""
    accelerogram: AccelerogramSection | None = None
    """in place of a file"""
    unit: Annotated[str, one_of(UNITS)] | None = None
    """of the record's accelerations, by default m/s2, of AT2 g"""
    scale: Annotated[float, Number(above=0)] = 1.0
    """factor on the accelerations"""
    direction: Way

    @model_validator(mode="after")
    def _is_one(self) -> Self:
        if sum(each is not None for each in (self.pulse, self.record, self.accelerogram)) != 1:
            raise ValueError("must have either pulse or record (or accelerogram)")
        if self.unit is not None and self.pulse is not None:
            raise ValueError("unit: is of a record")
        return self

    def motion(self, folder: Path) -> Ground:
        """The motion; ``folder``: that the record's path starts from. ValueError."""
        size = math.hypot(*self.direction)
        along = tuple(each / size for each in self.direction)
        if self.pulse:
            pulse = self.pulse
            return Pulse(pulse.shape, self.scale * pulse.acceleration, pulse.duration, along)
        unit = UNITS.get(self.unit or "")
        if self.accelerogram:
            return self.accelerogram.along(along, self.scale * (1.0 if unit is None else unit))
        assert self.record is not None
        return recorded(folder / self.record, unit, self.scale, along)


def recorded(
    path: Path, unit: float | None, scale: float = 1.0, along: tuple[float, ...] = ()
) -> Accelerogram:
    """The `accelerogram` in a file; ValueError that names the key, too, if it cannot be read."""
    try:
        return accelerogram(path, unit, scale, along)
    except OSError as error:
        raise ValueError(f"record: {path} cannot be read ({error.strerror})") from None
    except ValueError as error:
        raise ValueError(f"record: {error}") from None


def with_records(description: Any, folder: Path) -> Any:
    """``description`` with values in place of the records that its load names.

    ``folder``: that their paths start from. ValueError if one cannot be read.
    """
    load = description.get("load") if isinstance(description, Mapping) else None
    if not isinstance(load, Mapping) or "ground" not in load:
        return description
    ground = [
        _with_values(each, folder) if isinstance(each, Mapping) and "record" in each else each
        for each in _several(load["ground"])
    ]
    return {**description, "load": {**load, "ground": ground}}


def _with_values(ground: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    given = GroundSection.read(ground, "load", "ground")
    assert given.record is not None
    values = recorded(folder / given.record, UNITS.get(given.unit or "")).values
    kept = {key: value for key, value in ground.items() if key not in ("record", "unit")}
    return {**kept, "accelerogram": values}


def _several(value: Any) -> Any:
    return value if isinstance(value, list | tuple) else (value,)


class SpeedSection(Keys):
    """The velocity of a block at the moment 0, as after a blow."""

    block: Text
    """its name"""
    velocity: tuple[_Speed, _Speed, _Speed]
    """three components, m/s"""


class TimeSection(Keys):
    """What acts in time, from the moment 0, for a duration."""

    duration: Seconds
    """how long the blocks are followed, s"""
    ground: Annotated[
        tuple[GroundSection, ...],
        BeforeValidator(_several, json_schema_input_type=GroundSection | tuple[GroundSection, ...]),
    ] = ()
    """motions of the ground, which add up"""
    force: ForceSection | None = None
    """a force that acts at once, and stays"""
    newtons: Newtons | None = None
    """its size, N"""
    blow: SpeedSection | None = None
    """a block that is moving"""
    lost: Text | None = None
    """the name of a fixed block that is taken away"""
    step: Annotated[float, Number(above=0, at_most=0.1, unit="s")] = 5e-4
    """time step, s; halve it to see the error"""
    restitution: Part = 0.0
    """velocity after an impact over that before it"""

    @model_validator(mode="after")
    def _acts(self) -> Self:
        if (self.force is None) != (self.newtons is None):
            raise ValueError("must have both force and newtons, or neither")
        if self.duration / self.step > MOST_STEPS:
            raise refused("step", self.step, f"at least {self.duration / MOST_STEPS:g} s")
        return self

    def on(
        self, assembly: Assembly, beside: Permanent | None, folder: Path, key: str = "load"
    ) -> TimeLoads:
        """Weight of ``assembly``, permanent loads ``beside`` it, and what acts in time."""
        sudden, speed = Permanent.none(len(assembly.pieces)), np.zeros((len(assembly.pieces), 3))
        lost = None
        try:
            if self.force and self.newtons:
                at = self.force.block, self.force.at, self.force.direction
                sudden = permanent_force(assembly, *at, self.newtons)
            if self.blow:
                speed[numbered(assembly, self.blow.block, fixed=False)] = self.blow.velocity
            if self.lost:
                lost = numbered(assembly, self.lost, fixed=True)
            motions = tuple(each.motion(folder) for each in self.ground)
        except ValueError as error:
            raise ValueError(f"{key}: {error}") from None
        return TimeLoads(
            **vars(permanent_only(assembly, beside)),
            ground=motions,
            sudden=sudden.wrenches,
            arms=sudden.levers,
            speed=speed,
            lost=lost,
            duration=self.duration,
            step=self.step,
            restitution=self.restitution,
        )
