"""Run an engine on an assembly: render its script, execute it, keep its files."""

from pathlib import Path

from sidmacib.engines.engine import Engine
from sidmacib.engines.execute import EngineNoAnswerError, execute
from sidmacib.engines.numerics import Numerics
from sidmacib.engines.render import write_script
from sidmacib.engines.scripts.assembly import Guide
from sidmacib.mechanics.assembly import Assembly, Cuboid, Face, Failure, Kind
from sidmacib.mechanics.crushing import crushed_faces
from sidmacib.mechanics.springs import compliance
from sidmacib.model import Ability
from sidmacib.problem import Problem


def run_engine(
    engine: Engine,
    problem: Problem,
    numerics: Numerics,
    title: str,
    folder: Path,
    time_limit: float,
    guide: Guide | None,
) -> None:
    """Search the peak of ``problem`` for at most ``time_limit`` s, from the ``guide`` if any.

    Leaves in ``folder`` the script with all that it needs, the engine's log, and its results.
    Raises `EngineError` if the engine cannot compute such an assembly, or ends without a result.
    """
    if reason := refusal(engine, problem.assembly):
        raise EngineNoAnswerError(f"{engine.name}: {reason}")
    if not engine.elastic and (reason := _soft_contacts(problem, numerics)):
        raise EngineNoAnswerError(f"{engine.name}: {reason}")
    write_script(engine, *problem, numerics, title, folder, guide)
    execute(engine, folder, time_limit)


def refusal(engine: Engine, assembly: Assembly) -> str | None:
    """Why the engine cannot compute ``assembly``; None if it can."""
    if reason := _structure_refusal(engine, assembly):
        return reason
    if assembly.failure is Failure.SOFTENING:
        return (
            f"inner faces are {assembly.failure}; no engine models softening bonds; use "
            "the static model"
        )
    if Ability.DUCTILE not in engine.abilities and assembly.failure is not Failure.BRITTLE:
        return f"inner faces are {assembly.failure}; this engine models only {Failure.BRITTLE} ones"
    deforms = [piece.elastic is not None for piece in assembly.pieces if not piece.fixed]
    if engine.elastic and not all(deforms):
        return "pieces are rigid; this engine models only elastic pieces"
    if any(deforms) and not engine.elastic:
        return "pieces are elastic; this engine models only rigid pieces"
    reasons = (_bond_refusal(engine, face) for face in assembly.faces if face.kind is Kind.INNER)
    return next(filter(None, reasons), None)


def _soft_contacts(problem: Problem, numerics: Numerics) -> str | None:
    """Why the contacts are too soft for distinct elements; None if they are not."""
    moved = compliance(*problem) * problem.loads.scale / problem.assembly.length
    if moved <= numerics.collapse_share:
        return None
    return (
        f"contacts are so soft that the load moves the pieces by {moved:.2g} of their size; this "
        f"engine takes more than {numerics.collapse_share:g} for a collapse"
    )


def _structure_refusal(engine: Engine, assembly: Assembly) -> str | None:
    """Why the engine cannot compute pieces or faces of this kind; None if it can."""
    if engine.elastic and not all(isinstance(piece, Cuboid) for piece in assembly.pieces):
        return "pieces are polyhedra; this engine models only cuboids along the axes"
    if crushed := crushed_faces(assembly):
        return f"{crushed[0][1].name} has a compressive_strength; no engine models crushing"
    return assembly.without_stiffness


def _bond_refusal(engine: Engine, face: Face) -> str | None:
    """Why the engine cannot compute an inner face; None if it can."""
    law = face.material
    if law.bond_friction:
        return f"{face.name} has a bond_friction of {law.bond_friction:g}; it must be 0"
    unequal = law.normal_stiffness != law.shear_stiffness
    if unequal and Ability.TWO_STIFFNESSES not in engine.abilities:
        return (
            f"{face.name} has a normal stiffness of {law.normal_stiffness:g} Pa/m and a shear "
            f"stiffness of {law.shear_stiffness:g} Pa/m; inner faces must have one stiffness"
        )
    return None
