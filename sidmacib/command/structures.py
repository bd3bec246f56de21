"""What the command says of structures of blocks."""

from collections.abc import Iterator

from sidmacib.command.answers import Row, reason
from sidmacib.errors import DOES_NOT_STAND, CapacityError, NoEquilibriumError
from sidmacib.mechanics.assembly import Assembly, Kind
from sidmacib.mechanics.limit import LimitState, limit_load, require_standing
from sidmacib.mechanics.polygons import CondensedLocks
from sidmacib.mechanics.sliding import sliding_limit
from sidmacib.mechanics.static.model import static_peak
from sidmacib.problem import Problem
from sidmacib.structure.analysis.forces import interface_forces
from sidmacib.structure.analysis.limit_mesh_error import limit_mesh_error
from sidmacib.structure.analysis.limit_tilt import limit_tilt
from sidmacib.structure.analysis.mesh_error import (
    UNSETTLED,
    Failures,
    is_unsettled,
    structure_mesh_errors,
)
from sidmacib.structure.analysis.tilt import Tilt, moves_most, static_tilt
from sidmacib.structure.loads import free_weight
from sidmacib.structure.structure import refined


def limit_of(problem: Problem) -> LimitState | CapacityError | None:
    """Limit analysis with friction, or why it has no answer; None if gravity turns."""
    if problem.loads.axis is not None:
        return None
    try:
        require_standing(*problem, friction=True)
        return limit_load(*problem, friction=True)
    except CapacityError as error:
        return error


def structure_rows(problem: Problem, limit: LimitState | CapacityError | None = None) -> list[Row]:
    """What a structure carries after each model: loads, or angles if gravity turns.

    ``limit``: by `limit_of` if that was asked before, as it is solved once.
    """
    if problem.loads.axis is not None:
        return list(_tilts(problem, Tilt(problem.loads.axis)))
    return list(_rows(problem, limit_of(problem) if limit is None else limit))


def interface_rows(problem: Problem) -> list[Row]:
    """What each interface carries at the last equilibrium of the static model.

    On the finer of the two meshes, as the loads of `structure_rows`. `CapacityError` if the model
    has no answer.
    """
    fine = refined(problem.assembly)
    if problem.loads.axis is not None:
        peak = static_tilt(fine, Tilt(problem.loads.axis)).path[-1]
    else:
        peak = static_peak(fine, problem.loads).peak
    return [
        {
            "interface": each.name,
            "compression (N)": each.normal,
            "shear (N)": each.shear,
            "utilisation": each.utilisation,
            "bonded": each.bonded,
        }
        for each in interface_forces(fine, peak.force, peak.state)
    ]


def _rows(problem: Problem, limit: LimitState | CapacityError | None) -> Iterator[Row]:
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

    if isinstance(limit, CapacityError):
        yield row("limit", None, reason(limit))
    elif limit is not None:
        moves = f"{moves_most(problem.assembly, limit.mechanism)} moves most"
        error = limit_mesh_error(problem, limit.load)
        yield row("limit", limit.load, f"{_assumes(problem.assembly)}; {moves}", error)
        try:
            sliding = sliding_limit(*problem)
            yield row("limit, no dilation", sliding.state.load, sliding.note)
        except CapacityError as error:
            yield row("limit, no dilation", None, reason(error))
    try:
        coarse = static_peak(*problem)
        fine = static_peak(refined(problem.assembly), problem.loads)
        if not fine.peak.load > 0.0:
            raise NoEquilibriumError
        first, peak = structure_mesh_errors(
            problem.assembly,
            *(Failures(each.first_failure_load, each.peak.load) for each in (coarse, fine)),
            of_fine=True,
        )
        yield row("static, first failure", fine.first_failure_load, "of a bond, or the peak", first)
        note = f"ends by: {fine.mode}"
        if is_unsettled(peak, bond_fails=fine.first_failure_load < fine.peak.load):
            note += f"; {UNSETTLED}"
        yield row("static, peak", fine.peak.load, note, peak)
    except NoEquilibriumError:
        yield row("static", None, DOES_NOT_STAND)
    except CapacityError as error:
        yield row("static", None, reason(error))


def _assumes(assembly: Assembly) -> str:
    """What limit analysis assumes that may put its load too high or too low."""
    if any(isinstance(face, CondensedLocks) and face.limits for face in assembly.faces):
        return (
            "locks as a rule allows where they are held down as given; first lock to fail decides"
        )
    if any(face.kind is Kind.INNER for face in assembly.faces):
        return "bonds yield and never rub: no bound for brittle ones"
    return "associated friction: may overestimate"


def _tilts(problem: Problem, tilt: Tilt) -> Iterator[Row]:
    assembly = problem.assembly

    def row(model: str, angle: float | None, note: str, error: float | None = None) -> Row:
        return {"model": model, "tilt (degrees)": angle, "mesh error / tilt": error, "note": note}

    try:
        limit = limit_tilt(assembly, tilt)
        if limit.mechanism is None:
            note = "forces that balance gravity exist however far it turns"
        else:
            note = f"{_assumes(assembly)}; {moves_most(assembly, limit.mechanism)} moves most"
        yield row("limit", limit.angle, note, limit_mesh_error(problem, limit.angle))
    except CapacityError as error:
        yield row("limit", None, reason(error))
    try:
        coarse, fine = (static_tilt(each, tilt) for each in (assembly, refined(assembly)))
        first, last = structure_mesh_errors(
            assembly,
            *(Failures(each.first_failure, each.angle) for each in (coarse, fine)),
            of_fine=True,
        )
        note = f"ends by: {fine.motion}"
        if fine.mechanism is not None:
            note += f"; {moves_most(assembly, fine.mechanism)} moves most"
        yield row(
            "static, first failure", fine.first_failure, "of a bond, or the last equilibrium", first
        )
        yield row("static, last equilibrium", fine.angle, note, last)
    except CapacityError as error:
        yield row("static", None, reason(error))
