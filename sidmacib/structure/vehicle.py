"""Axles of a vehicle that stand on the blocks under them."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
import shapely

from sidmacib.mechanics.assembly import Assembly, Floats
from sidmacib.structure.blocks import solids_of
from sidmacib.structure.loads import Permanent, PointForce, permanent_only

UPWARDS = 1e-3  # least vertical part of the normal of a face that an axle stands on
SAME = 1e-6  # over the assembly's length: faces no further apart meet under an axle


@dataclass(frozen=True)
class Position:
    """Where the leading axle is: ``value`` (m) along the ``axis`` x or y, or s from the start."""

    axis: str
    value: float

    def __str__(self) -> str:
        return f"leading axle at {self.axis} = {round(self.value, 4) + 0.0:g} m"


class Deck:
    """The faces of an assembly that look upwards, which axles stand on."""

    def __init__(self, assembly: Assembly) -> None:
        self.assembly = assembly
        self._faces: list[tuple[int, Floats, Floats]] = []
        outlines = []
        for number, piece in enumerate(assembly.pieces):
            for solid in solids_of(piece):
                for corners, normal in zip(solid.outlines, solid.normals, strict=True):
                    if normal[2] > UPWARDS:
                        self._faces.append((number, corners[0], normal))
                        outlines.append(shapely.Polygon(corners[:, :2]))
        self._tree = shapely.STRtree(outlines)

    def under(self, x: float, y: float) -> tuple[float, list[int]]:
        """Height (m) of the highest face at a point in plan, and the pieces with such a face there.

        Several where the point is on a joint; none where it is beside the structure.
        """
        near, found = SAME * self.assembly.length, dict[int, float]()
        for face in self._tree.query(shapely.Point(x, y), "dwithin", near).tolist():
            number, (at_x, at_y, at_z), normal = self._faces[face]
            high = at_z - (normal[0] * (x - at_x) + normal[1] * (y - at_y)) / normal[2]
            found[number] = max(high, found.get(number, high))
        top = max(found.values(), default=0.0)
        return top, sorted(number for number, high in found.items() if high >= top - near)

    def standing(
        self, axles: Iterable[tuple[float, float, float]], beside: Permanent | None = None
    ) -> tuple[PointForce, float]:
        """Permanent loads, and ``axles`` (x, y in m, and N) that press on the blocks under them.

        The loads are 1 N together, downwards; and how many newtons press on free blocks, 0 if none
        do. Where a joint is under an axle, each block has its part.
        """
        pieces = self.assembly.pieces
        size, moments = np.zeros(len(pieces)), np.zeros((len(pieces), 3))
        for x, y, newtons in axles:
            z, numbers = self.under(x, y)
            for number in numbers:
                if not pieces[number].fixed:
                    size[number] += newtons / len(numbers)
                    arm = np.array((x, y, z)) - pieces[number].centre
                    moments[number] += newtons / len(numbers) * arm
        whole, always = float(size.sum()), permanent_only(self.assembly, beside)
        # Parallel forces on a piece act as one, at their centre.
        arms = moments / np.where(size, size, 1.0)[:, None]
        variable = np.zeros((len(pieces), 6))
        variable[:, 2] = -size / (whole or 1.0)
        variable[:, 3:] = np.cross(arms, variable[:, :3])
        return PointForce(**vars(replace(always, variable=variable)), arms=arms), whole
