"""The key of a structure's file that takes blocks from other files: meshes, COMPAS, Rhino."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal, Self, get_args

import numpy as np
from pydantic import BeforeValidator, StrictBool, model_validator

from sidmacib.mechanics.assembly import Floats
from sidmacib.quantities import MEASURED_IN, Number, shown
from sidmacib.reading import Keys, Text
from sidmacib.structure.blocks import Block
from sidmacib.structure.files.compas import DENSITIES, read_compas, read_compas_interfaces
from sidmacib.structure.files.meshes import blocks_from_mesh
from sidmacib.structure.files.repair import chosen
from sidmacib.structure.interfaces import Interface, mean_size
from sidmacib.structure.warnings import BLOCK
from sidmacib.validation import refused

Unit = Literal["m", "cm", "mm", "in", "ft"]
UPWARDS = {  # what turns a file's coordinates so that z is up
    "x": ((0, 1, 0), (0, 0, 1), (1, 0, 0)),
    "y": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "z": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
}


def _held(value: Any) -> Any:
    if not isinstance(value, bool | list | tuple):
        raise ValueError(f"{shown(value)} is not allowed; it must be true, false, or a list")
    return value


class FileSection(Keys):
    """Blocks from OBJ, PLY, STL or OFF files, from Rhino's 3dm, or from the JSON of COMPAS."""

    file: Text
    """its path, from the folder of this file; with `*` all that fit, a block or more from each"""
    unit: Unit | None = None
    """unit of its lengths: by default that of a 3dm file, else m"""
    scale: Annotated[float, Number(above=0)] | None = None
    """m per unit of the file, in place of `unit`"""
    up: Literal["x", "y", "z"] = "z"
    """its axis that points upwards"""
    density: Annotated[float, DENSITIES] = 2000.0
    fixed: Annotated[StrictBool | tuple[Text, ...], BeforeValidator(_held)] | None = None
    """whether the blocks cannot move, or names or patterns of those that cannot; of COMPAS by
    default its supports"""

    fixed_below: Annotated[float, Number(unit="m")] | None = None
    """height z that blocks reach below which cannot move, beside those that `fixed` names"""

    @model_validator(mode="after")
    def _is_one(self) -> Self:
        if self.unit is not None and self.scale is not None:
            raise ValueError("scale: must not be given beside unit")
        return self

    @property
    def length(self) -> float | None:
        """M per unit of the file, if it is given."""
        return self.scale if self.unit is None else MEASURED_IN["m"].units[self.unit]

    def blocks(self, name: str, folder: Path) -> list[Block]:
        """The blocks, whose names begin with ``name``; ValueError."""
        try:
            paths = sorted(folder.glob(self.file)) if "*" in self.file else [folder / self.file]
            if not paths:
                raise refused("file", self.file, "a pattern that fits a file")
            several = len(paths) > 1
            found = [
                block
                for path in paths
                for block in self._in(f"{name}-{path.stem}" if several else name, path)
            ]
            if several or not self.file.endswith(".json"):  # of COMPAS nodes are fixed
                found = self._fixed(name, found)
            self._require_unit(found)
            if (height := self.fixed_below) is None:
                return found
            return [replace(b, fixed=b.fixed or b.places[:, 2].min() < height) for b in found]
        except ValueError as error:
            raise ValueError(f"blocks.{name}.{error}") from None

    def interfaces(self, folder: Path, blocks: Sequence[Block]) -> tuple[Interface, ...]:
        """Those that a file of COMPAS brings between its ``blocks``; none of another file."""
        path = folder / self.file
        return read_compas_interfaces(path, blocks, self._frame) if self.is_compas else ()

    @property
    def is_compas(self) -> bool:
        """Whether the file is one of COMPAS."""
        return self.file.endswith(".json") and "*" not in self.file

    @property
    def _frame(self) -> Floats:
        return np.array(UPWARDS[self.up], float) * (self.length or 1.0)

    def _in(self, name: str, path: Path) -> list[Block]:
        if not path.is_file():
            raise refused("file", self.file, "a file that is there")
        if path.suffix == ".json":
            if isinstance(self.fixed, bool):
                raise refused("fixed", self.fixed, "a list of nodes")
            fixed = () if self.fixed is None and self.fixed_below is not None else self.fixed
            return list(read_compas(path, self.density, fixed, name, self._frame))
        bodies = blocks_from_mesh(
            path, self.density, np.array(UPWARDS[self.up], float), self.length
        )
        alone = len(bodies) == 1
        return [replace(b, name=name if alone else f"{name}-{k}") for k, b in bodies.items()]

    def _fixed(self, name: str, blocks: list[Block]) -> list[Block]:
        """``blocks`` of which those that cannot move are fixed."""
        if self.fixed is None:
            return blocks
        names = [block.name.removeprefix(f"{name}-") for block in blocks]
        if isinstance(self.fixed, bool):
            held = set(names) if self.fixed else set()
        else:
            held = chosen(self.fixed, names, "true, false, or a list of")
        return [replace(b, fixed=own in held) for b, own in zip(blocks, names, strict=True)]

    def _require_unit(self, blocks: list[Block]) -> None:
        """ValueError if blocks are so large that metres are hardly meant."""
        size = mean_size(blocks)
        if self.length is None and not self.file.endswith(".3dm") and size > BLOCK.likely[1]:
            raise ValueError(
                f"file: {self.file}: its blocks would be {size:.4g} m across; say unit: mm, or "
                f"{', '.join(each for each in get_args(Unit) if each != 'mm')}"
            )
