"""The contact law of nodes, compiled: force, tangent, slip and utilisation.

The equations are in `sidmacib.mechanics.contact_law`. ``law``: rows `NORMAL` and `SHEAR`
(stiffness, N/m), `FRICTION` (coefficient) and `GIVEN`, a friction limit in N that does not depend
on the normal force, not even at an open node; if there is no other friction, the energy of the
nodes is convex.

No node's result is used for another's, and a row of an array has one component of all nodes. So a
processor computes several nodes at a time, with the same digits as one by one.
"""

# mypy: allow-untyped-defs

import numpy as np

from sidmacib.mechanics.assembly import Floats
from sidmacib.mechanics.compilation import compiled
from sidmacib.mechanics.contact_law import ContactLaw, NodeState, components

NORMAL, SHEAR, FRICTION, GIVEN = range(4)
ROUNDING = 1e-9  # of the largest node force; equilibria are ten times more accurate


@compiled
def node_force(normal, shear, friction, given, whole, d0, d1, d2):
    """Force (N) of a node at displacement d less its slip (m): return mapping to the friction cone.

    ``whole``: the fraction of its stiffness that the bond still has, 0 without a bond. Under
    compression a bond has its full stiffness.
    """
    pressed, pulled = (d0, 0.0) if d0 > 0.0 else (0.0, d0)
    square, cone = shear * shear * (d1 * d1 + d2 * d2), friction * normal * pressed + given
    share = slid_share(shear, square, cone)
    share = whole * shear if whole > 0.0 else share
    return normal * (pressed + whole * pulled), share * d1, share * d2


@compiled
def slid_share(shear, square, cone):
    """Shear force over displacement (N/m) of a dry node, whose friction limit is ``cone`` (N).

    ``square``: of the force (N2) if it stuck.
    """
    return shear if square <= cone * cone else shear * (cone / np.sqrt(square))


@compiled
def slid_tangent(shear, friction, cone, d1, d2):
    """Derivatives of the shear forces of a dry node, displaced by d from its slip (m).

    Of both by the normal force (1), then by d (N/m): of the first, of it by d2, of the second.
    """
    square = d1 * d1 + d2 * d2
    if shear * shear * square <= cone * cone:
        return 0.0, 0.0, shear, 0.0, shear
    over = 1.0 / np.sqrt(square)
    x, y, across = over * d1, over * d2, over * cone
    return friction * x, friction * y, across * y * y, -across * x * y, across * x * x


@compiled
def node_tangent(normal, shear, friction, given, whole, d0, d1, d2):
    """Derivatives (N/m) of `node_force`.

    In this order: of the normal force by d0, of the shear forces (1, 2) by d0, of 1 by d1, of 1 by
    d2 (the same as of 2 by d1), of 2 by d2.
    """
    closed, bonded, square = d0 >= 0.0, whole > 0.0, d1 * d1 + d2 * d2  # closed as built
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
def all_bonded(count):
    """Slip (m), (2, N), and fractions of bonds left, (N,), of ``count`` nodes with whole bonds."""
    return np.zeros((2, count)), np.ones(count)


@compiled
def put_forces(law, slip, whole, moved, force):
    """Fill in the forces (N) of all nodes where they have ``moved`` (m); both (3, N)."""
    normal, shear, friction, given = law[NORMAL], law[SHEAR], law[FRICTION], law[GIVEN]
    slip_1, slip_2 = slip[0], slip[1]
    d0, d1, d2 = moved[0], moved[1], moved[2]
    f0, f1, f2 = force[0], force[1], force[2]
    for n in range(len(whole)):
        node = normal[n], shear[n], friction[n], given[n], whole[n]
        f0[n], f1[n], f2[n] = node_force(*node, d0[n], d1[n] - slip_1[n], d2[n] - slip_2[n])


@compiled
def put_tangents(law, first, last, slip, whole, moved, tangent):
    """Fill in the derivatives of nodes' forces (N/m) from the first column of ``tangent`` on.

    Of the nodes from ``first`` to before ``last``, in the order of `node_tangent`.
    """
    here = slice(first, last)
    normal, shear, friction = law[NORMAL, here], law[SHEAR, here], law[FRICTION, here]
    given, whole = law[GIVEN, here], whole[here]
    slip_1, slip_2 = slip[0, here], slip[1, here]
    d0, d1, d2 = moved[0, here], moved[1, here], moved[2, here]
    t00, t10, t20 = tangent[0], tangent[1], tangent[2]
    t11, t12, t22 = tangent[3], tangent[4], tangent[5]
    for n in range(len(whole)):
        node = normal[n], shear[n], friction[n], given[n], whole[n]
        t00[n], t10[n], t20[n], t11[n], t12[n], t22[n] = node_tangent(
            *node, d0[n], d1[n] - slip_1[n], d2[n] - slip_2[n]
        )


@compiled
def put_slip(law, slip, whole, moved, force, after):
    """Fill in the slip (m) of all nodes where they have ``moved``, from that before; (2, N).

    ``force``: of the nodes there, (3, N) in N.
    """
    shear, old_1, old_2 = law[SHEAR], slip[0], slip[1]
    d1, d2, f1, f2 = moved[1], moved[2], force[1], force[2]
    new_1, new_2 = after[0], after[1]
    for n in range(len(whole)):
        slid_1, slid_2 = d1[n] - f1[n] / shear[n], d2[n] - f2[n] / shear[n]
        new_1[n] = old_1[n] if whole[n] > 0.0 else slid_1
        new_2[n] = old_2[n] if whole[n] > 0.0 else slid_2


@compiled
def forces_and_tangents(law, slip, whole, moved):
    """Forces (N), (N, 3), and tangents (N/m), (N, 3, 3), of nodes that have ``moved`` (m), (N, 3).

    ``slip``: in m, (N, 2).
    """
    count = len(whole)
    force, tangent = np.empty((count, 3)), np.zeros((count, 3, 3))
    for n in range(count):
        place = moved[n, 0], moved[n, 1] - slip[n, 0], moved[n, 2] - slip[n, 1]
        node = law[NORMAL, n], law[SHEAR, n], law[FRICTION, n], law[GIVEN, n], whole[n], *place
        force[n, 0], force[n, 1], force[n, 2] = node_force(*node)
        t = tangent[n]
        t[0, 0], t[1, 0], t[2, 0], t[1, 1], t[1, 2], t[2, 2] = node_tangent(*node)
        t[2, 1] = t[1, 2]
    return force, tangent


def utilisation(contact_law: ContactLaw, state: NodeState, force: Floats) -> Floats:
    """Shear or tension over strength at each bonded node, whichever is larger; 0 at others, (N,).

    ``force``: in N, (N, 3). Where the bond has friction, the shear counts that this leaves to the
    cohesion. At a node without strength the result is infinite for any force above the rounding
    error of the largest force.
    """
    strengths = contact_law.shear_strength, contact_law.tensile_strength
    bonds = *strengths, contact_law.bond_friction, state.whole
    return np.asarray(_utilisation(*bonds, components(force), ROUNDING))


@compiled
def _utilisation(shear_strength, tensile_strength, friction, whole, force, rounding):
    """Implement `utilisation`; ``rounding``: of the largest force. ``force``: (3, N)."""
    without = 0
    for n in range(len(whole)):
        without += (shear_strength[n] <= 0.0) | (tensile_strength[n] <= 0.0)
    noise = rounding * np.abs(force).max() if without else 0.0
    used, normal, along, across = np.empty_like(whole), force[0], force[1], force[2]
    for n in range(len(whole)):
        shear = np.sqrt(along[n] * along[n] + across[n] * across[n]) - friction[n] * normal[n]
        by_shear = over(shear, shear_strength[n], noise)
        by_tension = over(-normal[n], tensile_strength[n], noise)
        most = by_shear if by_shear > by_tension else by_tension
        used[n] = most if whole[n] > 0.0 and most > 0.0 else 0.0
    return used


@compiled
def over(part, strength, noise):
    """A ``part`` of a node's force over its strength; without strength infinite above ``noise``."""
    without = np.inf if part > noise else 0.0
    return part / strength if strength > 0.0 else without
