"""What the command `assembly` prints of the verification of a mechanism for an earthquake."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from sidmacib.command.answers import Row
from sidmacib.command.output import Appended, cell, plot
from sidmacib.command.structure_views import KEPT, drawn_svg
from sidmacib.drawing import BLUE, GREY, VERMILION
from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import GRAVITY
from sidmacib.problem import Problem
from sidmacib.quantities import four_digits
from sidmacib.scene.page import rendered
from sidmacib.structure.analysis.kinematics import REACHED
from sidmacib.structure.analysis.seismic import (
    BEHAVIOUR,
    DAMPING,
    SeismicCheck,
    seismic_check,
)
from sidmacib.structure.files.seismic import SeismicSection

NOTE = Path(__file__).with_name("seismic_note.html.j2")
MISSING = "seismic: missing; --seismic needs the spectrum, such as {ag: 0.15g, S: 1.2, TB: 0.15, "
MISSING += "TC: 0.5, TD: 2}"


def checked(description: Any, problem: Problem) -> SeismicCheck:
    """The check of a ``description`` by the key that it has for it; ValueError if it has none."""
    given = description.get("seismic") if isinstance(description, dict) else None
    if given is None:
        raise ValueError(MISSING)
    load = description.get("load")
    if not isinstance(load, dict) or "acceleration" not in load:
        raise CapacityError("--seismic: needs a load that is an acceleration")
    section = SeismicSection.read(given, "seismic")
    return seismic_check(*problem, section.spectrum, section.confidence)


def answer(found: SeismicCheck) -> tuple[bool, str]:
    """Whether the mechanism bears the displacement that the spectrum asks for, in words too."""
    passes = found.ratio >= 1.0
    bears = f"the mechanism bears {four_digits(found.ultimate)} m"
    asked = f"the spectrum asks for {four_digits(found.demand)} m, so the ratio is "
    said = f"{bears}; {asked}{four_digits(found.ratio)} (Circolare 7/2019, C8.7.1.2.1.8)"
    return passes, f"{'Yes' if passes else 'No'}: {said}"


def seismic_rows(found: SeismicCheck) -> list[Row]:
    """Each step of the verification, with its formula and the equation's number."""
    curve, spectrum = found.curve, found.spectrum
    alpha = found.start * found.share * found.confidence / GRAVITY
    where = "where a = 0" if curve.path.end == REACHED else "where the curve ends, as blocks meet, "
    where += "" if curve.path.end == REACHED else "fall, or go on in another way"
    values = f"alpha = {alpha:.4g}, e* = {found.share:.4g}, FC = {found.confidence:g}"
    linear = f"q a0 / S, q = {BEHAVIOUR:g} (C8.7.1.2.1.7)"
    asked = f"ag, linear over the ag asked for, {spectrum.ground:.4g}"
    told = (
        ("a0 (m/s2)", found.start, f"alpha g / (e* FC) (C8.7.1.3); {values}"),
        ("d0 (m)", found.end, f"{where}; d = dC / e* (C8.7.1.4)"),
        ("d_SLV (m)", found.ultimate, "0.4 d0 (C8.7.1.2.1.6)"),
        ("T_SLV (s)", found.period, "1.68 pi sqrt(d_SLV / a(d_SLV)) (C8.7.1.10)"),
        ("S_De(T_SLV) (m)", found.demand, "damping 8 % (C8.7.1.2.1.8)"),
        ("ratio", found.ratio, "d_SLV / S_De"),
        ("ag, linear (m/s2)", found.ground, linear),
        ("ratio, linear", found.ground / spectrum.ground, asked),
    )
    return [{"what": what, "value": value, "note": note} for what, value, note in told]


def seismic_note(
    found: SeismicCheck, title: str, notes: Sequence[str], command: str, inputs: Sequence[Path]
) -> str:
    """The note in HTML: ``notes``, what it was made by, and files that are appended."""
    ratios = {"ratio": found.ratio, "ratio, linear": found.ground / found.spectrum.ground}
    kept = {name: KEPT["yes" if ratio >= 1.0 else "no"] for name, ratio in ratios.items()}
    curve, spectrum = found.curve, found.spectrum
    periods = zip(("TB", "TC", "TD"), spectrum.corners, strict=True)
    corners = ", ".join(f"{name} = {value:g} s" for name, value in periods)
    hinges, slides = (", ".join(names) or "none" for names in (curve.hinges, curve.slides))
    return rendered(
        NOTE,
        title=f"Calculation note: earthquake, {title}",
        answer=answer(found)[1],
        mechanism=f"Hinges: {hinges}. Sliding: {slides}",
        drawing=drawn_svg(seismic_picture(found, title)),
        spectrum=f"ag = {spectrum.ground:.4g} m/s2, S = {spectrum.soil:g}, "
        f"F0 = {spectrum.amplification:g}, {corners}",
        checks=[
            (row["what"], row["note"], cell(row["value"]), kept.get(str(row["what"]), ""))
            for row in seismic_rows(found)
        ],
        notes=notes,
        command=command,
        inputs=[*map(Appended.of, inputs)],
    )


def seismic_picture(found: SeismicCheck, title: str) -> Figure:
    """The oscillator's capacity over the spectrum that is asked for, at the same damping."""
    figure, axes = plot(title, "displacement (m)", "acceleration (m/s2)")
    axes.plot(found.displacement, found.acceleration, color=BLUE, label="capacity of the mechanism")
    periods = np.geomspace(0.02, 3.0 * found.period, 300)
    both = [(found.spectrum.displacement(T, DAMPING), found.spectrum.acceleration(T, DAMPING))
            for T in periods]  # fmt: skip
    axes.plot(*zip(*both, strict=True), color=VERMILION, label="spectrum, damping 8 %")
    slope = (2.0 * np.pi / found.period) ** 2
    far = max(found.demand, found.ultimate)
    axes.plot([0.0, far], [0.0, slope * far], color=GREY, linewidth=0.8, label="T_SLV")
    for place, colour, label in (
        (found.ultimate, BLUE, "d_SLV"),
        (found.demand, VERMILION, "S_De(T_SLV)"),
    ):
        axes.axvline(place, color=colour, linewidth=0.8, linestyle="--", label=label)
    axes.set_xlim(0.0, 1.1 * max(found.end, found.demand))
    axes.set_ylim(bottom=0.0)
    axes.legend(loc="upper right", frameon=False)
    return figure
