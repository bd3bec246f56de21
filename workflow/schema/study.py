"""A whole study."""

import math
from typing import Any, Self

from pydantic import Field, model_validator

from sidmacib.joint.joint import Joint
from sidmacib.mechanics.assembly import Elastic, NodeLayout
from sidmacib.quantities import Length
from sidmacib.reading import Section
from workflow.case import REFERENCE
from workflow.schema.assembly import AssemblySection, Pieces, VariantSection
from workflow.schema.campaign import Campaign
from workflow.schema.dem import DemSection, NumericsChanges
from workflow.schema.joint import (
    GeometrySection,
    MaterialsSection,
    PartSection,
    SampleSection,
)
from workflow.schema.measured import MeasuredSection
from workflow.schema.sampling import CalibrationSection, SamplingSection
from workflow.schema.sidmacib import SidmacibSection
from workflow.schema.structures import StructureSection
from workflow.schema.values import Eccentricities, Folder, Lengths, Name, Positive


class FiguresSection(Section):
    """Mesh (m) of the stress maps, the finest if None, and their eccentricity over a."""

    mesh: Length | None = None
    eccentricity: Positive = 0.5


# What the tables of all models depend on; the engines' numerics are not part of it. With further
# sections it is a study still.
_TABLES = (
    *("samples", "geometry", "materials", "meshes", "nodes", "eccentricities", "assembly"),
    *("models", "sidmacib"),
)


class Study(Section):
    """A whole study: joints, meshes, directions of loading, and the models that are run on them."""

    results: Folder = "results"
    samples: dict[Name, SampleSection] = Field(default_factory=dict)
    geometry: GeometrySection = GeometrySection()
    materials: MaterialsSection = MaterialsSection()
    meshes: Lengths = (0.02, 0.005)
    nodes: NodeLayout = NodeLayout.LOBATTO
    eccentricities: Eccentricities = (0.0, 0.05, 0.1, 0.2, 0.35, 0.5, 1.0, 2.0, math.inf)
    assembly: AssemblySection = AssemblySection()
    models: tuple[str, ...]
    sidmacib: SidmacibSection = SidmacibSection()
    dem: DemSection
    variants: dict[Name, VariantSection] = Field(default_factory=dict)
    overrides: dict[str, NumericsChanges] = Field(default_factory=dict)
    calibration: CalibrationSection = CalibrationSection()
    figures: FiguresSection = FiguresSection()
    samplings: dict[Name, SamplingSection] = Field(default_factory=dict)
    campaign: Campaign | None = None
    measured: MeasuredSection | None = None
    structures: dict[Name, StructureSection] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _of_something(self) -> Self:
        if not self.samples and not self.structures:
            raise ValueError("samples: missing; it must name at least one, unless structures does")
        return self

    @property
    def model_names(self) -> tuple[str, ...]:
        """Names of the models that the study runs: engines, then the others."""
        return *self.dem.engines, *self.models

    @property
    def every_variant(self) -> dict[str, VariantSection]:
        """The variants by name, the one without changes first."""
        return {REFERENCE: VariantSection(), **self.variants}

    @property
    def interlocking(self) -> tuple[str, ...]:
        """Names of the samples that SiDMACIB is a model of: those of at least two locks."""
        return tuple(name for name, sample in self.samples.items() if sample.locks > 1)

    def models_of(self, sample: str) -> tuple[str, ...]:
        """Those of `model_names` that run on ``sample``."""
        names = self.samples[sample].models
        return tuple(name for name in self.model_names if names is None or name in names)

    def whole_curve(self, sample: str, model: str) -> bool:
        """Whether ``model`` runs ``sample`` at all meshes and eccentricities of the study."""
        part = self.samples[sample].only.get(model, PartSection())
        return {*self.meshes} <= {*(part.meshes or self.meshes)} and {*self.eccentricities} <= {
            *(part.eccentricities or self.eccentricities)
        }

    @property
    def base_joint(self) -> Joint:
        """The properties that all joints of samplings share: width, strength and weight."""
        return SampleSection(locks=2).joint(self.geometry, self.materials)

    def joint(self, sample: str, change: VariantSection | None = None) -> Joint:
        """The joint of ``sample``, with the changes of a variant."""
        change = change or VariantSection()
        assembly, inner = change.assembly(self.assembly), self.materials.inner
        if change.fracture_energy is not None:
            inner = inner.model_copy(update={"fracture_energy": change.fracture_energy})
        return self.samples[sample].joint(
            self.geometry,
            self.materials.model_copy(update={"inner": inner}),
            failure=assembly.failure,
            upper_body=assembly.upper_body,
            hold_down=assembly.hold_down,
            elastic=self._block(change.young) if assembly.pieces is Pieces.ELASTIC else None,
        )

    def _block(self, young: float | None) -> Elastic:
        return Elastic(young or self.materials.young, self.materials.poisson)

    def tables_json(self) -> str:
        """The part of the study that the tables depend on, as JSON."""
        return self._selected()

    def measured_json(self) -> str:
        """The part of the study that the comparison with measured loads depends on, as JSON."""
        return self._selected("measured")

    def pieces_json(self) -> str:
        """The part of the study that models without an engine depend on, as JSON."""
        return self._selected("variants")

    def figures_json(self) -> str:
        """The part of the study that the figures depend on, as JSON."""
        return self._selected("variants", "figures", "measured")

    def structures_json(self) -> str:
        """The structures and the models that analyse them, as JSON."""
        return self.model_dump_json(
            include={"structures": True, "models": True, "dem": {"engines"}}
        )

    def calibration_json(self) -> str:
        """The part of the study that the calibration depends on, as JSON."""
        return self.model_dump_json(include={*_TABLES, "dem", "calibration"})

    def _selected(self, *sections: str) -> str:
        """`_TABLES`, the engines' names and some ``sections``: a valid study."""
        chosen: dict[str, Any] = dict.fromkeys((*_TABLES, *sections), True)
        return self.model_dump_json(include={**chosen, "dem": {"engines"}})
