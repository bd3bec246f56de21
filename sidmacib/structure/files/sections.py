"""The keys of a structure's file: their units, ranges and defaults, and what is made of them.

Editors check files by a schema that is made from these sections, as is the page of all keys.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self, get_args

from pydantic import BeforeValidator, Field, StrictBool, model_validator

from sidmacib.contact_points import OPTIONS
from sidmacib.joint import DRY, FIXED_PLATE, INNER, HeldDown
from sidmacib.mechanics.assembly import SOFTENED, FaceMaterial, NodeLayout
from sidmacib.mechanics.crushing import CompressiveStrength, CrushedMaterial
from sidmacib.quantities import Count, Length, Number, is_number, number_in, one_of, shown
from sidmacib.reading import Keys, Label, Section, Some, Text, Vector, Way, changes_to, section_of
from sidmacib.rule import RULES
from sidmacib.structure.blocks import Block, box, prism
from sidmacib.structure.files.block_files import FileSection, Unit, metres, require_likely
from sidmacib.structure.files.compas import DENSITIES
from sidmacib.structure.files.loads import LoadCaseSection, LoadSection, PermanentSection
from sidmacib.structure.files.seismic import SeismicSection
from sidmacib.structure.files.selection import Between
from sidmacib.structure.files.time_loads import TimeSection
from sidmacib.structure.locks import ALL, Condensed, Locks
from sidmacib.validation import kinds_of

INTERFACE = FaceMaterial(1e10, 1e10, friction=0.7, cohesion=0.0, tensile_strength=0.0)
NUMBERS = tuple(name for name in kinds_of(FaceMaterial) if name not in SOFTENED)
Positive = Annotated[float, Number(above=0)]
OF_TIME = set(TimeSection.model_fields) - {"force", "newtons"}
_Index = Annotated[int, Number(at_least=0, whole=True)]
_Density = Annotated[float, DENSITIES]


class _Law(Keys):
    of: ClassVar[Any] = FaceMaterial

    @property
    def material(self) -> Any:
        """The material of a face."""
        return self.of(**self.model_dump(include=set(kinds_of(self.of))))


_INTERFACE: Any = section_of(INTERFACE, *NUMBERS)
_INNER: Any = section_of(replace(INNER, bond_friction=None), *NUMBERS)
_DRY: Any = section_of(DRY, *NUMBERS)
_CHANGES: Any = changes_to(_INTERFACE)


FROM_FILE = "from_file"


class _Crushed(Keys):
    compressive_strength: CompressiveStrength | None = None
    """of the blocks, where they are pressed, Pa; by default none is exceeded"""


class InterfaceSection(_INTERFACE, _Crushed, _Law):
    """The law of faces, which are bonded if the cohesion or the tensile strength is above 0.

    Limit analysis uses no stiffnesses. ``friction``: coefficient μ. Bonds have the shear strength
    c + μσ (EN 1996-1-1, 3.6.2); ``bond_friction`` is their μ while they hold, if it is another.
    """

    of: ClassVar = CrushedMaterial
    from_file: StrictBool = False
    """whether interfaces are those that files of COMPAS bring, and not found by faces that touch"""

    @model_validator(mode="before")
    @classmethod
    def _named(cls, value: Any) -> Any:
        return {FROM_FILE: True} if value == FROM_FILE else value


class InnerSection(_INNER, _Law):
    """The law of the roots of locks."""


class DrySection(_DRY, _Law):
    """The law of all other faces of locks."""


class SpecialSection(_CHANGES, _Crushed):
    """A law of certain pairs of blocks: the numbers that differ from `interfaces`."""

    between: Between
    """the pairs of blocks"""

    def material(self, others: FaceMaterial) -> FaceMaterial:
        """The law of these pairs, where ``others`` is that of all others."""
        return replace(others, **self.model_dump(exclude={"between"}, exclude_none=True))


def _working(value: Any) -> float:
    try:
        return ALL if value in ("all", ALL) else Number(above=0).read(value)
    except ValueError:
        allowed = "a number greater than 0, or all"
        raise ValueError(f"{shown(value)} is not allowed; it must be {allowed}") from None


_Working = Annotated[
    float, BeforeValidator(_working, json_schema_input_type=Literal["all"] | Positive)
]
Option = Annotated[str, one_of(OPTIONS)]


class CondensedSection(Keys):
    """SiDMACIB's contact points in place of locks: some locks work, or a rule limits V and M."""

    working: _Working | None = None
    """how many locks work, or `all`"""
    option: Option = "option3"
    """where the contact points are"""
    rule: Annotated[str, one_of(RULES)] | None = None
    """the rule, by default `safe`, where `working` is not given"""
    hold_down: HeldDown = FIXED_PLATE
    """what holds the joint of the rule down"""

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if self.working is not None and "hold_down" in self.model_fields_set:
            raise ValueError("hold_down: is for a rule; must not be given beside working")
        self.condensed()
        return self

    def condensed(self) -> Condensed:
        """The section as the models take it; ValueError if its keys do not fit."""
        return Condensed(self.working, OPTIONS[self.option], self.rule, self.hold_down)


class LocksSection(Keys):
    """A row of locks across each interface of some pairs of blocks."""

    between: Between
    """the pairs of blocks"""
    count: Count
    """number of locks"""
    height: Length
    """h: half in either block"""
    row: Way | None = None
    """this or `run` is needed: direction in which the locks follow each other, and block sliding"""
    run: Way | None = None
    """direction along each lock, in which they let it slide"""
    first: Text | None = None
    """the block that has the first lock; by default that below"""
    widths: tuple[Length, ...] | None = None
    """width of each lock; by default equal"""
    inner: InnerSection = InnerSection()
    """the law of the roots"""
    dry: DrySection = DrySection()
    """the law of the other faces of locks"""
    condensed: CondensedSection | None = None
    """contact points in place of locks"""

    @model_validator(mode="after")
    def _fits(self) -> Self:
        self.locks()
        return self

    def locks(self) -> Locks:
        """The section as the models take it; ValueError if its keys do not fit."""
        same = ("count", "height", "row", "run", "first", "widths")
        return Locks(
            **{name: getattr(self, name) for name in same},
            inner=self.inner.material,
            dry=self.dry.material,
            condensed=self.condensed.condensed() if self.condensed else None,
        )


SHAPES = (("vertices", "faces"), ("low", "high"), ("outline", "along"))


class ShapeSection(Keys):
    """A block, as a cuboid, a prism or a polyhedron."""

    unit: Unit | None = None
    """unit of its coordinates, by default m; one with a unit of its own, such as 80mm, keeps it"""

    low: Vector | None = None
    """a corner of a cuboid"""
    high: Vector | None = None
    """the opposite corner"""
    outline: Annotated[tuple[Vector, ...], Field(min_length=3)] | None = None
    """a plane polygon, which sweeps a prism"""
    along: Vector | None = None
    """the vector that moves it"""
    vertices: tuple[Vector, ...] | None = None
    """the points of a polyhedron"""
    faces: tuple[tuple[_Index, ...], ...] | None = None
    """for each face the numbers of its vertices, from 0, anticlockwise seen from outside"""
    density: _Density = 2000.0
    fixed: StrictBool = False
    """whether the block cannot move"""
    material: str | None = None
    """a name for rules to refer to"""

    @model_validator(mode="before")
    @classmethod
    def _in_metres(cls, given: Any) -> Any:
        unit: Any = given.get("unit") if isinstance(given, Mapping) else None
        if unit not in get_args(Unit) or unit == "m":
            return given
        keys = {key for shape in SHAPES for key in shape} - {"faces"}
        return {k: _times(v, metres(unit)) if k in keys else v for k, v in given.items()}

    assumes_unit: ClassVar = False

    @property
    def assumes_density(self) -> bool:
        """Whether the block has the default density because nothing says another."""
        return "density" not in self.model_fields_set

    @model_validator(mode="after")
    def _has_a_shape(self) -> Self:
        given = self.model_fields_set & {key for shape in SHAPES for key in shape}
        if given not in map(set, SHAPES):
            shapes = ", or ".join(map(" and ".join, SHAPES))
            raise ValueError(f"must have either {shapes}, or file")
        return self

    def blocks(self, name: str, _: Path) -> list[Block]:
        """The block, called ``name``."""
        if self.low and self.high:
            made = box(name, self.low, self.high, self.density, fixed=self.fixed)
        elif self.outline and self.along:
            made = prism(name, self.outline, self.along, self.density, fixed=self.fixed)
        else:
            made = Block(name, self.vertices or (), self.faces or (), self.density, self.fixed)
        if not self.fixed and self.unit is None:  # the ground may be large
            require_likely(made.size, f"blocks.{name}: it")
        return [replace(made, material=self.material)]


class ReadSection(ShapeSection):
    """A block of a mesh whose unit is assumed, as studies have it: read from its file."""

    mesh: Text
    """the file, as it is named in the structure's file"""

    assumes_unit: ClassVar = True


def _times(value: Any, factor: float) -> Any:
    """Numbers without a unit of their own in ``value`` times a ``factor``."""
    if isinstance(value, list | tuple):
        return [_times(each, factor) for each in value]
    number: Any = number_in(value) if isinstance(value, str) else value
    return float(f"{number * factor:.15g}") if is_number(number) else value


def _block(value: Any) -> Any:
    if isinstance(value, Section):
        return value
    keys = value if isinstance(value, Mapping) else ()
    of = FileSection if "file" in keys else ReadSection if "mesh" in keys else ShapeSection
    return of.model_validate(value)


def _load(value: Any) -> Any:
    if isinstance(value, Section):
        return value
    in_time = isinstance(value, Mapping) and OF_TIME & set(value)
    return (TimeSection if in_time else LoadSection).model_validate(value)


class StructureFile(Keys):
    """A structure of blocks and its load. Lengths are in m, forces in N, stresses in Pa."""

    blocks: Annotated[
        dict[Label, Annotated[ShapeSection | FileSection, BeforeValidator(_block)]], Some
    ]
    """the blocks by name"""
    load: Annotated[LoadSection | TimeSection, BeforeValidator(_load)] | None = None
    """what is raised, or acts in time; without it `multilock assembly` says what is in reserve"""
    permanent: tuple[PermanentSection, ...] = ()
    """loads that always act, beside weight"""
    load_cases: Annotated[dict[Label, LoadCaseSection], Some] | None = None
    """load cases by name, in place of `load`; for `multilock assembly` and studies"""
    interfaces: InterfaceSection = InterfaceSection()
    """the law of all interfaces; by default dry"""
    special: tuple[SpecialSection, ...] = ()
    """laws of certain pairs of blocks"""
    locks: tuple[LocksSection, ...] = ()
    """rows of locks between pairs of blocks"""
    mesh: Length | None = None
    """largest cell; by default one cell for each interface"""
    nodes: NodeLayout | None = None
    """layout of the nodes on a cell; by default `lobatto` if anything is bonded, else `vertices`"""
    tolerance: Annotated[float, Number(above=0, at_most=0.1)] = 1e-6
    """largest gap between faces that touch, over the mean size of the free blocks"""
    seismic: SeismicSection | None = None
    """the spectrum of `multilock assembly --seismic`; else it is ignored"""
    design: Any = None
    """the task of `multilock design`; the other commands ignore it"""

    @property
    def pushed(self) -> dict[str, LoadSection | TimeSection | LoadCaseSection | PermanentSection]:
        """All loads by their keys."""
        found: dict[str, LoadSection | TimeSection | LoadCaseSection | PermanentSection] = {}
        if self.load:
            found["load"] = self.load
        found |= _numbered("permanent", self.permanent)
        for name, case in (self.load_cases or {}).items():
            found[f"load_cases.{name}"] = case
            found |= _numbered(f"load_cases.{name}.permanent", case.permanent)
        return found

    @property
    def assumed(self) -> dict[str, str]:
        """What blocks and interfaces have though the file does not say it."""
        blocks = [*self.blocks.values()]
        free = [each for each in blocks if each.fixed is not True]
        laws = {"friction", "from_file"} & self.interfaces.model_fields_set
        found = {}
        if free and not laws and not self.special:
            found["friction"] = f"{INTERFACE.friction:g}"
        if any(each.assumes_density for each in free):
            found["density"] = f"{FileSection.model_fields['density'].default:g} kg/m3"
        if any(each.assumes_unit for each in blocks):
            found["unit"] = "m"
        return found


def _numbered(key: str, given: Sequence[PermanentSection]) -> dict[str, PermanentSection]:
    return {f"{key}.{number}": each for number, each in enumerate(given, start=1)}
