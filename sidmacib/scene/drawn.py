"""What is drawn of a structure: its blocks and interfaces, and what a model says of them."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from sidmacib.build import Solid, solids
from sidmacib.build.views import edge_vertices
from sidmacib.mechanics.assembly import Assembly, Floats, Piece
from sidmacib.mechanics.polygons import Polygon
from sidmacib.mechanics.raised import Load
from sidmacib.problem import Outcome, Problem
from sidmacib.scene.forces import Section, arrows_of, forces_of, reactions, thrust
from sidmacib.structure.analysis.forces import (
    BlockRow,
    InterfaceRow,
    block_rows,
    interfaces_of,
    most_used,
)
from sidmacib.structure.blocks import solids_of
from sidmacib.structure.files.structure_file import blocks_and_rows
from sidmacib.structure.interfaces import tangents, triangles
from sidmacib.structure.structure import owners_of

MOTION = ("move_x_m", "move_y_m", "move_z_m", "turn_x", "turn_y", "turn_z")
DIGITS = 6  # of coordinates


@dataclass(frozen=True, eq=False)
class Drawn:
    """The ``outcome`` of a ``model`` for a structure, or the ``error`` why there is none."""

    model: str
    problem: Problem
    outcome: Outcome | None = None
    error: str | None = None

    @cached_property
    def assembly(self) -> Assembly:
        """The pieces on the cells that the outcome is from."""
        return (self.outcome and self.outcome.cells) or self.problem.assembly

    @cached_property
    def interfaces(self) -> tuple[InterfaceRow, ...]:
        """At the load that counts; none without forces."""
        return interfaces_of(self.assembly, self.outcome) if self.outcome else ()

    @cached_property
    def blocks(self) -> tuple[BlockRow, ...]:
        """Centroids and motions; none without an outcome."""
        return block_rows(self.assembly, self.outcome) if self.outcome else ()

    @cached_property
    def reactions(self) -> tuple[Section, ...]:
        """Of the supports, at the load that counts; none without forces."""
        return reactions(self.assembly, self.interfaces)

    @cached_property
    def thrust(self) -> list[list[dict[str, Any]]]:
        """Lines of thrust at the load that counts, see `sidmacib.scene.forces.thrust`."""
        return thrust(self.assembly, self.interfaces)

    @property
    def load(self) -> float | None:
        """The load (N) that counts, or the angle (degrees) where gravity turns."""
        return None if self.outcome is None else self.raised.value(self.outcome.state.load)

    @property
    def raised(self) -> Load:
        """What is raised: a load, or a tilt."""
        return self.problem.loads.raised

    @property
    def load_words(self) -> str:
        """That load in a legend."""
        return (
            "no answer"
            if self.load is None
            else f"{self.raised.acts} {self.raised.short(self.load)}"
        )

    @property
    def arrows(self) -> dict[str, Any]:
        """Forces (N) at the load that counts, see `arrows_of`; without an outcome at none."""
        return arrows_of(*self.problem, self.outcome.state.load if self.outcome else 0.0)

    @property
    def failing(self) -> list[tuple[str, float]]:
        """Interfaces whose bonds fail on the way to the peak, and the load of the first of them.

        In N, or degrees where gravity turns; the first to fail is the first.
        """
        lost = self.outcome.broken_at if self.outcome else {}
        faces, value = self.assembly.faces, self.raised.value
        return [(faces[face].name, value(load)) for face, load in lost.items()]

    def values(self) -> dict[str, Any]:
        """Plain values for `structure.js`."""
        column = f"{self.raised.name}_{self.raised.unit}"
        first = self.failing[0] if self.failing else (None, None)
        moving = [asdict(block) for block in self.blocks]
        for row in moving:
            row.update(zip(MOTION, row.pop("move") or (None,) * len(MOTION), strict=True))
        return {
            "row": {
                "model": self.model,
                "error": self.error,
                "refused": None,
                **{"load_N": None, "tilt_degrees": None, column: self.load},
                "first_interface": first[0],
                **{"first_failure_load_N": None, "first_failure_tilt_degrees": None},
                f"first_failure_{column}": first[1],
                "most_used_interface": most_used(self.interfaces),
            },
            "blocks": moving,
            "interfaces": [asdict(row) for row in self.interfaces],
            **forces_of(self.assembly, self.interfaces),
        }


def shape_of(assembly: Assembly, made: Sequence[Solid] = ()) -> dict[str, Any]:
    """The blocks and interfaces of ``assembly`` as plain values, coordinates in m.

    ``made``: solids that are drawn in place of the blocks of their names.

    Each has its name, ``points``, ``triangles`` and ``edges``, closed lines, as numbers of points.
    A block has ``fixed``, and the number of the block that it is a lock of, or its own, ``with``;
    an interface its ``middle`` and the numbers of the blocks, ``between``.
    """
    owners = owners_of(assembly)
    by_name = {
        solid.name: {
            "points": [_rounded(place) for place in solid.places],
            "triangles": solid.triangles.tolist(),
            "edges": edge_vertices(solid).tolist(),
        }
        for solid in made
    }
    return {
        "blocks": [
            {
                "name": piece.name,
                "fixed": piece.fixed,
                "with": owners[number],
                **(by_name.get(piece.name) or _solid(piece)),
            }
            for number, piece in enumerate(assembly.pieces)
        ],
        "interfaces": [
            {
                "name": face.name,
                "between": [face.below, face.above],
                "middle": _rounded(np.array(face.middle)),
                **_region(face),
            }
            for face in assembly.faces
            if isinstance(face, Polygon)
        ],
    }


def points_of(shape: dict[str, Any]) -> int:
    """Number of points of a shape."""
    return sum(len(each["points"]) for part in ("blocks", "interfaces") for each in shape[part])


def with_condensed_locks(description: Any, folder: Path) -> list[Solid]:
    """The blocks of a ``description`` with those of their locks that the model condenses.

    ``folder``: that paths of meshes start from. Without the blocks that locks are cut out of as
    well, and without any where the locks cannot be made.
    """
    blocks, rows, near = blocks_and_rows(description, folder)
    condensed = {pair: row for pair, row in rows.items() if row.locks.condensed}
    cut = {name for pair in rows.keys() - condensed.keys() for name in pair}
    names = {name for pair in condensed for name in pair} - cut
    if not names:
        return []
    try:
        made = solids(blocks, condensed, near=near)
    except ValueError:
        return []
    return [each for each in made if each.name in names]


def _solid(piece: Piece) -> dict[str, Any]:
    """The faces of the solids of a piece."""
    points: list[list[float]] = []
    filled, edges = [], []
    for solid in solids_of(piece):
        for face, corners, normal in zip(solid.faces, solid.outlines, solid.normals, strict=True):
            own = [len(points) + vertex for vertex in face]
            flat = corners @ np.array(tangents(normal)).T
            filled += [[own[k] for k in each] for each in triangles(shapely.Polygon(flat), flat)]
            edges.append(own)
        points += map(_rounded, solid.places)
    return {"points": points, "triangles": filled, "edges": edges}


def _region(face: Polygon) -> dict[str, Any]:
    """The outline of an interface, with holes if it has some."""
    rings = [
        shapely.get_coordinates(ring)[:-1]
        for ring in (face.outline.exterior, *face.outline.interiors)
    ]
    flat = np.concatenate(rings)
    ends = np.cumsum([0, *map(len, rings)]).tolist()
    return {
        "points": [_rounded(point) for point in face.at(flat)],
        "triangles": [*triangles(face.outline, flat)],
        "edges": [[*range(one, other)] for one, other in pairwise(ends)],
    }


def _rounded(values: Floats) -> list[float]:
    return [float(f"{value:.{DIGITS}g}") for value in values]
