"""A joint of your own: which lock fails first?
============================================

Nine locks under V at e = 0.3 a. Each bar is the mean shear stress on a lock's inner face over its
cohesion at the peak. Lock 2 carries most, and yet only 0.69 of its strength: the torque overloads
its corner, and the joint fails with this lock. A block in one piece makes the others carry almost
as much; the last lock has nothing to bear against.
"""

import matplotlib.pyplot as plt

import sidmacib
from sidmacib import lock_weights

joint = sidmacib.Joint(locks=9, a=0.08, H=0.06)  # m
direction = sidmacib.Direction(0.3)  # e / a
assembly = sidmacib.assemble(joint, mesh=0.02)
loads = sidmacib.lateral_load(joint, assembly, sidmacib.Loading(direction))
peak = sidmacib.static_peak(assembly, loads).peak
print(f"peak V: {direction.shear * peak.load:.1f} N")  # 827.6

weights = lock_weights(joint, assembly, peak.force)
most = max(weights, key=lambda each: each.mean_shear_ratio)
print(f"lock {most.lock} carries {most.mean_shear_ratio:.2f} of its strength")  # 2: 0.69

figure, axes = plt.subplots(figsize=(6, 3.4), layout="constrained")
colours = ["tab:blue" if each.block == "upper" else "tab:gray" for each in weights]
axes.bar(
    [each.lock for each in weights], [each.mean_shear_ratio for each in weights], color=colours
)
axes.set(xlabel="lock (blue: upper block, grey: lower block)", ylabel="mean stress / cohesion")
axes.set_xticks([each.lock for each in weights])
figure.savefig("own_joint.png", dpi=150)
