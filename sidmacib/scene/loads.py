"""Loads on a structure as arrows."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from sidmacib.mechanics.assembly import Assembly, Floats, Loads
from sidmacib.problem import Problem
from sidmacib.structure.loads import PointForce, weight_of_free
from sidmacib.structure.structure import owners_of

NOTHING = 1e-9  # of the largest force: no arrow


def arrows_of(assembly: Assembly, loads: Loads, load: float | None = None) -> dict[str, Any]:
    """The ``loads`` beside self-weight, as plain values.

    ``variable``: for each block that is loaded its name, ``block``, the place where the force acts,
    ``at`` (m), its ``force`` per newton, and whether that is a ``point``, or the middle of forces
    on the block and its locks; ``permanent``: the same in N. ``axis``: that gravity turns about, in
    place of a load that is raised; ``variable`` then has weights in N; None otherwise. With a
    ``load`` (N), all forces are those under this load, in N.
    """
    weights = weight_of_free(assembly)
    others, arms = loads.permanent - weights, None
    if loads.axis is None:
        raised = (1.0 if load is None else load) * loads.variable
        arms = loads.arms if isinstance(loads, PointForce) else None
    else:
        raised = weights if load is None else loads.at(load) - others
    most = float(np.abs(loads.permanent).max())
    return {
        "variable": [*_arrows(assembly, raised, arms)],
        "permanent": [*_arrows(assembly, others, _lever_arms(others), most)],
        "axis": None if loads.axis is None else [*loads.axis],
    }


def _lever_arms(wrenches: Floats) -> Floats:
    """From the centroids to the lines along which forces act (m), (P, 3); torsion apart."""
    force, moment = wrenches[:, :3], wrenches[:, 3:]
    square = np.maximum((force**2).sum(axis=1), np.finfo(float).tiny)
    return np.asarray(np.cross(force, moment) / square[:, None])


def load_of(problem: Problem) -> str:
    """The load that is raised, in words."""
    found = arrows_of(*problem)
    loaded, beside = found["variable"], ""
    if found["permanent"]:
        together = np.sum([each["force"] for each in found["permanent"]], axis=0)
        beside = f"; permanent loads beside weight, together {_listed(together.tolist())} N"
    if found["axis"] is not None:
        return f"Load: gravity, turned about the axis {_listed(found['axis'])}{beside}"
    if not loaded:
        return f"No load is raised{beside}"
    along = _listed(np.sum([each["force"] for each in loaded], axis=0).tolist())
    if len(loaded) == 1 and loaded[0]["point"]:
        at = _listed(loaded[0]["at"])
        return f"Load raised: a force on {loaded[0]['block']} at {at} m, along {along}{beside}"
    return f"Load raised: forces in proportion to the masses, along {along}{beside}"


def _listed(vector: Sequence[float]) -> str:
    return f"({', '.join(f'{round(each, 4) + 0.0:g}' for each in vector)})"


def _arrows(
    assembly: Assembly, forces: Floats, arms: Floats | None = None, most: float = 0.0
) -> Iterator[dict[str, Any]]:
    size = np.linalg.norm(forces[:, :3], axis=1)
    least = NOTHING * max(float(size.max(initial=0.0)), most)
    owner = np.array(owners_of(assembly))
    places = np.array([piece.centre for piece in assembly.pieces]) + (0.0 if arms is None else arms)
    for number in np.unique(owner[size > least]):
        parts = (owner == number) & (size > least)
        yield {
            "block": assembly.pieces[number].name,
            "at": (size[parts] @ places[parts] / size[parts].sum()).tolist(),
            "force": forces[parts, :3].sum(axis=0).tolist(),
            "point": arms is not None,
        }
