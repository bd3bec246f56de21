"""The cases of a study's structures."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from sidmacib.engines import ENGINES
from sidmacib.model import Ability
from sidmacib.models import MODELS, SOLVED
from sidmacib.quantities import shown
from workflow.case import REFERENCE, Case, StructureCase, StructureSubject, structure_case_name
from workflow.schema import Study
from workflow.schema.study import StructureSection
from workflow.schema.values import NAME_LENGTH

# Keys of a description, and of a load.
LOAD, CASES, PERMANENT, SUPPORT = "load", "load_cases", "permanent", "support"
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


def support_cases(study: Study) -> Iterator[tuple[StructureSubject, str]]:
    """Each structure, its load and the variant, where a support moves: of no model."""
    for name, section in study.structures.items():
        for load, variant, description in described(section):
            if moves_support(description):
                yield StructureSubject(name, load, description), variant


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
    """Load, variant and description of each case of a structure, whatever its model.

    Loads are those of the study, or else the load cases of the description, or its load.
    """
    for variant, whole in _wholes(section):
        always = {key: value for key, value in whole.items() if key != CASES}
        if section.loads:
            for name, load in section.loads.items():
                yield name, variant, {**always, LOAD: load}
        elif cases := _cases(whole):
            for name, case in cases.items():
                load = {key: value for key, value in case.items() if key != PERMANENT}
                own = [*always.get(PERMANENT, ()), *case.get(PERMANENT, ())]
                yield name, variant, {**always, LOAD: load, **({PERMANENT: own} if own else {})}
        else:
            yield LOAD, variant, whole


def _cases(description: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    """The load cases of a ``description`` by name; none of what is not a mapping of mappings."""
    cases = description.get(CASES)
    if not isinstance(cases, Mapping) or not all(isinstance(v, Mapping) for v in cases.values()):
        return {}
    return {str(name): case for name, case in cases.items()}


def _wholes(section: StructureSection) -> Iterator[tuple[str, dict[str, Any]]]:
    """Each variant of a structure, with its loads as they are in the description."""
    assert section.description is not None, "a file is read with the configuration"
    for variant, changes in {REFERENCE: {}, **section.variants}.items():
        yield variant, changed(section.description, changes)


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
    from sidmacib.structure.files.structure_file import (  # noqa: PLC0415
        assembly_of,
        demands_of,
        permanent_of,
    )

    for variant, whole in _wholes(section):
        place = f"variants.{variant}" if variant != REFERENCE else "description"
        try:
            if CASES in whole and not section.loads:
                demands_of(whole)
                yield from _unnameable(f"{key}.{place}.{CASES}", _cases(whole))
                continue
            assembly = assembly_of({k: v for k, v in whole.items() if k not in (LOAD, CASES)})
        except ValueError as error:
            yield f"{key}.{place}: {_in_a_line(error)}"
            continue
        loads: Mapping[str, Any] = section.loads or {LOAD: whole.get(LOAD)}
        for name, load in loads.items():
            try:
                given = LoadSection.read(load, LOAD)
                given.on(assembly, permanent_of(assembly, whole))
            except ValueError as error:
                yield f"{key}.{f'loads.{name}' if section.loads else place}: {_in_a_line(error)}"


def _unnameable(key: str, cases: Iterable[str]) -> Iterator[str]:
    """A fault where the names of files cannot be made of those of load ``cases``."""
    names = [structure_case_name("", name) for name in cases]
    if len({*names}) < len(names):
        yield f"{key}: two names differ in other characters than letters, digits, _ and . only"
    for name in cases:
        if len(name) > NAME_LENGTH:
            yield f"{key}.{name}: too long; a name must have at most {NAME_LENGTH} letters"


def _in_a_line(error: ValueError) -> str:
    return " ".join(str(error).split())
