"""The peak of an assembly by distinct elements in YADE."""

from .assembly import Assembly, Search
from .increments import peak_by_increments
from .records import History
from .yade_model import Settings, YadeModel
from .yade_program import VERSION


def find_peak(assembly: Assembly, search: Search, settings: Settings) -> None:
    """Search the peak and write ``history.csv``, ``nodes.csv`` and, at the end, ``result.json``."""
    history = History(assembly)
    peak = peak_by_increments(YadeModel(assembly, search, settings, history), search)
    history.write(peak, "yade", VERSION)
