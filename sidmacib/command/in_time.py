"""What the command `assembly` prints, writes and draws where loads act in time."""

import math
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from matplotlib.figure import Figure

from sidmacib.answers.ask import Tell
from sidmacib.answers.in_time import STEEPEST, TimeAnswer, falls_at
from sidmacib.command.answers import Row
from sidmacib.command.output import in_asked_words, plot
from sidmacib.command.structure_views import page_words
from sidmacib.drawing import BLACK, BLUE, GREEN, GREY, OCHRE, ORANGE, PURPLE, SKY, VERMILION
from sidmacib.engines.run import USUAL, EngineError
from sidmacib.problem import Outcome, Problem, State
from sidmacib.scene.drawn import Drawn, shape_of
from sidmacib.scene.forces import arrows_of
from sidmacib.scene.page import page
from sidmacib.structure.shaking import TimeLoads

VALIDATED = "No shake-table test has been compared with these motions."
EVERY = 0.01  # s: between rows of a history
FRAMES = 150  # of the page, at most
MONOTONIC = "larger factors need not fell it, and smaller ones may"
COLOURS = BLUE, VERMILION, GREEN, PURPLE, SKY, ORANGE, OCHRE, BLACK, GREY  # of blocks


def time_rows(answer: TimeAnswer) -> list[Row]:
    """How far blocks move and turn, and what that rests on."""
    degrees = math.degrees(1.0)
    found = [
        ("largest displacement (m)", 1.0, answer.largest_shift),
        ("largest rotation (degrees)", degrees, answer.largest_turn),
        ("displacement at the end (m)", 1.0, answer.last_shift),
        ("rotation at the end (degrees)", degrees, answer.last_turn),
    ]
    rows: list[Row] = [
        {
            "what": what,
            "value": unit * each.size,
            "block": each.block,
            "time (s)": each.time,
            "note": "",
        }
        for what, unit, each in found
    ]
    rows[0]["note"] = answer.note
    return rows


def collapse_row(answer: TimeAnswer, tell: Tell) -> Row:
    """The factor on the ground motion at which the structure falls."""
    factor = falls_at(answer.problem, answer.history.holds, tell)
    note = MONOTONIC
    if factor is None:
        note = f"it stands up to {STEEPEST:g}"
    elif not factor:
        note = f"it falls down to 1 / {STEEPEST:g}"
    bonds = ", or a bond may break" if answer.bond else ""
    name = f"factor on the ground motion at which it falls{bonds}"
    return {"what": name, "value": factor or None, "block": "", "time (s)": None, "note": note}


def yade_row(problem: Problem, tell: Tell) -> Row:
    """The largest displacement in YADE; the note says why there is none."""
    from sidmacib.engines.curve import engine_motion

    tell("YADE moves the ground")
    row: Row = {
        "what": "largest displacement, YADE (m)",
        "value": None,
        "block": "",
        "time (s)": None,
    }
    try:
        with TemporaryDirectory() as folder:
            time, motion = engine_motion(problem, USUAL, Path(folder))
    except EngineError as error:
        return {**row, "note": error.in_short}
    size = np.linalg.norm(motion[:, :, :3], axis=2)
    when, piece = np.unravel_index(int(size.argmax()), size.shape)
    found = {"value": float(size[when, piece]), "time (s)": float(time[when])}
    block = problem.assembly.pieces[int(piece)].name
    return {**row, **found, "block": block, "note": "elastic contacts, hardly damped"}


def history_rows(answer: TimeAnswer) -> list[Row]:
    """Displacements and rotation vectors of all free blocks since they were built."""
    found, names = answer.history, ["x_m", "y_m", "z_m", "rx_rad", "ry_rad", "rz_rad"]
    both = np.concatenate([found.shift, found.turn], axis=2)
    step = found.time[1] - found.time[0]
    every = max(round(EVERY / step), 1)
    return [
        {"time_s": float(time), "block": piece.name, **dict(zip(names, row.tolist(), strict=True))}
        for time, rows in zip(found.time[::every], both[::every], strict=True)
        for piece, row in zip(answer.problem.assembly.pieces, rows, strict=True)
        if not piece.fixed
    ]


def time_page(
    answer: TimeAnswer, title: str, rows: Sequence[Row], notes: Sequence[str], command: str
) -> str:
    """The page that plays what happens; ``rows``: the table that is printed by ``command``."""
    problem, found = answer.problem, answer.history
    assert isinstance(problem.loads, TimeLoads), "loads in time"
    frames = np.unique(np.linspace(0, len(found.time) - 1, FRAMES).astype(int))
    moves = np.concatenate([found.shift, found.turn], axis=2)[frames]
    end = Outcome((State(0.0),), math.inf, motion=moves[-1], motion_kind="in time")
    model = {
        **Drawn("time", problem, end).values(),
        "name": "rigid blocks in time",
        "history": {"times": found.time[frames].tolist(), "moves": moves.tolist()},
    }
    structure = {
        "title": title,
        "shape": {**shape_of(problem.assembly), "interfaces": []},
        "loads": arrows_of(*problem),
        "models": [model],
    }
    said = in_asked_words(answer.words)
    words = page_words(said, f"{problem.loads.words}.", notes, rows)
    more = {"title": title, "command": command, "validated": VALIDATED, "curve": ""}
    return page({"structures": [structure]}, {**words, **more})


def drift_picture(answer: TimeAnswer, title: str) -> Figure:
    """Displacements of the blocks that move most over time."""
    found, pieces = answer.history, answer.problem.assembly.pieces
    size = np.linalg.norm(found.shift, axis=2)
    free = [number for number, piece in enumerate(pieces) if not piece.fixed]
    most = sorted(free, key=lambda number: -float(size[:, number].max()))[: len(COLOURS)]
    figure, axes = plot(title, "time (s)", "displacement (m)")
    for number, colour in zip(most, COLOURS, strict=False):
        axes.plot(found.time, size[:, number], color=colour, label=pieces[number].name)
    axes.set_xlim(0.0, float(found.time[-1]))
    axes.set_ylim(bottom=0.0)
    axes.legend(loc="upper left", frameon=False)
    axes.grid(color="#dddddd", linewidth=0.6)
    return figure
