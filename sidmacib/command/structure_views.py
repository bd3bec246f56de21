"""Pages, pictures and calculation notes of a structure."""

import io
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import yaml

from sidmacib.answers.ask import Solved
from sidmacib.answers.said import Static
from sidmacib.answers.structure import Limit
from sidmacib.answers.structure_paths import StaticAnswer
from sidmacib.answers.verdict import Verdict, factor_of
from sidmacib.command.answers import Row
from sidmacib.command.output import Appended, Formula, cell, in_asked_units, in_asked_words
from sidmacib.drawing import write_figure
from sidmacib.errors import CapacityError, NoEquilibriumError, reason
from sidmacib.mechanics.assembly import Face, FaceMaterial, Kind, Piece, Vector
from sidmacib.mechanics.crushing import crushed_faces, strength_of
from sidmacib.models import MODELS, structure_limit, structure_static
from sidmacib.problem import Problem
from sidmacib.quantities import four_digits, number_of, some_of
from sidmacib.scene.drawn import Drawn, shape_of, with_condensed_locks
from sidmacib.scene.forces import arrows_of, load_of, total
from sidmacib.scene.page import rendered
from sidmacib.structure.blocks import solids_of
from sidmacib.structure.files.structure_file import Demand
from sidmacib.structure.loads import beside_of, free_weight

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TEMPLATE = Path(__file__).with_name("structure_note.html.j2")
MOST_ROWS = 8  # of a table of blocks, reactions or interfaces, for two pages
WIDTH = 5.0  # inches, of the picture
BALANCED = 1e-3  # of the loads: what may be left of all forces
FLEXIBLE = 0.1  # mesh error from which a load is doubtful
BELOW = 0.01  # of the static model's load: limit analysis that is lower by more
KEPT = {"yes": "verified", "no": "NOT verified", "open": "OPEN"}
KINDS = {Kind.INNER: "bonded", Kind.DRY: "dry", Kind.LOCKED: "condensed locks"}
OF_CASES = "case", "to first failure", "to peak", "to limit", "decides"
Cells = tuple[object, ...]


@dataclass(frozen=True, eq=False)
class Views:
    """What is drawn of a structure: its ``title``, ``answer`` in words, ``notes``, and ``models``.

    ``models``: the one that answers first; ``shape``: by `shape_of`; ``given``: the loads as in the
    structure's file; ``curve``: of the factor over the positions of a vehicle, as SVG, or nothing.
    """

    title: str
    demand: Demand
    verdict: Verdict | None
    answer: str
    notes: Sequence[str]
    models: Sequence[Drawn]
    shape: Mapping[str, Any]
    given: Sequence[tuple[str, str]]
    curve: str

    @classmethod
    def of(
        cls,
        file: Path,
        description: Any,
        solved: Solved,
        notes: Sequence[str],
        verdict: str = "",
        curve: "Figure | None" = None,
    ) -> "Views":
        """From what the models answer; ``verdict``: on a load to be carried, if there is one."""
        problem, static = solved.demand.problem, solved.static
        raised, weight = problem.loads.raised, free_weight(problem.assembly)
        models = [_drawn("static", problem, static), _drawn("limit", problem, solved.limit)]
        if isinstance(static, StaticAnswer):
            at = raised.beside(static.load, weight)
            answer = f"{raised.last} at {at}; failure mode: {static.mode}"
            if not static.counts.peak:
                answer = f"first bond failure at {at}; {static.counts}"
            elif static.counts.dry:
                counts = static.counts
                answer = f"{counts.name} at {at}, as {counts.why}; failure mode: {static.mode}"
        else:
            models.reverse()
            answer = f"static model: {reason(static)}"
            load = models[0].load
            if load is not None and not isinstance(static, NoEquilibriumError):
                answer = f"limit analysis: {raised.beside(load, weight)}; {answer}"
        shape = shape_of(problem.assembly, with_condensed_locks(description, file.parent))
        words = " ".join(f"{each[0].upper()}{each[1:]}." for each in (verdict, answer) if each)
        return cls(
            title=file.stem,
            demand=solved.demand,
            verdict=solved.verdict,
            answer=in_asked_words(words),
            notes=notes,
            models=models,
            shape=shape,
            given=_given(description),
            curve="" if curve is None else drawn_svg(curve),
        )

    @property
    def problem(self) -> Problem:
        """The structure and its loads."""
        return self.demand.problem

    @property
    def about(self) -> str:
        """What the structure is, and its load."""
        assembly = self.problem.assembly
        free = sum(not piece.fixed for piece in assembly.pieces)
        many = f"{free:,} free and {number_of(len(assembly.pieces) - free, 'fixed block')}"
        weight = f"weight of the free blocks {four_digits(free_weight(assembly))} N"
        load = load_of(self.problem)
        faces = number_of(len(assembly.faces), "interface")
        return in_asked_words(f"{many}, {faces}; {weight}. {load}.")

    def content(self, rows: Sequence[Row], command: str) -> tuple[dict[str, Any], dict[str, Any]]:
        """Data and words of `page`; ``rows``: the table that is printed by ``command``."""
        structure = {
            "title": self.title,
            "shape": self.shape,
            "loads": arrows_of(*self.problem),
            "models": [{"name": MODELS[each.model].label, **each.values()} for each in self.models],
        }
        words = page_words(self.answer, self.about, self.notes, rows)
        more = {"title": self.title, "command": command, "curve": self.curve}
        return {"structures": [structure]}, {**words, **more}


def page_words(
    answer: str, about: str, notes: Sequence[str], rows: Sequence[Row]
) -> dict[str, Any]:
    """What a page says in words; ``rows``: the table that is printed."""
    shown = in_asked_units(rows)
    cells = [
        [{"text": cell(each), "number": isinstance(each, int | float)} for each in row.values()]
        for row in shown
    ]
    return {
        "answer": answer,
        "about": about,
        "notes": notes,
        "head": list(shown[0]),
        "rows": cells,
    }


def _given(description: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Names of the loads of a ``description``, and each as it stands there, in YAML."""
    loads = [("permanent", each) for each in description.get("permanent", ())]
    loads += [("load", description["load"])] if "load" in description else []
    loads += description.get("load_cases", {}).items()

    def in_a_line(load: Any) -> str:
        return yaml.safe_dump(load, sort_keys=False, default_flow_style=True, width=math.inf)

    return [(name, in_a_line(load).strip()[1:-1]) for name, load in loads]


def _drawn(model: str, problem: Problem, found: Static | Limit) -> Drawn:
    if isinstance(found, CapacityError):
        return Drawn(model, problem, error=reason(found))
    of: Any = structure_static if model == "static" else structure_limit
    return Drawn(model, problem, of.outcome_of(problem, found))


def structure_note(views: Views, rows: Sequence[Row], command: str, inputs: Sequence[Path]) -> str:
    """The note in HTML; ``rows``: the table that is printed; ``command``: what it was made by.

    ``inputs``: files that are appended.
    """
    from sidmacib.scene.picture import picture

    drawn, assembly = views.models[0], views.problem.assembly
    forces_of = "no model has an answer"
    if drawn.load is not None:
        forces_of = f"{MODELS[drawn.model].label}; {in_asked_words(drawn.load_words)}"
    failing = [f"{name} ({four_digits(load)} {drawn.raised.unit})" for name, load in drawn.failing]
    asked, laws = in_asked_units(rows), [*_laws(assembly.faces)]
    if "case" in rows[0]:  # what stands in the checks would make the table too wide for a page
        asked = [{name: row[name] for name in OF_CASES} for row in asked]
    return rendered(
        TEMPLATE,
        title=f"Calculation note: structure {views.title}",
        views=views,
        drawn=drawn,
        curve=views.curve,
        drawing=drawn_svg(picture(drawn, views.shape, "", WIDTH)),
        blocks=[*_blocks(assembly.pieces[:MOST_ROWS])],
        more_blocks=len(assembly.pieces) - MOST_ROWS,
        laws=laws,
        kinds={kind for kind, *_ in laws},
        head=asked[0],
        rows=[map(cell, row.values()) for row in asked],
        failing=in_asked_words(some_of(failing, MOST_ROWS)),
        forces_of=forces_of,
        reactions=[*_reactions(drawn)],
        used=_used(drawn),
        checks=[*_checks(views, rows)],
        crushed=bool(crushed_faces(assembly)),
        load=in_asked_words(load_of(views.problem)),
        command=command,
        inputs=[*map(Appended.of, inputs)],
    )


def drawn_svg(figure: "Figure") -> str:
    """The element of a ``figure`` for a page."""
    svg = io.StringIO()
    write_figure(figure, svg)
    return svg.getvalue()[svg.getvalue().index("<svg") :]


def _blocks(pieces: Iterable[Piece]) -> Iterator[Cells]:
    for piece in pieces:
        corners = np.concatenate([solid.places for solid in solids_of(piece)])
        sides = " x ".join(f"{side:.4g}" for side in np.ptp(corners, axis=0))
        held = "fixed" if piece.fixed else cell(piece.weight)
        middle = ", ".join(f"{each + 0.0:.4g}" for each in np.round(piece.centre, 9))
        yield piece.name, sides, middle, held


def _laws(faces: Iterable[Face]) -> Iterator[Cells]:
    """Each law with the number and the area of its interfaces."""
    areas: dict[tuple[Kind, FaceMaterial, float | None], list[float]] = {}
    for face in faces:
        areas.setdefault((face.kind, face.material, strength_of(face)), []).append(face.area)
    for (kind, law, strength), own in areas.items():
        yield (
            KINDS[kind],
            len(own),
            four_digits(sum(own)),
            f"{law.friction:.4g}",
            f"{law.cohesion / 1e3:.4g}",
            f"{law.tensile_strength / 1e3:.4g}",
            "-" if strength is None else f"{strength / 1e6:.4g}",
            f"{law.normal_stiffness / 1e9:.4g}, {law.shear_stiffness / 1e9:.4g}",
        )


def _reactions(drawn: Drawn) -> Iterator[Cells]:
    """Reactions, and their sum; none of a model without forces."""
    if not drawn.reactions:
        return
    least = 1e-6 * max(float(np.linalg.norm(each.force)) for each in drawn.reactions)

    def cells(force: Vector) -> list[str]:
        return [cell(value if abs(value) > least else 0.0) for value in force]

    for each in drawn.reactions[:MOST_ROWS]:
        at = ", ".join(f"{round(x, 6) + 0.0:.4g}" for x in each.at) if each.at else "-"
        yield each.support, *cells(each.force), at
    yield f"all {len(drawn.reactions)}", *cells(total(drawn.reactions)), ""


def _used(drawn: Drawn) -> list[Cells]:
    """The interfaces that are used most."""
    found = [row for row in drawn.interfaces if row.utilisation is not None]
    found.sort(key=lambda row: -(row.utilisation or 0.0))
    return [
        (
            row.interface,
            cell(row.normal_N),
            cell(row.shear_N),
            "-" if row.eccentricity is None else f"{row.eccentricity:.3f}",
            f"{row.utilisation:.3f}",
            row.mode,
        )
        for row in found[:MOST_ROWS]
    ]


def _checks(views: Views, rows: Sequence[Row]) -> Iterator[Cells]:
    """Each check: what, the formula with numbers, the result, and whether it is kept."""
    yield from _design_values(views.demand)
    yield from _verdicts(views, rows)
    drawn = views.models[0]
    if drawn.outcome is not None and drawn.reactions:
        loads = views.problem.loads.at(drawn.outcome.state.load)
        acting = loads[[not piece.fixed for piece in drawn.assembly.pieces], :3].sum(axis=0)
        left = float(np.linalg.norm(acting + np.array(total(drawn.reactions))))
        size = float(np.abs(loads[:, :3]).sum())
        kept = "verified" if left <= BALANCED * size else "NOT verified"
        balance = _formula(
            f"|Σ<i>R</i> + Σ<i>F</i>| / Σ|<i>F</i>| = {left:.2g} N / {four_digits(size)} N"
        )
        yield (
            "Reactions balance the loads",
            balance,
            f"{left / size:.1e}",
            f"≤ {BALANCED:g}: {kept}",
        )
    raised = drawn.raised
    for row in (row for row in rows if row.get("governs", "yes")):
        if (error := row.get(f"mesh error / {raised.name}")) is not None:
            kept = "small" if error <= FLEXIBLE else "LARGE"
            told = f"{100.0 * error:.2g} % of the {raised.name}"
            name = f"Mesh error, {row.get('model') or row['case']}"
            yield name, f"error / {raised.name}", told, f"≤ {100.0 * FLEXIBLE:g} %: {kept}"
    found_by = {each.model: each.load for each in views.models}
    one, other = found_by.get("static"), found_by.get("limit")
    if one and other:
        kept = "verified" if other >= one * (1.0 - BELOW) else "NOT verified"
        ratio = _formula(
            f"<i>F</i><sub>limit</sub> / <i>F</i><sub>static</sub> = "
            f"{raised.told(other)} / {raised.told(one)}"
        )
        yield "Limit analysis, static model", ratio, f"{other / one:.3f}", f"≥ 1: {kept}"
    for note in views.notes:
        yield "Input", note, "", "see the file"


def _design_values(demand: Demand) -> Iterator[Cells]:
    """Where partial factors come in."""
    if not (factors := demand.factors):
        return
    assert demand.newtons is not None
    loads = demand.problem.loads
    beside = beside_of(loads).size
    of_actions = (
        ("Weight", "G", factors.gamma_g, loads.scale - beside),
        ("Load to be carried", "Q", factors.gamma_q, demand.newtons),
    )
    for name, symbol, factor, size in of_actions:
        words = (
            f"{symbol}</i><sub>d</sub> = &gamma;<sub>{symbol}</sub> <i>{symbol}</i><sub>k</sub> = "
        )
        numbers = f"{factor:g} · {four_digits(size / factor)} N"
        yield name, _formula(f"<i>{words}{numbers}"), in_asked_words(f"{four_digits(size)} N"), ""
    if beside:
        words = "&Sigma; &gamma;<sub>G</sub> |<i>G</i><sub>k</sub>|, by a load's own gamma_g if any"
        yield (
            "Other permanent loads",
            Formula(words),
            in_asked_words(f"{four_digits(beside)} N"),
            "",
        )
    divided = "<i>X</i><sub>d</sub> = <i>X</i><sub>k</sub> / &gamma;<sub>M</sub> = "
    of_laws = _formula(f"{divided}<i>X</i><sub>k</sub> / {factors.gamma_m:g}")
    yield "Friction and strengths", of_laws, "laws in section 1", ""


def _verdicts(views: Views, rows: Sequence[Row]) -> Iterator[Cells]:
    """What is carried over what is to be carried: of each load case, or of the only load."""
    found = [
        (row["case"], row["required (N)"], row["factor"], KEPT[row["carried"]])
        for row in rows
        if "case" in row
    ]
    if not found and (one := views.verdict):
        found = [(f"Load carried: {one.decides}", one.newtons, one.factor, KEPT[one.said.lower()])]
    for name, newtons, factor, kept in found:
        formula, result = Formula("-"), "-"
        if factor is not None:
            carried = f"{four_digits(factor * newtons)} N / {four_digits(newtons)} N"
            formula = _formula(f"<i>F</i><sub>R</sub> / <i>F</i><sub>E</sub> = {carried}")
            result = factor_of(factor)
        yield name, formula, result, f"≥ 1: {kept}"


def _formula(text: str) -> Formula:
    """With its numbers in the units that were asked for."""
    return Formula(in_asked_words(text))
