"""The peak of an assembly by distinct elements in YADE, or its load over a displacement."""

import json
import math
from pathlib import Path

from ..scripts.assembly import GivenAssembly, GivenSearch
from ..scripts.increments import peak_by_increments
from ..scripts.records import (
    MECHANISM,
    EngineOutcome,
    EnginePeak,
    History,
    NoAnswerError,
    require_contacts,
    require_standing,
)
from .model import SLICE, YadeModel, YadeSettings
from .program import VERSION

POINTS = 40  # equilibria of a curve
IN_TIME = 0.002  # damping where the ground moves
KEPT = 10  # slices from one row of a motion to the next
YIELDS = 0.01  # over the mean size of pieces: by so much a load as large as the weight moves it


def find_peak(assembly: GivenAssembly, search: GivenSearch, settings: YadeSettings) -> None:
    """Search the peak and write ``history.csv``, ``nodes.csv`` and, at the end, ``result.json``."""
    history = History(assembly)
    peak = peak_by_increments(YadeModel(assembly, search, settings, history), search)
    history.write(peak, "yade", VERSION)


def find_curve(
    assembly: GivenAssembly, search: GivenSearch, settings: YadeSettings, furthest_m: float
) -> None:
    """Move the assembly by ``furthest_m``; the files of a search, ``history.csv`` with the curve.

    A spring pulls along the load: its end moves step by step, and its force, at rest, is the load.
    Exits with a reason where the assembly comes to no rest, or pieces meet.
    """
    history = History(assembly)
    model = YadeModel(assembly, search, settings, history)
    require_standing(model.raised(0.0, 0.0, (0.0, 1.0)), model.met, search.guide)
    history.rows.clear()
    stiffness = assembly.permanent_N / (YIELDS * assembly.length_m)
    peak = EnginePeak(0.0, 0.0, None, MECHANISM, model.node_forces())
    for point in range(1, POINTS + 1):
        ends = (point - 1) / POINTS * furthest_m, point / POINTS * furthest_m
        load = _pulled(model, stiffness, ends)
        print(f"{load:12.4f} N at {model.displacement():.6g} m", flush=True)
        if load > peak.load:
            peak = EnginePeak(load, load, None, MECHANISM, model.node_forces())
    history.write(peak, "yade", VERSION)


def find_motion(
    assembly: GivenAssembly, search: GivenSearch, settings: YadeSettings, path: str
) -> None:
    """Move the ground of the data file at ``path``; ``history.csv`` has where pieces are.

    In the frame of the ground, where its acceleration acts on every mass. Nothing dissipates but
    friction and Cundall's damping, which is small here. Exits where pieces meet.
    """
    history = History(assembly)
    model = YadeModel(assembly, search, settings, history)
    require_standing(model.raised(0.0, 0.0, (0.0, 1.0)), model.met, search.guide)
    ground = json.loads(Path(path).read_text())["ground"]
    every, slice_s, rows = ground["acceleration"], SLICE * search.time_step_s, []
    model.undamp(IN_TIME)
    for step in range(math.ceil(len(every) * ground["step_s"] / slice_s)):
        now = every[min(int(step * slice_s / ground["step_s"]), len(every) - 1)]
        model.shake(now)
        motions = model.advance()
        if model.met:
            require_contacts(EngineOutcome.MEETING, f"{step * slice_s:.4g} s", model.met)
        if step % KEPT == 0:
            for piece, (moved, turned) in enumerate(motions):
                place = dict(zip(("x_m", "y_m", "z_m"), moved, strict=True))
                turn = dict(zip(("rx_rad", "ry_rad", "rz_rad"), turned, strict=True))
                rows.append({"time_s": (step + 1) * slice_s, "piece": piece, **place, **turn})
    history.rows[:] = rows
    history.write(EnginePeak(0.0, 0.0, None, MECHANISM, model.node_forces()), "yade", VERSION)


def _pulled(model: YadeModel, stiffness: float, ends: tuple[float, float]) -> float:
    """The load (N) of a spring (N/m) that pulls along it, at rest.

    ``ends``: its end moves from the one to the other (m), smoothly and slowly.
    """
    before, after = ends
    ramp = max(model.search.ramp_steps, model.slowly(after - before))
    for step in range(0, ramp + model.search.hold_steps, SLICE):
        share = 0.5 - 0.5 * math.cos(math.pi * min(1.0, step / ramp))
        load = stiffness * (before + share * (after - before) - model.displacement())
        model.apply(load, 1.0)
        model.advance()
        if model.met:
            require_contacts(EngineOutcome.MEETING, model.search.said(load), model.met)
        if step > ramp and model.unbalanced_ratio(load) < model.search.unbalanced_ratio:
            model.record(load, EngineOutcome.EQUILIBRIUM.value)
            return load
    raise NoAnswerError(f"no rest at a displacement of {model.displacement():.6g} m")
