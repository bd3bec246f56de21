"""An assembly that is no joint: a stack of dry blocks, tilted until they slide or fall."""

from itertools import pairwise

import numpy as np

from sidmacib import Assembly, FaceMaterial, Loads, NodeLayout
from sidmacib.joint.pieces import shared_face
from sidmacib.mechanics.assembly import Cuboid, Kind
from sidmacib.mechanics.contact_nodes import contact_nodes
from sidmacib.mechanics.equilibrium import self_weight


def tilted_stack(
    blocks: int = 3,
    friction: float = 0.5,
    width: float = 0.2,
    height: float = 0.1,
    depth: float = 0.2,
    mesh: float = 0.05,
    density: float = 2000.0,
    stiffness: float = 1e10,
) -> tuple[Assembly, Loads]:
    """Equal blocks on a fixed one, each ``width`` (x) by ``depth`` (y) by ``height`` (z).

    Lengths in m, ``density`` in kg/m3, ``stiffness`` in Pa/m. Tilting by an angle makes the weight
    act sideways too, by its tangent k: the load is k times the weight of all blocks. The tilt
    happens about y, so that the stack slides or falls towards +x.
    """
    x, y = width / 2, depth / 2
    mass = density * width * depth * height
    ground = Cuboid("ground", (-x, -y, -height), (x, y, 0.0), mass, fixed=True)
    pieces = (
        ground,
        *(
            Cuboid(f"block{i + 1}", (-x, -y, i * height), (x, y, (i + 1) * height), mass)
            for i in range(blocks)
        ),
    )
    dry = FaceMaterial(stiffness, stiffness, friction, cohesion=0.0, tensile_strength=0.0)
    pairs = pairwise(range(blocks + 1))
    faces = tuple(shared_face(f"bed{k}", Kind.DRY, dry, pieces, (i, k)) for i, k in pairs)
    weight = self_weight(pieces)
    weight[0] = 0.0  # the ground carries itself
    variable = np.zeros_like(weight)
    variable[1:, 0] = 1.0 / blocks
    total = -float(weight[:, 2].sum())
    return Assembly(pieces, faces, contact_nodes(faces, mesh, NodeLayout.CENTRES), width), Loads(
        weight, variable, total
    )
