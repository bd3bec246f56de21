"""Arch under horizontal load
==========================

The models work on arbitrary blocks. A semicircular arch of 20 voussoirs carries 0.29 of its weight
as a horizontal force, and then becomes a mechanism with four hinges.
"""

import math
from itertools import pairwise

import matplotlib.pyplot as plt
import numpy as np

from sidmacib.mechanics.assembly import FaceMaterial
from sidmacib.mechanics.limit import limit_load
from sidmacib.structure.blocks import prism
from sidmacib.structure.loads import acceleration, free_weight
from sidmacib.structure.structure import structure

inner, outer, depth, density = 0.9, 1.1, 0.3, 2000.0  # m, kg/m3
angles = np.linspace(0, math.pi, 21)


def at(radius: float, angle: float) -> tuple[float, float, float]:
    """A point of the arch's face."""
    return radius * math.cos(angle), 0.0, radius * math.sin(angle)


outlines = {
    f"voussoir{k}": [at(inner, p), at(outer, p), at(outer, q), at(inner, q)]
    for k, (p, q) in enumerate(pairwise(angles))
}
for name, x in (("left", -1.5), ("right", 0.5)):
    outlines[name] = [(x, 0, 0), (x + 1, 0, 0), (x + 1, 0, -0.2), (x, 0, -0.2)]
blocks = [
    prism(name, outline, (0, depth, 0), density, fixed=not name.startswith("voussoir"))
    for name, outline in outlines.items()
]
dry = FaceMaterial(1e10, 1e10, friction=0.7, cohesion=0, tensile_strength=0)
arch = structure(blocks, dry)
limit = limit_load(arch, acceleration(arch, (1, 0, 0)), friction=True)
print(f"carried: {limit.load / free_weight(arch):.3f} of the weight")  # 0.286

figure, axes = plt.subplots(figsize=(6, 3.6), layout="constrained")
for piece, moved in zip(arch.pieces, limit.mechanism):
    x, _, z = np.transpose(outlines[piece.name])
    axes.fill(x, z, facecolor="none", edgecolor="lightgray")
    shift, turn = 0.1 * moved[[0, 2]], 0.1 * moved[4]  # small: of the mechanism only its direction
    middle = piece.centre[[0, 2]]
    x, z = (
        x + shift[0] + turn * (z - middle[1]),
        z + shift[1] - turn * (x - middle[0]),
    )
    axes.fill(x, z, facecolor="tab:gray" if piece.fixed else "tab:blue", alpha=0.6, edgecolor="k")
axes.set_aspect("equal")
axes.set_axis_off()
figure.savefig("arch.png", dpi=150)
