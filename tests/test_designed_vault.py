"""The vault of `studies/designed_vault`, and what is designed of a small one."""

import json
from pathlib import Path

import pytest
import yaml
from command_runner import run

from sidmacib.design.blocking import order_of
from sidmacib.design.direction import RowSearch, choice_of
from sidmacib.design.file import read_task, write_designed
from sidmacib.design.sizing import carried
from sidmacib.mechanics.polygons import Polygon
from sidmacib.structure.files.compas import read_compas
from sidmacib.structure.files.structure_file import read_structure
from studies.designed_vault.all_layouts import GAP, compared
from studies.designed_vault.geometry import FILE, Barrel, barrel, content, text


def test_the_file_is_what_the_geometry_writes_and_has_110_free_blocks() -> None:
    assert FILE.read_text() == text(Barrel())
    blocks = read_compas(FILE, 1.0)
    assert sum(not block.fixed for block in blocks) == 110
    assert {block.density for block in blocks} == {2000.0}


def test_its_task_has_a_site_in_every_interface() -> None:
    task = read_task(FILE)
    assert len(task.structure.sites) == len(task.structure.assembly.faces) == 305
    assert all(site.layouts for site in task.structure.sites)


def test_a_small_vault_goes_from_a_compas_file_to_a_structure_with_locks(tmp_path: Path) -> None:
    path = tmp_path / "vault.json"
    path.write_text(json.dumps(content(barrel(Barrel(courses=5, blocks=2)))))
    design = yaml.safe_load(FILE.with_suffix(".yaml").read_text())
    design["design"]["gap"] = 0.2
    path.with_suffix(".yaml").write_text(yaml.safe_dump(design))
    task = read_task(path)
    structure = task.structure
    choice = choice_of(structure, RowSearch(structure, 1.0).cheapest(gap=0.5).parts)
    assert all(state.factor >= 1.0 - 1e-5 for state in carried(structure, choice))
    assert order_of(structure.assembly, structure.sites, choice).stuck == ()
    (tmp_path / "out").mkdir()
    write_designed(task, choice, tmp_path / "out" / "designed.yaml")
    found = read_structure(tmp_path / "out" / "designed.yaml").assembly
    locks = sum(len(row.widths) for row in choice if row)
    assert len(found.pieces) == len(structure.assembly.pieces) + locks
    assert all(isinstance(face, Polygon) for face in found.faces)
    head = (tmp_path / "out" / "designed.yaml").read_text().splitlines()[:3]
    cases = yaml.safe_load("".join(line.removeprefix("#   ") + "\n" for line in head[1:]))
    assert cases == design["design"]["cases"]
    loads = {name: case["acceleration"] for name, case in cases.items()}
    for file, case in (("designed", "along_x"), ("designed-along_y", "along_y")):
        written = yaml.safe_load((tmp_path / "out" / f"{file}.yaml").read_text())
        assert written["load"] == {"acceleration": loads[case]}


def test_the_designed_stack_is_what_the_command_writes(tmp_path: Path) -> None:
    folder, written = FILE.parent, tmp_path / "designed.yaml"
    found = run("design", str(folder / "stack.yaml"), "--quiet", "--output", str(written))
    assert found.exit_code == 0
    assert written.read_text() == (folder / "designed_stack.yaml").read_text()


def test_compas_dem_reads_the_file() -> None:
    compas = pytest.importorskip("compas")
    pytest.importorskip("compas_dem")
    model = compas.json_load(FILE)
    assert len(list(model.elements())) == 112
    assert len(list(model.supports())) == 2
    assert {block.material.density for block in model.elements()} == {2000.0}


def test_a_search_in_place_of_trying_all_layouts_costs_the_same() -> None:
    both = compared(1)
    assert both.layouts == 13**2
    assert both.found_cost == both.least_cost > 0.0
    assert both.bound <= both.found_cost <= both.bound * (1.0 + GAP)
