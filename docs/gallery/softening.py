"""Softening bonds
===============

A brittle bond loses its strength at once, a ductile one keeps it. In between, the fracture energy
of the inner faces decides how many of five locks act together: about 10 J/m² are needed for the
second lock to reach its strength while the first still carries load.
"""

from dataclasses import replace

import matplotlib.pyplot as plt

import sidmacib
from sidmacib import UpperBody
from sidmacib.mechanics.assembly import Failure


def peak(failure: Failure, energy: float = 0.0) -> float:
    """Largest V (N) of five locks in pure shear; ``energy`` in J/m2."""
    bonds = replace(sidmacib.Joint(5).inner, fracture_energy=energy)
    columns = UpperBody.COLUMNS  # as in the paper
    joint = sidmacib.Joint(locks=5, inner=bonds, failure=failure, upper_body=columns)
    assembly = sidmacib.assemble(joint, mesh=0.02, nodes=sidmacib.NodeLayout.VERTICES)
    loads = sidmacib.lateral_load(joint, assembly, sidmacib.Loading(sidmacib.Direction(0)))
    return sidmacib.static_peak(assembly, loads).peak.load


energies = [1, 3, 10, 30, 100, 300]  # J/m2
brittle, ductile = peak(Failure.BRITTLE), peak(Failure.DUCTILE)
softening = [peak(Failure.SOFTENING, energy) for energy in energies]
print(f"brittle: {brittle:.1f} N, ductile: {ductile:.1f} N")  # 408.9, 493.6
print(f"softening with {energies[2]} J/m²: {softening[2]:.1f} N")  # 10, 449.4

figure, axes = plt.subplots(figsize=(6, 3.6), layout="constrained")
axes.semilogx(energies, softening, marker="o", label="softening")
axes.axhline(brittle, color="tab:red", label="brittle")
axes.axhline(ductile, color="tab:green", label="ductile")
axes.set(xlabel="fracture energy (J/m²)", ylabel="peak V (N)", ylim=(0, 530))
axes.legend(loc="lower right")
figure.savefig("softening.png", dpi=150)
