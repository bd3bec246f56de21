"""What tests of structures share."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from sidmacib.mechanics.assembly import Assembly, FaceMaterial
from sidmacib.mechanics.limit import limit_load
from sidmacib.structure.blocks import Block
from sidmacib.structure.loads import acceleration, free_weight


def dry(friction: float) -> FaceMaterial:
    return FaceMaterial(1e10, 1e10, friction, 0.0, 0.0)


def moved(block: Block, turn: Rotation, shift: Sequence[float]) -> Block:
    """The block turned about the origin, then shifted (m)."""
    places = turn.apply(block.places) + np.array(shift)
    return replace(block, vertices=tuple(tuple(map(float, place)) for place in places))


def tilt(assembly: Assembly) -> float:
    """Angle in degrees at which a dry structure fails when it is tilted towards x."""
    loads = acceleration(assembly, (1.0, 0.0, 0.0))
    load = limit_load(assembly, loads, friction=True).load
    return math.degrees(math.atan(load / free_weight(assembly)))
