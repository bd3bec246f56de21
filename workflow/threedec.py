"""Decks for 3DEC, the commercial program of the paper, and the reader of what it prints back.

3DEC is not run here: who has a licence runs the decks and leaves each one's results.txt beside it.
What the decks assume of 3DEC is in docs/models.md; it has not been tried.
"""

import argparse
import hashlib
import math
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pandas as pd

from sidmacib.loading import lateral_load
from sidmacib.mechanics.assembly import GRAVITY, Assembly, Failure, Loads
from sidmacib.pieces import assemble
from workflow.cases import REFERENCE, Case, case_folder, cases_of
from workflow.engines.render import ENVIRONMENT
from workflow.results import NODE_COLUMNS, write_results
from workflow.study import Study

MODEL = "3dec"
TEMPLATE, DECK, RETURNED = "3dec.dat.j2", "joint.dat", "results.txt"
INCREMENT = 0.0025  # -, of the load, over the strength of the lower locks
ROUNDS = 4000  # at most: ten times the strength of the lower locks
RATIO, CYCLES = 1e-5, 200_000  # local unbalanced force ratio at rest, cycles to wait for it


def decks(study: Study) -> dict[str, Case]:
    """The cases that decks are written for, by name: brittle ones of the reference variant."""
    own = {"model": MODEL, "numerics": None}
    return {
        case.name: case.model_copy(update=own)
        for case in cases_of(study).values()
        if case.variant == REFERENCE and case.joint.failure is Failure.BRITTLE
    }


def fingerprint(case: Case) -> str:
    """Name of a case with a digest of all that its results depend on."""
    told = case.model_dump_json(include={"joint", "mesh", "loading"})
    return f"{case.name}-{hashlib.sha256(told.encode()).hexdigest()[:12]}"


def deck_folder(results: str, name: str) -> str:
    """Where the deck of a case is, and where what 3DEC prints is looked for."""
    return f"{results}/decks/{MODEL}/{name}"


def deck(case: Case) -> str:
    """3DEC's commands for ``case``: pieces, faces, loads."""
    assembly = assemble(case.joint, case.mesh)
    faces = [
        {
            "below": assembly.pieces[face.below].name,
            "above": assembly.pieces[face.above].name,
            **_law(asdict(face.material)),
        }
        for face in assembly.faces
    ]
    increment = INCREMENT * case.joint.T0 * len(case.joint.lower_locks)
    return ENVIRONMENT.get_template(TEMPLATE).render(
        title=f"{case.name}: {case.joint.locks} locks, mesh {case.mesh:g} m.",
        case=fingerprint(case),
        pieces=assembly.pieces,
        faces=faces,
        dry=_law(asdict(case.joint.dry)),
        mesh=case.mesh,
        density=case.joint.density,
        gravity=GRAVITY,
        increment=increment,
        rounds=ROUNDS,
        corners=_corners(assembly, lateral_load(case.joint, assembly, case.loading), increment),
        ratio=RATIO,
        cycles=CYCLES,
    )


def _law(material: dict[str, float]) -> dict[str, Any]:
    return {"law": material, "friction_degrees": math.degrees(math.atan(material["friction"]))}


def _corners(assembly: Assembly, loads: Loads, increment: float) -> list[dict[str, Any]]:
    """Forces (N) on the corners of the loaded faces, of the same resultant as ``loads``.

    At the corner x, each piece's force over four, plus or minus its torque over 2 a.
    """
    found = []
    for piece, load in zip(assembly.pieces, loads.variable, strict=True):
        if not load.any():
            continue
        y = piece.low[1] if load[1] >= 0.0 else piece.high[1]
        for x, sign in ((piece.low[0], -1.0), (piece.high[0], 1.0)):
            share = load[:3] / 4
            share[1] += sign * load[5] / (2 * piece.size[0])
            found += [
                {
                    "piece": piece.name,
                    "place": (x, y, z),
                    "force": (increment * share).tolist(),
                    "radius": 1e-6 + 0.01 * float(min(piece.size)),
                }
                for z in (piece.low[2], piece.high[2])
            ]
    return found


def read_returned(text: str, case: Case) -> tuple[float, float, pd.DataFrame]:
    """Load carried and load failed (N), and the nodes' stresses, from what 3DEC printed.

    Normal forces are taken as positive in compression, shear as acting on the piece above. Raises
    ValueError if the text is not of ``case`` as it is now, or not whole.
    """
    assembly = assemble(case.joint, case.mesh)
    faces = {
        frozenset((assembly.pieces[face.below].name, assembly.pieces[face.above].name)): face
        for face in assembly.faces
    }
    loads: list[float] = []
    rows = []
    of, ended = "", False
    for line in text.splitlines():
        tag, _, content = line.strip().partition("|")
        if tag != "MULTILOCK":
            continue
        kind, *values = content.split("|")
        of = values[0] if kind == "CASE" else of
        ended |= kind == "END"
        if kind == "LOAD":
            loads = [float(value) for value in values]
        if kind == "NODE" and frozenset(values[:2]) in faces:
            face = faces[frozenset(values[:2])]
            x, y, z, area, normal, *shear, _ = (float(value) for value in values[2:])
            if area <= 0.0:  # nothing of the face belongs to it
                continue
            stress = [force / area for force in (normal, *shear)]
            rows.append((face.name, str(face.kind), x, y, z, area, *stress, 1))
    if not ended or len(loads) != 2:
        raise ValueError(f"{RETURNED} of {case.name}: not whole, run the deck again")
    if of != fingerprint(case):
        raise ValueError(f"{RETURNED}: got results of {of}, allowed are: {fingerprint(case)}")
    nodes = pd.DataFrame(rows, columns=list(NODE_COLUMNS))
    covered = nodes.groupby("face")["area_m2"].sum()
    for face in faces.values():
        if not math.isclose(covered.get(face.name, 0.0), face.area, rel_tol=0.01):
            raise ValueError(
                f"{RETURNED}: got {covered.get(face.name, 0.0):g} m2 of subcontacts on "
                f"{face.name}, allowed is its area, {face.area:g} m2"
            )
    return loads[0], loads[1], nodes


def convert(case: Case, text: str, folder: Path) -> None:
    """Write what 3DEC printed in the form of every other model's results."""
    carried, failed, nodes = read_returned(text, case)
    history = pd.DataFrame([{"load_N": carried, "displacement_m": math.nan}])
    write_results(case, folder, nodes, history, (carried, failed, None))


def main() -> None:
    """Command line: write all decks of a study, or read one that came back."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=["write", "read"])
    parser.add_argument("study", type=Study.model_validate_json)
    parser.add_argument("results")
    parser.add_argument("case", nargs="?")
    arguments = parser.parse_args()
    cases = decks(arguments.study)
    if arguments.what == "write":
        for name, case in cases.items():
            folder = Path(deck_folder(arguments.results, name))
            folder.mkdir(parents=True, exist_ok=True)
            (folder / DECK).write_text(deck(case))
        return
    case = cases[arguments.case]
    returned = Path(deck_folder(arguments.results, case.name)) / RETURNED
    folder = Path(case_folder(arguments.results, MODEL, case.name))
    try:
        convert(case, returned.read_text(), folder)
    except ValueError as error:
        raise SystemExit(f"{returned}: {error}") from None


if __name__ == "__main__":
    main()
