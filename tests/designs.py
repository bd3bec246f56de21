"""What tests of the design share."""

from collections.abc import Sequence

import numpy as np
from structures import dry

from sidmacib.design import LockKind, Weights, directions_of, layouts_of
from sidmacib.design.model import DesignProblem, LoadCase, Site
from sidmacib.joint import DRY, INNER
from sidmacib.mechanics.assembly import Assembly, Vector
from sidmacib.structure.blocks import Block, box
from sidmacib.structure.loads import force_at
from sidmacib.structure.structure import structure

FRICTION = 0.3
KIND = LockKind((0.05,), 0.02, INNER, DRY)
T1 = 8e4 * 0.05 * 0.4  # N, a lock along x in the face of `two_blocks`


BASE = box("base", (0.0, 0.0, -0.3), (0.4, 0.6, 0.0), 2e3, fixed=True)


def two_blocks(friction: float = FRICTION) -> Assembly:
    return structure([BASE, box("block", (0.0, 0.0, 0.0), (0.4, 0.6, 0.3), 2e3)], dry(friction))


def design_on(
    assembly: Assembly,
    cases: Sequence[LoadCase],
    *,
    angles: Sequence[float] = (0.0, 90.0),
    weights: Weights | None = None,
    kind: LockKind = KIND,
    most: int = 10,
) -> DesignProblem:
    sites = tuple(
        Site(number, layouts_of(face, kind, directions_of(face, angles=angles), most))
        for number, face in enumerate(assembly.faces)
    )
    return DesignProblem(assembly, sites, tuple(cases), weights or Weights())


def pushed(assembly: Assembly, load: float, along: Vector = (0.0, 1.0, 0.0)) -> LoadCase:
    """A push at the foot of the block, so that nothing turns over."""
    return LoadCase("push", force_at(assembly, "block", (0.2, 0.3, 0.0), along), load)


def stack() -> list[Block]:
    """Two blocks on a base."""
    return [
        BASE,
        box("lower", (0.0, 0.0, 0.0), (0.4, 0.6, 0.3), 2e3),
        box("upper", (0.0, 0.0, 0.3), (0.4, 0.6, 0.6), 2e3),
    ]


def working(structure_: DesignProblem, parts: np.ndarray) -> list[int]:
    """Locks that work at each site."""
    found = np.zeros(len(structure_.sites))
    counts = np.array([layout.working for layout in structure_.layouts])
    np.add.at(found, structure_.site_of, counts * parts)
    return [round(each) for each in found.tolist()]
