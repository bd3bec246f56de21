"""How many locks does a structure need?
=====================================

A block on a base is pushed by 2000 N along y, or by 0.2 of its weight along x. Friction alone does
not hold it. multilock finds the cheapest locks, proves a lower bound of their cost, and checks them
by the static model, with the locks modelled as solids.
"""

import matplotlib.pyplot as plt
from matplotlib.patches import Rectangle

from sidmacib.design.designed import design_of
from sidmacib.design.file import task_of

force = {"block": "block", "at": [0.2, 0, 0.05], "direction": [0, 1, 0]}  # m
task = task_of(
    {
        "blocks": {
            "base": {"low": [0, 0, -0.3], "high": [0.4, 0.6, 0], "fixed": True},
            "block": {"low": [0, 0, 0], "high": [0.4, 0.6, 0.3]},
        },
        "interfaces": {"friction": 0.3},
        "design": {
            "locks": {"width": 0.05, "height": 0.02},
            "cases": {
                "push": {"force": force, "newtons": 2000},
                "quake": {"acceleration": [1, 0, 0], "over_weight": 0.2},
            },
        },
    }
)
design = design_of(task)
(row,) = design.choice  # of the one interface
print(f"locks: {row.working}, bound: {design.bound:.2f}")  # 2, 1.00
least = min(each.factor for each in design.checks if each.decides)
print(f"least carried over asked for: {least:.3f}")  # 1.485

figure, axes = plt.subplots(figsize=(5, 4.2), layout="constrained")
y = (0.6 - sum(row.widths)) / 2  # the row is in the middle of the interface, seen from above
axes.add_patch(Rectangle((0, 0), 0.4, 0.6, facecolor="none", edgecolor="black"))
for number, width in enumerate(row.widths):
    colour = "tab:blue" if number % 2 else "lightgray"
    axes.add_patch(Rectangle((0, y), 0.4, width, facecolor=colour, edgecolor="black"))
    y += width
axes.annotate("2000 N", (0.2, 0), (0.2, -0.12), arrowprops={"arrowstyle": "-|>"}, ha="center")
axes.annotate("quake", (0, 0.3), (-0.15, 0.3), arrowprops={"arrowstyle": "-|>"}, va="center")
axes.set(xlabel="x (m)", ylabel="y (m)", xlim=(-0.2, 0.5), ylim=(-0.15, 0.65), aspect="equal")
axes.set_title("interface from above; blue: locks of the block")
figure.savefig("designed_stack.png", dpi=150)
