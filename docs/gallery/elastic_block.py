"""Elastic block
=============

The published joints are rigid. Here the upper block of five locks is one elastic piece, from soft
stone to steel. The stiffer it is, the more evenly it loads the locks. Equilibrium allows two
effective locks at most, which rigid columns of the published sizes do not reach.
"""

import matplotlib.pyplot as plt
import numpy as np

import sidmacib
from sidmacib import UpperBody

pure_shear = sidmacib.Direction(0)
moduli = np.geomspace(3e9, 2e11, 9)  # Pa
working = []
for young in moduli:
    block = sidmacib.Elastic(young, poisson=0.2)
    joint = sidmacib.Joint(locks=5, upper_body=UpperBody.MONOLITHIC, elastic=block)
    working.append(sidmacib.law(joint, pure_shear).load / joint.T0)
columns = sidmacib.Joint(locks=5, upper_body=UpperBody.COLUMNS)
rigid = sidmacib.law(columns, pure_shear).load / columns.T0
print(f"softest: {working[0]:.2f}, stiffest: {working[-1]:.2f} locks")  # 1.44, 1.97
print(f"rigid columns: {rigid:.2f} locks")  # 1.71

figure, axes = plt.subplots(figsize=(6, 3.6), layout="constrained")
axes.semilogx(moduli / 1e9, working, marker="o", label="one elastic piece")
axes.axhline(rigid, color="tab:orange", label="rigid columns, as published")
axes.axhline(2, color="black", lw=0.8, ls="--", label="(n − 1) / 2")
axes.set(xlabel="Young's modulus (GPa)", ylabel="effective locks, V / T0", ylim=(0, 2.2))
axes.legend(loc="lower right")
figure.savefig("elastic_block.png", dpi=150)
