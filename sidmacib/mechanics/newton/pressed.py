"""Pressure on the pressed parts of faces with triangles, and the friction that it brings.

Sides of rigid pieces are plane, so that the gap between them is linear over a face and the pressed
part of a triangle is a polygon: force and moments of the pressure are integrated exactly, whatever
the size of the triangles, and edges give way as they are pressed.
"""

# mypy: allow-untyped-defs

import numpy as np

from sidmacib.mechanics.compilation import compiled
from sidmacib.mechanics.contact_law.kernels import (
    FRICTION,
    NORMAL,
    SHEAR,
    slid_share,
    slid_tangent,
)
from sidmacib.mechanics.newton.vectors import cross, dot, put


@compiled
def put_pressed(contacts, face, here):
    """Integrate over the pressed parts of a face's triangles; fill in ``here.pressed``.

    The gap of two plane sides is linear, g = g_0 + p g_p + q g_q, so that the pressed part of a
    triangle is a polygon. The force at a node is the integral of the pressure k g over it, times
    the node's hat function; resultant and moments are exact, whatever the size of the triangles.
    ``here.pressed``: integrals of k, k p and k q times that function, by which g_0, g_p and g_q
    give the force and its derivatives; and the derivatives of the first by these three, from the
    edge of the pressed part. What is not pressed does not resist shear either.
    """
    for node in range(contacts.start[face], contacts.start[face + 1]):
        for row in range(6):
            here.pressed[row, node] = 0.0
    share, p, q = np.empty(3), contacts.places[0], contacts.places[1]
    steep = dot(here.apart[face, 1], here.frame[face, 0]) ** 2
    steep = np.sqrt(steep + dot(here.apart[face, 2], here.frame[face, 0]) ** 2)
    for number in range(contacts.first_triangle[face], contacts.first_triangle[face + 1]):
        nodes, size = contacts.triangles[number], contacts.stiffness[number]
        gap, positive = here.moved[0], 0
        for node in nodes:
            positive += gap[node] > 0.0
        if positive == 0:
            continue
        if positive >= 2:
            for k in range(3):
                share[k] = 1.0
            add_part(here.pressed, nodes, p, q, size, nodes[0], share)
        if positive == 3:
            continue
        # What lies around the corner that differs from the other two: pressed alone, or open.
        odd = 0
        while (gap[nodes[odd]] > 0.0) == (positive == 2):
            odd += 1
        corner, part = nodes[odd], size
        for k in range(3):
            share[k] = 1.0
            if k != odd:
                share[k] = gap[corner] / (gap[corner] - gap[nodes[k]])
                part *= share[k]
        add_part(here.pressed, nodes, p, q, part if positive == 1 else -part, corner, share)
        add_edge(here.pressed, nodes, p, q, size / steep, odd, share)


@compiled
def add_part(pressed, nodes, p, q, size, corner, share):
    """Add the integrals over a part of the triangle of ``nodes``, of that ``size`` (N/m).

    The part has the corner of the triangle, and on the sides from there corners at their ``share``
    of the way to the others. The product of two linear functions on a triangle of area A has the
    integral A / 12 times the sum of products at its corners plus the product of their sums.
    """
    x = y = 0.0
    for k in range(3):
        x += p[corner] + share[k] * (p[nodes[k]] - p[corner])
        y += q[corner] + share[k] * (q[nodes[k]] - q[corner])
    part = size / 12.0
    others = 0.0
    for k in range(3):
        node = nodes[k]
        if node == corner:
            continue
        others += share[k]
        here_p = p[corner] + share[k] * (p[node] - p[corner])
        here_q = q[corner] + share[k] * (q[node] - q[corner])
        pressed[0, node] += part * share[k] * 4.0
        pressed[1, node] += part * share[k] * (here_p + x)
        pressed[2, node] += part * share[k] * (here_q + y)
        pressed[1, corner] += part * (1.0 - share[k]) * here_p
        pressed[2, corner] += part * (1.0 - share[k]) * here_q
    pressed[0, corner] += part * (12.0 - 4.0 * others)
    pressed[1, corner] += part * (p[corner] + (3.0 - others) * x)
    pressed[2, corner] += part * (q[corner] + (3.0 - others) * y)


@compiled
def add_edge(pressed, nodes, p, q, size, odd, share):
    """Add the integrals over the edge of a part of a triangle, which cuts off its ``odd`` corner.

    ``size``: stiffness of the triangle over the slope of the gap (N).
    """
    corner, one, two = nodes[odd], nodes[(odd + 1) % 3], nodes[(odd + 2) % 3]
    a, b = share[(odd + 1) % 3], share[(odd + 2) % 3]
    one_p, one_q = p[one] - p[corner], q[one] - q[corner]
    two_p, two_q = p[two] - p[corner], q[two] - q[corner]
    double = abs(one_p * two_q - one_q * two_p)  # of the triangle's area
    length = np.sqrt((a * one_p - b * two_p) ** 2 + (a * one_q - b * two_q) ** 2)
    # The ends of the edge, and the products of linear functions at them: l / 6 (2 f g + f g' ...).
    part = size / (double / 2.0) * length / 6.0
    first = 1.0, p[corner] + a * one_p, q[corner] + a * one_q
    second = 1.0, p[corner] + b * two_p, q[corner] + b * two_q
    for row in range(3):
        by_first = part * (2.0 * first[row] + second[row])
        by_second = part * (2.0 * second[row] + first[row])
        pressed[3 + row, corner] += (1.0 - a) * by_first + (1.0 - b) * by_second
        pressed[3 + row, one] += a * by_first
        pressed[3 + row, two] += b * by_second


@compiled
def resists(law, pressed, node):
    """Shear stiffness (N/m) of the pressed parts around a ``node``."""
    return law[SHEAR, node] / law[NORMAL, node] * pressed[0, node]


@compiled
def put_pressed_forces(contacts, face, slip, here):
    """Fill in the forces (N) of the nodes of a face with triangles."""
    frame, apart, law = here.frame[face], here.apart[face], contacts.law
    gap, by_p, by_q = dot(apart[0], frame[0]), dot(apart[1], frame[0]), dot(apart[2], frame[0])
    for node in range(contacts.start[face], contacts.start[face + 1]):
        normal = gap * here.pressed[0, node] + by_p * here.pressed[1, node]
        normal = max(normal + by_q * here.pressed[2, node], 0.0)
        cone = law[FRICTION, node] * normal
        d1, d2 = here.moved[1, node] - slip[0, node], here.moved[2, node] - slip[1, node]
        shear = resists(law, here.pressed, node)
        share = slid_share(shear, shear * shear * (d1 * d1 + d2 * d2), cone)
        here.force[0, node] = normal
        here.force[1, node], here.force[2, node] = share * d1, share * d2


@compiled
def pressed_stiffness(contacts, face, slip, here, rise, k):
    """`face_stiffness` of a face with triangles; ``rise``: see `tangent_stiffness`."""
    k[:] = 0.0
    law, along, rows = contacts.law, here.along[face], np.zeros((3, 6))
    for node in range(contacts.start[face], contacts.start[face + 1]):
        by_gap, by_p, by_q = here.pressed[0, node], here.pressed[1, node], here.pressed[2, node]
        if by_gap <= 0.0:
            continue
        friction = law[FRICTION, node]
        cone = friction * here.force[0, node]
        d1, d2 = here.moved[1, node] - slip[0, node], here.moved[2, node] - slip[1, node]
        shear = resists(law, here.pressed, node)
        rise_1, rise_2, t11, t12, t22 = slid_tangent(shear, friction, cone, d1, d2)
        grow_1 = grow_2 = 0.0
        if shear * shear * (d1 * d1 + d2 * d2) <= cone * cone:
            over = law[SHEAR, node] / law[NORMAL, node]
            grow_1, grow_2 = over * d1, over * d2
        rise_1, rise_2, grow_1, grow_2 = rise * rise_1, rise * rise_2, rise * grow_1, rise * grow_2
        x, y, z = place(along, contacts.places[0, node], contacts.places[1, node])
        _, by_z, by_y = place(along, by_p, by_q)
        put(rows[0], by_gap, 0.0, 0.0, 0.0, by_y, -by_z)
        edge = here.pressed[3, node]
        _, edge_z, edge_y = place(along, here.pressed[4, node], here.pressed[5, node])
        gap_1, gap_2 = rise_1 * by_gap + grow_1 * edge, rise_2 * by_gap + grow_2 * edge
        a, b = rise_1 * by_y + grow_1 * edge_y, -rise_1 * by_z - grow_1 * edge_z
        put(rows[1], gap_1, t11, t12, y * t12 - z * t11, a - x * t12, b + x * t11)
        a, b = rise_2 * by_y + grow_2 * edge_y, -rise_2 * by_z - grow_2 * edge_z
        put(rows[2], gap_2, t12, t22, y * t22 - z * t12, a - x * t22, b + x * t12)
        for column in range(6):
            a, b, c = cross((x, y, z), (rows[0, column], rows[1, column], rows[2, column]))
            k[0, column] += rows[0, column]
            k[1, column] += rows[1, column]
            k[2, column] += rows[2, column]
            k[3, column] += a
            k[4, column] += b
            k[5, column] += c


@compiled
def place(along, p, q):
    """The place in the frame of what is ``p`` and ``q`` along the tangents as built."""
    return (
        along[0, 0] * p + along[1, 0] * q,
        along[0, 1] * p + along[1, 1] * q,
        along[0, 2] * p + along[1, 2] * q,
    )
