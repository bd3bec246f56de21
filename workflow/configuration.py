"""Read a study's configuration from a mapping or a YAML file; one line reports each error."""

import re
import sys
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from sidmacib.engines import ENGINES
from sidmacib.models import LAWS, MODELS, RESISTANCES, SOLVED
from sidmacib.quantities import shown
from sidmacib.reading import faults, shown_key
from sidmacib.validation import refused
from sidmacib.yaml_text import TextError, read_yaml
from workflow.consistency import inconsistencies, requirements, rule_refusal
from workflow.schema import Study, with_changes


class ConfigError(ValueError):
    """The configuration is not valid; the arguments are lines of text, one for each fault."""

    def __str__(self) -> str:
        return "\n".join(self.args)

    def of(self, path: Path) -> "ConfigError":
        """The same, each line beginning with the file's name."""
        return ConfigError(*(f"{path}: {line.removeprefix(f'{path}: ')}" for line in self.args))


class CallError(ConfigError):
    """A wrong argument of a command; the configuration itself may be right."""


def read_study_file(path: Path, results: str | None = None) -> Study:
    """The study in the YAML file ``path``; ``results``: overrides its results folder.

    Raises `ConfigError`, whose lines begin with the file's name.
    """
    config = load_configuration(path, {"results": results} if results is not None else {})
    try:
        return read_study(config)
    except ConfigError as error:
        raise error.of(path) from None


def load_configuration(path: Path, changes: Mapping[str, Any]) -> dict[str, Any]:
    """The keys and values in the YAML file ``path`` with ``changes``, section by section.

    Files of structures are read too. Raises `ConfigError` if a file cannot be read; `read_study`
    checks whether it is a study.
    """
    try:
        config = read_yaml(path)
    except TextError as error:
        raise ConfigError(f"{path}: {error}") from None
    if not isinstance(config, dict | None):
        raise ConfigError(
            f"{path}: {shown(config)} is not a study; it must be a mapping of keys to values"
        )
    return _with_descriptions(with_changes(config or {}, changes), path)


def read_study(config: Mapping[str, Any]) -> Study:
    """The study in ``config``; if it names no models, with all that support it.

    Raises `ConfigError`.
    """
    try:
        study = _with_able_models(Study.model_validate(_with_all_models(config)), config)
    except ValidationError as error:
        lines = [line if ": " in line else f"study: {line}" for line in faults(error)]
    else:
        study = _with_able_rules(study, config)
        lines = [*inconsistencies(study)]
    if lines:
        raise ConfigError(*lines)
    return study


def with_installed_engines(study: Study) -> Study:
    """``study`` without the engines that are not installed, which are named on stderr."""
    missing = {name: ENGINES[name].missing() for name in study.dem.engines}
    for reason in filter(None, missing.values()):
        print(f"{reason}. The study continues without it.", file=sys.stderr)
    engines = tuple(name for name, reason in missing.items() if reason is None)
    return study.model_copy(update={"dem": study.dem.model_copy(update={"engines": engines})})


def _with_descriptions(config: dict[str, Any], path: Path) -> dict[str, Any]:
    """``config`` with descriptions of structures, blocks from mesh files, and records as values.

    Files are relative to the one that names them: ``path``, or the file of a structure.
    """
    for kind in ("structures", "earthquakes"):
        if isinstance(sections := config.get(kind), Mapping):
            read = {
                name: _described(given, path, f"{path}: {kind}.{shown_key(name)}")
                if isinstance(given, Mapping)
                else given
                for name, given in sections.items()
            }
            config = {**config, kind: read}
    return config


def _described(given: Mapping[str, Any], path: Path, key: str) -> dict[str, Any]:
    """The section of a structure with what its files say; ``key``: its place, for errors."""
    # Polygons take long to import.
    from sidmacib.structure.files.structure_file import with_bodies  # noqa: PLC0415
    from sidmacib.structure.files.time_loads import with_records  # noqa: PLC0415

    section, own, place = {**given}, path, key
    if isinstance(file := section.get("file"), str):
        if "description" in section:
            raise ConfigError(f"{key}: file and description are both given; give only one")
        own, place = path.parent / file, f"{key}.file: {file}"
    variants, records = section.get("variants"), section.get("records")
    try:
        if own is not path:
            section["description"] = read_yaml(own)
        if "description" in section:
            whole = with_bodies(section["description"], own.parent)
            section["description"] = with_records(whole, own.parent)
        if isinstance(variants, Mapping):
            within = {which: with_bodies(of, own.parent) for which, of in variants.items()}
            section["variants"] = within
        if records is not None and not isinstance(records, Mapping):
            place = key
            section["records"] = _records(records, section.get("unit"), path.parent)
    except ValueError as error:
        raise ConfigError(f"{place}: {error}") from None
    return section


def _records(patterns: Any, unit: Any, folder: Path) -> dict[str, dict[str, list[float]]]:
    """The values of the records in files that fit ``patterns``, by names; ValueError."""
    from sidmacib.structure.files.block_files import files_named  # noqa: PLC0415 (as above)
    from sidmacib.structure.files.time_loads import recorded  # noqa: PLC0415
    from sidmacib.structure.shaking import UNITS  # noqa: PLC0415

    found: dict[str, dict[str, list[float]]] = {}
    for pattern in patterns if isinstance(patterns, list) else [patterns]:
        if not isinstance(pattern, str):
            raise refused("records", pattern, "names of files")
        if not (files := files_named(pattern, folder)):
            raise refused("records", pattern, "files that are there")
        for each in files:
            name = re.sub("[^A-Za-z0-9_.]", "_", each.stem)
            if name in found:
                allowed = "names must differ in letters, digits, _ and ."
                raise ValueError(f"records: two files are called {name}; {allowed}")
            found[name] = recorded(each, UNITS.get(str(unit))).values
    return found


def _with_all_models(config: Mapping[str, Any]) -> dict[str, Any]:
    """``config`` with all models if it names none."""
    dem = config.get("dem", {})
    if isinstance(dem, Mapping):
        dem = {"engines": tuple(ENGINES), **dem}
    models = tuple(name for name in (*SOLVED, *LAWS) if name not in RESISTANCES)
    return {"models": models, **config, "dem": dem}


def _with_able_rules(study: Study, config: Mapping[str, Any]) -> Study:
    """``study`` without the reductions that ``config`` does not name and a joint does not take."""
    if "reductions" in config.get("sidmacib", {}):
        return study
    joints = []
    for name in study.samples:
        with suppress(ValueError):  # found later
            joints.append(study.joint(name))
    rules = study.sidmacib.reductions
    able = tuple(each for each in rules if not any(rule_refusal(each, j) for j in joints))
    sidmacib = study.sidmacib.model_copy(update={"reductions": able})
    return study.model_copy(update={"sidmacib": sidmacib})


def _with_able_models(study: Study, config: Mapping[str, Any]) -> Study:
    """``study`` without those models that ``config`` does not name and that cannot model it.

    With the resistances that it asks for by its reliability.
    """

    def refused(name: str) -> bool:
        return any(
            MODELS[name].refusal(requirements(study, study.assembly, sample))
            for sample, section in study.samples.items()
            if section.models is None or name in section.models
        )

    def able(names: tuple[str, ...]) -> tuple[str, ...]:
        # A law that refuses a joint gives its reason in the tables.
        return tuple(name for name in names if name in LAWS or not refused(name))

    models = able(study.models) if "models" not in config else study.models
    asked = [name for name in study.reliability.resistances if name not in models]
    study = study.model_copy(update={"models": (*models, *asked)})
    if "engines" not in config.get("dem", {}):
        dem = study.dem.model_copy(update={"engines": able(study.dem.engines)})
        study = study.model_copy(update={"dem": dem})
    return study
