"""What the command says of structures of blocks."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from sidmacib.command.answers import Row, reason
from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import Assembly
from sidmacib.mechanics.limit import LimitState, limit_load
from sidmacib.mechanics.sliding import sliding_limit
from sidmacib.mechanics.static.model import static_peak
from sidmacib.problem import Problem
from sidmacib.structure.file import read_structure
from sidmacib.structure.forces import interface_forces
from sidmacib.structure.loads import free_weight


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

    def row(model: str, load: float | None, note: str) -> Row:
        share = None if load is None else load / weight
        return {"model": model, "load (N)": load, "load / weight": share, "note": note}

    try:
        state = limit_load(*problem, friction=True)
        moves = f"{_moves_most(problem.assembly, state)} moves most"
        yield row("limit", state.load, f"associated friction: may overestimate; {moves}")
        sliding = sliding_limit(*problem).state
        yield row("limit, no dilation", sliding.load, "sliding does not open the joints")
    except CapacityError as error:
        yield row("limit", None, reason(error))
    try:
        path = static_peak(*problem)
        yield row("static, first failure", path.first_failure_load, "of a bond, or the peak")
        yield row("static, peak", path.peak.load, f"ends by: {path.mode}")
    except CapacityError as error:
        yield row("static", None, reason(error))


def _moves_most(assembly: Assembly, state: LimitState) -> str:
    """The piece whose centroid moves most in the mechanism of a limit state."""
    size = np.linalg.norm(state.mechanism[:, :3], axis=1)
    return assembly.pieces[int(np.argmax(size))].name
