"""What the command says of structures of blocks."""

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from sidmacib.command.answers import Row, reason
from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import Assembly
from sidmacib.mechanics.limit import LimitState, limit_load
from sidmacib.mechanics.sliding import sliding_limit
from sidmacib.mechanics.solution import StaticSolution
from sidmacib.mechanics.static.model import static_peak
from sidmacib.mesh_error import LoadKind, kind_of, mesh_errors
from sidmacib.problem import Problem
from sidmacib.structure.file import read_structure
from sidmacib.structure.forces import interface_forces
from sidmacib.structure.loads import free_weight
from sidmacib.structure.structure import refined


def structure_rows(path: Path) -> list[Row]:
    """The loads that a structure carries after each model; errors of `read_structure`."""
    return list(_rows(read_structure(path)))


def interface_rows(path: Path) -> list[Row]:
    """What each interface carries at the peak of the static model; errors of `read_structure`."""
    problem = read_structure(path)
    peak = static_peak(*problem).peak
    return [
        {
            "interface": each.name,
            "compression (N)": each.normal,
            "shear (N)": each.shear,
            "utilisation": each.utilisation,
            "bonded": each.bonded,
        }
        for each in interface_forces(problem.assembly, peak.force, peak.state)
    ]


def _rows(problem: Problem) -> Iterator[Row]:
    weight = free_weight(problem.assembly)

    def row(model: str, load: float | None, note: str, error: float | None = None) -> Row:
        share = None if load is None else load / weight
        return {
            "model": model,
            "load (N)": load,
            "load / weight": share,
            "mesh error / load": error,
            "note": note,
        }

    try:
        state = limit_load(*problem, friction=True)
        moves = f"{_moves_most(problem.assembly, state)} moves most"
        yield row("limit", state.load, f"associated friction: may overestimate; {moves}")
        sliding = sliding_limit(*problem).state
        yield row("limit, no dilation", sliding.load, "sliding does not open the joints")
    except CapacityError as error:
        yield row("limit", None, reason(error))
    try:
        coarse = static_peak(*problem)
        fine = static_peak(refined(problem.assembly), problem.loads)
        first, peak = _mesh_errors(problem.assembly, coarse, fine)
        yield row("static, first failure", fine.first_failure_load, "of a bond, or the peak", first)
        yield row("static, peak", fine.peak.load, f"ends by: {fine.mode}", peak)
    except CapacityError as error:
        yield row("static", None, reason(error))


def _mesh_errors(
    assembly: Assembly, coarse: StaticSolution, fine: StaticSolution
) -> tuple[float | None, float | None]:
    """Of the first failure and of the peak on cells of half the size, each over its load.

    None of a load that is 0.
    """
    sides = [math.sqrt(face.area) for face in assembly.faces]
    cells = max(1.0, float(np.mean(sides)) / assembly.mesh)
    loads = [(each.peak.load, each.first_failure_load) for each in (coarse, fine)]
    errors = [
        mesh_errors({cells: one, 2 * cells: other}, assembly.layout, kind)[2 * cells]
        if one > 0.0 and other > 0.0
        else None
        for one, other, kind in (
            (coarse.first_failure_load, fine.first_failure_load, LoadKind.FIRST_FAILURE),
            (coarse.peak.load, fine.peak.load, kind_of(loads)),
        )
    ]
    return errors[0], errors[1]


def _moves_most(assembly: Assembly, state: LimitState) -> str:
    """The piece whose centroid moves most in the mechanism of a limit state."""
    size = np.linalg.norm(state.mechanism[:, :3], axis=1)
    return assembly.pieces[int(np.argmax(size))].name
