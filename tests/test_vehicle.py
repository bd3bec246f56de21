"""A vehicle that moves over a structure, against statics by hand and a programme in the plane."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from axe_playwright_python.sync_playwright import Axe
from chromium import needs_browser, until
from command_runner import assembly, run
from scipy.optimize import linprog

from sidmacib import limit_load
from sidmacib.command.cases import factor_picture
from sidmacib.mechanics.assembly import GRAVITY
from sidmacib.scene.forces import load_of
from sidmacib.structure.files.structure_file import Demand, demands_of, structure_of
from sidmacib.structure.vehicle import Deck
from workflow.configuration import ConfigError, read_study

EDGE, DENSITY = 1.0, 2000.0
SLAB = DENSITY * GRAVITY * 4.0 * 1.0 * 0.5  # N
BEAM: dict[str, Any] = {  # a slab of 4 m on two piers, whose outer edges are 2 m apart
    "blocks": {
        "left": {"low": [-EDGE, 0, -1], "high": [-0.8, 1, 0], "fixed": True},
        "right": {"low": [0.8, 0, -1], "high": [EDGE, 1, 0], "fixed": True},
        "slab": {"low": [-2, 0, 0], "high": [2, 1, 0.5], "density": DENSITY},
    },
    "interfaces": {"friction": 0.5},
}
LORRY: dict[str, Any] = {
    "axles": ["20kN", "10kN"],
    "spacings": [0.5],
    "start": [-1.9, 0.5],
    "end": [2.3, 0.5],
    "positions": 8,
}


def moving(structure: Any, **vehicle: Any) -> dict[str, Any]:
    return {**structure, "load": {"vehicle": {**LORRY, **vehicle}}}


def factors(description: Any) -> list[float]:
    """Of limit analysis, by position."""
    found = demands_of(description)
    return [limit_load(*each.problem, friction=True).load / each.newtons for each in found]


# --- factors -------------------------------------------------------------------------------------
@pytest.mark.parametrize("at", [1.2, 1.5, 1.9])
def test_a_slab_tips_where_its_weight_balances_the_axles_beyond_its_support(at: float) -> None:
    given = moving(BEAM, axles=["10kN"], spacings=[], start=[at, 0.5], end=[-at, 0.5], positions=2)
    by_hand = SLAB * EDGE / (10e3 * (at - EDGE))
    assert factors(given) == pytest.approx([by_hand] * 2, rel=1e-6)


def test_an_axle_between_the_supports_holds_the_slab_down() -> None:
    given = moving(BEAM, start=[1.4, 0.5], end=[1.8, 0.5], positions=2)
    by_hand = [SLAB * EDGE / (20e3 * (x - EDGE) - 10e3 * (EDGE - (x - 0.5))) for x in (1.4, 1.8)]
    assert factors(given) == pytest.approx(by_hand, rel=1e-6)


def ring(count: int, radius: float, thickness: float) -> dict[str, Any]:
    """A semicircular arch of so many voussoirs, 1 m deep, of a mean ``radius`` (m)."""

    def at(r: float, k: int) -> list[float]:
        return [-r * math.cos(math.pi * k / count), 0.0, r * math.sin(math.pi * k / count)]

    inner, outer = radius - thickness / 2, radius + thickness / 2
    blocks: dict[str, Any] = {
        f"voussoir{k}": {
            "outline": [at(inner, k), at(outer, k), at(outer, k + 1), at(inner, k + 1)],
            "along": [0, 1, 0],
        }
        for k in range(count)
    }
    for name, way in (("left", -1.0), ("right", 1.0)):
        low, high = sorted((way * (inner - 0.1), way * (outer + 0.1)))
        blocks[name] = {"low": [low, 0, -0.5], "high": [high, 1, 0], "fixed": True}
    return {"blocks": blocks, "interfaces": {"friction": 2.0}}


def by_thrust_line(demand: Demand, count: int, radius: float, thickness: float) -> float:
    """The largest load of `ring` for which a line of thrust is in it: a programme of 4 numbers.

    Force and moment of the left support on the arch, and the load. At each joint the moment of all
    that acts on its left, about its inner and about its outer edge, has the sign of a compression
    between the two.
    """
    pieces, loads = demand.problem.assembly.pieces, demand.problem.loads
    rows, right = [], []
    for k in range(count + 1):
        angle = math.pi * k / count
        for r, sign in ((radius - thickness / 2, 1.0), (radius + thickness / 2, -1.0)):
            x, z = -r * math.cos(angle), r * math.sin(angle)
            arms = np.array([piece.centre[0] - x for piece in pieces[:k]])
            weight = float(arms @ loads.permanent[:k, 2])
            load = float(arms @ loads.variable[:k, 2] - loads.variable[:k, 4].sum())
            rows.append(sign * np.array([z, -x, 1.0, load]))  # about (x, z): H, V, M and the load
            right.append(-sign * weight)
    bounds = [(None, None)] * 3 + [(0.0, None)]
    found = linprog([0.0, 0.0, 0.0, -1.0], A_ub=rows, b_ub=right, bounds=bounds)
    assert found.success, found.message
    return float(-found.fun)


RING = (12, 3.0, 0.6)


def test_an_arch_carries_what_a_line_of_thrust_in_it_does() -> None:
    given = moving(ring(*RING), spacings=[1.2], start=[-1.5, 0.5], end=[2.7, 0.5], positions=7)
    for demand in demands_of(given):
        found = limit_load(*demand.problem, friction=True).load
        assert found == pytest.approx(by_thrust_line(demand, *RING), rel=1e-5), demand.case


def test_a_vehicle_that_comes_back_finds_the_same_factors_on_a_symmetric_arch() -> None:
    there = moving(ring(*RING), start=[-1.0, 0.5], end=[2.0, 0.5], positions=4)
    back = moving(ring(*RING), start=[1.0, 0.5], end=[-2.0, 0.5], positions=4)
    assert factors(there) == pytest.approx(factors(back), rel=1e-5)


# --- where axles stand ---------------------------------------------------------------------------
def test_an_axle_stands_on_the_highest_face_under_it_and_on_both_sides_of_a_joint() -> None:
    high = {"low": [0, 0, 0.5], "high": [1, 1, 0.8]}
    both = {"low": [1, 0, 0.5], "high": [2, 1, 0.8]}
    deck = Deck(
        structure_of(
            {
                **BEAM,
                "blocks": BEAM["blocks"] | {"a": high, "b": both},
                "load": {"acceleration": [1, 0, 0]},
            }
        ).assembly
    )
    assert deck.under(-1.0, 0.5) == (0.5, [2])
    assert deck.under(0.5, 0.5) == (0.8, [3])
    assert deck.under(1.0, 0.5) == (0.8, [3, 4])
    assert deck.under(9.0, 0.5) == (0.0, [])


def test_where_an_axle_would_be_on_a_joint_it_stands_just_before_and_behind() -> None:
    """Each block of two carries half of the axle there, which may find a higher factor."""
    arch = ring(12, 1.0, 0.2)
    joint = -math.cos(math.pi / 6) * 1.1
    lorry = {"axles": ["10kN"], "spacings": [], "start": [joint, 0.5], "end": [-joint, 0.5]}
    found = demands_of(moving(arch, **lorry, positions=2))
    at = [each.position.value for each in found if each.position]
    assert at == pytest.approx([joint - 1e-3, joint + 1e-3, -joint - 1e-3, -joint + 1e-3])
    for each in found:
        assert np.count_nonzero(each.problem.loads.variable[:, 2]) == 1


def test_an_axle_stands_on_a_slope_at_its_height() -> None:
    deck = Deck(demands_of(moving(ring(*RING)))[0].problem.assembly)
    z, (number,) = deck.under(-1.0, 0.5)
    one, other = (-3.3 * math.cos(math.pi * k / 12) for k in (number, number + 1))
    part = (-1.0 - one) / (other - one)
    low, high = (3.3 * math.sin(math.pi * k / 12) for k in (number, number + 1))
    assert z == pytest.approx(low + part * (high - low), rel=1e-9)


def test_axles_beside_the_free_blocks_are_left_out() -> None:
    found = demands_of(moving(BEAM, start=[-1.9, 0.5], end=[3.1, 0.5], positions=6))
    assert [each.position and each.position.value for each in found] == pytest.approx(
        [-1.9, -0.9, 0.1, 1.1, 2.1]
    )
    assert [each.newtons for each in found] == [20e3, 30e3, 30e3, 30e3, 10e3]


@pytest.mark.parametrize(
    ("vehicle", "name"),
    [
        ({"start": [0.2, 0.5], "end": [1, 0.5]}, "leading axle at x = 0.2 m"),
        ({"start": [1, 0.1], "end": [1, 0.9]}, "leading axle at y = 0.1 m"),
        ({"start": [0, 0.1], "end": [1, 0.9]}, "leading axle at s = 0 m"),
    ],
)
def test_a_position_is_named_by_the_axis_of_the_path(vehicle: Any, name: str) -> None:
    assert demands_of(moving(BEAM, **vehicle))[0].case == name


def test_the_axles_of_a_position_are_told_in_words() -> None:
    (both, *_) = demands_of(moving(BEAM, start=[1.5, 0.5], end=[1.6, 0.5]))
    # Of two parallel forces on one block, their sum at (2 x 1.5 + 1.0) / 3.
    assert load_of(both.problem) == (
        "Load raised: a force on slab at (1.3333, 0.5, 0.5) m, along (0, 0, -1)"
    )
    two = demands_of(moving(ring(*RING), start=[0.2, 0.5], end=[0.3, 0.5]))[0]
    words = load_of(two.problem)
    assert "(0.333 of it) and on voussoir6 at" in words
    assert words.endswith("m (0.667 of it), along (0, 0, -1)")


# --- the command ---------------------------------------------------------------------------------
def test_the_lowest_position_governs_and_has_the_verdict(tmp_path: Path) -> None:
    given = moving(BEAM, start=[1.2, 0.5], end=[1.8, 0.5], positions=4)
    lowest = SLAB * EDGE / (20e3 * 0.8 + 10e3 * 0.3)
    found = assembly(tmp_path / "beam.yaml", given, "--format", "json")
    answer = json.loads(found.stdout)
    assert found.exit_code == 0
    assert [row["position_m"] for row in answer["rows"]] == pytest.approx([1.2, 1.4, 1.6, 1.8])
    assert [row["governs"] for row in answer["rows"]] == ["", "", "", "yes"]
    assert answer["rows"][3]["to_limit"] == pytest.approx(lowest, rel=1e-6)
    assert answer["answer"].startswith(
        "Yes: all 4 cases; leading axle at x = 1.8 m governs: it carries 30000 N with a factor of "
    )
    alone = run("assembly", str(tmp_path / "beam.yaml"), "--case", "leading axle at x = 1.4 m")
    assert alone.output.startswith("Yes: it carries 30000 N with a factor of ")


def test_more_cases_than_can_be_read_are_counted(tmp_path: Path) -> None:
    given = moving(BEAM, axles=["80kN"], spacings=[], start=[1.4, 0.5], end=[1.9, 0.5], positions=6)
    found = assembly(tmp_path / "beam.yaml", given)
    assert found.exit_code == 1
    assert found.output.startswith("No: 5 of 6 cases are not carried; leading axle at x = 1.9 m ")


def test_a_picture_has_a_line_for_each_vehicle_and_marks_the_lowest_factor() -> None:
    vehicle = {**LORRY, "positions": 3}
    demands = demands_of(
        {
            **BEAM,
            "load_cases": {
                "there": {"vehicle": vehicle},
                "back": {"vehicle": {**vehicle, "start": [1.0, 0.5], "end": [-2.3, 0.5]}},
            },
        }
    )
    rows = [{"factor": factor} for factor in (3.0, None, 2.5, 9.0, 2.0, 2.1)]
    figure = factor_picture("slab", demands, rows)
    assert figure is not None
    (axes,) = figure.axes
    there, back, mark = axes.lines[:3]
    assert [there.get_label(), back.get_label()] == ["there", "back"]
    assert [*there.get_xdata()] == pytest.approx([-1.9, 2.3])
    assert (*mark.get_xdata(), *mark.get_ydata()) == pytest.approx((-0.65, 2.0))
    assert axes.texts[0].get_text() == "2 at x = -0.65 m"


def test_page_and_note_show_the_factor_over_the_position(tmp_path: Path) -> None:
    page, note, drawing = (tmp_path / name for name in ("a.html", "b.html", "c.svg"))
    given = moving(BEAM, start=[1.2, 0.5], end=[1.8, 0.5], positions=2)
    written = "--report", str(page), "--note", str(note), "--picture", str(drawing)
    assert assembly(tmp_path / "beam.yaml", given, *written).exit_code == 0
    for file in (page, note):
        assert 'aria-label="Load factor over the position of the leading axle"' in file.read_text()
    assert drawing.stat().st_size > 0


@pytest.mark.study
@needs_browser
def test_everyone_can_read_the_page_and_it_fits_a_telephone(tmp_path: Path, browser: Any) -> None:
    page = tmp_path / "a.html"
    given = moving(BEAM, start=[1.2, 0.5], end=[1.8, 0.5], positions=2)
    assert assembly(tmp_path / "beam.yaml", given, "--report", str(page)).exit_code == 0
    opened = browser.new_page(viewport={"width": 390, "height": 800})
    opened.goto(page.as_uri())
    until(opened, "!!document.querySelector('#structure-plot .gl-container')")
    found, wide = Axe().run(opened), opened.evaluate("document.documentElement.scrollWidth")
    opened.close()
    assert wide == 390
    assert found.violations_count == 0, found.generate_report()


# --- faults --------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("vehicle", "message"),
    [
        ({"spacings": []}, "load.vehicle.spacings: [] is not allowed; it must have 1 distances"),
        ({"end": LORRY["start"]}, "load.vehicle.end: [-1.9, 0.5] is not allowed; it must differ"),
        (
            {"start": [0, 0, 0]},
            "load.vehicle.start: a list is not allowed; it must be a list of x and y",
        ),
        ({"axles": ["5m", 1]}, "load.vehicle.axles.1: 5m is a length"),
        ({"positions": 1}, "load.vehicle.positions: 1 is not allowed"),
        (
            {"start": [0, 0.5], "end": [0.01, 0.5]},
            "load.vehicle.positions: 8 is not allowed; they must be at least 0.004 m apart",
        ),
        ({"start": [0, 7], "end": [1, 7]}, "load.vehicle: no axle is above a free block at any"),
    ],
)
def test_a_fault_is_named(vehicle: Any, message: str) -> None:
    with pytest.raises(ValueError) as fault:
        demands_of(moving(BEAM, **vehicle))
    assert str(fault.value).startswith(message)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"load": {"vehicle": LORRY, "newtons": 1}}, "load.newtons: must not be given beside veh"),
        (
            {"load_cases": {"a": {"vehicle": LORRY, "newtons": 1}}},
            "newtons: must not be given besi",
        ),
    ],
)
def test_a_vehicle_has_its_own_newtons(keys: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        demands_of({**BEAM, **keys})


def test_models_that_take_one_load_refuse_a_vehicle() -> None:
    with pytest.raises(
        ValueError, match=r"load\.vehicle: moves, and is for multilock assembly only"
    ):
        structure_of(moving(BEAM))


@pytest.mark.parametrize(
    ("keys", "place"),
    [
        ({"load": {"vehicle": LORRY}}, "description: load"),
        ({"load_cases": {"a": {"vehicle": LORRY}}}, "description.load_cases.a"),
    ],
)
def test_a_study_refuses_a_vehicle(keys: Any, place: str) -> None:
    given = {"structures": {"slab": {"description": {**BEAM, **keys}}}, "models": ["limit"]}
    with pytest.raises(ConfigError) as fault:
        read_study(given)
    assert f"structures.slab.{place}.vehicle: moves, and is for multilock assembly" in str(
        fault.value
    )
