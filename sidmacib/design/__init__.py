"""Layouts: the rows of locks that an interface may get, with what they carry and what they cost.

A row has ``working`` locks of one width, which belong to the block above, ridges of the same width
between them, and a margin on either side of at least that width; ridges and margins belong to the
block below. That makes n = 2 working + 1 locks, of which (n - 1) / 2 work, whichever way the blocks
are pushed. What slides across them shears off the roots of the locks that work.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Annotated, Any, Self

import numpy as np
from pydantic import BeforeValidator, model_validator

from sidmacib.contact_points import ContactOption
from sidmacib.mechanics.assembly import CLOSE, Floats, Vector
from sidmacib.mechanics.polygons import Polygon
from sidmacib.quantities import Length, Number
from sidmacib.reading import Keys, Some
from sidmacib.structure.blocks import vectors
from sidmacib.structure.files.sections import DrySection, InnerSection
from sidmacib.structure.interfaces import Interface
from sidmacib.structure.locks import Locks, Row, condensed_points
from sidmacib.validation import require_positive

_CENTRE = ContactOption((0.0,), (1.0,))  # one point has the area of a lock
MOST = 25  # locks that work in an interface, unless the file names fewer
_NotNegative = Annotated[float, Number(at_least=0)]
LEVEL = 1e-6  # length of a level direction below which an interface is level


def _listed(value: Any) -> Any:
    return value if isinstance(value, list | tuple) else [value]


class LockKindSection(Keys):
    """The locks that a design is made of."""

    width: Annotated[
        tuple[Length, ...],
        Some,
        BeforeValidator(_listed, json_schema_input_type=Length | tuple[Length, ...]),
    ]
    """width of a lock, or a list of those that it may have"""
    height: Length
    """h: half in either block"""
    most: Annotated[int, Number(at_least=1, at_most=500, whole=True)] = MOST
    """locks that work in an interface"""
    inner: InnerSection = InnerSection()
    """the law of the roots"""
    dry: DrySection = DrySection()
    """the law of the other faces of locks"""

    @model_validator(mode="after")
    def _holds(self) -> Self:
        require_positive(cohesion=self.inner.cohesion)
        return self


class WeightsSection(Keys):
    """What is to be small; with any of these keys, the others are 0."""

    number: _NotNegative = 0.0
    """cost of each lock that works, by default 1"""
    area: _NotNegative = 0.0
    """cost of each m² of their roots"""
    volume: _NotNegative = 0.0
    """cost of each m³ of them"""

    @model_validator(mode="after")
    def _weigh(self) -> Self:
        if self.model_fields_set and not (self.number or self.area or self.volume):
            raise ValueError("one must be more than 0")
        return self

    def cost(self, layout: "Layout") -> float:
        """Cost of a row, in the units of these keys."""
        number = self.number if self.model_fields_set else 1.0
        volume = layout.area * layout.kind.height
        parts = number * layout.working, self.area * layout.area, self.volume * volume
        return math.fsum(parts)


@dataclass(frozen=True, eq=False)
class Layout:
    """A row of locks that an interface may get.

    ``direction``: index of the direction in which its locks run; ``run``: that direction, unit, as
    plain numbers. ``working``: locks that work. ``area`` (m2): of the roots that are sheared off.
    """

    direction: int
    run: Vector
    working: int
    widths: tuple[float, ...]
    area: float
    kind: LockKindSection

    @property
    def strength(self) -> float:
        """Cohesion times area, in N."""
        return self.kind.inner.cohesion * self.area

    @property
    def width(self) -> float:
        """Width of a lock that works, in m."""
        return self.widths[1]


Choice = Sequence[Layout | None]  # for each site


def directions_of(
    face: Polygon, *, angles: Sequence[float] = (), runs: Sequence[Vector] = ()
) -> tuple[Vector, ...]:
    """Unit vectors in which locks of ``face`` may run, one of two opposite ones.

    ``angles`` in degrees in the plane of the face, anticlockwise about its normal from its level
    direction (from x in a level face); ``runs``: directions that are projected onto the face, of
    which those across it are left out.
    """
    normal = face.axes[0]
    level = np.cross([0.0, 0.0, 1.0], normal)
    if np.linalg.norm(level) <= LEVEL:
        level = np.array([1.0, 0.0, 0.0]) - normal[0] * normal
    level /= np.linalg.norm(level)
    steep = np.cross(normal, level)
    given = [
        math.cos(math.radians(angle)) * level + math.sin(math.radians(angle)) * steep
        for angle in angles
    ]
    for run in runs:
        flat = np.array(run, float) - (normal @ run) * normal
        if np.linalg.norm(flat) > LEVEL * np.linalg.norm(run):
            given.append(flat / np.linalg.norm(flat))
    found: list[Floats] = []
    for one in given:
        if all(abs(one @ other) < 1.0 - CLOSE for other in found):
            found.append(one)
    return vectors(np.reshape(np.round(found, 12) + 0.0, (-1, 3)))


def layouts_of(
    face: Polygon, kind: LockKindSection, directions: Sequence[Vector]
) -> tuple[Layout, ...]:
    """All rows of ``kind`` that have room on ``face``."""
    interface = Interface(face.below, face.above, face.axes, face.middle, face.outline)
    found = []
    for direction, run in enumerate(directions):
        whole = Row.of(Locks(1, kind.height, run=run), interface, face.name)
        across = float(whole.edges[1] - whole.edges[0])
        for width, working in product(kind.width, range(1, kind.most + 1)):
            margin = (across - (2 * working - 1) * width) / 2
            if margin < width * (1.0 - CLOSE):
                continue
            widths = (margin, *[width] * (2 * working - 1), margin)
            locks = Locks(len(widths), kind.height, run=run, widths=widths)
            _, areas = condensed_points(Row.of(locks, interface, face.name), _CENTRE)
            ridges = float(areas[2:-2:2].sum())
            # Either way, as many ridges bear as locks work: those between, and the margin ahead.
            held = min(float(areas[1::2].sum()), ridges + float(min(areas[0], areas[-1])))
            found.append(Layout(direction, run, working, widths, held, kind))
    return tuple(found)
