"""SiDMACIB in closed form, for two contact points on every lock, as far from its centre.

With points at +-d on every lock, of half its strength each, forces across the locks reach every
(V, M_s) with

    |V| + |M_s| / d <= C,

C being the sum of the strengths. The normal forces add up to N. They balance the moment of V, so
that N acts further across the joint than the permanent loads do, at a place y_N. It must lie
between the centrelines y_1 and y_n of the first lock and the last. Friction along the locks adds a
torque where it acts one way in front and the other way behind. With half of N at either of two
places whose mean is y_N, as far apart as the centrelines allow,

    |M_f| <= mu N min(y_n - y_N, y_N - y_1).

The torque is M_s + M_f. As every bound is linear in the load along a direction, the largest load is
the least of a few quotients. `sidmacib.contact_points.programme.capacities` solves a linear
programme for the same load, with any contact points.
"""

from collections.abc import Sequence

import numpy as np

from sidmacib.contact_points.options import ContactOption
from sidmacib.contact_points.programme import (
    Sidmacib,
    block_above,
    friction_along,
    pressing_lever,
)
from sidmacib.joint.joint import Direction
from sidmacib.mechanics.assembly import Floats
from sidmacib.validation import refused


def pair_loads(model: Sidmacib, directions: Sequence[Direction]) -> Floats:
    """The largest load (N) of ``model`` in each of ``directions``, (D,).

    ValueError unless its points are a `ContactOption.pair`.
    """
    joint, positions = model.joint, model.option.positions
    distance = abs(positions[-1])
    if model.option not in (ContactOption.pair(distance), ContactOption.pair(-distance)):
        raise refused("option", model.option, "a pair of contact points")
    factors = model.strength or (1.0,) * joint.locks
    strength = float(np.dot(factors, joint.strengths))
    weight, centroid = block_above(joint)
    normal = weight + model.pressing_force
    arm = float(centroid[2]) - joint.h / 2
    # Moments (N m) of the permanent loads about the two outer centrelines.
    moment = normal * float(centroid[1]) + pressing_lever(joint, centroid) * model.pressing_force
    behind = moment - normal * joint.lock_centre_y(1)
    before = normal * joint.lock_centre_y(joint.locks) - moment

    # V and M per newton of load; every bound is: load * slope <= most.
    shear = np.array([direction.shear for direction in directions])
    torque = np.abs([direction.torque * joint.a for direction in directions])
    distance, friction = distance * joint.a, friction_along(model)
    twist = torque + distance * shear
    slopes = [shear, arm * shear, twist + friction * arm * shear, twist - friction * arm * shear]
    most = [
        strength,
        before,
        distance * strength + friction * before,
        distance * strength + friction * behind,
    ]
    loads = [
        np.divide(each, slope, out=np.full_like(slope, np.inf), where=slope > 0.0)
        for each, slope in zip(most, slopes, strict=True)
    ]
    return np.asarray(np.min(loads, axis=0))
