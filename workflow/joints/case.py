"""A case: one model, one joint, one mesh, one direction of loading. Light to import."""

import hashlib
import json
import math
from dataclasses import asdict, dataclass
from typing import Any, NamedTuple

from sidmacib.engines.numerics import Numerics
from sidmacib.fields import dataclass_from
from sidmacib.joint.joint import Direction, Joint
from sidmacib.joint.loading import Loading
from sidmacib.mechanics.assembly import NodeLayout

REFERENCE = "reference"  # the variant without changes; compared with the published numbers


class CaseId(NamedTuple):
    """The identity of a case in its study: the model and the case's name."""

    model: str
    name: str

    @property
    def folder(self) -> str:
        """The folder of the case's files, below the results folder."""
        return f"cases/{self.model}/{self.name}"


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
    def id(self) -> CaseId:
        """Its identity in its study."""
        return CaseId(self.model, self.name)

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
        """SHA-256 of everything that the results depend on, which excludes the names."""
        data = _plain(self)
        for key in ("name", "variant", "sample"):
            del data[key]
        return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()

    def physics(self) -> str:
        """SHA-256 of joint, nodes and loads: the same for all models of a case."""
        return self._digest("joint", "mesh", "nodes", "loading")

    def series(self) -> str:
        """SHA-256 of joint, layout of the nodes and loads: the same at all meshes."""
        return self._digest("joint", "nodes", "loading")

    def _digest(self, *keys: str) -> str:
        data = _plain(self)
        shared = {key: data[key] for key in keys}
        return hashlib.sha256(json.dumps(shared, sort_keys=True).encode()).hexdigest()

    def to_json(self) -> str:
        """The case as JSON, exactly; infinity as text."""
        return json.dumps(_plain(self), indent=1, allow_nan=False) + "\n"

    @classmethod
    def from_json(cls, text: str | bytes) -> "Case":
        """The case that `to_json` wrote; ValueError if ``text`` is anything else."""
        try:
            data = json.loads(text)
            case = dataclass_from(cls, data)
            if case.to_json() == json.dumps(data, indent=1) + "\n":
                return case
        except (AttributeError, KeyError, RecursionError, TypeError, ValueError) as error:
            raise ValueError(f"not a case: {error}") from None
        raise ValueError("not a case: it has other keys or values")


def case_name(sample: str, mesh: float, ratio: float, variant: str = REFERENCE) -> str:
    """Name of a case, ``ratio`` being e / a."""
    direction = "torsion" if math.isinf(ratio) else f"e{ratio:g}a"
    name = f"{sample}-mesh{mesh:g}-{direction}"
    return name if variant == REFERENCE else f"{name}-{variant}"


def _plain(case: Case) -> dict[str, Any]:
    data = asdict(case)
    direction = data["loading"]["direction"]
    if math.isinf(direction["eccentricity"]):
        direction["eccentricity"] = "inf" if direction["eccentricity"] > 0 else "-inf"
    return data
