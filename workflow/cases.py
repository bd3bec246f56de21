"""The cases of a study: one model each, of one joint, mesh and direction, or of one structure."""

import difflib
from collections.abc import Collection, Iterator, Sequence
from functools import cache
from itertools import product
from typing import NamedTuple, TypeVar

from sidmacib.engines import ENGINES, Engine
from sidmacib.joint import Direction, Joint
from sidmacib.joint.loading import Loading
from sidmacib.mechanics.assembly import NodeLayout
from sidmacib.mesh_error import APART, cells_of
from sidmacib.model import Model
from sidmacib.models import CLOSED_FORM, MODELS, SOLVED, detailed
from sidmacib.quantities import shown
from workflow.case import (
    REFERENCE,
    Case,
    EarthquakeCase,
    EarthquakeSubject,
    JointCase,
    JointSubject,
    StructureCase,
    StructureSubject,
    case_name,
    structure_case_name,
)
from workflow.configuration import CallError, ConfigError
from workflow.consistency import MAX_NODES, models_of, moves_support, node_estimate, requirements
from workflow.schema import Study
from workflow.schema.sections import (
    AssemblySection,
    NumericsChanges,
    NumericsSection,
    PartSection,
    VariantSection,
)

MAX_CASES = 1_000_000
IN_TIME = "time"  # model of blocks that move
DEAR = 10.0  # largest cost of an extra finer mesh, over that of the study's finest mesh
BENT = 2.5  # power of the nodes' number by which time grows: elastic pieces; of rigid ones 1
WHOLE = 0.999  # of a side: a mesh must be less than it
Value = TypeVar("Value", str, float)


def cases_of(study: Study) -> dict[str, JointCase]:
    """All cases of ``study`` by their folders.

    Raises `ConfigError` for overrides of cases that do not exist, and if there are too many cases.
    """
    if (count := case_count(study)) > MAX_CASES:
        raise ConfigError(
            f"study: {count:,} cases (samples x meshes x eccentricities x models and "
            f"variants) are too many; at most {MAX_CASES:,} are allowed"
        )
    cases = {case.folder: case for case in _cases(study, study.model_names)}
    if study.overrides:
        # Engines that are left out, because they are not installed, have these cases too.
        names = {case.name for case in _cases(study, tuple(ENGINES))}
        for name in study.overrides:
            if name not in names:
                raise ConfigError(f"overrides: {shown(name)} is not a case; {_near(name, names)}")
    return cases


def case_count(study: Study) -> int:
    """The number of cases of ``study``, without building them."""
    runs = _runs(study, study.model_names)
    return sum(len(run.meshes) * len(run.ratios) for run in runs)


def _cases(study: Study, models: Sequence[str]) -> Iterator[JointCase]:
    for run in _runs(study, models):
        numerics = _changed(study.dem.numerics, run.change.numerics)
        share, push = run.assembly.load_share, run.assembly.push
        loadings = [Loading(Direction(ratio), share, push) for ratio in run.ratios]
        for mesh, loading in product(run.meshes, loadings):
            name = case_name(run.sample, mesh, loading.direction.eccentricity, run.variant)
            subject = JointSubject(run.sample, run.joint, mesh, run.nodes, loading)
            own = None
            if isinstance(run.model, Engine):
                changes = study.overrides.get(name, NumericsChanges())
                own = run.model.numerics(_changed(numerics, changes).numerics())
            yield Case(name, run.model.name, run.variant, subject, own)


class _Run(NamedTuple):
    """A model of a sample in a variant, and the meshes (m) and ratios e / a of its cases."""

    model: Model
    variant: str
    change: VariantSection
    assembly: AssemblySection
    nodes: NodeLayout
    sample: str
    joint: Joint
    meshes: tuple[float, ...]
    ratios: tuple[float, ...]


def _runs(study: Study, models: Sequence[str]) -> Iterator[_Run]:
    """Each model with the variants that change its results, on each sample that it can run."""
    variants = study.every_variant
    joint_of = cache(lambda sample, variant: study.joint(sample, variants[variant]))
    pieces = [MODELS[name] for name in models if name not in CLOSED_FORM]
    for model, (variant, change) in product(pieces, variants.items()):
        reference = variant == REFERENCE
        assembly, nodes = change.assembly(study.assembly), change.nodes or study.nodes
        before = study.assembly, study.nodes, None, None
        same = (assembly, nodes, change.young, change.fracture_energy) == before
        if same and not reference and model.name not in ENGINES:
            continue
        for sample, section in study.samples.items():
            part = section.only.get(model.name, PartSection())
            if (
                model.name not in (section.models or models)
                or not (reference or _chosen([variant], part.variants))
                or model.refusal(requirements(study, assembly, sample))
            ):
                continue
            joint = joint_of(sample, variant)
            meshes = _chosen(change.meshes or study.meshes, part.meshes)
            if meshes and model.name in SOLVED:  # another one for the mesh error
                other = second_mesh(joint, meshes, nodes)
                meshes = meshes if other is None else (*meshes, other)
            ratios = _chosen(change.eccentricities or study.eccentricities, part.eccentricities)
            yield _Run(model, variant, change, assembly, nodes, sample, joint, meshes, ratios)


def _chosen(values: Sequence[Value], chosen: Sequence[Value] | None) -> tuple[Value, ...]:
    """Those of the ``values`` that are ``chosen``; None: all."""
    return tuple(value for value in values if chosen is None or value in chosen)


def second_mesh(joint: Joint, meshes: Collection[float], nodes: NodeLayout) -> float | None:
    """The mesh (m) that ``meshes`` lack for a mesh error; None if they suffice, or no mesh would.

    Half the finest, or twice where the half is `DEAR`, or has too many nodes.
    """
    finest = min(meshes)
    cells = cells_of(joint, finest)
    if cells >= APART * cells_of(joint, max(meshes)):
        return None
    finer, coarser = finest / 2.0, min(2.0 * finest, WHOLE * joint.least_side)
    count = node_estimate(joint, finer, nodes)
    growth = count / node_estimate(joint, finest, nodes)
    cost = growth if joint.elastic is None else growth**BENT
    dear = count > MAX_NODES or cost >= DEAR
    if dear and cells >= APART * cells_of(joint, coarser):
        return coarser
    return None if count > MAX_NODES else finer


def _changed(numerics: NumericsSection, change: NumericsChanges) -> NumericsSection:
    return numerics.model_copy(update=change.model_dump(exclude_none=True))


def _near(name: str, names: set[str]) -> str:
    """The allowed names for a message: some of ``names``, preferably those close to ``name``."""
    sample = name.split("-", maxsplit=1)[0]
    among = sorted(n for n in names if len(names) < 5000 or n.startswith(f"{sample}-"))
    close = difflib.get_close_matches(name, among) or sorted(names)[:3]
    return f"it must be a case of the study, such as {', '.join(close)}"


class Place(NamedTuple):
    """The sample, mesh, direction and variant of a case, for any model; ``ratio`` is e / a."""

    sample: str
    mesh: float
    ratio: float
    variant: str


def find_place(study: Study, name: str) -> Place:
    """The place of the case ``name``; raises `ConfigError`."""
    places = {
        case_name(*place): place
        for sample, (variant, change) in product(study.samples, study.every_variant.items())
        for mesh in change.meshes or study.meshes
        for ratio in change.eccentricities or study.eccentricities
        for place in [Place(sample, mesh, ratio, variant)]
    }
    if name not in places:
        raise CallError(f"CASE: {shown(name)} is not a case; {_near(name, set(places))}")
    return places[name]


def find_case(study: Study, name: str, model: str | None = None) -> JointCase:
    """The case ``name`` of ``model``, or of the first installed model that has it.

    Raises `ConfigError`.
    """
    cases = cases_of(study).values()
    found = {case.model: case for case in cases if case.name == name}
    leading = detailed(study.model_names)
    there = [m for m in leading if m not in ENGINES or not ENGINES[m].missing()]
    among = there or leading
    model = model or next((m for m in among if m in found), among[0])
    runs = [each for each in study.model_names if each not in CLOSED_FORM]
    if model not in runs:
        allowed = " or ".join((*runs, *CLOSED_FORM))
        raise CallError(f"MODEL: {shown(model)} is not allowed; it must be {allowed}")
    if model not in found:
        names = {case.name for case in cases if case.model == model}
        raise CallError(f"CASE: {shown(name)} is not a case of {model}; {_near(name, names)}")
    return found[model]


def structure_cases(study: Study) -> Iterator[StructureCase]:
    """Each structure with each load and variant, in each of its models."""
    given = study.dem.numerics.numerics()
    for structure, section in study.structures.items():
        models = models_of(study, section)
        for model, (load, variant, description) in product(models, section.described()):
            if not moves_support(description):
                name = structure_case_name(structure, load, variant)
                subject = StructureSubject(structure, load, description)
                numerics = ENGINES[model].numerics(given) if model in ENGINES else None
                yield Case(name, model, variant, subject, numerics)


def support_cases(study: Study) -> Iterator[tuple[StructureSubject, str, bool]]:
    """Each structure, its load and the variant, where a support moves; whether YADE is asked."""
    for name, section in study.structures.items():
        for load, variant, description in section.described():
            if moves_support(description):
                yade = "yade" in models_of(study, section)
                yield StructureSubject(name, load, description), variant, yade


def earthquake_cases(study: Study) -> Iterator[EarthquakeCase]:
    """Each structure with each record and factor."""
    for structure, section in study.earthquakes.items():
        for (record, description), factor in product(section.described(), section.factors):
            subject = EarthquakeSubject(structure, record, factor, description)
            name = f"{structure}-{record}-{factor:g}"
            yield Case(name, IN_TIME, REFERENCE, subject, None)
