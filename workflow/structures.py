"""The cases of a study's structures."""

from collections.abc import Iterator, Mapping
from itertools import groupby
from operator import itemgetter
from typing import Any

from sidmacib.engines import ENGINES
from sidmacib.model import Ability
from sidmacib.models import MODELS, SOLVED
from sidmacib.quantities import shown
from workflow.case import REFERENCE, Case, StructureCase, StructureSubject, structure_case_name
from workflow.schema import Study
from workflow.schema.study import StructureSection

LOAD, SUPPORT = "load", "support"  # keys of a description, and of a load
ABLE = tuple(  # models of structures: those of rigid pieces
    name
    for name, model in MODELS.items()
    if Ability.RIGID in model.abilities and (name in ENGINES or name in SOLVED)
)


def structure_cases(study: Study) -> Iterator[StructureCase]:
    """Each structure with each load and variant, in each of its models."""
    numerics = study.dem.numerics.numerics()
    for name, section in study.structures.items():
        for model in models_of(study, section):
            engine = ENGINES.get(model)
            for load, variant, description in described(section):
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
        for load, variant, description in described(section):
            if moves_support(description):
                yade = "yade" in models_of(study, section)
                yield StructureSubject(name, load, description), variant, yade


def moves_support(description: Mapping[str, Any]) -> bool:
    """Whether the load of a ``description`` is a support that moves."""
    load = description.get(LOAD)
    return isinstance(load, Mapping) and SUPPORT in load


def models_of(study: Study, section: StructureSection) -> tuple[str, ...]:
    """Those of the study's models that analyse a structure."""
    names = section.models
    return tuple(
        name for name in study.model_names if name in ABLE and (names is None or name in names)
    )


def described(section: StructureSection) -> Iterator[tuple[str, str, dict[str, object]]]:
    """Load, variant and description of each case of a structure, whatever its model."""
    assert section.description is not None, "a file is read with the configuration"
    loads = section.loads or {LOAD: {}}
    for variant, changes in {REFERENCE: {}, **section.variants}.items():
        whole = changed(section.description, changes)
        for name, load in loads.items():
            yield name, variant, {**whole, "load": load} if load else whole


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


def structure_faults(study: Study) -> Iterator[str]:
    """Everything that is wrong with the structures of ``study``, one line each."""
    for name, section in study.structures.items():
        key = f"structures.{name}"
        for number, model in enumerate(section.models or ()):
            if model not in ABLE:
                yield f"{key}.models: {shown(model)} is not allowed; it must be {' or '.join(ABLE)}"
            elif model in (section.models or ())[:number]:
                yield f"{key}.models: {model} appears twice; each name must appear only once"
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
        if all(moves_support(description) for _, _, description in described(section)):
            allowed = "one that is not, such as {acceleration: [1, 0, 0]}, is needed beside them"
            yield f"{key}.loads: all are supports that move; {allowed}"
        yield from dict.fromkeys(_unreadable(key, section))


def _unreadable(key: str, section: StructureSection) -> Iterator[str]:
    # Polygons take long to import.
    from sidmacib.structure.files.loads import LoadSection  # noqa: PLC0415
    from sidmacib.structure.files.structure_file import assembly_of, permanent_of  # noqa: PLC0415

    for variant, group in groupby(described(section), key=itemgetter(1)):
        place = f"variants.{variant}" if variant != REFERENCE else "description"
        cases = [(load, description) for load, _, description in group]
        try:
            assembly = assembly_of({k: v for k, v in cases[0][1].items() if k != "load"})
        except ValueError as error:
            yield f"{key}.{place}: {_in_a_line(error)}"
            continue
        for load, description in cases:
            try:
                given = LoadSection.read(description.get(LOAD), LOAD)
                given.on(assembly, permanent_of(assembly, description))
            except ValueError as error:
                yield f"{key}.{f'loads.{load}' if section.loads else place}: {_in_a_line(error)}"


def _in_a_line(error: ValueError) -> str:
    return " ".join(str(error).split())
