"""Verdicts of rigid-block equilibrium (RBE) of compas_cra on its samples.

It is of the extra ``peers``; there is no verdict where it is not installed.
"""

import importlib.util
import io
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

from studies.structures.samples import HEAVY, Sample

INSTALLED = all(map(importlib.util.find_spec, ("compas", "compas_assembly", "compas_cra")))
TENSION = 1e-3  # of the sum of compressions: more is needed only by what is unstable
NEAR, LEAST_AREA = 1e-4, 1e-6  # m and m2, of interfaces that it finds, as in its examples
STABLE, UNSTABLE = "stable", "unstable"


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
