"""Checks across the sections of a study, and what a study requires of its models."""

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import Any

from sidmacib.contact_points import REDUCTIONS
from sidmacib.engines import ENGINES
from sidmacib.joint import Joint, UpperBody
from sidmacib.joint.loading import LoadShare
from sidmacib.joint.parameters import unit_warnings
from sidmacib.mechanics.assembly import FaceMaterial, Failure, NodeLayout
from sidmacib.mechanics.contact_nodes import CELL_RULES
from sidmacib.model import Ability, Requirement
from sidmacib.models import LAWS, MODELS, RESISTANCES, SOLVED, detailed
from sidmacib.quantities import shown
from sidmacib.reading import shown_key
from workflow.case import REFERENCE, structure_case_name
from workflow.schema import CASES, LOAD, MeasuredCapacity, StructureSection, Study, load_cases
from workflow.schema.sections import AssemblySection, NumericsSection, Pieces, changed

FAILURES = {  # what each asks of a model, and what a model that lacks it may be able to do
    Failure.BRITTLE: (Ability.BRITTLE, "ductile"),
    Failure.SOFTENING: (Ability.SOFTENING, "brittle or ductile"),
    Failure.DUCTILE: (Ability.DUCTILE, "brittle"),
}
ABLE = tuple(  # models of structures: those of rigid pieces
    name
    for name, model in MODELS.items()
    if Ability.RIGID in model.abilities and (name in ENGINES or name in SOLVED)
)
MAX_NODES = 1_000_000  # of one case: a few GB in any model


def inconsistencies(study: Study) -> Iterator[str]:
    """Everything that is wrong with ``study``, one line each."""
    joints: dict[str, Joint] = {}
    for name in study.samples:
        try:
            joints[name] = study.joint(name)
        except ValueError as error:
            yield f"samples.{name}: {_in_a_line(error)}"
    yield from _joints(study, joints)
    layouts = [study.nodes, *(v.nodes for v in study.variants.values() if v.nodes)]
    densest = max(layouts, key=lambda layout: len(CELL_RULES[layout][0]))
    every = {f"variants.{name}.meshes": v.meshes for name, v in study.variants.items() if v.meshes}
    for key, meshes in {"meshes": study.meshes, **every}.items():
        yield from _meshes(key, meshes, densest, joints)
    yield from _models(study)
    for name, sample in study.samples.items():
        yield from _models_of_sample(study, name, sample.models)
        yield from _parts(study, name)
    if study.figures.mesh is not None:
        yield from _among("figures.mesh", (study.figures.mesh,), "meshes", study.meshes)
    for number, load in enumerate(study.measured.loads if study.measured else (), start=1):
        key, ratios = f"measured.loads.{number}", study.eccentricities
        yield from _among(f"{key}.sample", (load.sample,), "samples", [*study.samples])
        yield from _among(f"{key}.eccentricity", (load.eccentricity,), "eccentricities", ratios)
    yield from structure_faults(study)
    yield from _earthquake_faults(study)
    if study.campaign is not None and not study.samplings:
        yield f"campaign: {study.campaign} needs samplings"
    if REFERENCE in study.variants:
        yield f"variants: the name {REFERENCE} is reserved; choose another name"


def _among(
    key: str, values: Iterable[object], what: str, allowed: Collection[object]
) -> Iterator[str]:
    """The ``values`` that are not among those ``allowed``."""
    for value in values:
        if value not in allowed:
            given = "torsion" if value == math.inf else shown(value)
            yield f"{key}: {given} is not allowed; it must be one of {what}: {_some(allowed)}"


def requirements(study: Study, assembly: AssemblySection, sample: str) -> Iterator[Requirement]:
    """Requirements of ``study`` on a model that runs ``sample`` with ``assembly``."""
    ability, allowed = FAILURES[assembly.failure]
    yield Requirement(ability, "assembly.failure", str(assembly.failure), allowed)
    if assembly.pieces is Pieces.ELASTIC:
        yield Requirement(Ability.ELASTIC, "assembly.pieces", "elastic", "rigid")
    else:
        yield Requirement(Ability.RIGID, "assembly.pieces", "rigid", "elastic")
    if assembly.load_share is not LoadShare.FACE:
        yield Requirement(Ability.SHARED, "assembly.load_share", str(assembly.load_share), "face")
    if assembly.upper_body is UpperBody.JOINED:
        allowed = "columns or monolithic"
        yield Requirement(Ability.JOINED, "assembly.upper_body", "joined", allowed)
    for place, inner in _inner_faces(study, sample):
        if inner.needs_in_bonds:
            given = f"{place}.bond_friction", f"{inner.friction_in_bonds:g}"
            yield Requirement(Ability.BOND_FRICTION, *given, inner.needs_in_bonds)
        if inner.normal_stiffness != inner.shear_stiffness:
            yield Requirement(
                Ability.TWO_STIFFNESSES,
                f"{place}.shear_stiffness",
                f"{inner.shear_stiffness:g} Pa/m",
                f"the same as normal_stiffness, {inner.normal_stiffness:g} Pa/m",
            )
    if (locks := study.samples[sample].locks) == 1:  # nothing but friction carries the load
        yield Requirement(Ability.FRICTION, f"samples.{sample}.locks", f"{locks}", "at least 2")


def _inner_faces(study: Study, sample: str) -> Iterator[tuple[str, FaceMaterial]]:
    """The inner faces of a joint, and where they are given."""
    section, common = study.samples[sample], study.materials.inner_face
    inner = changed(common, section.inner)
    yield ("materials" if inner == common else f"samples.{sample}") + ".inner", inner
    for number, lock in section.different.items():
        if (face := changed(inner, lock.inner)) != inner:
            yield f"samples.{sample}.different.{number}.inner", face


def node_estimate(joint: Joint, mesh: float, nodes: NodeLayout) -> float:
    """About how many nodes ``joint`` has on cells of ``mesh`` (m); never an underestimate."""

    def along(side: float) -> float:
        step = max(1, len(CELL_RULES[nodes][0]) - 1)
        return step * (side / mesh + 1.0) + 1.0

    upright = along(joint.h) + along(joint.H)  # between neighbours
    level = sum(along(joint.width(lock)) for lock in joint.numbers)
    return along(joint.a) * (3.0 * level + joint.locks * upright)


def notes(study: Study) -> list[str]:
    """Likely mistakes in a study that are nevertheless allowed, one line each.

    Settings that have no effect on one of its engines, and numbers that seem to be in another unit.
    """
    default = NumericsSection()
    given = {
        "dem.numerics": study.dem.numerics,
        **{f"variants.{name}.numerics": v.numerics for name, v in study.variants.items()},
        **{f"overrides.{shown_key(name)}": change for name, change in study.overrides.items()},
    }
    warnings = {
        f"{name}: {warning}"
        for name in study.samples
        for warning in unit_warnings(study.joint(name))
    }
    found = [*sorted(warnings), *_fading(study)]
    for engine in (ENGINES[name] for name in study.dem.engines):
        ignored = sorted({*NumericsSection.model_fields} - engine.reads)
        for place, numerics in given.items():
            for key in ignored:
                if getattr(numerics, key) not in (None, getattr(default, key)):
                    found.append(f"{place}.{key}: no effect in {engine.name}")
    return found


def _fading(study: Study) -> Iterator[str]:
    """Keys of softening bonds that have no effect."""
    fades = {
        name: change.assembly(study.assembly).failure is Failure.SOFTENING
        for name, change in study.every_variant.items()
    }
    for name, change in study.variants.items():
        if change.fracture_energy and not fades[name]:
            yield f"variants.{name}.fracture_energy: no effect while its failure is not softening"
    if any(fades.values()):
        return
    for key in ("residual", "fracture_energy"):
        if getattr(study.materials.inner, key):
            yield f"materials.inner.{key}: no effect while no assembly.failure is softening"


def _joints(study: Study, joints: dict[str, Joint]) -> Iterator[str]:
    for name, joint in joints.items():
        for rule in study.sidmacib.reductions:
            if error := rule_refusal(rule, joint):
                value, _, _ = error.partition(" is not allowed")
                yield (
                    f"samples.{name}.{value} is not allowed while sidmacib.reductions has {rule} "
                    f"({error})"
                )


def rule_refusal(rule: str, joint: Joint) -> str:
    """Why a reduction of SiDMACIB is not for a ``joint``, or nothing."""
    try:
        REDUCTIONS[rule](joint, (1.0,) * joint.locks)
    except ValueError as error:
        return str(error) if joint.interlocking else ""
    return ""


def _meshes(
    key: str, meshes: tuple[float, ...], nodes: NodeLayout, joints: dict[str, Joint]
) -> Iterator[str]:
    for name, joint in joints.items():
        side = joint.least_side
        if max(meshes) >= side:
            yield (
                f"{key}: {max(meshes)} m is too coarse for sample {name}; it must be less than "
                f"{side} m, the shorter side of an inner face"
            )
        if (count := node_estimate(joint, min(meshes), nodes)) > MAX_NODES:
            yield (
                f"{key}: {min(meshes)} m is too fine for sample {name}, which would have "
                f"{count:.2g} nodes; it must have {MAX_NODES:,} or fewer"
            )


def _names(key: str, names: Sequence[str], allowed: Sequence[str]) -> Iterator[str]:
    """Names of models that are not ``allowed``, or appear twice."""
    for place, name in enumerate(names):
        if name not in allowed:
            yield f"{key}: {shown(name)} is not allowed; it must be {' or '.join(allowed)}"
        elif name in names[:place]:
            yield f"{key}: {name} appears twice; each name must appear only once"


def _models(study: Study) -> Iterator[str]:
    never = {*RESISTANCES} - {*study.reliability.resistances}
    for key, names, allowed in (
        ("models", study.models, tuple(name for name in (*SOLVED, *LAWS) if name not in never)),
        ("dem.engines", study.dem.engines, tuple(ENGINES)),
    ):
        yield from _names(key, names, allowed)
    known = [name for name in study.model_names if name in MODELS]
    refusals = (
        MODELS[name].refusal(requirements(study, study.assembly, sample))
        for sample in study.samples
        for name in study.models_of(sample)
        # A rule that refuses a joint gives its reason in its rows of the tables.
        if name in known and name not in LAWS
    )
    yield from dict.fromkeys(filter(None, refusals))
    if not detailed(known):
        can = [n for n in detailed(MODELS) if n in SOLVED]
        yield (
            f"models: {_some(study.models)} has no model that follows failure while dem.engines is "
            f"{_some(study.dem.engines) if study.dem.engines else 'empty'}; it must "
            f"have {' or '.join(can)}"
        )


def _models_of_sample(study: Study, sample: str, models: tuple[str, ...] | None) -> Iterator[str]:
    """Faults of a sample's ``models``; engines that are not installed may be named too."""
    key, allowed = f"samples.{sample}.models", (*ENGINES, *study.models)
    yield from _names(key, models or (), allowed)
    can = detailed(name for name in study.model_names if name in MODELS)
    if models and can and {*models} <= {*allowed} and not {*models} & {*can}:
        yield f"{key}: {_some(models)} is not enough; it must have {' or '.join(can)}"


def _parts(study: Study, sample: str) -> Iterator[str]:
    """Each part of a sample must be in the study, and one model must run the whole sample."""
    solved = (name for name in study.models if name in SOLVED)
    known = (*ENGINES, *solved)
    for name, part in study.samples[sample].only.items():
        key = f"samples.{sample}.only"
        if name not in known:
            yield f"{key}: {shown(name)} is not allowed; it must be {' or '.join(known)}"
        for what, chosen, allowed in (
            ("meshes", part.meshes, study.meshes),
            ("eccentricities", part.eccentricities, study.eccentricities),
            ("variants", part.variants, tuple(study.variants)),
        ):
            yield from _among(f"{key}.{name}.{what}", chosen or (), what, allowed)
    names = detailed(name for name in study.models_of(sample) if name in MODELS)
    if names and not {*names} & {*study.models_of_whole(sample)}:
        yield (
            f"samples.{sample}.only: {_some(names)} run only parts of the study; one of them "
            "must run at all meshes and eccentricities"
        )


def _some(values: Iterable[object]) -> str:
    """The first of ``values`` in words."""
    words = ["torsion" if value == math.inf else str(value) for value in values]
    return ", ".join(words[:5]) + (", ..." if len(words) > 5 else "") or "nothing"


def models_of(study: Study, section: StructureSection) -> tuple[str, ...]:
    """Those of the study's models that analyse a structure."""
    names = section.models
    return tuple(
        name for name in study.model_names if name in ABLE and (names is None or name in names)
    )


def moves_support(description: Mapping[str, Any]) -> bool:
    """Whether the load of a ``description`` is a support that moves."""
    load = description.get(LOAD)
    return isinstance(load, Mapping) and "support" in load


def structure_faults(study: Study) -> Iterator[str]:
    """Everything that is wrong with the structures of ``study``, one line each."""
    for name, section in study.structures.items():
        key = f"structures.{name}"
        yield from _names(f"{key}.models", section.models or (), ABLE)
        if REFERENCE in section.variants:
            yield f"{key}.variants: the name {REFERENCE} is reserved; choose another name"
        if section.description is None:
            yield f"{key}: missing; give description or file"
            continue
        named = set(section.models or ABLE)
        if not models_of(study, section) and named <= set(ABLE) and not named & set(ENGINES):
            yield (
                f"{key}.models: none of these is in the study's models; it must have "
                f"{' or '.join(ABLE)}"
            )
        if all(moves_support(description) for _, _, description in section.described()):
            allowed = "one that is not, such as {acceleration: [1, 0, 0]}, is needed beside them"
            yield f"{key}.loads: all are supports that move; {allowed}"
        yield from dict.fromkeys(_unreadable(key, section))
        if section.measured is not None:
            yield from _measured_faults(key, section, section.measured.loads)


def _measured_faults(
    key: str, section: StructureSection, measured: Sequence[MeasuredCapacity]
) -> Iterator[str]:
    """Measured loads of no load or variant of a structure, or of one that is not in N."""
    cases = {(load, variant): whole for load, variant, whole in section.described()}
    loads, variants = (dict.fromkeys(each) for each in zip(*cases, strict=True))
    for number, each in enumerate(measured, start=1):
        place = f"{key}.measured.loads.{number}"
        yield from _among(f"{place}.load", (each.load,), "loads", loads)
        yield from _among(f"{place}.variant", (each.variant,), "variants", variants)
        load = cases.get((each.load, each.variant), {}).get(LOAD)
        if isinstance(load, Mapping) and not {"tilt", "support"}.isdisjoint(load):
            yield f"{place}.load: {each.load} is a tilt or a support; it must be a load in N"


def _unreadable(key: str, section: StructureSection) -> Iterator[str]:
    # Polygons take long to import.
    from sidmacib.structure.files import structure_file  # noqa: PLC0415
    from sidmacib.structure.files.loads import LoadSection  # noqa: PLC0415
    from sidmacib.structure.files.sections import OF_TIME  # noqa: PLC0415
    from sidmacib.structure.files.vehicle import MOVING  # noqa: PLC0415
    from sidmacib.structure.shaking import IN_TIME  # noqa: PLC0415

    for variant, whole in section.wholes():
        place = f"variants.{variant}" if variant != REFERENCE else "description"
        try:
            if CASES in whole and not section.loads:
                structure_file.demands_of(whole)
                for name in (each for each, case in load_cases(whole).items() if "vehicle" in case):
                    yield f"{key}.{place}.{CASES}.{name}.{MOVING}"
                names = [structure_case_name("", name) for name in load_cases(whole)]
                if len({*names}) < len(names):
                    allowed = "names must differ in letters, digits, _ and ."
                    yield f"{key}.{place}.{CASES}: {allowed}"
                continue
            own = {k: v for k, v in whole.items() if k not in (LOAD, CASES)}
            assembly = structure_file.assembly_of(own)
        except ValueError as error:
            yield f"{key}.{place}: {_in_a_line(error)}"
            continue
        if not section.loads and LOAD not in whole:
            yield f"{key}.{place}.{LOAD}: missing; a study needs it, or {CASES}, or {key}.loads"
            continue
        loads: Mapping[str, Any] = section.loads or {LOAD: whole[LOAD]}
        for name, load in loads.items():
            if isinstance(load, Mapping) and OF_TIME & {*load}:
                yield f"{key}.{place}: {IN_TIME}"
                continue
            try:
                beside = structure_file.permanent_of(assembly, whole)
                LoadSection.read(load, LOAD).on(assembly, beside)
            except ValueError as error:
                yield f"{key}.{f'loads.{name}' if section.loads else place}: {_in_a_line(error)}"


def _earthquake_faults(study: Study) -> Iterator[str]:
    """Structures that nothing moves in time, or that cannot be read."""
    for name, section in study.earthquakes.items():
        key, whole = f"earthquakes.{name}", section.description
        if whole is None:
            yield f"{key}.file: missing; it must be a file of multilock assembly"
            continue
        load = whole.get(LOAD)
        motions = load.get("ground", ()) if isinstance(load, Mapping) else ()
        if len(motions) != 1 and (section.records or not motions):
            allowed = "one, with its direction; a record is put in its place"
            yield f"{key}.{LOAD}.ground: has {len(motions)} motions; it must have {allowed}"
            continue
        from sidmacib.structure.files.structure_file import demands_of  # noqa: PLC0415 (as above)

        try:
            demands_of(whole, in_time=True)
        except ValueError as error:
            yield f"{key}: {_in_a_line(error)}"


def _in_a_line(error: ValueError) -> str:
    return " ".join(str(error).split())
