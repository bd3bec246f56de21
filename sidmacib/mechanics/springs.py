"""Contact nodes as springs between rigid pieces, unbroken: frequencies and compliance.

They set the scales of an explicit computation: its time step, its loading rate, and the
displacement beyond which the assembly can only have failed.

The unknowns are the displacements of the free pieces. Rotations are multiplied by the assembly's
``length`` and moments divided by it, see `row_units`: all unknowns are in m, all forces in N and
all stiffnesses in N/m.
"""

from dataclasses import replace

import numpy as np

from sidmacib.mechanics.assembly import Assembly, Floats, Kind, Loads
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.equilibrium import equilibrium_matrix, free_rows, row_units


def elastic_stiffness(assembly: Assembly, law: ContactLaw) -> Floats:
    """Stiffness (N/m) by all unknowns, (U, U), with every node closed and bonded by ``law``."""
    balance = equilibrium_matrix(assembly)[free_rows(assembly)] / row_units(assembly)[:, None]
    springs = np.column_stack([law.normal_stiffness, law.shear_stiffness, law.shear_stiffness])
    return np.asarray((balance * springs.ravel() @ balance.T).toarray())


def natural_frequencies(assembly: Assembly) -> Floats:
    """Angular frequencies of the free pieces, ascending, in rad/s, with every node closed.

    Every piece has its largest principal moment of inertia about all axes.
    """
    free = [piece for piece in assembly.pieces if not piece.fixed]
    inertia = [piece.inertia.max() / assembly.length**2 for piece in free]  # kg, as rotations in m
    mass = np.concatenate(
        [[piece.mass] * 3 + [turned] * 3 for piece, turned in zip(free, inertia, strict=True)]
    )
    root = np.sqrt(mass)
    stiffness = elastic_stiffness(assembly, ContactLaw.of(assembly)) / root / root[:, None]
    return np.sqrt(np.linalg.eigvalsh(stiffness))


def soft_law(assembly: Assembly) -> ContactLaw:
    """The law of ``assembly`` with no face stiffer than the softest inner one, if there is any.

    The reference for displacements: where all nodes are bonded, dry faces carry loads past the
    inner ones, and the stiffer they are the less moves. Once they slip, the inner faces decide.
    """
    laws = [face.material for face in assembly.faces]
    stiffness = np.array([(law.normal_stiffness, law.shear_stiffness) for law in laws])
    inner = np.array([face.kind is Kind.INNER for face in assembly.faces])
    most = stiffness[inner].min(axis=0, initial=np.inf)
    normal, shear = np.minimum(1.0, most / stiffness)[assembly.nodes.face].T
    law = ContactLaw.of(assembly)
    return replace(
        law,
        normal_stiffness=law.normal_stiffness * normal,
        shear_stiffness=law.shear_stiffness * shear,
    )


def compliance(assembly: Assembly, loads: Loads) -> float:
    """Displacement along the variable load, per newton of load, in m/N, with every node closed.

    By `soft_law`.
    """
    force = loads.variable.ravel()[free_rows(assembly)] / row_units(assembly)
    stiffness = elastic_stiffness(assembly, soft_law(assembly))
    return float(np.sum(force * np.linalg.solve(stiffness, force)))
