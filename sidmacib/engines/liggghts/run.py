"""The peak of an assembly by distinct elements in LIGGGHTS."""

from pathlib import Path

from ..scripts.assembly import GivenAssembly, GivenSearch
from ..scripts.flatness import FLATTER, MARGIN, check_mechanism
from ..scripts.next_failure import peak_by_failures
from ..scripts.records import MECHANISM, History
from .deck import LiggghtsDeck
from .model import DATA_FILE, INPUT_SCRIPT, Event, LiggghtsModel


def find_peak(
    title: str,
    assembly: GivenAssembly,
    search: GivenSearch,
    largest_radius_m: float,
    ranks: int,
    gradual: bool = False,
) -> None:
    """Search the peak and write ``history.csv``, ``nodes.csv`` and, at the end, ``result.json``.

    It writes LIGGGHTS' input script and atoms, starts it on them, and goes on to give it commands.
    ``largest_radius_m``: of contact spheres, which are large so that contacts are flat; ``ranks``:
    processes of LIGGGHTS; ``gradual``: whether the permanent loads are raised too, and pieces move
    against more drag. Blocks that friction and their weight hold would swing and slip otherwise.
    """

    def new_model(radius: float, history: History) -> LiggghtsModel:
        deck = LiggghtsDeck(assembly, search, radius, gradual)
        Path(INPUT_SCRIPT).write_text("\n".join(deck.input_script()) + "\n")
        Path(DATA_FILE).write_text(deck.data_file(title))
        return LiggghtsModel(deck, ranks, history)

    history = History(assembly)
    model = new_model(largest_radius_m, history)
    peak = peak_by_failures(model, search)
    model.engine.stop()
    if peak.mode == MECHANISM:
        flatter = new_model(FLATTER * largest_radius_m, History(assembly))
        events = [*model.events[:-1], Event((1.0 + MARGIN) * peak.failed_load)]
        check_mechanism(peak, flatter.replayed(events), len(events))
        flatter.engine.stop()
    history.write(peak, "liggghts", model.engine.version)
