"""Sections of a study that describe joints: samples, variants, sets of many; and their values.

Keys, ranges, units and defaults are those of `sidmacib.Joint`; narrower only where a study
requires it: joints have weight, inner faces have strength, and dry faces have none. A bad value
raises a ValueError whose text follows the key's name: "-1 is not allowed; it must be ...".
"""

import math
import os
import re
from dataclasses import replace
from enum import StrEnum
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field, PlainSerializer

from sidmacib.engines import Numerics
from sidmacib.joint import DRY, INNER, HeldDown, HoldDown, Joint, OwnLock, Side, UpperBody
from sidmacib.joint.loading import LoadShare, Push
from sidmacib.joint.parameters import SIZES
from sidmacib.mechanics.assembly import OF_BONDS, FaceMaterial, Failure, NodeLayout
from sidmacib.models import RESISTANCES
from sidmacib.quantities import (
    FractureEnergy,
    Length,
    Modulus,
    Number,
    Part,
    Poisson,
    Span,
    shown,
)
from sidmacib.reading import Section, Some, changes_to, section_of
from sidmacib.validation import kinds_of

NAME_LENGTH = 64  # a folder's name, at most 255 letters, is made of two names and more
NAME = re.compile(rf"[A-Za-z0-9][A-Za-z0-9_.]{{0,{NAME_LENGTH - 1}}}")
FOLDER = re.compile(r"(?![- ])[\w/. ,+=@%-]*(?<! )")

Positive = Annotated[float, Number(above=0)]
NotNegative = Annotated[float, Number(at_least=0)]


def eccentricity(value: Any) -> float:
    """The ratio e / a as a number; "torsion" is infinity."""
    if isinstance(value, str | float) and value in ("torsion", math.inf):
        return math.inf
    try:
        return Number(at_least=0).read(value)
    except ValueError:
        raise ValueError(
            f"{shown(value)} is not allowed; it must be a number of at least 0 (e / a), or torsion"
        ) from None


Eccentricity = Annotated[
    float,
    BeforeValidator(eccentricity, json_schema_input_type=Literal["torsion"] | NotNegative),
    PlainSerializer(lambda value: "torsion" if math.isinf(value) else value, when_used="json"),
]


def name(value: Any) -> str:
    """A name, which becomes part of the names of files and columns."""
    if not isinstance(value, str) or not NAME.fullmatch(value):
        raise ValueError(
            f"{shown(value)} is not allowed as a name; it must be made of letters, digits, _ and "
            f"., begin with a letter or digit, and have at most {NAME_LENGTH} letters"
        )
    return value


Name = Annotated[
    str,
    BeforeValidator(name),
    Field(description="letters, digits, _ and ., beginning with a letter or digit"),
]


def folder(value: Any) -> str:
    """A folder's name in its shortest form; numbers are names too."""
    text = str(value) if type(value) in (int, float) else value
    path = os.path.normpath(text) if isinstance(text, str) else ""
    if not FOLDER.fullmatch(path) or path.split("/")[-1] in ("", ".", ".."):
        raise ValueError(
            f"{shown(text)} is not allowed; a folder's name must be made of letters, digits, "
            "spaces and _ . , + - = @ %, not begin with - or a space or end with one, and not be "
            "/, . or .."
        )
    return path


Folder = Annotated[str, BeforeValidator(folder), Field(description="the name of a folder")]


def apart(values: tuple[float, ...]) -> tuple[float, ...]:
    """``values`` that differ in the names of cases."""
    if len({f"{value:g}" for value in values}) < len(values):
        raise ValueError("some are the same in the names of cases; they must differ in six digits")
    return values


Lengths = Annotated[tuple[Length, ...], Some, AfterValidator(apart)]
Eccentricities = Annotated[tuple[Eccentricity, ...], Some, AfterValidator(apart)]


class NumericsSection(section_of(Numerics)):  # type: ignore[misc]
    """The keys of `Numerics`."""

    def numerics(self) -> Numerics:
        """The section as the engines take it."""
        return Numerics(**self.model_dump())


class NumericsChanges(changes_to(NumericsSection)):  # type: ignore[misc]
    """Changes to the numerics; None means no change."""


MOST_LOCKS = 101

_Weight = Annotated[float, Number(above=0, unit="kg/m3")]
_Cohesion = Annotated[float, Number(above=0, unit="Pa")]
_NoStrength = Annotated[float, Number(at_least=0, at_most=0, unit="Pa")]
_Locks = Annotated[int, Number(at_least=1, at_most=MOST_LOCKS, whole=True)]


class GeometrySection(section_of(Joint, *SIZES)):  # type: ignore[misc]
    """Length, width and height of a lock, and height of the upper main body, in m."""


class InnerFaceSection(section_of(INNER, cohesion=_Cohesion)):  # type: ignore[misc]
    """Cohesive faces inside a block, see `sidmacib.mechanics.assembly.FaceMaterial`."""


_DRY: Any = section_of(
    DRY,
    *(name for name in kinds_of(FaceMaterial) if name not in OF_BONDS),
    cohesion=_NoStrength,
    tensile_strength=_NoStrength,
)


class DryFaceSection(_DRY):
    """Frictional faces between the blocks; they have no strength."""


class InnerChanges(changes_to(InnerFaceSection)):  # type: ignore[misc]
    """Changes to inner faces; None means no change."""


class DryChanges(changes_to(DryFaceSection)):  # type: ignore[misc]
    """Changes to dry faces; None means no change."""


def changed(face: FaceMaterial, changes: InnerChanges | DryChanges) -> FaceMaterial:
    """``face`` with ``changes``."""
    return replace(face, **changes.model_dump(exclude_none=True))


class MaterialsSection(Section):
    """Density (kg/m3), Young's modulus (Pa) and Poisson's ratio of the block, and its faces."""

    density: _Weight = Joint.density
    young: Modulus = 1e10
    poisson: Poisson = 0.2
    inner: InnerFaceSection = InnerFaceSection()
    dry: DryFaceSection = DryFaceSection()

    @property
    def inner_face(self) -> FaceMaterial:
        """The inner faces as the models take them."""
        return FaceMaterial(**self.inner.model_dump())


class ReliabilitySection(Section):
    """What the strengths stand for; studies have the resistances (EN 1990) that this asks for.

    ``scatter``: coefficient of variation of strengths that are means; 0 for characteristic or
    design values. ``gamma_m``: the partial factor, 1 for design values.
    """

    scatter: Annotated[float, Number(at_least=0, at_most=1)] = 0.0
    gamma_m: Annotated[float, Number(at_least=1, at_most=10)] = 1.0

    @property
    def resistances(self) -> tuple[str, ...]:
        """The models that it asks for."""
        asked = self.scatter > 0.0, self.gamma_m > 1.0
        return tuple(name for name, there in zip(RESISTANCES, asked, strict=True) if there)


class LockSection(Section):
    """A lock that differs: width (m), density (kg/m3), inner face; None: as the others."""

    width: Length | None = None
    density: _Weight | None = None
    inner: InnerChanges = InnerChanges()

    def own_lock(self, inner: FaceMaterial) -> OwnLock:
        """The section as the models take it, where other locks have this ``inner`` face."""
        face = changed(inner, self.inner)
        return OwnLock(self.width, self.density, None if face == inner else face)


class PartSection(Section):
    """The parts of a sample that a model runs; None: all. The reference variant always runs."""

    meshes: Lengths | None = None
    eccentricities: Eccentricities | None = None
    variants: tuple[Name, ...] | None = None


class SampleSection(changes_to(GeometrySection)):  # type: ignore[misc]
    """A joint of the study: sizes (m) and faces where they are not the study's.

    ``first``: the block that lock 1 belongs to. ``different``: locks that differ, by number.
    ``models``: those of the study's models and engines that run on it; None: all of them. ``only``:
    what each of them runs of it, by name; a model that is not named runs all.
    """

    locks: _Locks
    first: Side = Side.UPPER
    different: dict[_Locks, LockSection] = Field(default_factory=dict)
    inner: InnerChanges = InnerChanges()
    dry: DryChanges = DryChanges()
    models: Annotated[tuple[str, ...], Some] | None = None
    only: dict[str, PartSection] = Field(default_factory=dict)

    def joint(self, geometry: GeometrySection, materials: MaterialsSection, **others: Any) -> Joint:
        """The joint; sizes and faces that it does not set are those of the study."""
        sizes = {key: getattr(self, key) or size for key, size in geometry.model_dump().items()}
        inner = changed(materials.inner_face, self.inner)
        return Joint(
            self.locks,
            **sizes,
            first=self.first,
            different={lock: changes.own_lock(inner) for lock, changes in self.different.items()},
            inner=inner,
            dry=changed(FaceMaterial(**materials.dry.model_dump()), self.dry),
            density=materials.density,
            **others,
        )


class Pieces(StrEnum):
    """Rigid or elastic pieces of the joint."""

    RIGID = "rigid"
    ELASTIC = "elastic"  # with the material of the block


class AssemblySection(Section):
    """Cuts, loads, hold-down and failure of the joint."""

    pieces: Pieces = Pieces.RIGID
    failure: Failure = Failure.BRITTLE
    load_share: LoadShare = LoadShare.FACE
    upper_body: UpperBody = UpperBody.MONOLITHIC
    push: Push = Push.PLUS_Y
    hold_down: HeldDown = HoldDown()


class VariantSection(changes_to(AssemblySection)):  # type: ignore[misc]
    """Changes to the study, and the meshes and eccentricities at which it runs (None: all).

    ``young``: of the block (Pa). ``fracture_energy``: of the inner faces (J/m2).
    """

    numerics: NumericsChanges = NumericsChanges()
    nodes: NodeLayout | None = None
    young: Modulus | None = None
    fracture_energy: FractureEnergy | None = None
    meshes: Lengths | None = None
    eccentricities: Eccentricities | None = None

    def assembly(self, study: AssemblySection) -> AssemblySection:
        """The assembly of this variant."""
        changes = {key: getattr(self, key) for key in AssemblySection.model_fields}
        return study.model_copy(update={k: v for k, v in changes.items() if v is not None})


MOST_JOINTS = 1_000_000

_Count = Annotated[int, Number(at_least=1, at_most=MOST_JOINTS, whole=True)]
_LockSpan = Annotated[tuple[int, int], Span(Number(at_least=2, at_most=MOST_LOCKS, whole=True))]
_Cells = Annotated[tuple[int, int], Span(Number(at_least=1, at_most=8, whole=True))]
_Ratios = Annotated[tuple[float, float], Span(Number(above=0))]


class SamplingSection(Section):
    """Number of joints and ranges of a sampling; ratios are spread evenly in their logarithm.

    Width, strengths and normal stiffness are those of the study. ``smooth``, ``one_piece``,
    ``pressed``: shares of the joints without friction, with an upper body of one piece, and with a
    given pressure on top instead of the fixed plate. ``stiffness_ratio``: E / (Kn b) of elastic
    pieces; None: rigid pieces. ``energy_ratio``: of bonds that soften, fracture energy over the
    energy stored at failure, tau_k^2 / (2 Ks). Half of the joints with an even number of locks are
    pushed along -y. ``cells``: numbers of cells along the shorter side of a lock, of the two
    meshes. ``limited``: one in so many joints is solved by limit analysis too.
    """

    joints: _Count
    seed: Annotated[int, Number(at_least=0, at_most=2**31, whole=True)] = 1
    failure: Failure = Failure.BRITTLE
    locks: _LockSpan = (2, 31)
    a_over_b: _Ratios = (0.5, 3.0)
    h_over_b: _Ratios = (0.06, 0.6)
    H_over_b: _Ratios = (0.3, 3.0)
    shear_over_normal: _Ratios = (0.003, 3.0)
    dry_over_inner: _Ratios = (0.03, 30.0)
    friction: Annotated[tuple[float, float], Span(Number(at_least=0))] = (0.0, 0.8)
    pressure_over_cohesion: _Ratios = (0.03, 1.0)
    stiffness_ratio: _Ratios | None = None
    energy_ratio: _Ratios = (1.0, 1000.0)
    smooth: Part = 0.3
    one_piece: Part = 0.5
    pressed: Part = 0.2
    eccentricities: Eccentricities | None = None
    cells: _Cells = (1, 2)
    limited: _Count = 16

    def parameters(self) -> str:
        """The joints, without what says how they are solved, as JSON."""
        return self.model_dump_json(exclude={"eccentricities", "cells", "limited"})
