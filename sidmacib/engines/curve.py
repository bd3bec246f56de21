"""Structures that YADE moves: capacity curves, supports that settle, ground that shakes."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from sidmacib.engines import YADE, Numerics
from sidmacib.engines.render import GroundSteps, write_script
from sidmacib.engines.results import read_history
from sidmacib.engines.run import HOUR, USUAL, EngineError, EngineNoAnswerError, execute, refusal
from sidmacib.engines.scripts.records import HISTORY
from sidmacib.mechanics.assembly import Floats
from sidmacib.problem import Problem
from sidmacib.structure.analysis.supports import SupportAnswer
from sidmacib.structure.loads import SupportMotion
from sidmacib.structure.shaking import TimeLoads


def engine_curve(
    problem: Problem, numerics: Numerics, furthest: float, folder: Path, time_limit: float
) -> tuple[Floats, Floats]:
    """Displacement (m) and load (N) of a structure that YADE moves as far as ``furthest`` (m).

    As in `sidmacib.capacity_curve`, for an acceleration: the mean displacement by mass along it; or
    for a force through the centroid of a block: that of this point. Its files are left in
    ``folder``. `EngineError` if YADE ends without a result, for another load, and where blocks meet
    on the way.
    """
    loads = problem.loads
    needs = "an acceleration as the load, or a force through the centroid of a block"
    other = EngineNoAnswerError(f"yade: a capacity curve needs {needs}")
    loads.raised.require_newtons(other)
    if loads.variable[:, 3:].any() or not loads.variable.any():
        raise other
    return _run(problem, numerics, folder, time_limit, furthest)


def engine_support_path(
    problem: Problem, numerics: Numerics, folder: Path, time_limit: float
) -> tuple[Floats, Floats]:
    """Movement of a support (m or rad) and reaction (N or N m), until the structure falls in YADE.

    As in `sidmacib.structure.analysis.supports.support_path`, with elastic joints: at rest, up to
    the last movement at which there is rest. The support stops after each part of its movement; one
    that the structure does not survive is taken back and halved, until the last is the tolerance in
    ``numerics``. Its files are left in ``folder``. `EngineError` if YADE ends without a result, and
    where blocks meet on the way or the structure stands however far the support moves.
    """
    if not isinstance(problem.loads, SupportMotion):
        raise TypeError("loads: must be a support that moves")
    return _run(problem, numerics, folder, time_limit)


def yade_answer(problem: Problem) -> SupportAnswer:
    """Where the structure falls in YADE, and the reaction before that; or why there is none."""
    try:
        with TemporaryDirectory() as folder:
            movement, reaction = engine_support_path(problem, USUAL, Path(folder), HOUR)
    except EngineError as error:
        return SupportAnswer(YADE.name, None, None, error.in_short)
    note = f"the structure falls; elastic joints, at rest; YADE {YADE.version()}"
    return SupportAnswer(YADE.name, float(reaction[-1]), float(movement[-1]), note)


def _run(
    problem: Problem,
    numerics: Numerics,
    folder: Path,
    time_limit: float,
    furthest: float | None = None,
) -> tuple[Floats, Floats]:
    """Displacements and loads at equilibrium, by the former; the last before it falls if any."""
    assembly, loads = problem
    if reason := refusal(YADE, assembly):
        raise EngineNoAnswerError(f"yade: {reason}")
    write_script(YADE, assembly, loads, numerics, "Structure.", folder, furthest=furthest)
    execute(YADE, folder, time_limit)
    _, path = read_history(folder)
    displacement, load = np.array([(state.displacement, state.load) for state in path]).T
    return displacement, load


PLANE = 1e-6  # of the largest acceleration, squared: motion out of its vertical plane


def engine_motion(
    problem: Problem, numerics: Numerics, folder: Path, time_limit: float = HOUR
) -> tuple[Floats, Floats]:
    """Times (s), (T,), and displacement (m) and rotation vector of each piece then, (T, P, 6).

    YADE moves the ground of loads in time as `sidmacib.dynamics.motion.history` does, but with
    elastic contacts; pieces turn about the horizontal axis across the largest acceleration. Its
    files are left in ``folder``. `EngineError` if YADE ends without a result, and for what acts
    otherwise or out of one vertical plane.
    """
    assembly, loads = problem
    assert isinstance(loads, TimeLoads), "loads in time"
    if loads.sudden.any() or loads.speed.any() or loads.lost is not None or not loads.ground:
        raise EngineNoAnswerError("yade: in time moves the ground only")
    if reason := refusal(YADE, assembly):
        raise EngineNoAnswerError(f"yade: {reason}")
    ground = loads.accelerations()
    along = ground[np.linalg.norm(ground, axis=1).argmax()]
    across = np.cross(along, [0.0, 0.0, 1.0])
    if not across.any() or np.abs(ground @ across).max() > PLANE * np.square(along).sum():
        raise EngineNoAnswerError(
            "yade: in time moves the ground in one vertical plane, not up alone"
        )
    moved = GroundSteps(loads.step, ground, across / np.linalg.norm(across))
    write_script(YADE, assembly, loads, numerics, "Structure.", folder, ground=moved)
    execute(YADE, folder, time_limit)
    rows = np.loadtxt(folder / HISTORY, delimiter=",", skiprows=1)
    pieces = len(assembly.pieces)
    time = rows[::pieces, 0]
    return time, rows[:, 2:].reshape(len(time), pieces, 6)
