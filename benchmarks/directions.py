"""Directions of locks of a vault of 57 interfaces: `.venv/bin/python -m benchmarks.directions`.

A barrel vault of 22 blocks on two springers, four directions in each interface: mixed rows to a
proven gap of 1 %, in processor time.
"""

import time

from sidmacib.design.direction import Search
from sidmacib.design.layouts import LockKind, Weights, directions_of, layouts_of
from sidmacib.design.model import Case, Site, Structure
from sidmacib.joint.joint import DRY, INNER
from sidmacib.mechanics.assembly import FaceMaterial
from sidmacib.mechanics.polygons import Polygon
from sidmacib.structure.loads import acceleration, free_weight
from sidmacib.structure.structure import structure
from studies.designed_vault.geometry import Barrel, barrel

ANGLES = (0.0, 45.0, 90.0, 135.0)
FRICTION, PUSH, WIDTH, HEIGHT, MOST = 0.2, 0.25, 0.1, 0.02, 5  # lengths in m
LONGEST = 3600.0  # s


def main() -> None:
    """Search, and print cost, bound and time."""
    blocks = structure(
        barrel(Barrel(courses=5, blocks=4)), FaceMaterial(1e10, 1e10, FRICTION, 0.0, 0.0)
    )
    kind = LockKind((WIDTH,), HEIGHT, INNER, DRY)
    sites = tuple(
        Site(number, layouts_of(face, kind, directions_of(face, angles=ANGLES), MOST))
        for number, face in enumerate(blocks.faces)
        if isinstance(face, Polygon)
    )
    load = PUSH * free_weight(blocks)
    along = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0)}
    cases = tuple(Case(name, acceleration(blocks, way), load) for name, way in along.items())
    began = time.process_time()
    search = Search(Structure(blocks, sites, cases, Weights()), 1.0)
    found = search.cheapest(whole=False, time_limit=LONGEST, note=print)
    spent = time.process_time() - began
    print(
        f"{len(sites)} interfaces, {found.rounds} rounds: cost {found.cost:.6g}, at least "
        f"{found.bound:.6g}, gap {100 * found.gap:.2f} %, {spent:.0f} CPU-s"
    )


if __name__ == "__main__":
    main()
