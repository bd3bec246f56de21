"""A calculation note of a structure, in HTML like that of a joint."""

import io
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from html import escape
from importlib.metadata import version
from pathlib import Path
from string import Template

import matplotlib as mpl
import numpy as np

from sidmacib.command.answers import Row
from sidmacib.command.note import TEMPLATE, signatures, table
from sidmacib.command.output import cell, in_asked_units, in_asked_words, write_text
from sidmacib.command.structure_views import Views
from sidmacib.mechanics.assembly import Face, FaceMaterial, Kind
from sidmacib.mechanics.crushing import crushed_faces, strength_of
from sidmacib.scene.drawn import Drawn
from sidmacib.scene.loads import load_of
from sidmacib.scene.picture import picture
from sidmacib.scene.sections import total
from sidmacib.structure.blocks import solids_of

MOST_ROWS = 8  # of a table of blocks, reactions or interfaces, for two pages
WIDTH = 5.0  # inches, of the picture
BALANCED = 1e-3  # of the loads: what may be left of all forces
FLEXIBLE = 0.2  # mesh error from which a load is doubtful
KINDS = {Kind.INNER: "bonded", Kind.DRY: "dry", Kind.LOCKED: "condensed locks"}


def write_note(views: Views, rows: Sequence[Row], path: Path, command: str) -> None:
    """Write the note into a file; ``rows``: the table that is printed; `click.UsageError`."""
    write_text(structure_note(views, rows, command), path, "--note")


def structure_note(views: Views, rows: Sequence[Row], command: str) -> str:
    """The note in HTML; ``command``: what it was made by."""
    title = f"Calculation note: structure {escape(views.title)}"
    drawn = views.models[0]
    parts = (
        f"<h1>{title}</h1>",
        signatures(),
        f'<p class="verdict">{escape(views.answer)}</p>',
        "<h2>1 Structure and load</h2>",
        _drawing(views),
        f"<p>{escape(views.about)} Weight acts as well.</p>",
        *_blocks(views),
        "<p>Laws of the interfaces:</p>",
        _laws(drawn.assembly.faces),
        "<h2>2 Answer</h2>",
        *_answer(views, rows),
        f"<h2>3 Reactions and interfaces ({escape(_what(drawn))})</h2>",
        *_reactions(drawn),
        *_interfaces(drawn),
        "<h2>4 Checks</h2>",
        _checks(views, rows),
        "<h2>5 Assumptions</h2>",
        _assumptions(views),
        f'<p class="small">multilock {version("multilock")}; <code>{escape(command)}</code></p>',
    )
    return Template(TEMPLATE.read_text()).substitute(title=title, body="\n".join(parts))


def _drawing(views: Views) -> str:
    """The picture as SVG, the same for the same input."""
    stream = io.StringIO()
    with mpl.rc_context({"svg.hashsalt": "multilock"}):
        figure = picture(views.models[0], views.shape, "", WIDTH)
        figure.savefig(stream, format="svg", metadata={"Date": None})
    text = stream.getvalue()
    return text[text.index("<svg") :]


def _blocks(views: Views) -> Iterator[str]:
    pieces = views.problem.assembly.pieces
    rows = []
    for piece in pieces[:MOST_ROWS]:
        corners = np.concatenate([solid.places for solid in solids_of(piece)])
        sides = " x ".join(f"{side:.4g}" for side in np.ptp(corners, axis=0))
        held = "fixed" if piece.fixed else cell(piece.weight)
        middle = ", ".join(f"{each + 0.0:.4g}" for each in np.round(piece.centre, 9))
        rows.append((escape(piece.name), sides, middle, held))
    head = ("block", "box around it (m)", "centroid x, y, z (m)", "weight (N)")
    yield table(head, rows, numeric=True)
    if len(pieces) > MOST_ROWS:
        yield f"<p>And {len(pieces) - MOST_ROWS} others, as in the file.</p>"


def _laws(faces: Iterable[Face]) -> str:
    """Each law with the number and the area of its interfaces."""
    count: Counter[tuple[Kind, FaceMaterial, float | None]] = Counter()
    area: dict[tuple[Kind, FaceMaterial, float | None], float] = {}
    for face in faces:
        key = face.kind, face.material, strength_of(face)
        count[key] += 1
        area[key] = area.get(key, 0.0) + face.area
    rows = [
        (
            KINDS.get(kind, str(kind)),
            str(number),
            f"{area[kind, law, strength]:.4g}",
            f"{law.friction:.4g}",
            f"{law.cohesion / 1e3:.4g}",
            f"{law.tensile_strength / 1e3:.4g}",
            "-" if strength is None else f"{strength / 1e6:.4g}",
            f"{law.normal_stiffness / 1e9:.4g}, {law.shear_stiffness / 1e9:.4g}",
        )
        for (kind, law, strength), number in count.items()
    ]
    head = (
        *("kind", "number", "area (m²)", "friction", "cohesion (kPa)", "tension (kPa)"),
        "crushing (MPa)",
        "stiffness normal, shear (GPa/m)",
    )
    return table(head, rows, numeric=True)


def _answer(views: Views, rows: Sequence[Row]) -> Iterator[str]:
    asked = in_asked_units(rows)
    shown = [tuple(escape(cell(value)) for value in row.values()) for row in asked]
    yield table([escape(name) for name in asked[0]], shown)
    drawn = views.models[0]
    order = drawn.failing
    if order:
        unit = "N" if views.problem.loads.axis is None else "degrees"
        told = ", ".join(f"{name} ({load:.4g} {unit})" for name, load in order[:MOST_ROWS])
        more = f" and {len(order) - MOST_ROWS} others" if len(order) > MOST_ROWS else ""
        yield f"<p>Order in which bonds fail: {escape(in_asked_words(told))}{more}.</p>"


def _what(drawn: Drawn) -> str:
    """Model and load of the forces that follow."""
    if drawn.load is None:
        return "no model has an answer"
    name = {"static": "static model", "limit": "limit analysis"}[drawn.model]
    return f"{name}; {in_asked_words(drawn.load_words)}"


def _reactions(drawn: Drawn) -> Iterator[str]:
    if not drawn.reactions:
        yield "<p>This model gives no forces.</p>"
        return
    least = 1e-6 * max(float(np.linalg.norm(each.force)) for each in drawn.reactions)
    rows = []
    for each in drawn.reactions[:MOST_ROWS]:
        forces = (_number(value, least) for value in each.force)
        at = ", ".join(f"{round(x, 6) + 0.0:.4g}" for x in each.at) if each.at else "-"
        rows.append((escape(each.support), *forces, at))
    forces = (_number(value, least) for value in total(drawn.reactions))
    rows.append((f"all {len(drawn.reactions)}", *forces, ""))
    yield table(
        ("support", "Rx (N)", "Ry (N)", "Rz (N)", "acts at x, y, z (m)"), rows, numeric=True
    )


def _number(value: float, least: float) -> str:
    return cell(value if abs(value) > least else 0.0)


def _interfaces(drawn: Drawn) -> Iterator[str]:
    """Those that are used most."""
    found = [row for row in drawn.interfaces if row.utilisation is not None]
    if not found:
        return
    found.sort(key=lambda row: -(row.utilisation or 0.0))
    rows = [
        (
            escape(row.interface),
            cell(row.normal_N),
            cell(row.shear_N),
            "-" if row.eccentricity is None else f"{row.eccentricity:.3f}",
            f"{row.utilisation:.3f}",
        )
        for row in found[:MOST_ROWS]
    ]
    yield f"<p>Interfaces used most, {len(rows)} of {len(drawn.interfaces)}:</p>"
    head = ("interface", "compression (N)", "shear (N)", "eccentricity", "utilisation")
    yield table(head, rows, numeric=True)
    yield (
        '<p class="small">Eccentricity: over the distance to the edge, 1 in a hinge. '
        "Utilisation: of bonds the highest at a node; of dry faces friction or eccentricity.</p>"
    )


def _checks(views: Views, rows: Sequence[Row]) -> str:
    drawn = views.models[0]
    found = []
    if drawn.outcome is not None and drawn.reactions:
        loads = views.problem.loads.at(drawn.outcome.state.load)
        acting = loads[[not piece.fixed for piece in drawn.assembly.pieces], :3].sum(axis=0)
        left = float(np.linalg.norm(acting + np.array(total(drawn.reactions))))
        size = float(np.abs(loads[:, :3]).sum())
        kept = "verified" if left <= BALANCED * size else "NOT verified"
        found.append(
            ("Reactions balance the loads", f"{left / size:.1e} of the loads is left", kept)
        )
    for row in rows:
        error = next((value for key, value in row.items() if key.startswith("mesh error")), None)
        if error is not None:
            result = "small" if error <= FLEXIBLE else "LARGE"
            told = f"{100.0 * error:.2g} % of the load"
            found.append((f"Mesh error, {escape(str(row['model']))}", told, result))
    found_by = {each.model: each.load for each in views.models}
    one, other = found_by.get("static"), found_by.get("limit")
    if one and other:
        kept = "above" if other >= one * (1.0 - FLEXIBLE) else "BELOW"
        told = f"{other:.4g} / {one:.4g} = {other / one:.3f}"
        found.append(("Limit analysis over static model", told, kept))
    for note in views.notes:
        found.append(("Geometry", escape(note), "see the file"))
    return table(("check", "found", "result"), found)


def _assumptions(views: Views) -> str:
    faces = views.problem.assembly.faces
    lines = [
        "Blocks are rigid and do not break; they touch in the interfaces only, with Coulomb "
        "friction and, where they are not bonded, without tension.",
        "Where they are pressed they are crushed at the compressive strength of the interface, "
        "with a rectangular stress block."
        if crushed_faces(views.problem.assembly)
        else "They are not crushed.",
        in_asked_words(f"Weight acts first and stays. {load_of(views.problem)}."),
    ]
    if any(face.kind is Kind.INNER for face in faces):
        lines.append(
            "Bonds are brittle in the static model, which counts the first failure unless meshes "
            "agree on the peak, and ductile in limit analysis. Strengths are taken as design "
            "values; their scatter is not covered by this note."
        )
    if any(face.kind is Kind.LOCKED for face in faces):
        lines.append("Locks are condensed to contact points of an interface.")
    lines += [
        "Displacements are small. Supports do not move. Fatigue, creep, impact, moisture and fire "
        "are not covered.",
        "No partial factors are applied. No laboratory test has validated the models.",
    ]
    return "<ul>" + "".join(f"<li>{escape(line)}</li>" for line in lines) + "</ul>"
