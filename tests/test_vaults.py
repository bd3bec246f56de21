"""The studies of structures: vaults, programmes against theory, samples, and pages."""

import json
import math
from collections import Counter
from itertools import pairwise, product
from pathlib import Path

import pytest
import yaml
from command_runner import run
from structures import (
    BLOCK,
    GROUND,
    LEANING,
    degrees,
    dry,
    notch,
    on_ground,
    read_flat_vault,
    read_structure,
    row_of_cubes,
    study,
)

from sidmacib import limit_load, static_peak
from sidmacib.design import LockKindSection, WeightsSection, directions_of, layouts_of
from sidmacib.design.blocking import order_of
from sidmacib.design.direction import RowSearch, choice_of
from sidmacib.design.file import read_task, write_designed
from sidmacib.design.model import DesignProblem, LoadCase, Site
from sidmacib.design.sizing import carried
from sidmacib.mechanics.assembly import Assembly, NodeLayout, Vector
from sidmacib.mechanics.loads import Loads
from sidmacib.mechanics.polygons import Polygon
from sidmacib.structure.analysis.limit import limit_tilt
from sidmacib.structure.analysis.tilt import static_tilt, tilting
from sidmacib.structure.blocks import Block, box, prism
from sidmacib.structure.files.compas import read_compas
from sidmacib.structure.files.structure_file import structure_of
from sidmacib.structure.loads import force_at, free_weight
from sidmacib.structure.structure import structure
from studies.structures.compare import PUBLISHED, TYPES
from studies.structures.other_methods import pyramid_tilt, relaxed_tilt
from studies.structures.shapes import ABOUT_Y, AXES, HELD, answers, arch, pushed_walls

SIDE, THICKNESS, LEAN = 0.3, 0.15, 0.4  # of flat vaults: m, m, tangent of the sides' lean
EDGE = 0.4  # m, of cubes
GAP = 1e-4
FILE = Path(__file__).parents[1] / "studies/designed_vault/vault.json"


def test_each_block_is_a_truncated_tetrahedron_that_touches_four_others() -> None:
    assembly = read_flat_vault(5).assembly
    blocks = {piece.name: piece for piece in assembly.pieces if piece.name.startswith("block")}
    assert len(blocks) == 25
    for block in blocks.values():
        assert isinstance(block, Block)
        assert block.reentrant is None
        # The integral over its height of (a + 2 z tan) (a - 2 z tan).
        volume = SIDE**2 * THICKNESS - 4 * LEAN**2 * THICKNESS**3 / 3
        assert block.volume == pytest.approx(volume, rel=1e-6)
    ends = Counter(end for face in assembly.faces for end in (face.below, face.above))
    assert {ends[k] for k, each in enumerate(assembly.pieces) if each.name in blocks} == {4}


@pytest.mark.long
def test_the_vault_carries_more_the_rougher_its_joints_and_opens_as_it_slides() -> None:
    problem = read_flat_vault(3)
    weight = free_weight(problem.assembly)
    static, limit = static_peak(*problem).peak.load, limit_load(*problem, friction=True).load
    # By the last digits 0.3622 or 0.3624: friction remembers the way.
    assert static / weight == pytest.approx(0.3623, abs=5e-4)
    assert static < limit == pytest.approx(0.3930 * weight, abs=5e-4 * weight)
    rough = structure_of(study("flat_vault/vault3", friction=0.8))
    assert limit_load(*rough, friction=True).load > 2 * limit


@pytest.mark.long
def test_the_barrel_has_110_free_blocks_and_its_task_a_site_in_every_interface() -> None:
    blocks = read_compas(FILE, 1.0)
    assert sum(not block.fixed for block in blocks) == 110
    assert {block.density for block in blocks} == {2000.0}
    task = read_task(FILE)
    assert len(task.structure.sites) == len(task.structure.assembly.faces) == 305
    assert all(site.layouts for site in task.structure.sites)


def small_barrel() -> list[Block]:
    """Five courses of two blocks in running bond, on springers."""

    def at(r: float, angle: float, y: float) -> Vector:
        return r * math.cos(angle), y, r * math.sin(angle)

    found = []
    for near, far in ((2.25, 2.75), (-2.75, -2.25)):
        base = [(near, 0.0, 0.0), (far, 0.0, 0.0), (far, 0.0, -0.5), (near, 0.0, -0.5)]
        found.append(prism(f"springer{len(found)}", base, (0.0, 1.2, 0.0), 2e3, fixed=True))
    for course in range(5):
        p, q = (math.pi * (course + k) / 5 for k in (0, 1))
        for start, end in pairwise((0.0, 0.3, 0.9, 1.2) if course % 2 else (0.0, 0.6, 1.2)):
            base = [
                at(r, angle, start) for r, angle in ((2.25, p), (2.75, p), (2.75, q), (2.25, q))
            ]
            found.append(prism(f"block{len(found)}", base, (0.0, end - start, 0.0), 2e3))
    return found


@pytest.mark.long
def test_a_small_vault_goes_from_a_compas_file_to_a_structure_with_locks(tmp_path: Path) -> None:
    path = tmp_path / "vault.json"
    nodes = {
        str(number): {
            "block": {
                "vertex": {
                    str(k): dict(zip("xyz", v, strict=True)) for k, v in enumerate(b.vertices)
                },
                "face": {str(k): [*map(str, face)] for k, face in enumerate(b.faces)},
            },
            "is_support": b.fixed,
        }
        for number, b in enumerate(small_barrel())
    }
    path.write_text(json.dumps({"graph": {"node": nodes, "edge": {}}}))
    design = yaml.safe_load(FILE.with_suffix(".yaml").read_text())
    design["design"]["gap"] = 0.2
    path.with_suffix(".yaml").write_text(yaml.safe_dump(design))
    task = read_task(path)
    structure = task.structure
    choice = choice_of(structure, RowSearch(structure, 1.0).cheapest(gap=0.5).parts)
    assert (carried(structure, choice)[0] >= 1.0 - 1e-5).all()
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


@pytest.mark.long
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


@pytest.mark.long
def test_a_search_in_place_of_trying_all_layouts_costs_the_same() -> None:
    """A cube between two walls is held by its locks alone, and pushed aside and down."""
    assembly = structure(row_of_cubes(1), dry(0.0), nodes=NodeLayout.VERTICES)
    pushes = [
        force_at(assembly, "cube0", (EDGE / 2,) * 3, along)
        for along in ((0.0, 1.0, 0.0), (0.0, 1.0, -1.0))
    ]
    kind = LockKindSection(width=(0.05,), height=0.02, most=3)
    angles = (0.0, 45.0, 90.0, 135.0)
    sites = tuple(
        Site(number, layouts_of(face, kind, directions_of(face, angles=angles)))
        for number, face in enumerate(assembly.faces)
        if isinstance(face, Polygon)
    )
    cases = tuple(LoadCase(str(number), push, 2500.0) for number, push in enumerate(pushes))
    given = DesignProblem(assembly, sites, cases, WeightsSection())
    found = RowSearch(given, 1.0).cheapest(gap=GAP)
    choices = [*product(*[(None, *site.layouts) for site in sites])]
    taken = [given.chosen(choice) for choice in choices]
    least = min(given.costs @ each for each in taken if RowSearch(given, 1.0).carries(each))
    assert len(choices) == 13**2
    assert found.cost == least > 0.0
    assert found.bound <= found.cost <= found.bound * (1.0 + GAP)


# --- structures beside published values ----------------------------------------------------------
Y = (0.0, 1.0, 0.0)


def tilts(model: Assembly, axis: Vector = Y) -> tuple[Assembly, Loads]:
    return model, tilting(model, axis)


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize(("friction", "expected"), [(0.2, degrees(0.2)), (0.84, degrees(0.4))])
def test_a_block_rests_on_a_slope_as_by_hand(
    friction: float, expected: float, finite: bool
) -> None:
    found = relaxed_tilt(*tilts(on_ground(friction)), finite=finite)
    assert found == pytest.approx(expected, abs=0.3)


@pytest.mark.study
def test_finite_rotations_wedge_a_block_that_small_ones_let_go() -> None:
    """It then slides as a whole, at a friction of mu over the sine of half the notch's angle."""
    model, tilt = tilts(structure(notch(1.0, 2.3), dry(0.84)), (1.0, 0.0, 0.0))
    small = relaxed_tilt(model, tilt, finite=False)
    slides = degrees(0.84 / math.cos(math.radians(30.0)))
    assert small < slides - 5.0
    assert static_tilt(model, tilt).angle == pytest.approx(slides, abs=0.7)
    assert relaxed_tilt(model, tilt, finite=True) == pytest.approx(slides, abs=0.3)


def test_relaxation_is_for_one_free_block() -> None:
    other = box("other", (0.0, 0.0, 1.0), (0.4, 0.6, 2.0), 2e3)
    with pytest.raises(ValueError, match="one block must be free"):
        relaxed_tilt(*tilts(structure([GROUND, BLOCK, other], dry(0.5))), finite=True)


def test_a_pyramid_around_the_cone_holds_at_most_8_percent_more() -> None:
    model = on_ground(0.2)
    assert pyramid_tilt(*tilts(model)) == pytest.approx(degrees(0.2), rel=1e-6)
    turn = math.radians(22.5)
    between = pyramid_tilt(*tilts(model, (math.cos(turn), math.sin(turn), 0.0)))
    assert between == pytest.approx(degrees(0.2 / math.cos(turn)), rel=1e-6)


def test_a_pyramid_sees_what_stands_upside_down_and_what_falls() -> None:
    wedged = tilts(structure(notch(1.0, 2.3), dry(3.0)))
    assert limit_tilt(*wedged).angle == pyramid_tilt(*wedged)
    assert pyramid_tilt(*tilts(structure([GROUND, LEANING], dry(0.7)))) is None


@pytest.mark.long
def test_shapes_have_their_known_answers() -> None:
    published = yaml.safe_load(PUBLISHED.read_text())
    for answer in answers(published["shapes"]):
        near = 0.003 if answer.source in published["sources"] else 1e-6
        assert answer.limit == pytest.approx(answer.known, rel=near), answer.name
        if answer.static is not None:
            assert 0.995 * answer.limit < answer.static <= answer.limit * 1.0001, answer.name


@pytest.mark.long
def test_the_tilt_of_an_arch_does_not_hang_on_its_last_digits() -> None:
    """With friction that rises with pressure, stable steps were refused: 14.86 degrees."""
    model = structure(arch(100, 0.2 * (1.0 + 1e-9)), dry(HELD))
    assert static_tilt(model, tilting(model, ABOUT_Y)).angle == pytest.approx(15.779, abs=0.01)


@pytest.mark.long
def test_walls_that_slide_carry_their_known_acceleration_and_less_along_a_path() -> None:
    """Those of Ferris & Tin-Loi: sliding that dilates holds more than friction with a history."""
    published = yaml.safe_load(PUBLISHED.read_text())
    for answer in pushed_walls(published["shapes"]):
        assert answer.limit == pytest.approx(answer.known, abs=6e-6), answer.name
        assert answer.static is not None
        assert 0.85 * answer.limit < answer.static < answer.limit - 1e-3, answer.name


def test_published_values_are_of_samples_and_axes_that_there_are() -> None:
    published = yaml.safe_load(PUBLISHED.read_text())
    keys = [(each["sample"], each["friction"], each["axis"]) for each in published["tilts"]]
    assert len(set(keys)) == len(keys) == 12
    assert {sample for sample, _, _ in keys} <= set(TYPES)
    assert {axis for _, _, axis in keys} == set(AXES)
