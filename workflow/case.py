"""A case: one model of one subject, a joint or a structure, under one load. Light to import."""

import hashlib
import importlib
import json
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Generic, TypeVar

from sidmacib.engines import Numerics
from sidmacib.joint import Direction, Joint
from sidmacib.joint.loading import Loading, posed
from sidmacib.mechanics.assembly import NodeLayout
from sidmacib.problem import Problem
from sidmacib.validation import dataclass_from, plain

REFERENCE = "reference"  # the variant without changes; compared with the published numbers
STRUCTURE_FILE = "sidmacib.structure.files.structure_file"


@dataclass(frozen=True, slots=True)
class JointSubject:
    """A joint of a sample under a load; ``mesh`` in m, ``nodes`` on its cells."""

    kind: ClassVar[str] = "cases"
    part: ClassVar[str] = "workflow.results.joint_part"  # module of its part of a record
    modules: ClassVar[tuple[str, ...]] = (part,)
    demands: ClassVar[bool] = False

    sample: str
    joint: Joint
    mesh: float
    nodes: NodeLayout
    loading: Loading

    def problem(self) -> Problem:
        """The pieces of the joint under its load.

        ValueError for a mesh that is too coarse, `CapacityError` if the joint can carry nothing.
        """
        return posed(self.joint, self.loading, self.mesh, self.nodes)

    def physics(self) -> dict[str, Any]:
        """All that its results depend on, as plain values."""
        found: dict[str, Any] = plain(self)
        del found["sample"]
        return found

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

    def series(self) -> str:
        """SHA-256 of joint, layout of the nodes and loads: the same at all meshes."""
        data = self.physics()
        del data["mesh"]
        return _digest(data)


@dataclass(frozen=True, slots=True)
class StructureSubject:
    """A structure under a load, both by name.

    ``description``: of the two, plain values as in a file of
    `sidmacib.structure.files.structure_file`.
    """

    kind: ClassVar[str] = "structures"
    part: ClassVar[str] = "workflow.results.structure_part"
    # Both are imported by name, so that no joint runs again when the code of structures changes.
    modules: ClassVar[tuple[str, ...]] = (part, STRUCTURE_FILE)

    structure: str
    load: str
    description: dict[str, Any]

    @property
    def demands(self) -> bool:
        """Whether the description says how much of the load is to be carried."""
        load = self.description.get("load")
        return isinstance(load, Mapping) and not {"newtons", "over_weight"}.isdisjoint(load)

    def problem(self) -> Problem:
        """The blocks under their load; ValueError if the description is not of such."""
        found: Problem = importlib.import_module(STRUCTURE_FILE).structure_of(self.description)
        return found

    def physics(self) -> dict[str, Any]:
        """All that its results depend on, as plain values."""
        return {"description": self.description}


@dataclass(frozen=True, slots=True)
class EarthquakeSubject:
    """A structure that a record moves in time, with a ``factor`` on its accelerations."""

    kind: ClassVar[str] = "earthquakes"
    part: ClassVar[str] = "workflow.results.earthquake_part"
    modules: ClassVar[tuple[str, ...]] = (part, STRUCTURE_FILE)
    demands: ClassVar[bool] = False

    structure: str
    record: str
    factor: float
    description: dict[str, Any]

    def problem(self) -> Problem:
        """The blocks and what moves them, but for the factor."""
        read = importlib.import_module(STRUCTURE_FILE).demands_of
        found: Problem = read(self.description, in_time=True)[0].problem
        return found

    def physics(self) -> dict[str, Any]:
        """All that its results depend on, as plain values."""
        return {"description": self.description, "factor": self.factor}


SUBJECTS = {each.kind: each for each in (JointSubject, StructureSubject, EarthquakeSubject)}
Subject = TypeVar("Subject", JointSubject, StructureSubject, EarthquakeSubject)


@dataclass(frozen=True, slots=True)
class Case(Generic[Subject]):
    """One run of a model of a subject; ``numerics``: for engines only."""

    name: str
    model: str
    variant: str
    subject: Subject
    numerics: Numerics | None

    @property
    def folder(self) -> str:
        """The folder of its files, below the results folder: its identity."""
        return f"{self.subject.kind}/{self.model}/{self.name}"

    def digest(self) -> str:
        """SHA-256 of everything that the results depend on, which excludes the names."""
        return _digest([self.model, self.subject.physics(), plain(self.numerics)])

    def physics(self) -> str:
        """SHA-256 of the subject: the same for all models of a case."""
        return _digest(self.subject.physics())

    def to_json(self) -> str:
        """The case as JSON, exactly; infinity as text."""
        data = {
            "name": self.name,
            "model": self.model,
            "variant": self.variant,
            "kind": self.subject.kind,
            "subject": plain(self.subject),
            "numerics": plain(self.numerics),
        }
        return json.dumps(data, indent=1, allow_nan=False) + "\n"

    @classmethod
    def from_json(cls, text: str) -> "Case[Subject]":
        """The case that `to_json` wrote."""
        data = json.loads(text)
        kind: Any = SUBJECTS[data.pop("kind")]
        data["subject"] = dataclass_from(kind, data["subject"])
        if data["numerics"] is not None:
            data["numerics"] = dataclass_from(Numerics, data["numerics"])
        return cls(**data)


JointCase = Case[JointSubject]
StructureCase = Case[StructureSubject]
EarthquakeCase = Case[EarthquakeSubject]


def case_name(sample: str, mesh: float, ratio: float, variant: str = REFERENCE) -> str:
    """Name of a joint's case, ``ratio`` being e / a."""
    direction = "torsion" if math.isinf(ratio) else f"e{ratio:g}a"
    return _varied(f"{sample}-mesh{mesh:g}-{direction}", variant)


def structure_case_name(structure: str, load: str, variant: str = REFERENCE) -> str:
    """Name of a structure's case, fit for files."""
    return _varied(f"{structure}-{re.sub('[^A-Za-z0-9_.]', '_', load)}", variant)


def _varied(name: str, variant: str) -> str:
    return name if variant == REFERENCE else f"{name}-{variant}"


def _digest(value: Mapping[str, Any] | list[Any]) -> str:
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()
