"""The peak of an assembly by distinct elements in LIGGGHTS."""

from pathlib import Path

from .assembly import Assembly, Search
from .liggghts_deck import Deck
from .liggghts_model import DATA_FILE, INPUT_SCRIPT, LiggghtsModel
from .next_failure import peak_by_failures
from .records import History


def find_peak(
    title: str, assembly: Assembly, search: Search, largest_radius_m: float, ranks: int
) -> None:
    """Search the peak and write ``history.csv``, ``nodes.csv`` and, at the end, ``result.json``.

    It writes LIGGGHTS' input script and atoms, starts it on them, and goes on to give it commands.
    ``largest_radius_m``: of contact spheres, which are large so that contacts are flat; ``ranks``:
    processes of LIGGGHTS.
    """
    deck, history = Deck(assembly, search, largest_radius_m), History(assembly)
    Path(INPUT_SCRIPT).write_text("\n".join(deck.input_script()) + "\n")
    Path(DATA_FILE).write_text(deck.data_file(title))
    model = LiggghtsModel(deck, ranks, history)
    peak = peak_by_failures(model, search)
    model.engine.stop()
    history.write(peak, "liggghts", model.engine.version)
