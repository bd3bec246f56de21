"""multilock as a solver of compas_dem: from its problem and model to its results.

COMPAS is imported where it is used: `import sidmacib` needs none of it.
"""

import importlib
import tempfile
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from sidmacib.errors import CapacityError, UnboundedError
from sidmacib.mechanics.assembly import GRAVITY, Assembly, Floats
from sidmacib.structure.analysis.limit import limit_state
from sidmacib.structure.files.compas import NAME
from sidmacib.structure.files.compas_results import compas_results
from sidmacib.structure.files.structure_file import assembly_of, permanent_of
from sidmacib.structure.loads import permanent_only
from sidmacib.validation import refused
from sidmacib.yaml_text import read_yaml

SAME = 1e-9  # over the load: what is carried as far as this is carried


def multilock_solve(
    problem: Any,
    model: Any,
    *,
    laws: Mapping[str, Any] | str | Path | None = None,
    limit: bool = False,
    density: float | None = None,
) -> Any:
    """Solve a `compas_dem.problem.Problem` on a `BlockModel`; returns a `compas_dem` `Results`.

    Limit analysis with associated friction: forces that balance weight and loads within friction,
    cohesion and tensile strength, those with the least sum of s^2 / A of all that do. Supports,
    densities of materials, point, surface and body loads and the contact model (mu, c and t_c in
    Pa) are taken from COMPAS, in m, N and kg.

    ``laws``: the keys `interfaces`, `special`, `locks`, `mesh`, `nodes`, `tolerance` and
    `permanent` of a structure's file, or the path of one: what COMPAS has no words for. ``limit``:
    the loads of the problem are raised to their limit, and blocks are moved by the mechanism there;
    otherwise forces are those under the loads as they are. ``density`` (kg/m3): of blocks whose
    material has none.
    The ``metadata`` of the results have `load_factor`, the largest multiple of the loads that is
    carried; None where there are none, or where no multiple is too large.

    ValueError for what is not understood, by name. `sidmacib.errors.CapacityError` if the loads, or
    the weight alone, are not carried.
    """
    compas = importlib.import_module("compas")
    described = _described(problem, laws)
    with tempfile.TemporaryDirectory() as folder:
        compas.json_dump(model, Path(folder, "model.json"))
        blocks: dict[str, Any] = {"file": "model.json"}
        if density is not None:
            blocks["density"] = density
        else:
            for block in model.elements():
                known = getattr(getattr(block, "material", None), "density", None)
                if hasattr(block, "is_support") and known is None:
                    what = "its material must have a density, or give density"
                    raise ValueError(f"block {block.graphnode}: {what}")
        assembly = assembly_of({**described, "blocks": {NAME: blocks}}, Path(folder))
    always = permanent_only(assembly, permanent_of(assembly, described))
    given = _loads(problem, model, assembly)
    total = float(np.abs(given[:, :3]).sum() + np.abs(given[:, 3:]).sum() / assembly.length)
    if limit and not total:
        raise ValueError("limit: the problem must have loads on free blocks, to be raised")
    loads = replace(always, variable=given / (total or 1.0), scale=max(always.scale, total))
    factor: float | None = None
    if total:
        try:
            state = limit_state(assembly, loads)
            factor = state.load / total
        except UnboundedError:
            if limit:
                raise
    if not limit:
        if factor is not None and factor < 1.0 - SAME:
            raise CapacityError(f"no equilibrium: the model carries {factor:.4g} of its loads")
        state = limit_state(assembly, loads, most=total)
    metadata = {
        "program": "multilock",
        "analysis": "limit, associated friction",
        "load_factor": factor,
        "at": "limit" if limit else "loads",
    }
    data = compas_results(
        assembly, state.force, state.mechanism, str(model.guid), metadata, str(problem.guid)
    )
    return compas.json_loads(compas.json_dumps(data))


def show_forces(model: Any, results: Any) -> None:
    """Put the contacts of ``results``, with their forces, in place of those of a `BlockModel`.

    Each pair of blocks then has all its contacts in `model.graph`, with `forces` at their corners.
    """
    for one, other in results.edges():
        contacts = results.edge_attribute((one, other), "contacts")
        edge = (one, other) if model.graph.has_edge((one, other)) else (other, one)
        if not model.graph.has_edge(edge):
            model.graph.add_edge(one, other)
            edge = (one, other)
        model.graph.edge_attribute(edge, "contacts", contacts)


def _described(problem: Any, laws: Mapping[str, Any] | str | Path | None) -> dict[str, Any]:
    """Description as in a structure's file: ``laws``, else what the contact model says."""
    given = read_yaml(Path(laws)) if isinstance(laws, str | Path) else dict(laws or {})
    if not isinstance(given, dict):
        raise refused("laws", given, "a mapping with interfaces, special, locks")
    for key in ("blocks", "load", "load_cases"):
        if key in given:
            allowed = "interfaces, special, locks, mesh, nodes, tolerance or permanent"
            raise refused("laws", key, allowed)
    contact = problem.contact_properties.contact_model
    of_problem = {}
    if contact is not None:
        names = {"friction": "mu", "cohesion": "c", "tensile_strength": "t_c"}
        of_problem = {name: getattr(contact, of) or 0.0 for name, of in names.items()}
    elif "friction" not in (given.get("interfaces") or {}):
        raise ValueError("problem: must have a contact model, or laws with interfaces")
    return {**given, "interfaces": {**of_problem, **(given.get("interfaces") or {})}}


def _loads(problem: Any, model: Any, assembly: Assembly) -> Floats:
    """Forces (N) and moments (N m) about the centroids of all pieces, (P, 6)."""
    number = {int(p.name.rpartition("-")[2]): i for i, p in enumerate(assembly.pieces)}
    meshes = {block.graphnode: block for block in model.elements()}
    found = np.zeros((len(assembly.pieces), 6))

    def add(node: int, force: Any, at: Any = None, moment: Any = None) -> None:
        if node not in number:
            raise refused("block_index", node, "a block of the model")
        piece = assembly.pieces[number[node]]
        arm = np.zeros(3) if at is None else np.array(list(at), float) - piece.centre
        vector = np.array(list(force), float)
        more = np.zeros(3) if moment is None else np.array(list(moment), float)
        if not piece.fixed:
            found[number[node]] += [*vector, *(np.cross(arm, vector) + more)]

    for group in problem.boundary_conditions:
        if group.displacements:
            raise ValueError("displacements: must not be prescribed; rigid blocks have no answer")
        if abs(getattr(group, "g", GRAVITY) - GRAVITY) > 1e-6 * GRAVITY:
            raise refused("g", group.g, f"{GRAVITY:g} m/s2")
        for load in group.body_forces:
            for node, place in number.items():
                add(node, assembly.pieces[place].mass * np.array(load.acceleration, float))
        for load in group.point_loads:
            add(load.block_index, load.force or (0.0, 0.0, 0.0), load.point, load.moment)
        for load in group.surface_loads:
            mesh = meshes[load.block_index].modelgeometry
            area = mesh.face_area(load.face_index)
            force = area * np.array(load.load, float)
            add(load.block_index, force, mesh.face_center(load.face_index))
    if not np.isfinite(found).all():
        raise ValueError("loads: all numbers must be finite")
    return found
