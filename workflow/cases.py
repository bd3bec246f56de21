"""The cases of a study: one model each, of one joint, mesh and direction, or of one structure."""

import difflib
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import NamedTuple

from sidmacib.engines import ENGINES
from sidmacib.engines.engine import Engine
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
    CaseId,
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
DEAR = 10.0  # largest cost of an extra finer mesh, over that of the study's finest mesh
BENT = 2.5  # power of the nodes' number by which time grows: elastic pieces; of rigid ones 1
WHOLE = 0.999  # of a side: a mesh must be less than it


def cases_of(study: Study) -> dict[CaseId, JointCase]:
    """All cases of ``study`` by their identity.

    Raises `ConfigError` for overrides of cases that do not exist, and if there are too many cases.
    """
    if (count := case_count(study)) > MAX_CASES:
        raise ConfigError(
            f"study: {count:,} cases (samples x meshes x eccentricities x models and "
            f"variants) are too many; at most {MAX_CASES:,} are allowed"
        )
    cases = {case.id: case for case in _cases(study, study.model_names)}
    if study.overrides:
        # Engines that are left out, because they are not installed, have these cases too.
        names = {case.name for case in _cases(study, tuple(ENGINES))}
        for name in study.overrides:
            if name not in names:
                raise ConfigError(f"overrides: {shown(name)} is not a case; {_near(name, names)}")
    return cases


def case_count(study: Study) -> int:
    """The number of cases of ``study``, without building them."""
    joint = _joints(study)
    return sum(
        len(_levels(study, joint(sample, run.variant), run, sample))
        * len(_ratios(study, run, sample))
        for run, sample in _runs(study, study.model_names)
    )


def _cases(study: Study, models: Sequence[str]) -> Iterator[JointCase]:
    joint = _joints(study)

    @cache
    def loading(ratio: float, assembly: AssemblySection) -> Loading:
        return Loading(Direction(ratio), assembly.load_share, assembly.push)

    for run, sample in _runs(study, models):
        numerics = _changed(study.dem.numerics, run.change.numerics)
        for mesh in _levels(study, joint(sample, run.variant), run, sample):
            for ratio in _ratios(study, run, sample):
                name = case_name(sample, mesh, ratio, run.variant)
                yield Case(
                    name=name,
                    model=run.model.name,
                    variant=run.variant,
                    subject=JointSubject(
                        sample=sample,
                        joint=joint(sample, run.variant),
                        mesh=mesh,
                        nodes=run.nodes,
                        loading=loading(ratio, run.assembly),
                    ),
                    numerics=run.model.numerics(
                        _changed(numerics, study.overrides.get(name, NumericsChanges())).numerics()
                    )
                    if isinstance(run.model, Engine)
                    else None,
                )


def _joints(study: Study) -> Callable[[str, str], Joint]:
    """The joint of a sample under a variant, both by name."""
    variants = study.every_variant
    return cache(lambda sample, variant: study.joint(sample, variants[variant]))


@dataclass(frozen=True)
class _Run:
    """A model with a variant: the changes of the variant, and the resulting assembly and nodes."""

    model: Model
    variant: str
    change: VariantSection
    assembly: AssemblySection
    nodes: NodeLayout


def _runs(study: Study, models: Sequence[str]) -> Iterator[tuple[_Run, str]]:
    """Each model with the variants that change its results, and each sample that it can run."""
    allowed = {name: sample.models or models for name, sample in study.samples.items()}
    for model in (MODELS[name] for name in models):
        if model.name in CLOSED_FORM:  # not of pieces
            continue
        for variant, change in study.every_variant.items():
            assembly = change.assembly(study.assembly)
            nodes = change.nodes or study.nodes
            before = study.assembly, study.nodes, VariantSection().material
            same = variant != REFERENCE and (assembly, nodes, change.material) == before
            if same and model.name not in ENGINES:
                continue
            run = _Run(model, variant, change, assembly, nodes)
            for sample in study.samples:
                if (
                    model.name in allowed[sample]
                    and (
                        variant == REFERENCE or _within(variant, _part(study, run, sample).variants)
                    )
                    and not model.refusal(requirements(study, assembly, sample))
                ):
                    yield run, sample


def _part(study: Study, run: _Run, sample: str) -> PartSection:
    """The parts of a sample that the model runs."""
    return study.samples[sample].only.get(run.model.name, PartSection())


def _within(value: object, chosen: Sequence[object] | None) -> bool:
    return chosen is None or value in chosen


def _ratios(study: Study, run: _Run, sample: str) -> tuple[float, ...]:
    """Eccentricities of a sample, over a."""
    chosen = _part(study, run, sample).eccentricities
    every = run.change.eccentricities or study.eccentricities
    return tuple(ratio for ratio in every if _within(ratio, chosen))


def _levels(study: Study, joint: Joint, run: _Run, sample: str) -> tuple[float, ...]:
    """Meshes (m) of a joint: the study's or variant's, and another one for the mesh error."""
    chosen = _part(study, run, sample).meshes
    every = run.change.meshes or study.meshes
    meshes = tuple(mesh for mesh in every if _within(mesh, chosen))
    if not meshes or run.model.name not in SOLVED:
        return meshes
    other = second_mesh(joint, meshes, run.nodes)
    return meshes if other is None else (*meshes, other)


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
    close = difflib.get_close_matches(name[:200], among[:20_000]) or sorted(names)[:3]
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
    cases = cases_of(study)
    leading = detailed(study.model_names)
    there = [m for m in leading if m not in ENGINES or not ENGINES[m].missing()]
    among = there or leading
    model = model or next((m for m in among if CaseId(m, name) in cases), among[0])
    runs = [each for each in study.model_names if each not in CLOSED_FORM]
    if model not in runs:
        allowed = " or ".join((*runs, *CLOSED_FORM))
        raise CallError(f"MODEL: {shown(model)} is not allowed; it must be {allowed}")
    chosen = CaseId(model, name)
    if chosen not in cases:
        names = {case for case_model, case in cases if case_model == model}
        raise CallError(f"CASE: {shown(name)} is not a case of {model}; {_near(name, names)}")
    return cases[chosen]


def structure_cases(study: Study) -> Iterator[StructureCase]:
    """Each structure with each load and variant, in each of its models."""
    numerics = study.dem.numerics.numerics()
    for name, section in study.structures.items():
        for model in models_of(study, section):
            engine = ENGINES.get(model)
            for load, variant, description in section.described():
                if moves_support(description):
                    continue
                yield Case(
                    name=structure_case_name(name, load, variant),
                    model=model,
                    variant=variant,
                    subject=StructureSubject(name, load, description),
                    numerics=engine.numerics(numerics) if engine else None,
                )


def support_cases(study: Study) -> Iterator[tuple[StructureSubject, str, bool]]:
    """Each structure, its load and the variant, where a support moves; whether YADE is asked."""
    for name, section in study.structures.items():
        for load, variant, description in section.described():
            if moves_support(description):
                yade = "yade" in models_of(study, section)
                yield StructureSubject(name, load, description), variant, yade
