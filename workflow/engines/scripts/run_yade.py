"""The peak of an assembly by distinct elements in YADE."""

from dataclasses import replace

from .assembly import Assembly, Search
from .flatness import FLATTER, check_mechanism
from .increments import outcome_at, peak_by_increments
from .records import MECHANISM, History
from .yade_model import Settings, YadeModel
from .yade_program import VERSION


def find_peak(assembly: Assembly, search: Search, settings: Settings) -> None:
    """Search the peak and write ``history.csv``, ``nodes.csv`` and, at the end, ``result.json``."""
    history = History(assembly)
    peak = peak_by_increments(YadeModel(assembly, search, settings, history), search)
    if peak.mode == MECHANISM:
        flatter = replace(settings, radius_m=FLATTER * settings.radius_m)
        model = YadeModel(assembly, search, flatter, History(assembly))
        check_mechanism(peak, outcome_at(model, peak.failed_load))
    history.write(peak, "yade", VERSION)
