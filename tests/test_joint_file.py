"""The command reads a joint from a file, or from flags."""

from pathlib import Path

import pytest
from click.testing import CliRunner
from command_runner import answers, run

from sidmacib.command.main import main


def test_flags_go_before_a_file(tmp_path: Path) -> None:
    path = tmp_path / "joint.yaml"
    path.write_text("locks: 9\nH: 6e-2\nhold_down: {pressure: 2e4}\n")
    (of_file,) = answers("capacity", "--file", str(path), "-m", "law")
    flags = ["-n", "9", "-H", "0.06", "--hold-down", "pressure:2e4"]
    assert of_file == answers("capacity", *flags, "-m", "law")[0]
    (other,) = answers("capacity", "--file", str(path), "-n", "3", "-m", "law")
    assert other != of_file


def test_a_joint_is_read_from_standard_input() -> None:
    found = CliRunner().invoke(main, ["law", "--file", "-"], input="locks: 9\n")
    assert found.output == run("law", "-n", "9").output


@pytest.mark.parametrize("command", ["capacity -m law", "weights"])
def test_an_eccentricity_may_be_a_length(command: str) -> None:
    of_length = run(*command.split(), "-n", "3", "-a", "80mm", "-e", "20mm")
    assert of_length.exit_code == 0
    assert of_length.output == run(*command.split(), "-n", "3", "-a", "80mm", "-e", "0.25").output


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("lock: 5", "unknown key; did you mean locks? the keys here are locks, a, b, h, H, "),
        ("a: wide", "a: 'wide' is not a number; it must be a number greater than 0 (m)"),
        ("[1, 2]", "must have names and values"),
        ("", "must have names and values"),
        ("a: -1", "a: -1 is not allowed; it must be greater than 0 (m)"),
        ("poisson: 0.7", "poisson: 0.7 has no effect on rigid pieces; give young too"),
        ("locks: 5.5", "locks: 5.5 is not allowed; it must be a whole number from 1 to 300"),
        ("locks: 3\nlocks: 9", "line 2: 'locks' appears twice"),
        ("hold_down: []", "hold_down: an empty list is not allowed; it must be plate, weight, "),
        ("hold_down: {}", "hold_down: an empty mapping is not allowed"),
        ("hold_down: {force: [1]}", "hold_down: force: a list is not a number"),
        ("hold_down: {force: -1}", "force: -1 is not allowed; it must be at least 0 (N)"),
        (
            "hold_down: {force: 500, pressure: 1e4}",
            "a mapping of 'force', 'pressure' is not allowed; it must be plate, weight, {force: ",
        ),
        ("upper_body: 3", "upper_body: 3 is not allowed; it must be columns, joined or monolithic"),
        ("failure: soft", "failure: 'soft' is not allowed; it must be brittle, softening or"),
        ("a: 1" + "0" * 400, "is not a number"),
    ],
)
def test_faults_in_a_file_are_told_with_its_name(tmp_path: Path, content: str, words: str) -> None:
    path = tmp_path / "joint.yaml"
    path.write_text(content)
    found = run("capacity", "--file", str(path))
    assert found.exit_code == 2
    output = " ".join(found.output.split())
    assert words in output
    assert "Traceback" not in output and len(output) < 900
    assert f"--file {path}: " in output


def test_a_flag_before_a_faulty_file_is_blamed_for_its_own_value_only(tmp_path: Path) -> None:
    path = tmp_path / "joint.yaml"
    path.write_text("a: 0.08\nb: -1\n")
    assert f"--file {path}: b: -1 is" in run("law", "--file", str(path), "-a", "0.07").output
    assert "-a: '-2' is not" in run("law", "--file", str(path), "-a", "-2", "-b", "1").output


@pytest.mark.parametrize(("name", "value"), [("a", 80.0), ("b", 50.0), ("h", 472e3), ("H", 5.1)])
@pytest.mark.parametrize("what", ["capacity", "sensitivity", "weights", "law"])
def test_a_joint_of_too_many_cells_is_refused_at_once(what: str, name: str, value: float) -> None:
    found = run(what, f"-{name}", str(value))
    most = 100 * {"a": 0.05, "b": 0.06}.get(name, 0.05)
    assert found.exit_code == 2
    assert f"-{name}: {value:g} m is not allowed; it must be at most {most:g} m" in found.stderr
    if value > 10.0:
        assert f"{name}: {value:g} m is very large; is it in m?" in found.stderr
