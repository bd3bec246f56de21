"""Decks for 3DEC, the commercial program of the paper, and the reader of its output.

3DEC is not run here: users with a licence run the decks, each of which writes results.txt into its
folder. docs/maintain/threedec.md lists what the decks assume of 3DEC; they have never been run.
"""

import math
import re
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np

from sidmacib.engines.render import ENVIRONMENT
from sidmacib.engines.results import stress_to_force
from sidmacib.errors import ResultError
from sidmacib.mechanics.assembly import (
    GRAVITY,
    Assembly,
    Cuboid,
    FaceMaterial,
    Failure,
    Floats,
    Kind,
    Nodes,
    Vector,
)
from sidmacib.mechanics.equilibrium import face_frames, self_weight
from sidmacib.mechanics.loads import Loads
from sidmacib.problem import Outcome, Problem, State
from workflow.case import REFERENCE, JointCase
from workflow.results import record_of, record_without_result
from workflow.schema import Study
from workflow.step import Arguments, FileLists, Files, step

MODEL = "3dec"
TEMPLATE, DECK, PRINTED = "3dec.dat.j2", "joint.dat", "results.txt"
INCREMENT = 0.0025  # -, of the load, over the strength of the lower locks
ROUNDS = 4000  # at most: ten times the strength of the lower locks
TAGGED = re.compile(r"^\s*MULTILOCK\|(CASE|LOAD|NODE|END)\b\|?(.*?)\s*$", re.MULTILINE)
RATIO, CYCLES = 1e-5, 200_000  # local unbalanced force ratio at rest, cycles to wait for it


def decks(study: Study, cases: Iterable[JointCase]) -> dict[str, JointCase]:
    """Those of ``cases`` that decks are written for, by name: brittle, of the reference variant."""
    return {
        case.name: replace(case, model=MODEL, numerics=None)
        for case in cases
        if case.variant == REFERENCE
        and case.subject.joint.failure is Failure.BRITTLE
        and case.subject.mesh in study.meshes
    }


def fingerprint(case: JointCase) -> str:
    """Name of a case with a digest of its joint, nodes and loads."""
    return f"{case.name}-{case.physics()[:12]}"


def deck_folder(name: str) -> str:
    """The folder of a case's deck and of 3DEC's output, below the results folder."""
    return f"decks/{MODEL}/{name}"


def deck(case: JointCase) -> str:
    """3DEC's commands for ``case``: pieces, faces, loads."""
    joint, (assembly, loads) = case.subject.joint, case.subject.problem()
    faces = [
        {
            "below": assembly.cuboids[face.below].name,
            "above": assembly.cuboids[face.above].name,
            **_law(face.material),
        }
        for face in assembly.faces
    ]
    lower = math.fsum(map(joint.strength, joint.lower_locks))
    increment = INCREMENT * (lower or loads.scale)  # one upper lock alone has no lower ones
    return ENVIRONMENT.get_template(TEMPLATE).render(
        title=f"{case.name}: {joint.locks} locks, mesh {case.subject.mesh:g} m.",
        case=fingerprint(case),
        pieces=assembly.cuboids,
        faces=faces,
        dry=_law(joint.material_of(Kind.DRY)),
        mesh=case.subject.mesh,
        density=joint.density,
        elastic=joint.elastic,
        gravity=GRAVITY,
        increment=increment,
        rounds=ROUNDS,
        heavier={
            piece.name: density
            for piece in assembly.cuboids
            for density in [piece.mass / math.prod(piece.size.tolist())]
            if not math.isclose(density, joint.density)
        },
        pressed=_pressed(assembly, loads),
        corners=_corners(assembly, loads, increment),
        ratio=RATIO,
        cycles=CYCLES,
    )


def _pressed(assembly: Assembly, loads: Loads) -> list[dict[str, Any]]:
    """Permanent loads besides self-weight: forces (N) on the corners of the pieces' tops.

    Each is a quarter of the force on the piece, whose resultant is in the middle.
    """
    given = loads.permanent - self_weight(assembly.cuboids)
    return [
        _corner(piece, (x, y, piece.high[2]), load[:3] / 4)
        for piece, load in zip(assembly.cuboids, given, strict=True)
        if load.any()
        for x in (piece.low[0], piece.high[0])
        for y in (piece.low[1], piece.high[1])
    ]


def _corner(piece: Cuboid, place: Vector, force: Floats) -> dict[str, Any]:
    radius = 1e-6 + 0.01 * float(min(piece.size))
    return {"piece": piece.name, "place": place, "force": force.tolist(), "radius": radius}


def _law(material: FaceMaterial) -> dict[str, Any]:
    bonded = material.cohesion > 0.0 or material.tensile_strength > 0.0
    friction = material.friction_in_bonds if bonded else material.friction
    found = {"law": material, "friction_degrees": math.degrees(math.atan(friction))}
    if friction != material.friction:
        found["friction_after_degrees"] = math.degrees(math.atan(material.friction))
    return found


def _corners(assembly: Assembly, loads: Loads, increment: float) -> list[dict[str, Any]]:
    """Forces (N) on the corners of the loaded faces, of the same resultant as ``loads``.

    At the corner x, each piece's force over four, plus or minus its torque over 2 a.
    """
    found = []
    for piece, load in zip(assembly.cuboids, loads.variable, strict=True):
        if not load.any():
            continue
        y = piece.low[1] if load[1] >= 0.0 else piece.high[1]
        for x, sign in ((piece.low[0], -1.0), (piece.high[0], 1.0)):
            share = load[:3] / 4
            share[1] += sign * load[5] / (2 * piece.size[0])
            ends = piece.low[2], piece.high[2]
            found += [_corner(piece, (x, y, z), increment * share) for z in ends]
    return found


def read_returned(text: str, case: JointCase) -> tuple[Problem, Outcome]:
    """The problem of ``case`` on the nodes of 3DEC, and the outcome that it printed.

    Normal forces are taken as positive in compression, shear as acting on the piece above. Raises
    `ResultError` if the text is incomplete, or is not of ``case`` as it is now.
    """
    problem = case.subject.problem()
    assembly = problem.assembly
    numbers = {
        frozenset((assembly.cuboids[face.below].name, assembly.cuboids[face.above].name)): number
        for number, face in enumerate(assembly.faces)
    }
    lines: dict[str, list[list[str]]] = {"CASE": [], "LOAD": [], "NODE": [], "END": []}
    for kind, values in TAGGED.findall(text):
        lines[kind].append(values.split("|"))
    if not all(lines.values()):
        raise ResultError(f"{PRINTED}: incomplete; run the deck again")
    if lines["CASE"][-1] != [fingerprint(case)]:
        of = "|".join(lines["CASE"][-1])
        raise ResultError(
            f"{PRINTED}: results of {of}; they must be results of {fingerprint(case)}"
        )
    nodes = [(numbers.get(frozenset(each[:2])), each[2:]) for each in lines["NODE"]]
    try:
        load, failed = map(float, lines["LOAD"][-1])
        rows = [(face, *map(float, values)) for face, values in nodes if face is not None]
        table = np.array(rows).reshape(-1, 10)
    except ValueError as error:
        raise ResultError(f"{PRINTED}: not the numbers of loads and nodes: {error}") from None
    table = table[table[:, 4] > 0.0]  # else no part of the face belongs to the node
    table = table[np.argsort(table[:, 0], kind="stable")]
    face, values = table[:, 0].astype(int), table[:, 1:]
    covered = np.bincount(face, weights=values[:, 3], minlength=len(assembly.faces))
    for covered_face, area in zip(assembly.faces, covered, strict=True):
        if not math.isclose(area, covered_face.area, rel_tol=0.01):
            raise ResultError(
                f"{PRINTED}: {area:g} m2 of subcontacts on {covered_face.name}; they must "
                "cover all of its "
                f"{covered_face.area:g} m2"
            )
    assembly = replace(assembly, nodes=Nodes(face, values[:, :3], values[:, 3]))
    stress = values[:, 4:8] / values[:, 3:4]
    force = stress_to_force(assembly.nodes, face_frames(assembly), stress)
    state = State(load, None, force, np.ones(len(force), dtype=bool))
    return problem._replace(assembly=assembly), Outcome((state,), failed, peak_load=load)


def write_decks(arguments: Arguments, inputs: Files, outputs: FileLists) -> None:
    """Write the deck of each case."""
    for data, path in zip(arguments["cases"], outputs["decks"], strict=True):
        path.write_text(deck(JointCase.from_json(data)))


def write_returned(arguments: Arguments, inputs: Files, outputs: Files) -> str | None:
    """Write the record; returns the error message, or None."""
    case = JointCase.from_json(arguments["case"])
    try:
        problem, found = read_returned(inputs["printed"].read_text(errors="replace"), case)
        record = record_of(case, problem, found, {})
    except (OSError, ResultError) as error:
        record = record_without_result(case, error=f"{case.model}: {error}")
    outputs["record"].write_text(record.to_json() + "\n")
    return None if record.error is None else f"{case.name}: {record.error}"


if __name__ == "__main__":
    step(write_decks, returned=write_returned)
