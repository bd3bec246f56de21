"""A case of a structure: one model, one structure, one load, one variant. Light to import."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from sidmacib.engines.numerics import Numerics
from workflow.joints.case import REFERENCE, CaseId

FOLDER = "structures"  # below the results folder


@dataclass(frozen=True, slots=True)
class StructureCase:
    """One run of a model of a structure.

    ``description``: of the structure and its load, plain values as in a file of
    `sidmacib.structure.files.structure_file`. ``numerics``: for engines only.
    """

    name: str
    model: str
    structure: str
    load: str
    variant: str
    description: Mapping[str, Any]
    numerics: Numerics | None

    @property
    def id(self) -> CaseId:
        """Its identity in its study: no joint's case has such a name."""
        return CaseId(self.model, f"{FOLDER}/{self.name}")

    def digest(self) -> str:
        """SHA-256 of all that the results depend on: everything except the names."""
        return _digest([self.model, dict(self.description), _plain(self.numerics)])

    def physics(self) -> str:
        """SHA-256 of the structure and its load: the same for all models."""
        return _digest(dict(self.description))

    def to_json(self) -> str:
        """The case as JSON, exactly."""
        return json.dumps(asdict(self), indent=1, allow_nan=False) + "\n"

    @classmethod
    def from_json(cls, text: str | bytes) -> "StructureCase":
        """The case that `to_json` wrote; ValueError if ``text`` is anything else."""
        try:
            data = json.loads(text)
            numerics = data.pop("numerics")
            return cls(**data, numerics=None if numerics is None else Numerics(**numerics))
        except (TypeError, KeyError, AttributeError, RecursionError, ValueError) as error:
            raise ValueError(f"not a case of a structure: {error}") from None


def structure_case_name(structure: str, load: str, variant: str = REFERENCE) -> str:
    """Name of a case of a structure."""
    name = f"{structure}-{load}"
    return name if variant == REFERENCE else f"{name}-{variant}"


def changed(description: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """``description`` with ``changes``, key by key; null takes a key away."""
    found = dict(description)
    for key, value in changes.items():
        before = found.get(key)
        if value is None:
            found.pop(key, None)
        elif isinstance(value, Mapping) and isinstance(before, Mapping):
            found[key] = changed(before, value)
        else:
            found[key] = value
    return found


def _plain(numerics: Numerics | None) -> dict[str, Any] | None:
    return None if numerics is None else asdict(numerics)


def _digest(value: Any) -> str:
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()
