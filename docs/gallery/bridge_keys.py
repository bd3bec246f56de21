"""Keys of a bridge: what does the next key add?
=============================================

Dry joints of segmental bridges have shear keys. Codes add up the strengths of the keys. If keys
fail one after the other, the sum is an upper bound: the curves show the first failure / sum, for a
row of smooth keys in columns, in concrete of 35 GPa and in a rigid block.
"""

from dataclasses import replace

import matplotlib.pyplot as plt

import sidmacib
from sidmacib import UpperBody

smooth = replace(sidmacib.Joint(3).dry, friction=0.0)
bodies = {
    "rigid block": {"upper_body": UpperBody.MONOLITHIC},
    "concrete, 35 GPa": {
        "upper_body": UpperBody.MONOLITHIC,
        "elastic": sidmacib.Elastic(young=3.5e10, poisson=0.2),
    },
    "columns": {"upper_body": UpperBody.COLUMNS},
}
keys = range(1, 8)

figure, axes = plt.subplots(figsize=(6, 3.8), layout="constrained")
for name, body in bodies.items():
    joints = [sidmacib.Joint(2 * count + 1, dry=smooth, **body) for count in keys]
    loads = [sidmacib.law(joint, sidmacib.Direction(0)).load for joint in joints]
    part = [load / (joint.T0 * count) for load, joint, count in zip(loads, joints, keys)]
    axes.plot(keys, part, marker="o", label=name)
print(f"three keys in {name}: {part[2]:.3f} of their sum")  # 0.645
axes.axhline(1, color="black", lw=0.8, ls="--", label="sum over keys")

axes.set(xlabel="keys", ylabel="first failure / sum over keys", ylim=(0, 1.05))
axes.legend()
figure.savefig("bridge_keys.png", dpi=150)
