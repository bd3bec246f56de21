"""V–M curves of five joints
=========================

The upper body of seven locks grows from 20 to 100 mm. A taller body transfers more load to
the locks behind the first ones. Each curve is the safe load, by the safe rule.
"""

import math

import matplotlib.pyplot as plt
import numpy as np

import sidmacib

ratios = [*np.linspace(0, 0.5, 6), 0.75, 1, 2, 4, math.inf]  # e / a, up to pure torsion
directions = [sidmacib.Direction(ratio) for ratio in ratios]

figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
for H in (0.02, 0.04, 0.06, 0.08, 0.1):  # m
    joint = sidmacib.Joint(locks=7, H=H)
    curve = [sidmacib.safe(joint, direction) for direction in directions]
    axes.plot(
        [point.shear for point in curve],
        [point.torque for point in curve],
        marker="o",
        markersize=3,
        label=f"H = {1000 * H:g} mm",
    )
print(f"the tallest in pure shear: {curve[0].shear:.1f} N")  # 695.1
print(f"and in pure torsion: {curve[-1].torque:.2f} N m")  # 14.58

axes.set(xlabel="shear V (N)", ylabel="torque M (N m)", xlim=(0, None), ylim=(0, None))
axes.grid(alpha=0.3)
axes.legend()
figure.savefig("five_sizes.png", dpi=150)
