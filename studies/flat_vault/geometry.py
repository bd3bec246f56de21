"""Abeille's flat vault (1699), and its files: `python -m studies.flat_vault.geometry`.

Its blocks are truncated tetrahedra: squares below, whose sides lean outwards along one direction
and inwards along the other, in turn from block to block. Each rests on two neighbours and carries
the other two; the ceiling is flat, the floor has a pyramid left out at each corner. Kerb stones
around it lie on fixed walls and take the thrust by friction: in a frame that cannot move, a vault
of rigid blocks carries any load.
"""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml

FILES = {blocks: Path(__file__).parent / f"vault{blocks}.yaml" for blocks in (3, 5)}
HEAD = """\
# yaml-language-server: $schema=../../docs/structure.schema.json
# A flat vault of {0} x {0} of Abeille's blocks, 0.15 m thick, between kerb stones on walls, loaded
# at the middle: written by studies/flat_vault/geometry.py, which says how the blocks lean. Lengths
# in m, densities in kg/m3.
"""
SIDE, THICKNESS = 0.3, 0.15  # m: of a block's square, of the vault
LEAN = 0.4  # tangent of the sides' angle to the vertical
KERB = 0.6  # m, width of the kerb stones and of the walls below
WALL = 0.3  # m, height of the walls
FRICTION = 0.6
DENSITY = 2000  # kg/m3
SIDES = {  # of the vault: axis across it, and outwards along that
    "left": (0, -1),
    "right": (0, 1),
    "front": (1, -1),
    "back": (1, 1),
}


def description(blocks: int, friction: float = FRICTION) -> dict[str, Any]:
    """The vault of so many blocks along either side, loaded downwards at its middle block."""
    middle = blocks // 2
    at = _rounded((middle + 0.5) * SIDE, (middle + 0.5) * SIDE, THICKNESS)
    return {
        "blocks": dict((*_walls(blocks), *_blocks(blocks), *_kerb(blocks))),
        "interfaces": {"friction": friction},
        "load": {
            "force": {"block": name(middle, middle), "at": at, "direction": [0, 0, -1]},
        },
    }


def name(column: int, row: int) -> str:
    """Name of a block, whose numbers count from 0; names count from 1."""
    return f"block{column + 1}{row + 1}"


def _out(column: int, row: int) -> int:
    """1 where a block leans outwards along x and inwards along y, -1 where it is the reverse."""
    return 1 if (column + row) % 2 == 0 else -1


def _blocks(count: int) -> Iterator[tuple[str, dict[str, Any]]]:
    faces = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
    for column in range(count):
        for row in range(count):
            out = _out(column, row) * LEAN * THICKNESS
            vertices = []
            for height, over in ((0.0, 0.0), (THICKNESS, out)):
                left, right = column * SIDE - over, (column + 1) * SIDE + over
                front, back = row * SIDE + over, (row + 1) * SIDE - over
                for x, y in ((left, front), (right, front), (right, back), (left, back)):
                    vertices.append(_rounded(x, y, height))
            yield name(column, row), {"vertices": vertices, "faces": faces, "density": DENSITY}


def _kerb(count: int) -> Iterator[tuple[str, dict[str, Any]]]:
    """A stone along each outer side of a block."""
    for side, (axis, outwards) in SIDES.items():
        edge = 0 if outwards < 0 else count - 1
        for number in range(count):
            out = -_out(number, edge) if axis else _out(edge, number)
            reaches = (0.0, KERB, KERB, out * LEAN * THICKNESS)
            heights = (0.0, 0.0, THICKNESS, THICKNESS)
            points = [
                _rounded(*_across(count, side, reach, number * SIDE), height)
                for reach, height in zip(reaches, heights, strict=True)
            ]
            along = [SIDE, 0, 0] if axis else [0, SIDE, 0]
            yield f"{side}{number + 1}", {"outline": points, "along": along, "density": DENSITY}


def _walls(count: int) -> Iterator[tuple[str, dict[str, Any]]]:
    """A fixed wall below each row of kerb stones."""
    for side in SIDES:
        ends = _across(count, side, 0.0, 0.0), _across(count, side, KERB, count * SIDE)
        low, high = zip(*(sorted(each) for each in zip(*ends, strict=True)), strict=True)
        shape = {"low": _rounded(*low, -WALL), "high": _rounded(*high, 0.0), "fixed": True}
        yield f"wall_{side}", shape


def _across(count: int, side: str, reach: float, along: float) -> tuple[float, float]:
    """A point (x and y, m) ``reach`` outside a side, and ``along`` it."""
    axis, outwards = SIDES[side]
    across = (count * SIDE if outwards > 0 else 0.0) + outwards * reach
    return (along, across) if axis else (across, along)


def _rounded(*values: float) -> list[float]:
    return [round(value, 6) + 0.0 for value in values]


def text(blocks: int) -> str:
    """The file of a vault of so many blocks along either side, a line for each block."""
    shapes, *others = description(blocks).items()
    lines = [f"  {block}: {_in_a_line(shape)}" for block, shape in shapes[1].items()]
    lines += [f"{key}: {_in_a_line(value)}" for key, value in others]
    return "\n".join([HEAD.format(blocks), "blocks:", *lines]) + "\n"


def _in_a_line(value: Any) -> str:
    text: str = yaml.safe_dump(value, default_flow_style=True, sort_keys=False, width=math.inf)
    return text.strip()


if __name__ == "__main__":
    for number, path in FILES.items():
        path.write_text(text(number))
