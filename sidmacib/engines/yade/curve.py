"""The load over the displacement that it works on, of an assembly in YADE that is moved."""

from ..scripts.assembly import GivenAssembly, GivenSearch
from ..scripts.records import MECHANISM, EngineOutcome, EnginePeak, History, NoAnswerError
from .model import YadeModel, YadeSettings
from .program import VERSION

POINTS = 40  # equilibria
YIELDS = 0.01  # over the mean size of pieces: by so much a load as large as the weight moves it


def find_curve(
    assembly: GivenAssembly, search: GivenSearch, settings: YadeSettings, furthest_m: float
) -> None:
    """Move the assembly by ``furthest_m``; the files of a search, ``history.csv`` with the curve.

    A spring pulls along the load: its end moves step by step, and its force, at rest, is the load.
    Exits with a reason where the assembly comes to no rest, or pieces meet.
    """
    history = History(assembly)
    model = YadeModel(assembly, search, settings, history)
    if model.raised(0.0, 0.0, (0.0, 1.0)) is not EngineOutcome.EQUILIBRIUM:
        raise NoAnswerError("the assembly carries no load: it fails under its permanent loads")
    history.rows.clear()
    stiffness = assembly.permanent_N / (YIELDS * assembly.length_m)
    peak = EnginePeak(0.0, 0.0, None, MECHANISM, model.node_forces())
    for point in range(1, POINTS + 1):
        ends = (point - 1) / POINTS * furthest_m, point / POINTS * furthest_m
        load = model.pulled(stiffness, ends)
        print(f"{load:12.4f} N at {model.displacement():.6g} m", flush=True)
        if load > peak.load:
            peak = EnginePeak(load, load, None, MECHANISM, model.node_forces())
    history.write(peak, "yade", VERSION)
