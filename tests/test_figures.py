"""Figures: which there are, and the geometry that they draw."""

import re
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pandas as pd
import pytest
from conftest import ROOT
from joints import sawn
from made_up_results import record_with, tables_of
from small import BOTH, TWO_MESHES

from analysis.drawing import PICTURE, sketch
from analysis.figures import figures_of
from analysis.figures.draw import DRAWN_BY, run
from analysis.figures.joint import cell_edges
from analysis.figures.style import caption, of_model, words_only
from analysis.tables.capacity import envelope_rows
from analysis.tables.collect import models_table, weight_sums, weights_table
from analysis.tables.comparisons import variants_table
from sidmacib import NodeLayout
from sidmacib.engines import ENGINES
from sidmacib.joint.pieces import assemble, lock_faces
from sidmacib.models import LAWS
from workflow.case import JointCase
from workflow.cases import cases_of
from workflow.configuration import read_study, read_study_file
from workflow.results import record_without_result
from workflow.results.tables import write_tables


def test_every_figure_of_the_paper_that_can_be_redrawn_is_there() -> None:
    study = read_study_file(ROOT / "config.yaml")
    figures = figures_of(study)
    kinds = ("joint", "options", "shear_stress", "torsion_stress", "revised", "models")
    samples = ("n3", "n5", "n3_fits", "n5_fits")
    per_sample = {f"{kind}-{sample}" for kind in kinds for sample in samples}
    of_liggghts = {f"{kind}-{sample}-liggghts" for kind in kinds[2:4] for sample in samples}
    assert set(figures) == per_sample | of_liggghts | {"meshes", "side_by_side"}
    variants = {"stiffness", "fracture_energy"}
    assert {spec.kind for spec in figures.values()} == set(DRAWN_BY) - variants


def test_a_caption_lies_within_its_figure() -> None:
    figure = words_only("nothing")
    caption(figure, "A caption.")
    assert all(0.0 < share < 0.5 for share in figure.texts[-1].get_position())


def test_stress_maps_show_pure_shear_and_torsion_with_shear_at_the_finest_mesh() -> None:
    study = read_study({"samples": {"n3": {"locks": 3}}})
    figures = figures_of(study)
    assert figures["shear_stress-n3"].case.name == "n3-mesh0.005-e0a"
    assert figures["torsion_stress-n3"].case.name == "n3-mesh0.005-e0.5a"


def test_what_runs_a_part_of_a_sample_leads_no_figure_and_shows_what_it_has() -> None:
    only = {"yade": {"eccentricities": [0]}, "liggghts": {"meshes": [0.02]}}
    sample = {"locks": 3, "only": only}
    study = read_study({"samples": {"n3": sample}, "dem": {"engines": [*only]}})
    figures = figures_of(study)
    assert figures["shear_stress-n3"].case.model == "static"
    assert figures["torsion_stress-n3-yade"].case.name == "n3-mesh0.005-e0a"
    assert "shear_stress-n3-liggghts" not in figures


def test_a_sweep_over_many_samples_has_figures_of_the_first_ones_only() -> None:
    study = read_study({"samples": {f"n{n}": {"locks": 3} for n in range(40)}})
    drawn = {spec.sample for spec in figures_of(study).values()}
    assert drawn == {None, *(f"n{n}" for n in range(12))}


@pytest.mark.parametrize("layout", NodeLayout)
def test_the_cells_of_a_stress_map_fill_the_face(layout: NodeLayout) -> None:
    model, locks = assemble(sawn(3), 0.005, layout), lock_faces(sawn(3))
    number = next(k for k, face in enumerate(model.faces) if locks.get(face.name) == 1)
    face, places = model.faces[number], model.nodes.position[model.nodes.face == number]
    for axis in (0, 1):
        edges = cell_edges(np.unique(places[:, axis].round(12)), face.low[axis], face.high[axis])
        assert (np.diff(edges) > 0.0).all()
        assert (edges[0], edges[-1]) == (face.low[axis], face.high[axis])


# --- cases without a result ----------------------------------------------------------------------
TOUGH = {"failure": "softening", "fracture_energy": 10.0}
MORE = {"models": ["static", "limit"], "variants": {"stiff": {"young": 1e9}, "tough": TOUGH}}
STUDY = TWO_MESHES | BOTH | MORE


WITHOUT: dict[str, Callable[[JointCase], bool]] = {
    "the finest mesh": lambda case: case.model == "static" and case.subject.mesh == 0.01,
    "pure shear": lambda case: case.subject.direction.eccentricity == 0.0,
    "everything": lambda case: True,
}


@pytest.mark.study
@pytest.mark.parametrize("without", WITHOUT)
def test_every_figure_is_drawn_without_the_results_of(without: str, tmp_path: Path) -> None:
    study, fails = read_study(STUDY), WITHOUT[without]
    cases = [case for case in cases_of(study).values() if case.model not in LAWS]
    records = [
        record_without_result(case, error="no result") if fails(case) else record_with(case, 0.5)
        for case in cases
    ]
    tables = tables_of(study, records) | {"models": models_table(records)}
    tables["envelopes"] = pd.DataFrame(envelope_rows(study))
    sums = weight_sums(weights_table(records))
    tables["variants"] = variants_table(study, tables["capacity"], sums)
    read = ("capacity", "validation", "models", "envelopes", "variants")
    inputs = {name: tmp_path / f"{name}.csv" for name in read}
    write_tables({name: tables[name] for name in read}, inputs)
    part = study.part("variants", "figures", "measured")
    names = figures_of(study)
    figures = [tmp_path / f"{n}.png" for n in names if not n.startswith(("joint", "options"))]
    run({"study": part}, inputs, {"figures": figures})
    drawn = {path.stem for path in figures if path.exists()}
    assert {"meshes", "models-n3", "side_by_side", "stiffness", "fracture_energy"} <= drawn


def test_a_model_has_the_same_look_whichever_models_have_results() -> None:
    looks = {model: of_model(model) for model in ("static", "limit", *ENGINES, "3dec")}
    assert [look["linestyle"] for look in looks.values()][:2] == ["-", "--"]
    assert len({str(sorted(look.items())) for look in looks.values()}) == len(looks)
    assert {looks[name]["linestyle"] for name in (*ENGINES, "3dec")} == {"none"}


# --- the sketch of a joint ------------------------------------------------------------------------
SVG = "{http://www.w3.org/2000/svg}"


def test_the_picture_of_the_readme_is_the_sketch_of_the_published_joint() -> None:
    assert PICTURE.read_text() == sketch(sawn(5))


@pytest.mark.parametrize("locks", [2, 5])
def test_every_lock_has_its_number_and_every_piece_three_faces(locks: int) -> None:
    root = ElementTree.fromstring(sketch(sawn(locks)))
    words = [each.text for each in root.iter(f"{SVG}text")]
    assert sorted(words) == sorted([*map(str, range(1, locks + 1)), "V", "M = V e"])
    faces = [each for each in root.iter(f"{SVG}polygon") if each.get("stroke")]
    assert len(faces) == 3 * (1 + 2 * locks)  # lower body, and a lock and a column for each


def test_all_that_is_drawn_is_within_the_frame() -> None:
    root = ElementTree.fromstring(sketch(sawn(3, a=0.1, H=0.2)))
    left, top, width, height = map(float, str(root.get("viewBox")).split())
    for shape in (*root.iter(f"{SVG}polygon"), *root.iter(f"{SVG}polyline")):
        for u, v in re.findall(r"([-\d.]+),([-\d.]+)", str(shape.get("points"))):
            assert left <= float(u) <= left + width and top <= float(v) <= top + height
