"""The configuration of a study: its schema, with units, ranges and defaults."""

import math
import os
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from sidmacib.contact_points import OPTIONS, ContactOption
from sidmacib.joint import DRY, INNER, Joint, UpperBody
from sidmacib.loading import LoadShare, Push
from sidmacib.mechanics.assembly import FaceMaterial, Failure
from sidmacib.revision import REDUCTIONS
from workflow.engines import ENGINES
from workflow.solvers import SOLVERS

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Share = Annotated[float, Field(gt=0, lt=1)]
Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.]*$")]


def _eccentricity(value: Any) -> float:
    """E / a as a number; "torsion" is infinity."""
    try:
        number = math.inf if value == "torsion" else float(value)
    except (TypeError, ValueError):
        number = math.nan
    if not number >= 0:
        raise ValueError(f"got {value!r}, allowed are numbers from 0 (e / a) and torsion")
    return number


def _folder(value: Any) -> str:
    """A folder's name in its shortest form; numbers are names too."""
    if not str(value).strip():
        raise ValueError("got nothing, allowed is the name of a folder")
    return os.path.normpath(str(value))


Eccentricity = Annotated[float, BeforeValidator(_eccentricity)]  # over a


_JOINT = Joint(locks=3)


class Section(BaseModel):
    """A part of the configuration: no unknown keys, no changes after reading."""

    model_config = ConfigDict(extra="forbid", frozen=True, ser_json_inf_nan="strings")


class Geometry(Section):
    """Sizes of the joint, in m."""

    a: Positive = _JOINT.a  # length of a lock
    b: Positive = _JOINT.b  # width of a lock
    h: Positive = _JOINT.h  # height of a lock
    H: Positive = _JOINT.H  # height of the upper main body above the locks


class Sample(Section):
    """A joint of the study; sizes in m, those of the study's geometry where not given."""

    locks: Annotated[int, Field(ge=2, le=101)]
    a: Positive | None = None
    b: Positive | None = None
    h: Positive | None = None
    H: Positive | None = None


class Face(Section):
    """Material of a face, see `sidmacib.joint.FaceMaterial`."""

    normal_stiffness: Positive  # Pa/m
    shear_stiffness: Positive  # Pa/m
    friction: NotNegative  # coefficient
    cohesion: NotNegative  # Pa
    tensile_strength: NotNegative  # Pa

    def material(self) -> FaceMaterial:
        """The same as the models take it."""
        return FaceMaterial(**self.model_dump())


class InnerFace(Face):
    """Cohesive faces inside a block."""

    normal_stiffness: Positive = INNER.normal_stiffness
    shear_stiffness: Positive = INNER.shear_stiffness
    friction: NotNegative = INNER.friction
    cohesion: Positive = INNER.cohesion
    tensile_strength: NotNegative = INNER.tensile_strength


class DryFace(Face):
    """Frictional faces between the blocks; they have no strength of their own."""

    normal_stiffness: Positive = DRY.normal_stiffness
    shear_stiffness: Positive = DRY.shear_stiffness
    friction: NotNegative = DRY.friction
    cohesion: Literal[0] = 0
    tensile_strength: Literal[0] = 0


class Materials(Section):
    """Materials of the joint."""

    density: Positive = _JOINT.density  # kg/m3
    inner: InnerFace = InnerFace()
    dry: DryFace = DryFace()


class Option(Section):
    """Contact points of a lock: positions over a, and shares of its strength."""

    positions: tuple[Annotated[float, Field(ge=-0.5, le=0.5)], ...] = Field(min_length=1)
    portions: tuple[Annotated[float, Field(ge=0, le=1)], ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _fits(self) -> Self:
        self.contact_option()
        return self

    def contact_option(self) -> ContactOption:
        """The same as the models take it; ValueError if positions and portions do not fit."""
        return ContactOption(self.positions, self.portions)


class SidmacibSection(Section):
    """The limit model."""

    overload: NotNegative = 1000.0  # N
    options: Annotated[dict[Name, Option], Field(min_length=1)] = {
        name: Option(positions=option.positions, portions=option.portions)
        for name, option in OPTIONS.items()
    }
    reductions: Annotated[
        tuple[Literal[tuple(REDUCTIONS)], ...],  # type: ignore[valid-type]
        Field(min_length=1),
    ] = tuple(REDUCTIONS)


Tolerance = Annotated[float, Field(ge=1e-5, le=0.0025)]
FirstIncrement = Annotated[float, Field(gt=0, le=1)]
RampPeriods = Annotated[float, Field(ge=1, le=1000)]
HoldPeriods = Annotated[float, Field(ge=1, le=100_000)]
UnbalancedRatio = Annotated[float, Field(ge=1e-9, le=0.01)]
Ranks = Annotated[int, Field(ge=1, le=1024)]
CollapseRatio = Annotated[float, Field(ge=5, le=10_000)]


class Numerics(Section):
    """How the peak is searched; all ratios are pure numbers.

    ``tolerance``: last load increment over the peak. ``first_increment``: over T0.
    ``ramp_periods``, ``hold_periods``: duration of an increment and of the longest wait for
    equilibrium after it, over the unbroken joint's longest natural period. ``unbalanced_ratio``:
    mean unbalanced force on a piece over the load. ``collapse_ratio``: displacement over that of
    the unbroken joint under the same load. ``time_step_ratio``: over the largest stable time step.
    ``ranks``: processes for one case, of engines that can share it out.
    """

    tolerance: Tolerance = 0.001
    first_increment: FirstIncrement = 0.05
    ramp_periods: RampPeriods = 40.0
    hold_periods: HoldPeriods = 400.0
    unbalanced_ratio: UnbalancedRatio = 1e-4
    collapse_ratio: CollapseRatio = 200.0
    damping: Share = 0.4
    time_step_ratio: Share = 0.4
    ranks: Ranks = 1


class NumericsChange(Section):
    """Changes to `Numerics`; what is None stays."""

    tolerance: Tolerance | None = None
    first_increment: FirstIncrement | None = None
    ramp_periods: RampPeriods | None = None
    hold_periods: HoldPeriods | None = None
    unbalanced_ratio: UnbalancedRatio | None = None
    collapse_ratio: CollapseRatio | None = None
    damping: Share | None = None
    time_step_ratio: Share | None = None
    ranks: Ranks | None = None


class Assembly(Section):
    """How the joint is cut, loaded and fails, in every model of its pieces."""

    failure: Failure = Failure.BRITTLE
    load_share: LoadShare = LoadShare.FACE
    upper_body: UpperBody = UpperBody.COLUMNS
    push: Push = Push.PLUS_Y


class Dem(Section):
    """The distinct-element model."""

    engines: tuple[Literal[tuple(ENGINES)], ...] = tuple(ENGINES)  # type: ignore[valid-type]
    time_limit: Annotated[float, Field(ge=1, le=1e7)] = 3600.0  # s, of one case
    numerics: Numerics = Numerics()


class Variant(Section):
    """What differs from the reference, and where; everywhere if meshes, eccentricities are None."""

    failure: Failure | None = None
    load_share: LoadShare | None = None
    upper_body: UpperBody | None = None
    push: Push | None = None
    numerics: NumericsChange = NumericsChange()
    meshes: Annotated[tuple[Positive, ...], Field(min_length=1)] | None = None
    eccentricities: Annotated[tuple[Eccentricity, ...], Field(min_length=1)] | None = None

    def assembly(self, reference: Assembly) -> Assembly:
        """The assembly of this variant."""
        own = {key: getattr(self, key) for key in Assembly.model_fields}
        return reference.model_copy(update={k: v for k, v in own.items() if v is not None})


class Calibration(Section):
    """Geometries that the static model is tried on, to fit the published numbers."""

    a: Annotated[tuple[Positive, ...], Field(min_length=1)] = (0.03, 0.04, 0.05, 0.06, 0.075, 0.1)
    height_share: Annotated[tuple[Share, ...], Field(min_length=1)] = (
        *(0.18, 0.19, 0.2, 0.21, 0.22),
        *(0.23, 0.24, 0.25, 0.26, 0.27, 0.28),
    )  # h / (h + H)
    height_over_b: Annotated[tuple[Positive, ...], Field(min_length=1)] = (
        *(0.3, 0.4, 0.5, 0.6, 0.7, 0.8),
        *(0.9, 1.0, 1.1, 1.2, 1.4),
    )  # (h + H) / b
    mesh: Positive = 0.005  # m
    confirmed: Annotated[int, Field(ge=1, le=20)] = 3  # how many of the best engines run


class Figures(Section):
    """What the figures show: mesh in m (the finest if None), eccentricity of stress maps over a."""

    mesh: Positive | None = None
    eccentricity: Annotated[float, Field(gt=0, allow_inf_nan=False)] = 0.5


class Study(Section):
    """A whole study."""

    results: Annotated[str, BeforeValidator(_folder)] = "results"
    samples: dict[Name, Sample] = Field(min_length=1)
    geometry: Geometry = Geometry()
    materials: Materials = Materials()
    meshes: tuple[Positive, ...] = Field(default=(0.02, 0.005), min_length=1)
    eccentricities: tuple[Eccentricity, ...] = Field(
        default=(0.0, 0.05, 0.1, 0.2, 0.35, 0.5, 1.0, 2.0, math.inf), min_length=1
    )
    assembly: Assembly = Assembly()
    models: tuple[Literal[tuple(SOLVERS)], ...] = tuple(SOLVERS)  # type: ignore[valid-type]
    sidmacib: SidmacibSection = SidmacibSection()
    dem: Dem = Dem()
    variants: dict[Name, Variant] = {}
    overrides: dict[str, NumericsChange] = {}
    calibration: Calibration = Calibration()
    figures: Figures = Figures()

    @model_validator(mode="after")
    def _is_consistent(self) -> Self:
        meshes = [*self.meshes, *(m for v in self.variants.values() for m in v.meshes or ())]
        for name, sample in self.samples.items():
            joint = self.joint(name)
            side = min(joint.a, joint.b)
            if max(meshes) >= side:
                raise ValueError(
                    f"meshes: got {max(meshes)} m, allowed is less than {side} m, the shorter side "
                    f"of an inner face of sample {name}"
                )
            if sample.locks % 2 == 0 and "half" in self.sidmacib.reductions:
                raise ValueError(
                    f"samples.{name}.locks: got {sample.locks}, allowed are odd numbers while "
                    "sidmacib.reductions has half, the rule (n - 1) / 2"
                )
        for key in ("meshes", "eccentricities"):
            values = getattr(self, key)
            if len({f"{value:g}" for value in values}) < len(values):  # as in names of cases
                raise ValueError(f"{key}: got {list(values)}, allowed is each value once")
        for key, names in (("models", self.models), ("dem.engines", self.dem.engines)):
            if len(set(names)) < len(names):
                raise ValueError(f"{key}: got {list(names)}, allowed is each name once")
        if self.figures.mesh not in (None, *self.meshes):
            raise ValueError(
                f"figures.mesh: got {self.figures.mesh}, allowed are meshes: {list(self.meshes)}"
            )
        if "reference" in self.variants:
            raise ValueError("variants: got reference, allowed is any other name")
        return self

    @model_validator(mode="after")
    def _has_models_that_can(self) -> Self:
        brittle = [name for name in self.models if SOLVERS[name].brittle]
        if not self.dem.engines and not brittle:
            raise ValueError(
                f"models: got {list(self.models)}, allowed without an engine (dem.engines) are "
                "lists with static"
            )
        if brittle and self.assembly.failure is not Failure.BRITTLE:
            raise ValueError(
                f"models: got {brittle[0]}, allowed with assembly.failure {self.assembly.failure} "
                f"are: {', '.join(s.name for s in SOLVERS.values() if not s.brittle)}"
            )
        inner = self.materials.inner
        for name in self.dem.engines:
            if ENGINES[name].one_stiffness and inner.normal_stiffness != inner.shear_stiffness:
                raise ValueError(
                    f"materials.inner.shear_stiffness: got {inner.shear_stiffness:g} Pa/m, allowed "
                    f"with {name} is normal_stiffness, {inner.normal_stiffness:g} Pa/m"
                )
            if ENGINES[name].brittle_only and self.assembly.failure is not Failure.BRITTLE:
                raise ValueError(
                    f"assembly.failure: got {self.assembly.failure}, allowed with {name} is brittle"
                )
        return self

    @property
    def references(self) -> tuple[str, ...]:
        """Models that SiDMACIB is held against, the leading one first: engines, then others."""
        return *self.dem.engines, *(name for name in self.models if SOLVERS[name].brittle)

    def joint(self, sample: str, assembly: Assembly | None = None) -> Joint:
        """The joint of ``sample``, in the reference variant or as another ``assembly``."""
        assembly = assembly or self.assembly
        own = self.samples[sample].model_dump(exclude_none=True)
        return Joint(
            **{**self.geometry.model_dump(), **own},
            density=self.materials.density,
            inner=self.materials.inner.material(),
            dry=self.materials.dry.material(),
            failure=assembly.failure,
            upper_body=assembly.upper_body,
        )

    def tables_json(self) -> str:
        """What tables depend on, as JSON: not how engines compute."""
        return self._without("results", "overrides", "variants", "calibration", "figures")

    def pieces_json(self) -> str:
        """What the models of the joint's pieces that need no engine depend on, as JSON."""
        return self._without("results", "overrides", "calibration", "figures")

    def figures_json(self) -> str:
        """What figures depend on, as JSON: not how engines compute."""
        return self._without("results", "overrides", "calibration")

    def calibration_json(self) -> str:
        """What the search for the published geometry depends on, as JSON."""
        return self.model_dump_json(exclude={"results", "overrides", "variants", "figures"})

    def _without(self, *sections: str) -> str:
        """All but some sections and how engines compute; what is left is a valid study."""
        dem = {"numerics": True, "time_limit": True}
        return self.model_dump_json(exclude={**dict.fromkeys(sections, True), "dem": dem})
