"""No command writes over a file that it reads."""

from pathlib import Path
from typing import Any

import click
import pytest
import yaml
from command_runner import run
from structures import CUBE, PUSH

from sidmacib.command.main import main
from sidmacib.command.options import Written

MESH = Path(__file__).parent / "cases/geometry/yup.obj"
FROM_MESH = {"blocks": {"b": {"file": "b.obj", "up": "y", "fixed": ["ground"]}}, "load": PUSH}
IN_TIME = {"duration": 1, "ground": {"record": "record.csv", "direction": [1, 0, 0]}}
DESIGN = {
    "locks": {"width": 0.05, "height": 0.02},
    "cases": {"one": PUSH | {"newtons": 1}, "two": PUSH | {"newtons": 2}},
}


@pytest.mark.parametrize(
    ("file", "description", "command", "kept"),
    [
        ("a.yaml", {**CUBE, "load": PUSH}, "assembly a.yaml --capacity-curve a.yaml", "a.yaml"),
        ("a.yaml", {**CUBE, "load": PUSH}, "assembly linked.yaml --compas a.yaml", "a.yaml"),
        ("b.yaml", {"load": PUSH}, "assembly b.obj --compas b.yaml", "b.yaml"),
        ("a.yaml", FROM_MESH, "assembly a.yaml --capacity-curve b.obj", "b.obj"),
        ("a.yaml", {**CUBE, "load": IN_TIME}, "assembly a.yaml --history record.csv", "record.csv"),
        (
            "a-two.yaml",
            {**CUBE, "design": DESIGN},
            "design a-two.yaml --output a.yaml",
            "a-two.yaml",
        ),
        ("blocks.yaml", {}, "build blocks.obj -o .", "blocks.obj"),
        ("a.html", {"locks": 5}, "capacity --file a.html --note a.html", "a.html"),
    ],
)
def test_no_file_that_is_read_is_written_over(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    file: str,
    description: Any,
    command: str,
    kept: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("b.obj", "blocks.obj"):
        Path(name).write_text(MESH.read_text())
    Path("record.csv").write_text("0,0\n1,1\n")
    Path(file).write_text(yaml.safe_dump(description))
    if "linked.yaml" in command:
        Path("linked.yaml").hardlink_to(file)
    before = Path(kept).read_text()
    found = run(*command.split())
    assert found.exit_code == 2
    assert f"{kept}: is what the command reads; it must be another file" in found.output
    assert Path(kept).read_text() == before


def test_every_option_that_names_a_file_to_be_written_is_of_one_kind() -> None:
    others = {
        f"{command} {each.name}"
        for command, of in main.commands.items()
        for each in of.params
        if isinstance(each.type, click.Path)
        and not (each.type.exists or isinstance(each.type, Written))
    }
    assert others == {
        "build output",
        *(f"{command} file" for command in main.commands if command not in ("assembly", "design")),
    }
