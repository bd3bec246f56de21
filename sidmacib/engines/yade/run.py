"""The peak of an assembly by distinct elements in YADE."""

from dataclasses import replace

from ..scripts.assembly import GivenAssembly, GivenSearch
from ..scripts.flatness import FLATTER, MARGIN, check_mechanism
from ..scripts.increments import STEPS, displacements_towards, peak_by_increments
from ..scripts.records import MECHANISM, History
from .model import YadeModel, YadeSettings
from .program import VERSION


def find_peak(assembly: GivenAssembly, search: GivenSearch, settings: YadeSettings) -> None:
    """Search the peak and write ``history.csv``, ``nodes.csv`` and, at the end, ``result.json``."""
    history = History(assembly)
    peak = peak_by_increments(YadeModel(assembly, search, settings, history), search)
    if peak.mode == MECHANISM:
        flatter = replace(settings, radius_m=FLATTER * settings.radius_m)
        model = YadeModel(assembly, search, flatter, History(assembly))
        found = displacements_towards(model, (1.0 + MARGIN) * peak.failed_load)
        check_mechanism(peak, found, STEPS)
    history.write(peak, "yade", VERSION)
