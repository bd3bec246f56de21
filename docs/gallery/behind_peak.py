"""After the peak
==============

Five locks under V at e = a / 2. Nodes of lock 2 fail first, and the load still rises a little.
After the peak each point is the load that remains when further bonds fail. Where the line goes
back (snap-back), a test under displacement control would show a sudden drop.
"""

import matplotlib.pyplot as plt

import sidmacib
from sidmacib import UpperBody
from sidmacib.mechanics.static.peaks import after_peak

joint = sidmacib.Joint(locks=5, upper_body=UpperBody.COLUMNS)  # as in the paper
direction = sidmacib.Direction(0.5)  # e / a
assembly = sidmacib.assemble(joint, mesh=0.01)
loads = sidmacib.lateral_load(joint, assembly, sidmacib.Loading(direction))
solution = sidmacib.static_peak(assembly, loads)
behind = list(after_peak(assembly, loads, solution.peak))
first, most = solution.first_failure_load, solution.peak.load
print(f"first failure: V = {direction.shear * first:.1f} N")  # 145.2
print(f"peak: V = {direction.shear * most:.1f} N")  # 154.8

figure, axes = plt.subplots(figsize=(6, 3.6), layout="constrained")
for points, label in ((solution.path, "up to the peak"), ([solution.peak, *behind], "after it")):
    moved = [1e6 * point.displacement for point in points]
    axes.plot(moved, [direction.shear * point.load for point in points], marker=".", label=label)
axes.set(xlabel="displacement of the load (µm)", ylabel="V (N)", ylim=(0, None))
axes.legend()
figure.savefig("behind_peak.png", dpi=150)
