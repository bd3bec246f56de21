"""The page with all keys of a structure's file."""

import re
from pathlib import Path

from sidmacib.structure.files.keys import MATERIAL
from sidmacib.structure.files.selection import RULE
from sidmacib.structure.files.structure_file import LOCKS, OPTIONAL, SHAPES

PAGE = (Path(__file__).parents[1] / "docs/structure_file.md").read_text()
SECTIONS = dict(
    part.partition("\n")[::2]
    for part in PAGE.replace("# The file of", "## The file of").split("## ")[1:]
)


def keys(section: str) -> set[str]:
    """Keys in the first column of a section's table."""
    rows = [line.split("|")[1] for line in SECTIONS[section].splitlines() if line.startswith("| `")]
    return {key for row in rows for key in re.findall(r"`(\w+)`", row)}


def test_it_has_all_keys_that_a_file_may_have_and_no_other() -> None:
    assert keys("The file of a structure") == {"blocks", "load", *OPTIONAL}
    shapes = {key for shape in SHAPES for key in shape}
    assert keys("`blocks`") == shapes | {"file", "scale", "density", "fixed", "material"}
    assert keys("`interfaces` and `special`") == set(MATERIAL)
    assert keys("`locks`") == {"between", "count", "height", *LOCKS}
    assert keys("`between`") == set(RULE)
    assert keys("`load`") == {"acceleration", "force", "tilt"}
