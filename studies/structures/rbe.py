"""Rigid-block equilibrium (RBE) with a friction pyramid: as a linear programme, and in compas_cra.

In place of each friction cone there is a pyramid of eight sides around it: along its edges it
allows 8 % more shear than the cone. The programme is solved by HiGHS. compas_cra is of the extra
``peers``; there is no verdict of it where it is not installed.
"""

import importlib.util
import io
import math
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import block_diag, csr_array, diags_array, hstack

from sidmacib.mechanics.assembly import Assembly, Floats
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.equilibrium import equilibrium_matrix, free_rows, row_units
from sidmacib.structure.analysis.limit import SECTOR
from sidmacib.structure.analysis.tilt import LARGEST, Tilt, turned
from studies.structures.samples import HEAVY, Sample

PYRAMID_SIDES = 8
INFEASIBLE, UNBOUNDED = 2, 3  # of HiGHS, as SciPy has it
INSTALLED = all(map(importlib.util.find_spec, ("compas", "compas_assembly", "compas_cra")))
TENSION = 1e-3  # of the sum of compressions: more is needed only by what is unstable
NEAR, LEAST_AREA = 1e-4, 1e-6  # m and m2, of interfaces that it finds, as in its examples
STABLE, UNSTABLE = "stable", "unstable"


def pyramid_tilt(assembly: Assembly, tilt: Tilt) -> float | None:
    """The smallest angle (degrees) beyond which no forces in the pyramids carry gravity.

    For dry assemblies and level axes. None if there are none upright.
    """
    if _tangent(assembly, tilt, 0.0, most=0.0) is None:
        return None
    for begin in np.arange(0.0, LARGEST, SECTOR).tolist():
        tangent = _tangent(assembly, tilt, begin)
        if tangent is None:  # at the very end of the sector before
            return float(begin)
        further = math.degrees(math.atan(tangent))
        if further < SECTOR:
            return float(begin + further)
    return LARGEST


def _tangent(assembly: Assembly, tilt: Tilt, begin: float, most: float = math.inf) -> float | None:
    """The largest tangent, at most ``most``, of an angle beyond ``begin`` that is carried."""
    rows, units = free_rows(assembly), row_units(assembly)
    ahead = turned(assembly, tilt, begin)
    beside = turned(assembly, tilt, begin + 90.0)
    weight, across = (load.permanent.ravel()[rows] / units / load.scale for load in (ahead, beside))
    balance = diags_array(1.0 / units) @ equilibrium_matrix(assembly)[rows]
    count = len(assembly.nodes.area)
    limits = _pyramids(ContactLaw.of(assembly).friction)
    found = linprog(
        np.append(np.zeros(3 * count), -1.0),
        A_ub=hstack([limits, csr_array((limits.shape[0], 1))]),
        b_ub=np.zeros(limits.shape[0]),
        A_eq=hstack([balance, csr_array(-across[:, None])]),
        b_eq=weight,
        bounds=[*[(0.0, None), (None, None), (None, None)] * count, (0.0, most)],
        method="highs",
    )
    if found.status == UNBOUNDED:
        return math.inf
    return None if found.status == INFEASIBLE else float(found.x[-1])


def _pyramids(friction: Floats) -> csr_array:
    """Rows that are 0 at most where shear is inside the pyramid, (8 N, 3 N)."""
    angle = 2.0 * np.pi * np.arange(PYRAMID_SIDES) / PYRAMID_SIDES
    sides = np.column_stack([np.cos(angle), np.sin(angle)])
    blocks = np.zeros((len(friction), PYRAMID_SIDES, 3))
    blocks[:, :, 0], blocks[:, :, 1:] = -friction[:, None], sides
    return csr_array(block_diag(blocks))


def rbe_verdict(path: Path, sample: Sample) -> str | None:
    """Whether rigid-block equilibrium of compas_cra needs no tension; None without compas_cra."""
    if not INSTALLED:
        return None
    from compas_cra.equilibrium import rbe_solve

    with redirect_stdout(io.StringIO()):  # it prints its progress
        assembly = _assembly(path, sample)
        try:
            rbe_solve(assembly, mu=sample.friction, density=1.0)
        except ValueError as error:
            return f"no answer ({error})"
    pull = push = 0.0
    for edge in assembly.graph.edges():
        for interface in assembly.graph.edge_attribute(edge, "interfaces"):
            pull += sum(force["c_nn"] for force in interface.forces)
            push += sum(force["c_np"] for force in interface.forces)
    return STABLE if pull <= TENSION * push else UNSTABLE


def _assembly(path: Path, sample: Sample) -> Any:
    """The sample as compas_cra has it, with supports, densities and interfaces."""
    import compas
    from compas_cra.algorithms import assembly_interfaces_numpy
    from compas_cra.datastructures import CRA_Assembly
    from compas_cra.equilibrium import density_setup

    assembly = compas.json_load(str(path)).copy(cls=CRA_Assembly)
    if sample.fixed is not None:
        assembly.set_boundary_conditions(list(sample.fixed))
    if sample.heavy:
        nodes = assembly.graph.nodes()
        density_setup(assembly, {n: HEAVY if n in sample.heavy else 1.0 for n in nodes})
    if not sample.own_interfaces:
        assembly_interfaces_numpy(assembly, nmax=10, amin=LEAST_AREA, tmax=NEAR)
    return assembly
