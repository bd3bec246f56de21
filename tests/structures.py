"""Blocks and arches that tests build structures of."""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from scipy.spatial.transform import Rotation

from sidmacib.mechanics.assembly import Assembly, FaceMaterial, Vector
from sidmacib.mechanics.limit import limit_load
from sidmacib.structure.blocks import Block, box, prism
from sidmacib.structure.loads import acceleration, free_weight


def dry(friction: float) -> FaceMaterial:
    return FaceMaterial(1e10, 1e10, friction, 0.0, 0.0)


def arch(
    count: int, thickness: float, radius: float = 1.0, depth: float = 0.3, density: float = 2e3
) -> list[Block]:
    """A semicircle of ``count`` equal voussoirs on two supports.

    ``thickness`` over the mean ``radius``; lengths in m. Voussoirs are numbered from +x to -x.
    """
    inner, outer = radius * (1.0 - thickness / 2), radius * (1.0 + thickness / 2)
    angles = np.linspace(0.0, math.pi, count + 1).tolist()

    def at(r: float, angle: float) -> Vector:
        return r * math.cos(angle), 0.0, r * math.sin(angle)

    voussoirs = [
        prism(
            f"voussoir{k}",
            [at(inner, one), at(outer, one), at(outer, other), at(inner, other)],
            (0.0, depth, 0.0),
            density,
        )
        for k, (one, other) in enumerate(pairwise(angles))
    ]
    step, low = radius / 2, (0.0, -radius)
    left = box(
        "left", (-outer - step, 0.0, low[1]), (-inner + step, depth, 0.0), density, fixed=True
    )
    right = box(
        "right", (inner - step, 0.0, low[1]), (outer + step, depth, 0.0), density, fixed=True
    )
    return [left, right, *voussoirs]


def moved(block: Block, turn: Rotation, shift: Sequence[float]) -> Block:
    """The block turned about the origin, then shifted (m)."""
    places = turn.apply(block.places) + np.array(shift)
    return replace(block, vertices=tuple(tuple(map(float, place)) for place in places))


def tilt(assembly: Assembly) -> float:
    """Angle in degrees at which a dry structure fails when it is tilted towards x."""
    loads = acceleration(assembly, (1.0, 0.0, 0.0))
    load = limit_load(assembly, loads, friction=True).load
    return math.degrees(math.atan(load / free_weight(assembly)))
