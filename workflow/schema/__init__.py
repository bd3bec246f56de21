"""The keys of a study: units, ranges and defaults; here the whole, and all sections but of joints.

It names no model; `workflow.consistency` checks the abilities of models.
"""

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import BeforeValidator, Field, WithJsonSchema, model_validator

from sidmacib.contact_points import OPTIONS, READY_OPTIONS, REDUCTIONS, ContactOption
from sidmacib.joint import Joint
from sidmacib.mechanics.assembly import Elastic, NodeLayout
from sidmacib.quantities import Friction, Length, Number, Part, Share, one_of, shown
from sidmacib.reading import Label, Section, Some, Text
from workflow.case import REFERENCE
from workflow.schema.earthquakes import EarthquakeSection
from workflow.schema.sections import (
    AssemblySection,
    Eccentricities,
    Eccentricity,
    Folder,
    GeometrySection,
    Lengths,
    MaterialsSection,
    Name,
    NumericsChanges,
    NumericsSection,
    Pieces,
    Positive,
    ReliabilitySection,
    SampleSection,
    SamplingSection,
    VariantSection,
)

STUDIES = Path(__file__).parents[2] / "studies"

Campaign = Annotated[str, one_of(sorted(path.parent.name for path in STUDIES.glob("*/rules.smk")))]
HEIGHT_SHARES = (0.2, 0.21, 0.22, 0.23, 0.24, 0.25, 0.26)  # of the calibration
HEIGHTS_OVER_B = (0.3, 0.5, 0.7, 0.9, 1.0, 1.1, 1.2, 1.3, 1.4)
FRICTIONS = (0.0, 0.005236, 0.01, 0.02, 0.03, 0.05, 0.1, 0.2, 0.3, 0.4)
LOAD, CASES, PERMANENT = "load", "load_cases", "permanent"  # keys of a description
FILE = "structure.schema.json"  # beside the schema of studies; `see` becomes a reference there
# What the tables of all models depend on; the engines' numerics are not part of it. With further
# sections it is a study still.
_TABLES = (
    *("samples", "geometry", "materials", "reliability", "meshes", "nodes", "eccentricities"),
    *("assembly", "models", "sidmacib"),
)


def _in_a_line(value: Any) -> Any:
    return " ".join(value.split()) if isinstance(value, str) else value


Words = Annotated[Label, BeforeValidator(_in_a_line)]
_Force = Annotated[float, Number(above=0, unit="N")]
_Torque = Annotated[float, Number(above=0, unit="N m")]


class DemSection(Section):
    """Engines by name, the longest time for one case (s), and the engines' numerics."""

    engines: tuple[str, ...]
    time_limit: Annotated[float, Number(at_least=1, at_most=1e7, unit="s")] = 3600.0
    numerics: NumericsSection = NumericsSection()


class OptionSection(Section):
    """Contact points of a lock: positions over a, and shares of its strength."""

    positions: Annotated[tuple[Annotated[float, Number(at_least=-0.5, at_most=0.5)], ...], Some]
    portions: Annotated[tuple[Part, ...], Some]

    @model_validator(mode="after")
    def _fits(self) -> Self:
        self.contact_option()
        return self

    def contact_option(self) -> ContactOption:
        """The section as the models take it; ValueError if positions and portions do not match."""
        return ContactOption(self.positions, self.portions)


_READY = {
    name: OptionSection(positions=option.positions, portions=option.portions)
    for name, option in READY_OPTIONS.items()
}


def _with_ready(value: Any) -> Any:
    """Options with those given only by name replaced by their definitions."""
    named = isinstance(value, list | tuple) and all(isinstance(name, str) for name in value)
    options = dict.fromkeys(value) if named else value
    if not isinstance(options, Mapping):
        return value
    for name, option in options.items():
        if option is None and name not in _READY:
            raise ValueError(
                f"{shown(name)} needs positions and portions; without them it must be one of "
                f"{', '.join(_READY)}"
            )
    return {name: _READY[name] if option is None else option for name, option in options.items()}


class SidmacibSection(Section):
    """The overload on the upper block (N), contact points, and rules for which locks count."""

    overload: Annotated[float, Number(at_least=0, unit="N")] = 1000.0
    options: Annotated[
        dict[Name, OptionSection],
        Some,
        BeforeValidator(
            _with_ready, json_schema_input_type=list[Name] | dict[Name, OptionSection | None]
        ),
    ] = Field(default={name: _READY[name] for name in OPTIONS})
    reductions: Annotated[tuple[Annotated[str, one_of(REDUCTIONS)], ...], Some] = tuple(REDUCTIONS)


class MeasuredLoad(Section):
    """A measured load: its shear V (N) or its torque M (N m), at an eccentricity e / a."""

    sample: Name
    eccentricity: Eccentricity
    shear: _Force | None = None
    torque: _Torque | None = None
    specimen: Words | None = None

    @model_validator(mode="after")
    def _one_of_both(self) -> Self:
        always_zero = {0.0: "torque", math.inf: "shear"}.get(self.eccentricity)
        given = [name for name in ("shear", "torque") if getattr(self, name) is not None]
        if len(given) != 1 or given == [always_zero]:
            raise ValueError(
                "one of shear (N) and torque (N m) must be given, shear alone where the "
                "eccentricity is 0, torque alone in torsion"
            )
        return self

    def components(self, a: float) -> tuple[float, float]:
        """Shear (N) and torque (N m), where locks are ``a`` (m) long."""
        if math.isinf(self.eccentricity):
            return 0.0, self.torque or 0.0
        arm = self.eccentricity * a
        shear = self.shear if self.shear is not None else (self.torque or 0.0) / arm
        return shear, shear * arm


class DemandSection(Section):
    """A load that each joint must carry: V (N) and M (N m), or V at an eccentricity e / a."""

    shear: _Force | None = None
    torque: _Torque | None = None
    eccentricity: Eccentricity | None = None

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if not (self.shear or self.torque):
            raise ValueError("shear (N) or torque (N m) must be given, or both")
        ratio = self.eccentricity
        if ratio is not None and (self.torque or math.isinf(ratio)):
            raise ValueError("eccentricity must be finite, and beside shear alone")
        return self


class MeasuredSection(Section):
    """Measured loads of one campaign; ``source``: where they stand, ``digitised``: how read."""

    source: Words
    digitised: Words
    loads: tuple[MeasuredLoad, ...]


class MeasuredCapacity(Section):
    """A measured load of a structure, and by name the load and the variant that it is of."""

    newtons: _Force
    load: Text = LOAD
    variant: Text = REFERENCE
    specimen: Words | None = None


class MeasuredStructure(Section):
    """Measured loads of a structure, which are compared with computed ones and change none.

    ``source``: where they stand. ``scatter``: their coefficient of variation, if it is known.
    """

    source: Words
    loads: Annotated[tuple[MeasuredCapacity, ...], Some]
    scatter: Share | None = None


_Description = Annotated[dict[Text, Any], Some, WithJsonSchema({"see": FILE})]
_Changes = Annotated[dict[Text, Any], WithJsonSchema({"type": "object"})]
_Load = Annotated[dict[Text, Any], Some, WithJsonSchema({"see": f"{FILE}#/$defs/LoadSection"})]


class StructureSection(Section):
    """A structure of blocks: a ``file`` of `multilock assembly`, or its ``description`` here.

    ``file``: beside the configuration. ``models``: which of the study's models and engines analyse
    it, by default all that can. ``loads``: by name, in place of the load, or the load cases, in the
    description. ``variants``: by name, changes to the description, where null leaves a key out;
    they run beside the reference variant. ``measured``: loads of tests beside the computed ones.
    """

    file: Annotated[str, Some] | None = None
    description: _Description | None = None
    models: tuple[str, ...] | None = None
    loads: dict[Name, _Load] = Field(default_factory=dict)
    variants: dict[Name, _Changes] = Field(default_factory=dict)
    measured: MeasuredStructure | None = None

    def described(self) -> Iterator[tuple[str, str, dict[str, object]]]:
        """Load, variant and description of each case, whatever its model.

        Loads are those of the study, or else the load cases of the description, or its load.
        """
        for variant, whole in self.wholes():
            always = {key: value for key, value in whole.items() if key != CASES}
            if self.loads:
                for name, load in self.loads.items():
                    yield name, variant, {**always, LOAD: load}
            elif cases := load_cases(whole):
                for name, case in cases.items():
                    load = {key: value for key, value in case.items() if key != PERMANENT}
                    own = [*always.get(PERMANENT, ()), *case.get(PERMANENT, ())]
                    yield name, variant, {**always, LOAD: load, **({PERMANENT: own} if own else {})}
            else:
                yield LOAD, variant, whole

    def wholes(self) -> Iterator[tuple[str, dict[str, Any]]]:
        """Each variant, and its description, with its load or load cases."""
        for variant, changes in {REFERENCE: {}, **self.variants}.items():
            yield variant, with_changes(self.description or {}, changes)


def load_cases(description: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    """The load cases of a ``description`` by name; none of what is not a mapping of mappings."""
    cases = description.get(CASES)
    if not isinstance(cases, Mapping) or not all(isinstance(v, Mapping) for v in cases.values()):
        return {}
    return {str(name): case for name, case in cases.items()}


def with_changes(description: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """``description`` with ``changes``, key by key; null takes a key away."""
    found = dict(description)
    for key, value in changes.items():
        before = found.get(key)
        if value is None:
            found.pop(key, None)
        elif isinstance(value, Mapping) and isinstance(before, Mapping):
            found[key] = with_changes(before, value)
        else:
            found[key] = value
    return found


class CalibrationSection(Section):
    """A grid of geometries and frictions, meshes (m), and how many of the best the engines run."""

    a: Lengths = (0.03, 0.06, 0.1)
    # h / (h + H), (h + H) / b, and of dry faces
    height_share: Annotated[tuple[Share, ...], Some] = HEIGHT_SHARES
    height_over_b: Annotated[tuple[Positive, ...], Some] = HEIGHTS_OVER_B
    friction: Annotated[tuple[Friction, ...], Some] = FRICTIONS
    meshes: Lengths = (0.02, 0.005)
    confirmed: Annotated[int, Number(at_least=1, at_most=20, whole=True)] = 3


class FiguresSection(Section):
    """Mesh (m) of the stress maps, the finest if None, and their eccentricity over a."""

    mesh: Length | None = None
    eccentricity: Positive = 0.5


class Study(Section):
    """A whole study: joints, meshes, directions of loading, and the models that are run on them."""

    results: Folder = "results"
    samples: dict[Name, SampleSection] = Field(default_factory=dict)
    geometry: GeometrySection = GeometrySection()
    materials: MaterialsSection = MaterialsSection()
    reliability: ReliabilitySection = ReliabilitySection()
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
    demand: DemandSection | None = None
    structures: dict[Name, StructureSection] = Field(default_factory=dict)
    earthquakes: dict[Name, EarthquakeSection] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _of_something(self) -> Self:
        if not (self.samples or self.structures or self.earthquakes):
            allowed = "it must name at least one, unless structures or earthquakes does"
            raise ValueError(f"samples: missing; {allowed}")
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

    def models_of_whole(self, sample: str) -> tuple[str, ...]:
        """Those of `models_of` that run all of a sample: all meshes and eccentricities."""
        parts = {name: self.samples[sample].only.get(name) for name in self.models_of(sample)}
        return tuple(
            name
            for name, part in parts.items()
            if part is None
            or (
                {*self.meshes} <= {*(part.meshes or self.meshes)}
                and {*self.eccentricities} <= {*(part.eccentricities or self.eccentricities)}
            )
        )

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
            elastic=Elastic(change.young or self.materials.young, self.materials.poisson)
            if assembly.pieces is Pieces.ELASTIC
            else None,
        )

    def part(self, *sections: str) -> str:
        """What the tables of all models depend on, and further ``sections``, as JSON.

        A valid study, of the engines' names only.
        """
        chosen: dict[str, Any] = dict.fromkeys((*_TABLES, *sections), True)
        return self.model_dump_json(include={**chosen, "dem": {"engines"}})
