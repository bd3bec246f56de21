"""The peak of an assembly by distinct elements in YADE."""

from ..scripts.assembly import GivenAssembly, GivenSearch
from ..scripts.increments import peak_by_increments
from ..scripts.records import History
from .model import YadeModel, YadeSettings
from .program import VERSION


def find_peak(assembly: GivenAssembly, search: GivenSearch, settings: YadeSettings) -> None:
    """Search the peak and write ``history.csv``, ``nodes.csv`` and, at the end, ``result.json``."""
    history = History(assembly)
    peak = peak_by_increments(YadeModel(assembly, search, settings, history), search)
    history.write(peak, "yade", VERSION)
