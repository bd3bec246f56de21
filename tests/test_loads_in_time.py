"""What acts in time, as files and commands give it: records, factors, refusals."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from command_runner import run
from conftest import ROOT
from test_in_time import FLAT, GROUND, SLENDER, described, moved, pulse

from sidmacib.answers.in_time import falls_at
from sidmacib.mechanics.assembly import GRAVITY
from sidmacib.structure.files.structure_file import demands_of
from sidmacib.structure.shaking import Accelerogram, accelerogram


def test_records_are_read_by_columns_and_as_at2(tmp_path: Path) -> None:
    time = np.arange(0.0, 2.0, 0.01)
    values = 0.4 * np.sin(5.0 * time) * np.exp(-time)
    plain, peer = tmp_path / "record.csv", tmp_path / "record.AT2"
    rows = [f"{t:.4f}, {a * GRAVITY:.9g}" for t, a in zip(time, values, strict=True)]
    plain.write_text("time (s), acceleration (m/s2)\n" + "\n".join(rows))
    lines = [" ".join(f"{each:.9g}" for each in values[k : k + 5]) for k in range(0, len(time), 5)]
    head = "PEER\nmade up\nACCELERATION IN UNITS OF G\nNPTS= 200, DT= .0100 SEC\n"
    peer.write_text(head + "\n".join(lines))
    one, other = (accelerogram(path, None, 1.0, (1.0, 0.0, 0.0)) for path in (plain, peer))
    at = np.linspace(0.0, 2.5, 301)
    assert one.velocity(at) == pytest.approx(other.velocity(at), abs=1e-7)
    assert isinstance(one, Accelerogram)
    speed = np.gradient(one.velocity(at)[:, 0], at)
    assert speed[50] == pytest.approx(
        0.4 * GRAVITY * np.sin(5 * at[50]) * np.exp(-at[50]), abs=0.02
    )
    (tmp_path / "bad.csv").write_text("0 1\n0 2\n")
    with pytest.raises(ValueError, match=r"bad\.csv: times must grow"):
        accelerogram(tmp_path / "bad.csv", None, 1.0, (1.0, 0.0, 0.0))


def test_the_factor_at_which_a_block_falls_is_that_of_its_pulse() -> None:
    """A block that rocks falls under a pulse of 0.3 s at a factor between two that were run."""
    blocks = {"ground": GROUND, "block": SLENDER}
    load = {"ground": pulse(0.05 * GRAVITY, 0.3), "duration": 3}
    problem = demands_of(described(blocks, load, 3.0), in_time=True)[0].problem
    factor = falls_at(problem)
    assert factor is not None and 2.0 < factor < 4.0
    strong = {**load, "ground": pulse(0.05 * factor * GRAVITY, 0.3)}
    weak = {**load, "ground": pulse(0.05 * 0.98 * factor * GRAVITY, 0.3)}
    assert not moved(blocks, strong, 3.0).history.stands
    assert moved(blocks, weak, 3.0).history.stands


@pytest.mark.long
def test_the_command_says_whether_it_stands_and_writes_the_history(tmp_path: Path) -> None:
    history, picture = tmp_path / "history.csv", tmp_path / "drift.svg"
    example = str(ROOT / "studies/time/arch.yaml")
    found = run("assembly", example, "--history", str(history), "--picture", str(picture))
    assert found.exit_code == 0, found.output
    assert "Yes: it stands for 3 s; voussoir1 moves most" in found.output
    head, *rows = history.read_text().splitlines()
    assert head == "time_s,block,x_m,y_m,z_m,rx_rad,ry_rad,rz_rad"
    assert len(rows) == 301 * 5
    assert "<svg" in picture.read_text()
    given = yaml.safe_load(Path(example).read_text())
    given["load"]["ground"]["scale"] = 2.0
    path = tmp_path / "arch.yaml"
    path.write_text(yaml.safe_dump(given))
    found = run("assembly", str(path), "--format", "json")
    assert found.exit_code == 1
    assert json.loads(found.stdout)["verdict"] == "no"


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"load": {"duration": 1, "lost": "block"}}, "a block that is fixed"),
        ({"load": {"duration": 1, "force": {"block": "block"}}}, "force"),
        ({"load": {"duration": 1, "ground": {"direction": [1, 0, 0]}}}, "either pulse or record"),
        ({"load": {"duration": "1m"}}, "a time"),
        ({"load": {"blow": {"block": "block", "velocity": [1, 0, 0]}}}, "duration: missing"),
    ],
)
def test_what_cannot_act_in_time_is_refused_by_name(changes: dict[str, Any], why: str) -> None:
    with pytest.raises(ValueError, match=why):
        demands_of(
            {**described({"ground": GROUND, "block": FLAT}, {}, 0.5), **changes}, in_time=True
        )


def test_a_motion_that_goes_on_is_noted_and_collapse_needs_one(tmp_path: Path) -> None:
    path = tmp_path / "block.yaml"
    load = {"ground": pulse(1.0, 5.0), "duration": 1}
    path.write_text(yaml.safe_dump(described({"ground": GROUND, "block": FLAT}, load, 0.5)))
    assert "load.duration: the ground moves on for 4 s more" in run("assembly", str(path)).output
    still = described({"ground": GROUND, "block": FLAT}, {"duration": 1}, 0.5)
    path.write_text(yaml.safe_dump(still))
    assert "--collapse: needs load.ground" in run("assembly", str(path), "--collapse").output
    path.write_text(yaml.safe_dump({**still, "load": {"acceleration": [1, 0, 0]}}))
    words = "--collapse: needs a load with a duration"
    assert words in run("assembly", str(path), "--collapse").output


@pytest.mark.parametrize("option", [("--history", "h.csv"), ("--collapse",)])
def test_what_needs_a_duration_is_refused_beside_load_cases_and_the_reserve(
    tmp_path: Path, option: tuple[str, ...]
) -> None:
    given = described({"ground": GROUND, "block": FLAT}, {"acceleration": [1, 0, 0]}, 0.5)
    path = tmp_path / "it.yaml"
    cases = {"load_cases": {"a": {"acceleration": [1, 0, 0], "newtons": 1}}}
    for each in (given, {k: v for k, v in given.items() if k != "load"} | cases):
        path.write_text(yaml.safe_dump(each))
        for more in ((), ("--reserve",)):
            found = run("assembly", str(path), *option, *more)
            assert found.exit_code == 2
            assert f"{option[0]}: needs a load with a duration" in found.output
