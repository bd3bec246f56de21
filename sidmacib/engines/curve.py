"""The capacity curve of a structure in YADE: the load over the displacement that is given."""

import csv
from pathlib import Path

import numpy as np

from sidmacib.engines.engine import Numerics
from sidmacib.engines.render import write_script
from sidmacib.engines.run import EngineNoAnswerError, execute, refusal
from sidmacib.engines.scripts.records import HISTORY
from sidmacib.engines.yade.engine import YADE
from sidmacib.mechanics.assembly import Floats
from sidmacib.problem import Problem


def engine_curve(
    problem: Problem, numerics: Numerics, furthest: float, folder: Path, time_limit: float
) -> tuple[Floats, Floats]:
    """Displacement (m) and load (N) of a structure that YADE moves as far as ``furthest`` (m).

    As in `sidmacib.capacity_curve`, for an acceleration: the mean displacement by mass along it.
    Its files are left in ``folder``. `EngineError` if YADE ends without a result, for another load,
    and where blocks meet on the way.
    """
    assembly, loads = problem
    if reason := refusal(YADE, assembly):
        raise EngineNoAnswerError(f"yade: {reason}")
    if loads.axis is not None or loads.variable[:, 3:].any() or not loads.variable.any():
        raise EngineNoAnswerError("yade: a capacity curve needs an acceleration as the load")
    write_script(YADE, assembly, loads, numerics, "capacity curve", folder, furthest=furthest)
    execute(YADE, folder, time_limit)
    with (folder / HISTORY).open() as stream:
        rows = [(float(r["displacement_m"]), float(r["load_N"])) for r in csv.DictReader(stream)]
    displacement, load = np.array(rows).T
    return displacement, load
