"""Whether contact spheres still stand for flat faces.

Two spheres of radius R stand for a node. Where one piece slips by s along the face, their centres
move apart by s^2 / (4 R); where it turns by t against the face, they approach by R t^2 / 4. Flat
faces do neither. Times the node's stiffness that is a spurious force. Measured on joints with
stiffnesses from 1e8 to 1e10 Pa/m and radii from 2 a to 200 a, peaks were off by at most 0.16 of the
sum of these forces over the load, and by less than 0.5 % where that sum was less than 0.1.

Spheres also roll off each other: a force N across a contact pushes two pieces that have slipped by
s further apart, by N s / (2 R). Pieces that nothing holds in one direction drift off in it, where
flat faces would leave them alone. So a mechanism counts only if flatter spheres show it as well.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from .assembly import Assembly, Vector, cross, dot, length, plus
from .records import MECHANISM, NodeForce, Outcome, Peak

LARGEST_SHARE = 0.1  # of spurious forces in the load
FLATTER = 100.0  # times the radius, to see a mechanism again


@dataclass(frozen=True)
class Motion:
    """Displacement (m) of a piece's centroid, and its rotation as a vector (rad)."""

    displacement: Vector
    rotation: Vector


STILL = Motion((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


def check_flat(
    assembly: Assembly,
    motions: Sequence[Motion],
    radii: Sequence[float],
    forces: Sequence[NodeForce],
    load: float,
) -> None:
    """End with a reason where contact spheres do not stand for flat faces at a ``load`` (N).

    ``motions``: of each piece; ``radii``: of each face's spheres, in m; ``forces``: of each node.
    """
    share = spurious_force(assembly, motions, radii, forces) / max(load, assembly.permanent_N)
    if share > LARGEST_SHARE:
        raise SystemExit(
            f"no peak: at {load:g} N the pieces have moved further than contact spheres can follow:"
            f" spurious forces are {share:.2g} of the load, and may be {LARGEST_SHARE:g}"
        )


def spurious_force(
    assembly: Assembly,
    motions: Sequence[Motion],
    radii: Sequence[float],
    forces: Sequence[NodeForce],
) -> float:
    """Sum over all nodes in contact of the force (N) that comes of the spheres' roundness."""
    total = 0.0
    for node, force in zip(assembly.nodes, forces, strict=True):
        if not (force.bonded or force.normal > 0):
            continue
        face, radius = assembly.faces[node.face], radii[node.face]
        above, below = (
            plus(
                motions[piece].displacement,
                cross(motions[piece].rotation, plus(node.position_m, centre, -1.0)),
            )
            for piece, centre in (
                (index, assembly.pieces[index].centre_m) for index in (face.above, face.below)
            )
        )
        slip = across(plus(above, below, -1.0), face.normal)
        turn = across(
            plus(motions[face.above].rotation, motions[face.below].rotation, -1.0), face.normal
        )
        gap = slip**2 / (4 * radius) - radius * turn**2 / 4
        total += abs(gap) * face.material.normal_stiffness * node.area_m2
    return total


def across(vector: Vector, normal: Vector) -> float:
    """Length of what a vector has across a unit normal."""
    return length(plus(vector, normal, -dot(vector, normal)))


def check_mechanism(peak: Peak, flatter: Outcome) -> None:
    """End with a reason where a mechanism is none on flatter spheres, at the same loads."""
    if peak.mode == MECHANISM and flatter is Outcome.EQUILIBRIUM:
        raise SystemExit(
            f"no peak: at {peak.failed_load:g} N the pieces drift off their contact spheres and no "
            f"bond breaks, but on spheres of {FLATTER:g} times the radius they come to rest"
        )
