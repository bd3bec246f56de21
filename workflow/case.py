"""A case: one model, one joint, one mesh, one direction of loading. Light to import."""

import hashlib
import json
import math
import types
import typing
from collections.abc import Collection
from dataclasses import asdict, dataclass, fields, is_dataclass
from enum import StrEnum
from functools import cache
from typing import Any

from sidmacib.joint import Direction, Joint
from sidmacib.loading import Loading
from sidmacib.mechanics.assembly import NodeLayout
from workflow.engines.numerics import Numerics

REFERENCE = "reference"  # the variant without changes; compared with the published numbers
APART = 1.5  # ratio of two meshes, at least, to tell a mesh error: closer ones may give equal cells


def missing_level(meshes: Collection[float]) -> float | None:
    """The mesh (m) that ``meshes`` lack to tell a mesh error: half the finest, None if they can."""
    finest = min(meshes)
    return finest / 2.0 if max(meshes) < APART * finest else None


@dataclass(frozen=True, slots=True)
class Case:
    """One run of a model of the joint's pieces.

    ``mesh`` in m, ``nodes`` on its cells. ``numerics``: for engines only.
    """

    name: str
    model: str
    variant: str
    sample: str
    joint: Joint
    mesh: float
    nodes: NodeLayout
    loading: Loading
    numerics: Numerics | None

    @property
    def direction(self) -> Direction:
        """Direction of loading in the (V, M) plane."""
        return self.loading.direction

    @property
    def eccentricity_m(self) -> float:
        """The eccentricity e in m; ``inf`` is pure torsion."""
        return self.direction.eccentricity * self.joint.a

    @property
    def key(self) -> str:
        """Sample, mesh and direction: the same for all models and variants."""
        return case_name(self.sample, self.mesh, self.direction.eccentricity)

    def digest(self) -> str:
        """SHA-256 of all that the results depend on: everything except the names."""
        told = _plain(self)
        for key in ("name", "variant", "sample"):
            del told[key]
        return hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()

    def physics(self) -> str:
        """SHA-256 of joint, nodes and loads: the same for all models of a case."""
        return self._digest("joint", "mesh", "nodes", "loading")

    def series(self) -> str:
        """SHA-256 of joint, layout of the nodes and loads: the same at all meshes."""
        return self._digest("joint", "nodes", "loading")

    def _digest(self, *keys: str) -> str:
        told = _plain(self)
        shared = {key: told[key] for key in keys}
        return hashlib.sha256(json.dumps(shared, sort_keys=True).encode()).hexdigest()

    def to_json(self) -> str:
        """The case as JSON, exactly; infinity as text."""
        return json.dumps(_plain(self), indent=1, allow_nan=False) + "\n"

    @classmethod
    def from_json(cls, text: str | bytes) -> "Case":
        """The case that `to_json` wrote; ValueError if ``text`` is anything else."""
        try:
            found = _built(cls, json.loads(text, parse_constant=_refused))
        except (TypeError, RecursionError, ValueError) as error:
            raise ValueError(f"not a case: {error}") from None
        assert isinstance(found, cls)
        return found


def case_name(sample: str, mesh: float, ratio: float, variant: str = REFERENCE) -> str:
    """Name of a case, ``ratio`` being e / a."""
    direction = "torsion" if math.isinf(ratio) else f"e{ratio:g}a"
    name = f"{sample}-mesh{mesh:g}-{direction}"
    return name if variant == REFERENCE else f"{name}-{variant}"


def _plain(case: Case) -> dict[str, Any]:
    told = asdict(case)
    direction = told["loading"]["direction"]
    if math.isinf(direction["eccentricity"]):
        direction["eccentricity"] = "inf" if direction["eccentricity"] > 0 else "-inf"
    return told


def _refused(constant: str) -> None:
    raise ValueError(f"{constant} is not a number")


def _built(kind: Any, value: Any) -> Any:
    """``value``, read from JSON, as ``kind``; ValueError or TypeError if it is not of that kind."""
    if isinstance(kind, types.UnionType):
        *_, kept = (k for k in typing.get_args(kind) if k is not types.NoneType)
        # Of several kinds that are taken, the last is the one that is kept, and so written.
        return None if value is None else _built(kept, value)
    if typing.get_origin(kind) is tuple:
        if not isinstance(value, list):
            raise ValueError(f"{str(value)[:60]!r} is not a list")
        first, *others = typing.get_args(kind)
        every = [first] * len(value) if others == [...] else [first, *others]
        return tuple(_built(own, each) for own, each in zip(every, value, strict=True))
    if isinstance(kind, type) and is_dataclass(kind):
        hints = _hints(kind)
        if not isinstance(value, dict) or set(value) != set(hints):
            raise ValueError(f"{kind.__name__} must have the keys {', '.join(hints)}")
        return kind(**{key: _built(hints[key], own) for key, own in value.items()})
    if issubclass(kind, StrEnum):
        return kind(value)
    if kind is float and (value in ("inf", "-inf") or type(value) in (float, int)):
        return float(value)
    if type(value) is not kind:
        raise ValueError(f"{str(value)[:60]!r} is not of the kind {kind.__name__}")
    return value


@cache
def _hints(kind: Any) -> dict[str, Any]:
    hints = typing.get_type_hints(kind)
    return {field.name: hints[field.name] for field in fields(kind)}
