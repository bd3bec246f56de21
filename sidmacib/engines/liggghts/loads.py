"""Loads on pieces as LIGGGHTS takes them: accelerations of all, and forces on their handles."""

import math

from ..scripts.assembly import GivenAssembly, GivenPiece, Vector, length, plus


def common_gravity(assembly: GivenAssembly) -> float:
    """The acceleration (m/s2) along -z that all free pieces have, whatever else acts; or else 0."""
    accelerations = [
        -p.force_N[2] / p.mass_kg for p in (assembly.pieces[index] for index in assembly.free)
    ]
    least = max(0.0, min(accelerations))
    return accelerations[0] if math.isclose(accelerations[0], least, rel_tol=1e-12) else least


def common_acceleration(assembly: GivenAssembly) -> Vector:
    """The acceleration (m/s2 per newton of load) of all free pieces; empty if it differs."""
    each = {
        part.piece: [value / assembly.pieces[part.piece].mass_kg for value in part.force]
        for part in assembly.loads
    }
    if set(each) != set(assembly.free) or any(any(part.moment_m) for part in assembly.loads):
        return ()
    shared = each[assembly.free[0]]
    apart = max(length(plus(one, shared, -1.0)) for one in each.values())
    return () if apart > 1e-12 * length(shared) else shared


def beyond_gravity(piece: GivenPiece, gravity: float) -> Vector:
    """Permanent force (N) on a piece besides its weight under ``gravity`` (m/s2)."""
    x, y, z = piece.force_N
    alike = math.isclose(-z, gravity * piece.mass_kg, rel_tol=1e-12)
    return x, y, 0.0 if alike else z + gravity * piece.mass_kg


def handle_forces(force: Vector, moment: Vector, distance: float) -> list[list[float]]:
    """Forces on a piece's six handles (+x, -x, +y, -y, +z, -z) that add up to force and moment.

    The force is shared by the two handles on x; each component of the moment is a couple.
    """
    (fx, fy, fz), (mx, my, mz) = force, [value / (2 * distance) for value in moment]
    return [
        [fx / 2, fy / 2 + mz, fz / 2],
        [fx / 2, fy / 2 - mz, fz / 2],
        [0.0, 0.0, mx],
        [0.0, 0.0, -mx],
        [my, 0.0, 0.0],
        [-my, 0.0, 0.0],
    ]
