"""The peak of an assembly by distinct elements in LIGGGHTS."""

from pathlib import Path

from ..scripts.assembly import GivenAssembly, GivenSearch, Vector
from ..scripts.next_failure import peak_by_failures
from ..scripts.records import History
from .deck import LiggghtsDeck
from .model import DATA_FILE, INPUT_SCRIPT, LiggghtsModel


def find_peak(
    title: str,
    assembly: GivenAssembly,
    search: GivenSearch,
    radii_m: Vector,
    ranks: int,
    drag: float,
    gradual: bool = False,
) -> None:
    """Search the peak and write ``history.csv``, ``nodes.csv`` and, at the end, ``result.json``.

    It writes LIGGGHTS' input script and atoms, starts it on them, and goes on to give it commands.
    ``radii_m``: of the contact spheres of vertices and, at most, of flat sides;
    ``ranks``: processes of LIGGGHTS; ``drag``: on the pieces, over critical drag at the longest
    natural period; ``gradual``: whether the permanent loads are raised too. Blocks that friction
    and their weight hold would swing and slip otherwise.
    """
    deck = LiggghtsDeck(assembly, search, radii_m, drag, gradual)
    Path(INPUT_SCRIPT).write_text("\n".join(deck.input_script()) + "\n")
    Path(DATA_FILE).write_text(deck.data_file(title))
    history = History(assembly)
    model = LiggghtsModel(deck, ranks, history)
    peak = peak_by_failures(model, search)
    model.engine.stop()
    history.write(peak, "liggghts", model.engine.version)
