"""What locks lose so that they go into hollows with corners that a mill leaves round."""

import math
from pathlib import Path

import pytest
import trimesh
import yaml
from command_runner import run
from test_build import LARGER_BASE, made

from sidmacib.build import joint_blocks
from sidmacib.build.clearance import CHORDS, Clearance
from sidmacib.joint import Joint
from sidmacib.structure.files.structure_file import blocks_and_rows


def test_edges_of_locks_in_corners_of_hollows_are_rounded() -> None:
    """Both locks of the block go into the base, each with four corners; the base's runs through."""
    radius, gap = 5e-3, 1e-3
    base, block = made(blocks_and_rows(LARGER_BASE), Clearance(gap))
    same, rounded = made(blocks_and_rows(LARGER_BASE), Clearance(gap, radius=radius))
    step = math.pi / 2.0 / CHORDS
    corner = radius**2 - CHORDS * radius**2 / 2.0 * math.sin(step)
    assert same.volume == pytest.approx(base.volume, rel=1e-9)
    assert block.volume - rounded.volume == pytest.approx(8 * corner * 0.01, rel=1e-3)
    assert trimesh.Trimesh(rounded.places, rounded.triangles, process=False).is_volume
    with pytest.raises(ValueError, match=r"radius: 0\.2 is not allowed"):
        made(blocks_and_rows(LARGER_BASE), Clearance(gap, radius=0.2))
    through = joint_blocks(Joint(5))  # no corners
    for one, other in zip(made(through), made(through, Clearance(radius=radius)), strict=True):
        assert one.volume == other.volume


@pytest.mark.long
def test_a_radius_that_changes_nothing_is_told(tmp_path: Path) -> None:
    words = "Note: --radius changes nothing: no edge of a lock lies in a corner of a hollow"
    to = "--radius", "5mm", "-o", str(tmp_path / "out")
    found = run("build", "-n", "3", *to)
    assert (found.exit_code, found.stderr.splitlines()) == (0, [words])
    assert "radius" not in (tmp_path / "out/drawings/A.svg").read_text()
    (tmp_path / "base.yaml").write_text(yaml.safe_dump(LARGER_BASE))
    assert run("build", str(tmp_path / "base.yaml"), *to).stderr == ""
    assert "radius 5 mm" in (tmp_path / "out/drawings/A.svg").read_text()
