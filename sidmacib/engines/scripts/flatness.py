"""Checks that contact spheres still represent flat faces.

Two spheres of radius R stand for a node. Where one piece slips by s along the face, their centres
move apart by s^2 / (4 R), which flat faces do not. Times the node's stiffness that is a spurious
force. Measured on joints with stiffnesses from 1e8 to 1e10 Pa/m and R = 2 a, peaks were off by 0.04
to 0.16 of the sum of these forces over the load, and by less than 0.5 % where it was less than 0.1.

Where a piece turns by t against the face, the point of contact moves by R t / 2, and with it the
lever of the force. With R = 20 a and 200 a, peaks were off by 0.06 of that over half the face.

Both get the better of flat faces in mechanisms. A force N across a contact pushes two pieces that
have slipped by s further apart, by N s / (2 R): pieces that nothing holds in one direction drift
off in it, where flat faces would leave them alone. So a mechanism counts only where flatter spheres
show it as well. There pieces that fall over find another equilibrium on round feet, but far away.
"""

from collections.abc import Sequence
from typing import NamedTuple

from .assembly import GivenAssembly, Vector, cross, dot, length, plus
from .records import EnginePeak, NoAnswerError, NodeForce

LARGEST_SHARE = 0.1  # of spurious forces in the load
LARGEST_SHIFT = 0.1  # of the point of contact, over the distance from a face's centre to its edge
FLATTER = 30.0  # times the radius, to see a mechanism again
MARGIN = 0.05  # more load than where it was seen first
FIRM = 2.0  # times the displacement before the last step, at most, of what stands firmly


class PieceMotion(NamedTuple):
    """Displacement (m) of a piece's centroid, and its rotation as a vector (rad)."""

    displacement: Vector
    rotation: Vector


STILL = PieceMotion((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


def check_flat(
    assembly: GivenAssembly,
    motions: Sequence[PieceMotion],
    radii: Sequence[float],
    forces: Sequence[NodeForce],
    load: float,
) -> None:
    """End with a reason if contact spheres do not represent flat faces at a ``load`` (N).

    ``motions``: of each piece; ``radii``: of each face's spheres, in m; ``forces``: of each node.
    """
    if reason := roundness(assembly, motions, radii, forces, load):
        raise NoAnswerError(
            f"no peak: at {load:g} N the pieces have moved further than contact spheres can follow:"
            f" {reason}"
        )


def roundness(
    assembly: GivenAssembly,
    motions: Sequence[PieceMotion],
    radii: Sequence[float],
    forces: Sequence[NodeForce],
    load: float,
) -> str | None:
    """Why spheres do not represent flat faces; None if they do. Arguments as for `check_flat`."""
    share = spurious_force(assembly, motions, radii, forces) / max(load, assembly.permanent_N)
    if share > LARGEST_SHARE:
        return f"spurious forces are {share:.2g} of the load; the limit is {LARGEST_SHARE:g}"
    shift = contact_shift(assembly, motions, radii, forces)
    if shift > LARGEST_SHIFT:
        return f"contacts move by {shift:.2g} of half a face; the limit is {LARGEST_SHIFT:g}"
    return None


def spurious_force(
    assembly: GivenAssembly,
    motions: Sequence[PieceMotion],
    radii: Sequence[float],
    forces: Sequence[NodeForce],
) -> float:
    """Sum over all nodes in contact of the force (N) that slip makes of the spheres' roundness."""
    total = 0.0
    for node, force in zip(assembly.nodes, forces, strict=True):
        if force.bonded or force.normal > 0:
            face = assembly.faces[node.face]
            above, below = (
                moved(node.position_m, assembly.pieces[piece].centre_m, motions[piece])
                for piece in (face.above, face.below)
            )
            gap = across(plus(above, below, -1.0), face.normal) ** 2 / (4 * radii[node.face])
            total += gap * face.material.normal_stiffness * node.area_m2
    return total


def contact_shift(
    assembly: GivenAssembly,
    motions: Sequence[PieceMotion],
    radii: Sequence[float],
    forces: Sequence[NodeForce],
) -> float:
    """Largest movement of a point of contact where a piece turns, over half its face's length."""
    numbers_of: list[list[int]] = [[] for _ in assembly.faces]
    for number, node in enumerate(assembly.nodes):
        numbers_of[node.face].append(number)
    largest = 0.0
    for face, radius, numbers in zip(assembly.faces, radii, numbers_of, strict=True):
        if any(forces[n].bonded or forces[n].normal > 0 for n in numbers):
            turn = plus(motions[face.above].rotation, motions[face.below].rotation, -1.0)
            shift = radius * across(turn, face.normal) / 2
            largest = max(largest, 2 * shift / max(face.size_m))
    return largest


def moved(position: Vector, centre: Vector, motion: PieceMotion) -> list[float]:
    """Displacement (m) of a point of a piece with this ``centre``."""
    return plus(motion.displacement, cross(motion.rotation, plus(position, centre, -1.0)))


def across(vector: Vector, normal: Vector) -> float:
    """Length of the component of a vector across a unit normal."""
    return length(plus(vector, normal, -dot(vector, normal)))


def check_mechanism(peak: EnginePeak, displacements: Sequence[float], steps: int) -> None:
    """End with a reason where flatter spheres stand firmly at `MARGIN` more than the peak.

    ``displacements`` (m): theirs at the equilibria of that many ``steps`` towards it, or of fewer
    where they come to no equilibrium.
    """
    if len(displacements) == steps and abs(displacements[-1]) <= FIRM * abs(displacements[-2]):
        raise NoAnswerError(
            f"no peak: at {peak.failed_load:g} N the pieces drift off their contact spheres and no "
            f"bond breaks, but on spheres of {FLATTER:g} times the radius they carry more"
        )
