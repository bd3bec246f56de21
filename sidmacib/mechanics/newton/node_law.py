"""The contact law of a node: its force, and the derivatives of that."""

# mypy: allow-untyped-defs

import numpy as np

from sidmacib.mechanics.newton.compilation import compiled


@compiled
def node_force(normal, shear, friction, given, whole, d0, d1, d2):
    """Force (N) of a node at displacement d less its slip (m): return mapping to the friction cone.

    ``normal``, ``shear``: stiffness in N/m; ``whole``: the fraction of it that the bond still has,
    0 without a bond. Under compression a bond has its full stiffness. ``given``: friction limit in
    N, added to that of the normal force.
    """
    pressed, pulled = (d0, 0.0) if d0 > 0.0 else (0.0, d0)
    square, cone = shear * shear * (d1 * d1 + d2 * d2), friction * normal * pressed + given
    share = shear if square <= cone * cone else shear * (cone / np.sqrt(square))
    share = whole * shear if whole > 0.0 else share
    return normal * (pressed + whole * pulled), share * d1, share * d2


@compiled
def node_tangent(normal, shear, friction, given, whole, d0, d1, d2):
    """Derivatives (N/m) of `node_force`.

    In this order: of the normal force by d0, of the shear forces (1, 2) by d0, of 1 by d1, of 1 by
    d2 (the same as of 2 by d1), of 2 by d2.
    """
    closed, bonded, square = d0 > 0.0, whole > 0.0, d1 * d1 + d2 * d2
    cone = friction * normal * (d0 if closed else 0.0) + given
    rigid = bonded or ((closed or given > 0.0) and shear * shear * square <= cone * cone)
    over = 0.0 if rigid or square == 0.0 else 1.0 / np.sqrt(square)
    x, y, across = over * d1, over * d2, 0.0 if rigid else over * cone  # which may be infinite
    along = (whole * shear if bonded else shear) if rigid else 0.0
    rise = friction * normal if closed else 0.0
    held = normal if closed else whole * normal
    return (
        *(held, rise * x, rise * y),
        *(along + across * y * y, -across * x * y, along + across * x * x),
    )


@compiled
def forces_and_tangents(stiffness, friction, whole, displacement):
    """Forces (N), (N, 3), and tangents (N/m), (N, 3, 3), of nodes at ``displacement`` (m), (N, 3).

    ``stiffness``: normal and shear (N/m), (N, 2). Displacements are less the slip.
    """
    count = len(friction)
    force, tangent = np.empty((count, 3)), np.zeros((count, 3, 3))
    for n in range(count):
        normal, shear = stiffness[n]
        d0, d1, d2 = displacement[n]
        contact_law = normal, shear, friction[n], 0.0, whole[n], d0, d1, d2
        force[n, 0], force[n, 1], force[n, 2] = node_force(*contact_law)
        t = tangent[n]
        t[0, 0], t[1, 0], t[2, 0], t[1, 1], t[1, 2], t[2, 2] = node_tangent(*contact_law)
        t[2, 1] = t[1, 2]
    return force, tangent
