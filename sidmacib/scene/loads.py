"""Loads on a structure as arrows."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from sidmacib.mechanics.assembly import Assembly, Floats, Loads
from sidmacib.problem import Problem
from sidmacib.structure.loads import PointForce, weight_of_free

NOTHING = 1e-9  # of the largest force: no arrow


def arrows_of(assembly: Assembly, loads: Loads) -> dict[str, Any]:
    """The ``loads`` beside self-weight, as plain values.

    ``variable``: for each piece that is loaded the name of its ``block``, the place where the force
    acts, ``at`` (m), its ``force`` per newton, and whether that is a ``point``, or the centroid of
    forces in proportion to masses; ``permanent``: the same in N. ``axis``: that gravity turns
    about, in place of a load that is raised, when the forces are weights in N; None otherwise.
    """
    if loads.axis is not None:
        weights = weight_of_free(assembly)
        return {"variable": [*_arrows(assembly, weights)], "permanent": [], "axis": [*loads.axis]}
    arms = loads.arms if isinstance(loads, PointForce) else None
    others = loads.permanent - weight_of_free(assembly)
    return {
        "variable": [*_arrows(assembly, loads.variable, arms)],
        "permanent": [*_arrows(assembly, others, most=float(np.abs(loads.permanent).max()))],
        "axis": None,
    }


def load_of(problem: Problem) -> str:
    """The load that is raised, in words."""
    found = arrows_of(*problem)
    if found["axis"] is not None:
        return f"Load: gravity, turned about the axis {_listed(found['axis'])}"
    loaded = found["variable"]
    along = _listed(np.sum([each["force"] for each in loaded], axis=0).tolist())
    if len(loaded) == 1 and loaded[0]["point"]:
        at = _listed(loaded[0]["at"])
        return f"Load raised: a force on {loaded[0]['block']} at {at} m, along {along}"
    return f"Load raised: forces in proportion to the masses, along {along}"


def _listed(vector: Sequence[float]) -> str:
    return f"({', '.join(f'{round(each, 4) + 0.0:g}' for each in vector)})"


def _arrows(
    assembly: Assembly, forces: Floats, arms: Floats | None = None, most: float = 0.0
) -> Iterator[dict[str, Any]]:
    size = np.linalg.norm(forces[:, :3], axis=1)
    least = NOTHING * max(float(size.max(initial=0.0)), most)
    for number in np.flatnonzero(size > least):
        piece = assembly.pieces[number]
        arm = np.zeros(3) if arms is None else arms[number]
        yield {
            "block": piece.name,
            "at": (piece.centre + arm).tolist(),
            "force": forces[number, :3].tolist(),
            "point": arms is not None,
        }
