"""The command: what it prints, its help, and how it refuses."""

import csv
import io
import math
import re
from dataclasses import replace
from pathlib import Path

import pytest
from command_runner import answers, run
from conftest import ROOT
from joints import sawn

from analysis.drawing import label_of
from sidmacib import Elastic, law, lock_weights, lowest_peak, pairs_of, safe, sensitivity
from sidmacib.command import output
from sidmacib.command.answers import capacity_rows
from sidmacib.command.main import main
from sidmacib.command.options import GROUPS, Grouped
from sidmacib.command.output import COLOURS, bars, curves, status_line, text_of
from sidmacib.engines import ENGINES
from sidmacib.joint import DRY, INNER, Direction, HoldDown, Joint, UpperBody
from sidmacib.joint.loading import Loading, Push, posed
from sidmacib.models.joint_answers import MODELS
from sidmacib.quantities import rounded

SAWN = "--upper-body", "columns"


def test_the_static_model_of_pieces_that_bend_is_asked_for_by_name() -> None:
    flags = ["--young", "1e10", "--upper-body", "monolithic"]
    assert [row["model"] for row in answers("capacity", "-n", "3", *flags)] == ["safe", "law"]
    assert [row["model"] for row in answers("capacity", "-n", "3")] == ["safe", "law", "static"]


@pytest.mark.long
def test_the_mesh_error_is_that_of_the_load_it_stands_beside() -> None:
    flags = ["-n", "5", "-a", "0.08", "-H", "0.06", "-e", "0.5", "-m", "static"]
    (row,) = answers("capacity", *flags)
    joint = Joint(5, a=0.08, H=0.06)
    problem = posed(joint, Loading(Direction(0.5)), 0.00625)
    finer = lowest_peak(*problem).peak.load * Direction(0.5).shear
    error = abs(row["V_N"] / finer - 1.0)
    assert error < row["mesh_error_over_load"] < 0.05


def test_every_model_answers() -> None:
    names = [name for name in MODELS if name not in ENGINES]
    flags = [part for name in names for part in ("-m", name)]
    rows = answers("capacity", "-n", "3", *flags)
    assert [row["model"] for row in rows] == names
    loads = {row["model"]: row["V_N"] for row in rows}
    assert loads["safe"] < loads["law"] <= loads["static"] * 1.01


@pytest.mark.parametrize(
    "names",
    [
        ("-n", "-a", "-b", "-h", "-H"),
        ("--locks", "--length", "--width", "--height", "--body-height"),
    ],
)
def test_flags_make_the_joint(names: tuple[str, ...]) -> None:
    sizes = zip(names, ("4", "0.08", "0.04", "0.01", "0.05"), strict=True)
    flags = [*(word for pair in sizes for word in pair), "--cohesion", "7e4"]
    flags += ["--young", "1e10", "--upper-body", "monolithic", "--friction", "0.1"]
    (row,) = answers("capacity", *flags, "-m", "law")
    inner, dry = replace(INNER, cohesion=7e4), replace(DRY, friction=0.1)
    materials = {"inner": inner, "dry": dry, "elastic": Elastic(1e10)}
    joint = Joint(4, 0.08, 0.04, 0.01, 0.05, upper_body=UpperBody.MONOLITHIC, **materials)
    assert row["V_N"] == rounded(law(joint, Direction(0.0)).shear)


TOLD = [
    (parameter.opts[0], default.group(1))
    for parameter in main.commands["law"].params
    if (default := re.search(r"\[default: ([^\s\],]+)", getattr(parameter, "help", None) or ""))
]


def test_what_help_calls_the_default_is_the_default() -> None:
    flags = dict(TOLD)
    assert len(flags) > 15
    assert flags.pop("--young") == "rigid"
    given = [word for pair in flags.items() for word in pair]
    bends = ("capacity", "-m", "law", "--young", "1e11")
    assert answers(*bends, *given) == answers(*bends) != answers("capacity", "-m", "law")


def test_an_envelope_goes_from_shear_to_torsion_and_is_drawn(tmp_path: Path) -> None:
    picture = tmp_path / "vm.png"
    rows = answers("envelope", "-n", "3", "--picture", str(picture))
    assert rows[0]["e_over_a"] == 0.0
    assert rows[-1]["e_over_a"] == "torsion"
    for model, rule in {"law": law, "safe": safe}.items():
        of_model = [row for row in rows if row["model"] == model]
        assert len(of_model) > 5
        for row in of_model:
            ratio = math.inf if row["e_over_a"] == "torsion" else row["e_over_a"]
            expected = rule(Joint(3), Direction(ratio))
            assert (row["V_N"], row["M_Nm"]) == (rounded(expected.shear), rounded(expected.torque))
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_between_few_directions_no_line_is_drawn(tmp_path: Path) -> None:
    """It would lie up to 5 % above the safe rule."""
    picture = tmp_path / "points.svg"
    flags = ("-n", "3", "-m", "safe", "-e", "0", "-e", "0.3", "-e", "torsion")
    answers("capacity", *flags, "--picture", str(picture))
    text = picture.read_text()
    assert "<svg" in text
    answers("capacity", *flags, "--picture", str(picture))
    assert picture.read_text() == text
    rows, _ = capacity_rows(Joint(3), [0.0, 0.3, math.inf], {"safe": MODELS["safe"]}, Push.PLUS_Y)
    (axes,) = curves(rows, "three", "", joined=False).axes
    (points,) = axes.lines
    assert (points.get_linestyle(), points.get_marker()) == ("None", "o")
    assert points.get_xdata() == pytest.approx([row["V (N)"] for row in rows])


@pytest.mark.long
def test_a_late_peak_that_meshes_do_not_agree_on_says_what_to_use() -> None:
    """120 N, and 33 N on a mesh of 5 mm, where the first failure is 17 N on all of them."""
    weak, usual = (
        answers("capacity", "-n", "5", *SAWN, "-e", "0.5", "-m", "static", *more)[0]["note"]
        for more in (("--tensile-strength", "20000"), ())
    )
    assert weak.endswith("not converged: use the first failure")
    assert usual == "peak"


def test_weights_are_those_of_each_lock() -> None:
    rows = answers("weights", "-n", "5", "-e", "0.3")
    joint = Joint(5)
    problem = posed(joint, Loading(Direction(0.3)), 0.24975 * joint.b)
    locks = lock_weights(joint, problem.assembly, lowest_peak(*problem).peak.force)
    for row, lock in zip(rows, locks, strict=True):
        assert (row["lock"], row["block"]) == (lock.lock, lock.block)
        assert row["weight"] == pytest.approx(lock.weight)
        assert row["largest_shear_over_cohesion"] == pytest.approx(lock.max_shear_ratio)
        assert row["Vx_N"] == pytest.approx(lock.shear_x_N, abs=1e-9 * joint.T0)
        assert row["Vy_N"] == pytest.approx(lock.shear_y_N, abs=1e-9 * joint.T0)
    assert [row["lock"] for row in rows] == [1, 2, 3, 4, 5]
    in_shear = [row["weight"] for row in answers("weights", "-n", "5")]
    assert max(in_shear) == pytest.approx(1.0, abs=1e-3)


@pytest.mark.long
def test_effects_are_those_of_the_library_largest_first() -> None:
    flags = ["-n", "3", "-e", "0.3", "--hold-down", "pressure:5e4", "--push=-y"]
    rows = answers("sensitivity", *flags)
    joint = Joint(3, hold_down=HoldDown.pressure(5e4))
    mesh = 0.24975 * joint.least_side
    found = sensitivity(joint, Loading(Direction(0.3), push=Push.MINUS_Y), mesh)
    by_name = {row["parameter"]: row for row in rows}
    assert len(rows) == len(found.effects)
    for each in found.effects:
        row = by_name[each.name]
        assert (row["value"], row["unit"], row["note"]) == (each.value, each.unit, each.note)
        assert row["first_failure_N"] == rounded(found.shear)
        for key, value in (
            ("1_percent_more_percent", each.more),
            ("1_percent_less_percent", each.less),
        ):
            assert row[key] == (None if value is None else pytest.approx(value, abs=1e-9))
    sizes = [abs(row["1_percent_more_percent"] or 0.0) for row in rows]
    assert sizes == sorted(sizes, reverse=True)
    first = run("sensitivity", *flags).output.splitlines()[0]
    assert first.startswith("First failure at V = ") and first.endswith("root of lock 2.")


def test_the_law_prints_how_many_locks_work() -> None:
    values = {row["what"]: row["value"] for row in answers("law", "-n", "9", *SAWN)}
    joint, pairs = sawn(9), pairs_of(sawn(9))
    expected = {
        "bearing pairs of locks": 4,
        "effective locks, closed form": pairs.working,
        "effective locks, endless joint": pairs.most,
        "transfer length": pairs.transfer_length,
    }
    for rule in (law, safe):
        shear = rule(joint, Direction(0.0)).shear
        expected[f"V (N), {rule.__name__}"] = shear
        expected[f"effective locks, {rule.__name__}"] = shear / joint.T0
    assert values == pytest.approx(expected)
    assert values["effective locks, safe"] < values["effective locks, law"] < 4


def test_in_a_table_numbers_stand_at_the_right_and_csv_is_csv() -> None:
    rows = [{"name": "a", "V (N)": 1.5}, {"name": "bcd", "V (N)": None}, {"name": "e", "V (N)": 10}]
    lines = ["name  V (N)", "a       1.5", "bcd       -", "e        10"]
    assert text_of(rows, "table").splitlines() == lines
    written = csv.DictReader(io.StringIO(run("weights", "-n", "3", "--format", "csv").output))
    assert [row["block"] for row in written] == ["upper", "lower", "upper"]


@pytest.mark.long
def test_a_model_that_refuses_says_why_and_others_go_on() -> None:
    rows = answers("capacity", "-n", "40", "-m", "law", "-m", "static")
    assert rows[0]["V_N"] is None
    assert "from 2 to 31" in rows[0]["note"]
    assert rows[1]["V_N"] is not None


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ("capacity -a -1", "-a: '-1' is not allowed; it must be greater than 0 (m)"),
        ("capacity -e x", "neither a number (e / a), a length such as 20mm (e), nor torsion"),
        ("capacity --hold-down rope", "'rope' is not one of plate, weight"),
        ("capacity -m magic", "'magic' is not one of 'safe'"),
        ("capacity --poisson 0.3", "--poisson: 0.3 has no effect on rigid pieces"),
        ("capacity --young 1e10 --poisson 0.7", "--poisson: '0.7' is not allowed"),
        ("capacity --dry-stiffness -1", "--dry-stiffness: '-1' is not allowed"),
        ("capacity -n 100000", "--locks: 100000 is not allowed; it must be a whole number from 1"),
        ("weights -e .2 -e .3", "-e is given more than once; it must be given once"),
        ("law -n 3 --locks 5", "-n is given more than once"),
        ("envelope --picture x.unknown", "--picture x.unknown"),
        (
            "capacity -m law --units kN,stone",
            "--units: 'stone' is not a unit; it must be one of m, mm",
        ),
        ("capacity -n 9 -H 4 -m law", "H / b: 80 is not allowed"),
        ("capacity -n 300 -e torsion -m limit -a 0.1", "GiB; at most 2 GiB are allowed"),
        ("sensitivity -n 3 --young 1e10", "for rigid pieces only; elastic ones take minutes each"),
        ("capacity -V 1 -e 0 -e 1", "-V, -M: need one direction, -e once"),
        ("capacity -M 1 -e 0.2", "must have a torque or e / a, not both"),
        ("capacity --scatter 20", "'20' is not allowed; it must be greater than 0 and at most 1"),
        ("capacity --scatter 0", "--scatter: '0' is not allowed"),
        ("capacity --gamma-m 0.8", "'0.8' is not allowed; it must be from 1 to 10"),
        ("capacity --note n.html -e 0 -e 1", "--note: needs one direction"),
        ("capacity --note /nowhere/n.html", "--note /nowhere/n.html: No such folder"),
        ("joint", "Give the load: -V, -M, or -V with -e."),
        ("joint -V -3", "-V: '-3' is not allowed; it must be at least 0 (N)"),
        ("joint -V nan", "-V: 'nan' is not a number"),
        ("joint -V 3 -M 1 -e 0.3", "not both"),
        ("joint -V 3 -n 5", "-n: joint finds the number of locks; remove -n or use --vary"),
        ("joint -V 3 --vary locks=3,5 -n 5", "remove -n or --vary locks"),
        ("joint -V 3 --all", "--all: needs --vary"),
        ("joint -V 3 --price area=2", "--price: needs --vary"),
        ("joint -V 3 --vary q=3", "--vary: 'q=3' is not allowed"),
        ("joint -V 3 --vary a=1 --vary a=2", "--vary: 'a=2' is there twice"),
        ("joint -V 3 --vary a=0.1:0.2", "--vary a: must have a step"),
        ("joint -V 3 --vary a=0.2:0.1:0.01", "--vary a: has 0 values"),
        ("joint -V 3 --vary a=0.1:0.2:0", "--vary a: '0' is not allowed; it must be greater"),
        ("joint -V 3 --vary a=0.1:2:1e-9", "--vary a: has 1900000001 values"),
        ("joint -V 3 --vary a=0.1:0.2:0.1:0.1", "it must be from:to:step"),
        ("joint -V 3 --vary locks=3.5", "--vary locks: '3.5'"),
        ("joint -V 3 --vary a=", "--vary a: '' is not a number"),
        ("joint -V 3 --vary a=1 --price gold=2", "--price: 'gold=2' is not allowed"),
        ("joint -V 3 --vary a=1 --price area=0", "must be more than 0"),
        ("build --clearance 5kN", "5kN is a force; it must be a length, such as 80mm"),
        ("build --clearance -1mm", "--clearance: '-1mm' is not allowed; it must be at least 0 (m)"),
        (f"build {ROOT}/studies/arch/arch_with_locks.yaml -n 5 -o none", "--locks: is for a joint"),
        ("law --file /dev/zero", "--file /dev/zero: not a file"),
        ("law --file /", "--file /: not a file"),
        ("law --file /none", "--file /none: No such file or directory"),
    ],
)
def test_errors_name_flag_value_and_what_is_allowed(arguments: str, words: str) -> None:
    found = run(*arguments.split())
    assert found.exit_code in (1, 2)
    assert words in " ".join(found.output.split())
    assert "Traceback" not in found.output


def test_pictures_have_the_colours_of_the_figures() -> None:
    assert {name: label_of(name).colour for name in MODELS}.items() <= COLOURS.items()


def test_an_answer_asked_for_twice_is_printed_once() -> None:
    rows = answers("capacity", "-m", "law", "-m", "law", "-e", "0.2", "-e", ".2", "-e", "0")
    assert [(row["model"], row["e_over_a"]) for row in rows] == [("law", 0.2), ("law", 0.0)]


def test_a_picture_of_weights_has_a_bar_for_each_lock() -> None:
    rows = answers("weights", "-n", "3")
    (axes,) = bars(rows, "three").axes
    found = {bar.get_x() + bar.get_width() / 2: bar.get_height() for bar in axes.patches}
    assert found == pytest.approx({r["lock"]: r["weight"] for r in rows})


def test_a_terminal_sees_what_is_computed_and_nothing_of_it_at_the_end(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    with status_line() as show:
        show("1 of 2: law, e/a = 0")
    assert capsys.readouterr().err == "\r\x1b[K1 of 2: law, e/a = 0\r\x1b[K"


def test_what_each_model_answers_is_told_where_all_take_long(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(output, "PATIENCE", 0.0)
    found = run("capacity", "-n", "5", "-m", "safe", "-m", "static", "--units", "kN")
    (row,) = [line.split() for line in found.stdout.splitlines() if line.split()[1] == "safe"]
    assert f"1 of 2: safe, e/a = 0: V = {row[2]} kN, M = 0 N m\n" in found.stderr
    assert "2 of 2: static, e/a = 0 ...\n" in found.stderr


def test_columns_are_in_the_units_that_were_asked_for() -> None:
    (plain,) = answers("capacity", "-m", "law", "-e", "0.3")
    (other,) = answers("capacity", "-m", "law", "-e", "0.3", "--units", "kN,N mm")
    assert other["V_kN"] == pytest.approx(plain["V_N"] / 1e3)
    assert other["M_Nmm"] == pytest.approx(plain["M_Nm"] * 1e3)
    assert other["e_over_a"] == plain["e_over_a"] and other["note"] == plain["note"]


COLUMNS = 80


@pytest.mark.parametrize("command", ["", *main.commands])
def test_no_line_of_the_help_is_cut_off_or_wider_than_a_terminal(command: str) -> None:
    found = run(*filter(None, [command]), "--help")
    assert found.exit_code == 0 and "Usage" in found.output
    assert all(len(line) <= COLUMNS for line in found.output.splitlines())
    if not command:
        listed = found.output.partition("Commands:\n")[2]
        assert len(listed.splitlines()) == len(main.commands) and "..." not in listed


@pytest.mark.parametrize("command", ["capacity", "envelope", "weights", "sensitivity", "joint"])
def test_options_stand_under_the_heading_of_their_group(command: str) -> None:
    parts = re.split(r"^(\S.*):\n(?=  )", run(command, "--help").output, flags=re.MULTILINE)
    under = dict(zip(parts[1::2], parts[2::2], strict=True))
    assert [group for group in GROUPS if group in under] == [*under]
    for option in main.commands[command].params:
        if isinstance(option, Grouped):
            assert re.search(rf"^  {option.opts[0]}\b", under[option.group], re.MULTILINE)
